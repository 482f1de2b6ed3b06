//! A check on the terminal: what moved, by how much, whether it matters.

use super::{Names, told};
use crate::check::{Checked, Finding, Outcome, Part};
use crate::report::number::counted;
use crate::report::terminal::{BOLD, DIM, YELLOW, heading, wrapped};
use anstyle::{AnsiColor, Style};
use std::io::{self, Write};

const RED: Style = AnsiColor::Red.on_default().bold();
const GREEN: Style = AnsiColor::Green.on_default();
/// Findings of one kind that are listed individually.
const TOLD: usize = 20;

/// Writes what `checked` found to `out`; nothing but the verdict where nothing moved.
pub fn write_summary(out: &mut impl Write, checked: &Checked, names: &Names) -> io::Result<()> {
    let Names { campaign, baseline, stored_by, .. } = names;
    writeln!(out, "{BOLD}{campaign}{BOLD:#}  {DIM}compared with {baseline}, stored by tautline {stored_by}{DIM:#}")?;
    let regressed = gravest(checked);
    list(out, "Regressed", RED, &regressed)?;
    for (title, style, outcome) in [
        ("Data changed", YELLOW, Outcome::Changed),
        ("Errors that shrank", GREEN, Outcome::Better),
        ("Moved within their confidence", DIM, Outcome::Within),
        ("Moved, but too loosely known to tell", DIM, Outcome::Untold),
    ] {
        let found: Vec<&Finding> = checked.with(outcome).collect();
        list(out, title, style, &found)?;
    }
    match checked.with(Outcome::Rounded).count() {
        0 => {}
        n => writeln!(out, "\n{DIM}{}: the same except for rounding{DIM:#}", counted(n, "trial", "trials"))?,
    }
    let of = |part: Part| checked.findings.iter().filter(|finding| finding.part == part).count();
    let all = format!(
        "{}, {}, {}, {}",
        counted(of(Part::Setting), "setting", "settings"),
        counted(of(Part::Data), "trial", "trials"),
        counted(of(Part::Choice), "choice", "choices"),
        counted(of(Part::Figure), "figure", "figures")
    );
    match regressed.len() {
        0 => writeln!(out, "\n{GREEN}within tolerance{GREEN:#}: {all}"),
        n => writeln!(out, "\n{RED}regressed{RED:#}: {n} of {all}; where that is meant, store it with --update"),
    }
}

/// What regressed, the gravest first: what is no figure, then figures by how far they moved, in tolerances.
pub(super) fn gravest(checked: &Checked) -> Vec<&Finding> {
    let mut found: Vec<&Finding> = checked.with(Outcome::Regressed).collect();
    let far = |finding: &Finding| if finding.tolerances().is_nan() { f64::INFINITY } else { finding.tolerances() };
    found.sort_by(|a, b| {
        let rank = |f: &Finding| f.part == Part::Figure;
        rank(a).cmp(&rank(b)).then(far(b).total_cmp(&far(a)))
    });
    found
}

fn list(out: &mut impl Write, title: &str, style: Style, found: &[&Finding]) -> io::Result<()> {
    if found.is_empty() {
        return Ok(());
    }
    heading(out, &format!("{title}: {}", found.len()))?;
    for finding in found.iter().take(TOLD) {
        let name = &finding.name;
        writeln!(out, "  {style}{name}{style:#}  {}", wrapped(&told(finding), 4))?;
    }
    match found.len() - found.len().min(TOLD) {
        0 => Ok(()),
        more => writeln!(out, "  {DIM}and {more} more: --format json lists all{DIM:#}"),
    }
}
