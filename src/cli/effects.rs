//! `tautline effects`.

use super::outcome::Talk;
use crate::problem::Result;
use crate::report::effects::{as_json, write_list};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Parameters with bounds must be given; a strength that is left out is 0.

Examples:
  tautline effects
  tautline simulate --model out/model.json -o gap --effect torque_ripple:periods_per_rad=8,sin_1_nm=0.05")]
pub struct Arguments {}

pub fn run(_: &Arguments, talk: &Talk) -> Result<ExitCode> {
    talk.result(as_json, write_list)?;
    Ok(ExitCode::SUCCESS)
}
