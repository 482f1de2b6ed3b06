//! `tautline model`.

use super::outcome::{Talk, complain};
use crate::problem::{Problem, Problems, Result};
use crate::report::json_text;
use crate::robots;
use clap::Subcommand;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline model from robot.xml --joint elbow -o model.json
  tautline simulate --model model.json -o simulated")]
pub struct Arguments {
    #[command(subcommand)]
    action: Action,
}

#[derive(Debug, Subcommand)]
enum Action {
    /// Make a model of what a robot's description says of a joint: URDF or MuJoCo XML
    From(From),
}

#[derive(Debug, clap::Args)]
struct From {
    /// The robot: a URDF or a MuJoCo XML
    robot: PathBuf,
    /// The joint's name in it
    #[arg(long)]
    joint: String,
    /// File to write
    #[arg(short, long, default_value = "model.json")]
    output: PathBuf,
    /// Replace an existing file
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let Action::From(from) = &arguments.action;
    let described = robots::read(&from.robot, &from.joint)?;
    if from.output.exists() && !from.force {
        return Problem::error(&from.output, "exists", "name another file, or replace it with --force").alone();
    }
    let model = described.to_json();
    std::fs::write(&from.output, json_text(&model))
        .or_else(|error| Problem::unwritable(&from.output, "cannot be written", &error).alone())?;
    let unknown = |what: &String| Problem::warning(&from.robot, format!("unknown: {what}"), "");
    complain(&Problems(described.unknown.iter().map(unknown).collect()));
    talk.result(
        || model,
        |out| {
            let unit = described.kind.torque_unit();
            writeln!(
                out,
                "{}: friction {} {unit}, damping {}, inertia {:.6}, gravity {:.6} {unit} at 0 and {:.6} at 90 deg",
                from.output.display(),
                described.friction_nm,
                described.damping_nm_s_rad,
                described.inertia_kg_m2,
                described.gravity_nm.0,
                described.gravity_nm.1
            )
        },
    )?;
    Ok(ExitCode::SUCCESS)
}
