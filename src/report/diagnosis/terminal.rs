//! The summary of a diagnosis on the terminal.

use super::names::{Role, bounds, floor_source};
use super::next::next_steps;
use super::parameters::{Shown, shown};
use super::words::{flexible_shrink, kept_together, percent, shrink, taken, verdict};
use crate::diagnose::Diagnosis;
use crate::report::number::counted;
use crate::report::plots::diagnosis::budget::{self, added};
use crate::report::terminal::{BOLD, DIM, heading, picture, wrapped, write_warnings};
use crate::report::wording::Units;
use std::io::{self, Write};
use std::path::Path;

/// Places told.
const PLACES: usize = 3;
/// Candidates told.
const CANDIDATES: usize = 5;
/// Parameters told of a candidate that was not taken.
const PARAMETERS: usize = 3;
/// Columns before a candidate's parameters.
const INDENT: usize = 6;
/// Columns before the note of a number, and before how a candidate is taken.
const NOTE: usize = 41;
const HOW: usize = 47;
/// Columns before what is said of a place.
const PLACE: usize = 52;

/// Writes the summary to `out`; `written` is where the files went.
pub fn write_summary(out: &mut impl Write, found: &Diagnosis, campaign: &str, written: &Path) -> io::Result<()> {
    let trials = counted(found.views.len(), "trial", "trials");
    let name = &found.before.joint.name;
    writeln!(out, "{BOLD}{name}{BOLD:#}  {DIM}diagnosed on {trials} of campaign {campaign}{DIM:#}")?;
    writeln!(out, "\n  {}", wrapped(&verdict(found), 2))?;
    gap(out, found)?;
    if found.verdict.tells_of_a_gap() {
        picture(out, &budget::figure(found))?;
    }
    places(out, found)?;
    candidates(out, found)?;
    motion(out, found)?;
    heading(out, "What to do next")?;
    next_steps(found).iter().try_for_each(|step| writeln!(out, "  {}", wrapped(step, 2)))?;
    write_warnings(out, &found.warnings)?;
    writeln!(out, "\nwritten to {BOLD}{}{BOLD:#}: diagnosis.json, model.json, report.html, plots", written.display())
}

fn gap(out: &mut impl Write, found: &Diagnosis) -> io::Result<()> {
    let units = Units::of(&found.before.joint);
    let (gap, verdict) = (&found.gap, &found.verdict);
    heading(out, &format!("Gap (RMS above the noise floor), on held-out {}", found.held_out))?;
    let mut row = |name: &str, value_nm: f64, note: String| {
        writeln!(out, "  {name:<24} {:>12}  {DIM}{}{DIM:#}", units.torque(value_nm), wrapped(&note, NOTE))
    };
    row("as delivered", verdict.gap_before_nm, format!("RMSE {}", units.torque(gap.rmse_nm)))?;
    if verdict.tells_of_a_gap() {
        row("with the causes found", verdict.gap_after_nm, format!("shrinks by {}", shrink(verdict.shrink)))?;
        let flexible = flexible_shrink(found);
        let note = format!("shrinks by {}: without any named cause", percent(flexible));
        row("with a flexible fit", verdict.gap_before_nm * (1.0 - flexible), note)?;
    }
    let floor = format!("upper limit; {}, {}", units.torque(gap.floor.rms_nm), floor_source(&gap.floor));
    row("noise floor", gap.floor.upper_nm(), floor)?;
    writeln!(
        out,
        "  {:<24} {:>12}  {DIM}in the verdict: share of such verdicts right on simulated joints{DIM:#}",
        "confidence",
        percent(verdict.confidence)
    )
}

/// The gap in motion, where a simulator's log was compared.
fn motion(out: &mut impl Write, found: &Diagnosis) -> io::Result<()> {
    let Some(gap) = &found.motion else { return Ok(()) };
    heading(out, "Beside the simulator's log")?;
    let lines = super::motion::lines(gap, found.before.joint.kind);
    lines.iter().try_for_each(|line| writeln!(out, "  {}", wrapped(line, 2)))
}

fn places(out: &mut impl Write, found: &Diagnosis) -> io::Result<()> {
    let units = Units::of(&found.before.joint);
    if found.places.is_empty() || !found.verdict.tells_of_a_gap() {
        return Ok(());
    }
    heading(out, "What the gap depends on: share of its mean square (quantities are correlated)")?;
    for at in found.places.iter().take(PLACES) {
        let samples = format!("{} of the samples, RMS {}", percent(at.share_of_samples), units.torque(at.rmse_nm));
        writeln!(
            out,
            "  {:<42} {:>5}  {DIM}{}{DIM:#}",
            bounds(at),
            percent(at.share_of_gap),
            wrapped(&samples, PLACE)
        )?;
    }
    Ok(())
}

fn candidates(out: &mut impl Write, found: &Diagnosis) -> io::Result<()> {
    if found.candidates.is_empty() {
        return Ok(());
    }
    heading(out, "Candidate causes, ranked: how far the gap shrinks [95 % interval]; of several, the part of each")?;
    let together = taken(found).count() > 1;
    // Of a single cause the shrink as a whole is told, in which they have their part.
    if let Some(share) = added(None, found).filter(|_| together) {
        let adds = format!("adds {}", percent(share));
        writeln!(out, "  {:<24} {adds:>18}  of the model, moved within their confidence", "own parameters")?;
    }
    for candidate in found.candidates.iter().take(CANDIDATES) {
        let role = Role::of(candidate, found);
        let (bold, plain) =
            if role == Role::Taken { (format!("{BOLD}"), format!("{BOLD:#}")) } else { Default::default() };
        let range = match added(Some(candidate.cause), found).filter(|_| together) {
            Some(share) => format!("adds {}", percent(share)),
            None => shrink(candidate.shrink),
        };
        let how =
            [role.name(), candidate.how].into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>().join(", ");
        writeln!(out, "  {bold}{:<24}{plain} {range:>18}  {}", candidate.cause.name(), wrapped(&how, HOW))?;
        let all = shown(candidate, found);
        let told = if role == Role::Taken { all.len() } else { PARAMETERS.min(all.len()) };
        let mut parameters: Vec<String> = all[..told].iter().map(Shown::sentence).collect();
        if told < all.len() {
            parameters.push(format!("and {} more", all.len() - told));
        }
        if !parameters.is_empty() {
            writeln!(out, "{:INDENT$}{DIM}{}{DIM:#}", "", wrapped(&kept_together(&parameters.join("; ")), INDENT))?;
        }
    }
    let rest = found.candidates.len().saturating_sub(CANDIDATES);
    if rest > 0 {
        writeln!(out, "  {DIM}and {} in the report{DIM:#}", counted(rest, "more cause", "more causes"))?;
    }
    Ok(())
}
