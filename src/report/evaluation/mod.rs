//! An evaluation as `evaluation.json`, on the terminal, and as a page.

mod json;
mod page;

pub use json::to_json;
pub use page::page;

use super::number::{counted, significant, with_spread};
use super::terminal::{BOLD, DIM, heading, table, write_warnings};
use super::wording::Units;
use crate::evaluate::{Evaluation, Group, Rival, Source, Split, Spread};
use std::io::{self, Write};
use std::path::Path;

/// Writes the summary to `out`; `written` is where the files went.
pub fn write_summary(out: &mut impl Write, found: &Evaluation, campaign: &str, written: &Path) -> io::Result<()> {
    let units = Units::of(&found.model.joint);
    let trials = counted(found.trials.len(), "trial", "trials");
    writeln!(
        out,
        "{BOLD}{}{BOLD:#}  {DIM}evaluated on {trials} of campaign {campaign}{DIM:#}",
        found.model.joint.name
    )?;
    heading(out, &format!("Error, both sides low-passed at {} Hz", significant(found.lowpass_hz, 3)))?;
    let (unit, factor) = scale(found, &units);
    let scaled = |s: Spread| format!("{} {unit}", with_spread(factor * s.mean, factor * s.sd));
    let row = |group: &Group| {
        let name = group_name(group, &units);
        vec![name, group.trials.len().to_string(), scaled(group.rmse_nm), scaled(group.mae_nm)]
    };
    let heads = ["motion", "trials", "RMSE", "MAE"].map(String::from);
    table(out, &heads, &found.groups.iter().map(row).collect::<Vec<_>>())?;
    heading(out, "By change-over curve, all trials together")?;
    let row = |(at, rival): (usize, &Rival)| {
        let Split { all, stable, transition } = found.together(|t| &t.rivals[at]);
        let own = if rival.source == Source::Model { "the model's" } else { "" };
        let figures = [all.rmse_nm, stable.rmse_nm, transition.rmse_nm, all.peak_nm].map(|x| units.torque(x));
        std::iter::once(rival.kind.name().to_string()).chain(figures).chain([own.to_string()]).collect()
    };
    let heads = ["curve", "RMSE", "stable state", "transition", "peak", ""].map(String::from);
    table(out, &heads, &found.rivals.iter().enumerate().map(row).collect::<Vec<_>>())?;
    let raw = found.together(|t| &t.raw).all;
    writeln!(
        out,
        "\n  Raw, neither side filtered: RMSE {}, MAE {}",
        units.torque(raw.rmse_nm),
        units.torque(raw.mae_nm)
    )?;
    write_warnings(out, &found.warnings)?;
    writeln!(out, "\nwritten to {BOLD}{}{BOLD:#}: evaluation.json, report.html, plots", written.display())
}

/// Unit and factor that suit the error over all trials.
fn scale(found: &Evaluation, units: &Units) -> (&'static str, f64) {
    units.torque_scale(found.overall().all.rmse_nm)
}

/// Words of a group.
fn group_name(group: &Group, units: &Units) -> String {
    let speed =
        group.protocol.speed_rad_s().map_or(String::new(), |v| format!(" {} {}", significant(v, 3), units.speed));
    let trajectory = group.trajectory.as_ref().map_or(String::new(), |name| format!(" {name}"));
    format!("{}{speed}{trajectory}", group.protocol.name())
}
