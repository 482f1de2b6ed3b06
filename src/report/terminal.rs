//! The summary of an identification in a terminal.
//!
//! Colours only repeat what words say. Written through anstream's streams, which drop them where `NO_COLOR` is set or the output is not a
//! terminal.

use super::chart::{Figure, characters};
use super::identification::parameter;
use super::number::{counted, r_squared, significant};
use super::parameters::{Parameter, combination, friction, rests_on};
use super::plots;
use super::verdict::{refinement, share_of_load};
use super::wording::{LEFT_OUT, Units, met, moving, status_word};
use crate::identify::stribeck::exponentials;
use crate::identify::{CombinationFit, FreeFit, FrictionFit, Identification, Route};
use crate::model::{Both, Direction, Model, Status};
use anstyle::{AnsiColor, Style};
use std::io::{self, Write};
use std::path::Path;

/// Columns of running text: the widest that reads well, and the width where the output is not a terminal.
const WIDTH: usize = 112;
/// No narrower, however narrow the terminal is.
const WIDTH_MIN: usize = 40;
/// Columns that both directions' parameters take side by side.
const SIDE_BY_SIDE: usize = 20 + 2 * CELL;

pub(super) const BOLD: Style = Style::new().bold();
pub(super) const DIM: Style = Style::new().dimmed();
pub(super) const YELLOW: Style = AnsiColor::Yellow.on_default();

/// Writes the summary to `out`; `written` is where the files went.
pub fn write_summary(
    out: &mut impl Write,
    found: &Identification,
    campaign: &str,
    written: Option<&Path>,
) -> io::Result<()> {
    let units = Units::of(&found.model.joint);
    let (trials, rows) = (counted(found.trials, "trial", "trials"), counted(found.rows, "row", "rows"));
    let name = &found.model.joint.name;
    writeln!(out, "{BOLD}{name}{BOLD:#}  {DIM}campaign {campaign}: {trials}, {rows}{DIM:#}")?;
    match &found.route {
        Route::Sweeps(fits) => {
            sweeps(out, fits, &units)?;
            plots::friction::figure(found).map_or(Ok(()), |figure| picture(out, &figure))?;
        }
        Route::Free(free) => free_motion(out, free, &units)?,
    }
    parameter_table(out, &found.model)?;
    if let Some(fit) = &found.combination {
        curves(out, fit, &units)?;
    }
    combination_table(out, &found.model)?;
    if let Some(text) = rests_on(found, &units) {
        writeln!(out, "  {DIM}{}{DIM:#}", wrapped(&text, 2))?;
    }
    heading(out, "Whole series")?;
    writeln!(out, "  RMSE over all trials {}", units.torque(found.rmse_nm()))?;
    if let Some(refined) = &found.refinement {
        writeln!(out, "  {}", wrapped(&refinement(refined, &units), 2))?;
    }
    write_warnings(out, &found.warnings)?;
    if let Some(path) = written {
        let table = if found.legs.is_empty() { "" } else { "trials.csv, " };
        writeln!(out, "\nwritten to {BOLD}{}{BOLD:#}: model.json, {table}report.html, plots", path.display())?;
    }
    Ok(())
}

/// Writes the warnings, if there are any.
pub(super) fn write_warnings(out: &mut impl Write, warnings: &[String]) -> io::Result<()> {
    if !warnings.is_empty() {
        heading(out, "Warnings")?;
    }
    warnings.iter().try_for_each(|warning| writeln!(out, "  {YELLOW}!{YELLOW:#} {}", wrapped(warning, 4)))
}

pub(super) fn heading(out: &mut impl Write, text: &str) -> io::Result<()> {
    writeln!(out, "\n{BOLD}{}{BOLD:#}", wrapped(text, 0))
}

/// Columns to write in: the terminal's.
pub(super) fn width() -> usize {
    let terminal = console::Term::stdout();
    match terminal.is_term() {
        true => usize::from(terminal.size().1).clamp(WIDTH_MIN, WIDTH),
        false => WIDTH,
    }
}

