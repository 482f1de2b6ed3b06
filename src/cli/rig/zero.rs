//! `tautline rig zero`: the joint's zero from a pose.

use super::check::{self, look};
use super::rewrite::rewrite;
use crate::cli::outcome::Talk;
use crate::cli::wire::Described;
use crate::problem::{Problem, Result};
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Bring the joint into a pose whose angle you know, such as hanging (0) or held against a square (1.5708), and keep it
there: the drive's counts there then make the zero of the rig's file. Nothing is enabled.

Example: tautline rig zero --rig rig.toml --at-rad 0"
)]
pub struct Arguments {
    #[command(flatten)]
    rig: check::Arguments,
    /// Where the joint is, rad (m of a prismatic joint)
    #[arg(long, allow_negative_numbers = true)]
    at_rad: f64,
}

/// A joint that moved by more than this while it was looked at has no pose, rad.
const STILL_RAD: f64 = 0.01;

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let file = &arguments.rig.rig;
    let refuse = |what: String, cure: &str| Problem::error(file, what, cure).in_column("drive.zero_counts").alone();
    if !arguments.at_rad.is_finite() {
        return refuse(format!("cannot be found from {} rad", arguments.at_rad), "say where the joint is");
    }
    let described = Described::read(file)?;
    let drive = &described.rig.drive;
    let outcome = look(&arguments.rig, &described, talk)?;
    let Some(now) = outcome.now.as_ref().filter(|now| now.position_rad.is_finite()) else {
        return refuse("no position came".to_string(), "check the bus: `tautline rig check`");
    };
    if outcome.looked.spread_rad > STILL_RAD {
        return refuse(format!("the joint moved by {:.4} rad meanwhile", outcome.looked.spread_rad), "hold it still");
    }
    let counts = drive.counts(now.position_rad);
    let (before, zero) =
        (drive.zero_counts, (counts - drive.sign * arguments.at_rad * drive.counts_per_rad).round() + 0.0);
    if described.has_file {
        rewrite(file, &described.text, &[("drive", "zero_counts", zero)])?;
    }
    talk.result(
        || json!({ "zero_counts": zero, "before": before, "counts": counts, "at_rad": arguments.at_rad }),
        |out| writeln!(out, "zero_counts = {zero} (was {before}): {counts:.0} counts at {} rad", arguments.at_rad),
    )?;
    Ok(ExitCode::SUCCESS)
}
