//! `tautline rig tare`: the torque sensor's zero.

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
    after_help = "The cables must be slack or the joint hang free, so that the sensor feels nothing: what it reads
then becomes its zero in the rig's file."
)]
pub struct Arguments {
    #[command(flatten)]
    rig: check::Arguments,
}

/// Fewer samples than this tell no mean.
const SAMPLES: u32 = 100;
/// A sensor that feels nothing reads evenly: a spread beyond this share of its range is a load that changes.
const SPREAD: f64 = 0.01;

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let file = &arguments.rig.rig;
    let described = Described::read(file)?;
    let sensor = &described.rig.sensor;
    let outcome = look(&arguments.rig, &described, talk)?;
    let looked = outcome.looked;
    let refuse = |what: String, cure: &str| Problem::error(file, what, cure).in_column("sensor.zero_counts").alone();
    if let Some(doubt) = outcome.doubt.filter(|doubt| doubt.name().starts_with("sensor")) {
        return refuse(doubt.to_string(), "mend the sensor first");
    }
    if looked.samples < SAMPLES {
        return refuse(format!("{} samples came", looked.samples), "check the bus: `tautline rig check`");
    }
    if looked.sd_counts > SPREAD * sensor.saturated_counts {
        return refuse(format!("the sensor's value spreads by {:.0} counts", looked.sd_counts), "let go of the joint");
    }
    // Adding 0 takes the sign off a zero.
    let (before, zero) = (sensor.zero_counts, looked.mean_counts.round() + 0.0);
    if described.has_file {
        rewrite(file, &described.text, &[("sensor", "zero_counts", zero)])?;
    }
    let shift_nm = (zero - before) * sensor.nm_per_count;
    talk.result(
        || json!({ "zero_counts": zero, "before": before, "shift_nm": shift_nm, "sd_counts": looked.sd_counts }),
        |out| {
            writeln!(
                out,
                "zero_counts = {zero} (was {before}): {shift_nm:+.4} N m, noise {:.1} counts",
                looked.sd_counts
            )
        },
    )?;
    Ok(ExitCode::SUCCESS)
}