/// Writes `rows` below `heads` in columns: the first and columns of words to the left, the others to the right. What does not fit the
/// terminal's width goes on in a line below.
pub(super) fn table(out: &mut impl Write, heads: &[String], rows: &[Vec<String>]) -> io::Result<()> {
    let all = || std::iter::once(heads).chain(rows.iter().map(Vec::as_slice));
    let wide: Vec<usize> = (0..heads.len())
        .map(|at| all().filter_map(|row| row.get(at)).map(|cell| cell.chars().count()).max().unwrap_or(0))
        .collect();
    let is_number = |at: usize| {
        let starts = |cell: &String| cell.starts_with(|c: char| c.is_ascii_digit() || "-+–\u{2212}".contains(c));
        at > 0 && rows.iter().filter_map(|row| row.get(at)).all(|cell| cell.is_empty() || starts(cell))
    };
    let room = width();
    for (row, style) in all().zip(std::iter::once(DIM).chain(std::iter::repeat(Style::new()))) {
        let (mut line, mut column) = (String::from("  "), 2);
        for (at, cell) in row.iter().enumerate() {
            if column + wide[at] > room && at > 0 {
                line = format!("{}\n      ", line.trim_end());
                column = 6;
            }
            let fill = " ".repeat(wide[at] - cell.chars().count());
            line += &if is_number(at) { format!("{fill}{cell}  ") } else { format!("{cell}{fill}  ") };
            column += wide[at] + 2;
        }
        writeln!(out, "{style}{}{style:#}", line.trim_end())?;
    }
    Ok(())
}

/// `text` in lines of at most `width()` columns, all but the first set in by `indent`.
pub fn wrapped(text: &str, indent: usize) -> String {
    wrapped_to(text, indent, width())
}

fn wrapped_to(text: &str, indent: usize, width: usize) -> String {
    let mut lines = String::new();
    let mut column = indent;
    // Spaces that do not break stay within their word, and are written as plain ones.
    for word in text.split_ascii_whitespace() {
        let length = word.chars().count();
        if column + length > width && column > indent {
            lines.push('\n');
            lines.push_str(&" ".repeat(indent));
            column = indent;
        } else if column > indent {
            lines.push(' ');
        }
        lines.push_str(&word.replace('\u{a0}', " "));
        column += length + 1;
    }
    lines
}

/// Writes the two directions' A, B(v) and forms.
pub fn sweeps(out: &mut impl Write, fits: &Both<FrictionFit>, units: &Units) -> io::Result<()> {
    heading(out, "Load and friction at constant speed")?;
    for direction in Direction::BOTH {
        let fit = fits.of(direction);
        let a = units.amplitude(&fit.a);
        let name = moving(direction);
        writeln!(out, "  {name:<12} {}", wrapped(&format!("A = {a}; B(v) {}", met(fit, units)), 15))?;
    }
    for direction in Direction::BOTH {
        let fit = fits.of(direction);
        let taken = exponentials(fit.taken.rates.len());
        writeln!(out, "  {:<12} {}", moving(direction), wrapped(&format!("{taken} selected; {}", fit.why), 15))?;
    }
    Ok(())
}

fn free_motion(out: &mut impl Write, free: &FreeFit, units: &Units) -> io::Result<()> {
    heading(out, "Friction from free motion")?;
    for (form, held_out_nm) in &free.forms {
        let selected = if *form == free.form { "selected" } else { "" };
        writeln!(out, "  {:<46} {:>12} held out  {selected}", form.name(free.is_loaded), units.torque(*held_out_nm))?;
    }
    if let Some(words) = share_of_load(free) {
        writeln!(out, "  {}", wrapped(&words, 2))?;
    }
    Ok(())
}

/// Friction in both directions, side by side where the terminal is wide enough.
pub fn parameter_table(out: &mut impl Write, model: &Model) -> io::Result<()> {
    let [up, down] = Direction::BOTH.map(|direction| friction(model, direction));
    heading(out, "Friction parameters, with 95 % intervals")?;
    let head = |direction| format!("{:<width$}", moving(direction), width = CELL);
    if width() < SIDE_BY_SIDE.min(WIDTH) {
        for (direction, rows) in [(Direction::Up, &up), (Direction::Down, &down)] {
            writeln!(out, "  {DIM}{:<6} {:<8} {}{DIM:#}", "", "unit", head(direction).trim_end())?;
            rows.iter().try_for_each(|row| writeln!(out, "  {:<6} {:<8} {}", row.name, row.unit, cell(row, 0)))?;
        }
        return Ok(());
    }
    writeln!(out, "  {DIM}{:<6} {:<8} {} {}{DIM:#}", "", "unit", head(Direction::Up), head(Direction::Down))?;
    for (up, down) in up.iter().zip(&down) {
        writeln!(out, "  {:<6} {:<8} {} {}", up.name, up.unit, cell(up, CELL), cell(down, 0))?;
    }
    Ok(())
}

