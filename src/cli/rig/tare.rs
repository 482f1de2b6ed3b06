//! `tautline rig tare`: the torque sensor's zero.

use super::check::{self, look};
use crate::cli::outcome::Talk;
use crate::cli::wire::Described;
use crate::problem::{Problem, Result};
use serde_json::json;
use std::io::Write;
use std::path::Path;
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
    if !described.is_demo {
        rewrite(file, &described.text, "[sensor]", zero)?;
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

/// Puts `zero` in place of `zero_counts` of `place` (`[sensor]`), and leaves all else of the file as it stands.
///
/// Errors: the line is not found, or the file cannot be written.
pub(super) fn rewrite(file: &Path, text: &str, place: &str, zero: f64) -> Result<()> {
    let mut section = "";
    let mut found = false;
    let lines = text.lines().map(|line| {
        let bare = line.trim_start();
        if bare.starts_with('[') {
            section = bare.split(['#', ' ']).next().unwrap_or_default();
        }
        match bare.strip_prefix("zero_counts").map(str::trim_start).and_then(|rest| rest.strip_prefix('=')) {
            Some(rest) if section == place => {
                found = true;
                let comment = rest.find('#').map_or(String::new(), |at| format!("   {}", &rest[at..]));
                format!("zero_counts = {zero}{comment}")
            }
            _ => line.to_string(),
        }
    });
    let text = lines.collect::<Vec<_>>().join("\n") + "\n";
    if !found {
        let what = format!("has no line `zero_counts = ...` under {place}");
        return Problem::error(file, what, format!("write `zero_counts = {zero}` there")).alone();
    }
    let folder = file.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let written = tempfile::NamedTempFile::new_in(folder).and_then(|mut new| {
        new.write_all(text.as_bytes())?;
        if let Ok(old) = std::fs::metadata(file) {
            new.as_file().set_permissions(old.permissions())?;
        }
        new.persist(file).map_err(|error| error.error)
    });
    match written {
        Ok(_) => Ok(()),
        Err(error) => Problem::unwritable(file, "cannot be written", &error).alone(),
    }
}