/// Width of a direction's column.
const CELL: usize = 50;

/// Value, interval and status, filled up to `width` without counting the colours.
fn cell(parameter: &Parameter, width: usize) -> String {
    let value = if parameter.left_out { "-".to_string() } else { significant(parameter.value, 4) };
    let unit = if parameter.direction.is_none() && !parameter.unit.is_empty() {
        format!(" {}", parameter.unit)
    } else {
        String::new()
    };
    let value = format!("{value}{unit}");
    let range = parameter.interval();
    let (word, style) = match &parameter.confidence {
        _ if parameter.left_out => (LEFT_OUT, DIM),
        None => ("as declared", DIM),
        Some(c) => (status_word(c.status), style(c.status)),
    };
    let plain = format!("{value:<10} {range:<25} {word}");
    let fill = width.saturating_sub(plain.chars().count());
    format!("{value:<10} {range:<25} {style}{word}{style:#}{:fill$}", "")
}

fn style(status: Status) -> Style {
    match status {
        Status::Pinned => AnsiColor::Green.on_default(),
        Status::TradeOff => YELLOW,
        Status::Merged => YELLOW,
        Status::Flat => DIM,
        Status::AtBound => AnsiColor::Red.on_default(),
    }
}

/// Writes the curve's parameters and the clearance.
pub fn combination_table(out: &mut impl Write, model: &Model) -> io::Result<()> {
    for row in combination(model) {
        writeln!(out, "  {:<10} {}", row.name, cell(&row, 0))?;
    }
    Ok(())
}

/// Writes the curves side by side.
pub fn curves(out: &mut impl Write, fit: &CombinationFit, units: &Units) -> io::Result<()> {
    heading(out, "Change of friction after a reversal")?;
    for (at, curve) in fit.curves.iter().enumerate() {
        let own = parameter(&curve.curve).map_or(String::new(), |(name, x)| format!("{name} = {}", significant(x, 4)));
        let notes = [(at == fit.taken, "selected"), (at == fit.supported && at != fit.taken, "best supported")];
        let note: Vec<&str> = notes.iter().filter(|(applies, _)| *applies).map(|(_, note)| *note).collect();
        let (rmse, r_squared) = (units.torque(curve.rmse_nm), r_squared(curve.r_squared));
        let name = curve.kind.name();
        writeln!(out, "  {name:<10} {own:<14} RMSE {rmse:>11}   R² {r_squared:>7}   {}", note.join(", "))?;
    }
    Ok(())
}

/// Writes `figure`'s panels as characters, where somebody looks at a terminal.
pub(super) fn picture(out: &mut impl Write, figure: &Figure) -> io::Result<()> {
    if !console::Term::stdout().is_term() {
        return Ok(());
    }
    let (Some(first), Some(last)) = (figure.rows.first(), figure.rows.last()) else { return Ok(()) };
    for (panel, lowest) in first.panels.iter().zip(&last.panels) {
        let title = if panel.title.is_empty() { &figure.title } else { &panel.title };
        let unit = if panel.y.label.is_empty() { String::new() } else { format!("; {}", panel.y.label) };
        writeln!(out, "\n  {DIM}{title}{unit}{DIM:#}")?;
        characters(panel, &lowest.x.label, width().min(PICTURE))
            .iter()
            .try_for_each(|line| writeln!(out, "  {line}"))?;
    }
    Ok(())
}

/// Columns of a picture.
const PICTURE: usize = 78;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_tables_fit_a_narrow_terminal() {
        let text = "a diagnosis of the joint that moves up and down between two cables of one length ".repeat(6);
        assert!(wrapped_to(&text, 2, 80).lines().all(|line| line.chars().count() <= 80));
        let heads = ["trial", "RMSE", "what"].map(String::from);
        let rows = vec![["a long name of a trial".repeat(3), "1.2".into(), "words about it ".repeat(3)].to_vec(); 2];
        let mut out = Vec::new();
        table(&mut out, &heads, &rows).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(
            text.lines().all(|line| anstream::adapter::strip_str(line).to_string().chars().count() <= WIDTH),
            "{text}"
        );
    }
}
