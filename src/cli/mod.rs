//! The command line: one file per subcommand, no mathematics in it.
//!
//! Exit status: 0 done, 1 a judgement that failed, 2 bad input or usage.

mod arm;
mod batch;
mod capture;
mod check;
mod compare;
mod completions;
mod demo;
mod diagnose;
mod effects;
mod evaluate;
mod excite;
mod export;
mod fit;
mod follow;
mod guide;
mod identify;
mod import;
mod init;
mod interaction;
mod interrupt;
mod judged;
mod keyboard;
mod live;
mod man;
mod model;
mod outcome;
mod predict;
mod progress;
mod repeatability;
mod rig;
mod simulate;
mod validate;
mod wire;

use crate::problem::Result;
use clap::{Parser, Subcommand};
use outcome::Talk;
use std::process::ExitCode;

/// Identify, judge and explain the models of cable-driven robot joints from recorded logs.
#[derive(Debug, Parser)]
#[command(name = "tautline", version, max_term_width = 100, after_help = EXAMPLES)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    talk: Talk,
}

const EXAMPLES: &str = "Examples:
  tautline demo                             see it work in a minute
  tautline identify data/elbow -o out       identify a joint; then open out/report.html
  tautline validate my-campaign             list everything that is wrong with a campaign
  tautline simulate --model out/model.json -o simulated
                                            record a campaign from a model

Exit status: 0 done, 1 a judgement that failed, 2 bad input or usage; 130 after Ctrl-C, 143 after kill.";

#[derive(Debug, Subcommand)]
enum Command {
    /// Identify a joint from its campaign: all steps of the protocol
    Identify(identify::Arguments),
    /// Judge a model on recorded motions: best on ones that it was not identified from
    Evaluate(evaluate::Arguments),
    /// Write what a model makes of every sample: prediction, its parts, residual
    Predict(predict::Arguments),
    /// Extract the torque that a person adds, from logs or from samples as they come
    Interaction(interaction::Arguments),
    /// Find where the gap between model and recordings lies, and what causes it
    Diagnose(diagnose::Arguments),
    /// Hold a campaign against a stored baseline: has code or data changed what comes out?
    Check(check::Arguments),
    /// Compare runs of one joint under nominally the same conditions: what is repeatable
    Repeatability(repeatability::Arguments),
    /// Compare two models of one joint, before and after
    Compare(compare::Arguments),
    /// Identify many campaigns, on all cores: one table, one report of the fleet
    Batch(batch::Arguments),
    /// Run one step of the protocol alone
    Fit(fit::Arguments),
    /// Draft a campaign.toml from logs: columns, units, motions; asks what no data can tell
    Init(Box<init::Arguments>),
    /// Make a campaign of MATLAB, ROS 2 or TwinCAT Scope recordings
    Import(import::Arguments),
    /// List every problem of a campaign
    Validate(validate::Arguments),
    /// Make motions to record, held against the joint's limits
    Excite(Box<excite::Arguments>),
    /// Write the model for where it is used: controllers in C and Rust, MuJoCo, URDF, tables
    Export(export::Arguments),
    /// Make a model of a joint from a robot's URDF or MuJoCo XML
    Model(model::Arguments),
    /// Record a campaign from a model
    Simulate(Box<simulate::Arguments>),
    /// Drive a joint over EtherCAT along a plan and record it, safely; `--rig demo` needs no hardware
    Capture(capture::Arguments),
    /// List what is on an EtherCAT bus, check it against a rig, zero its torque sensor
    Rig(rig::Arguments),
    /// List the effects that a model may have beyond the paper's formula, with their parameters
    Effects(effects::Arguments),
    /// Print a page of the guide
    Guide(guide::Arguments),
    /// See it work in a minute, on recordings that it makes
    Demo(demo::Arguments),
    /// Write manual pages
    Man(man::Arguments),
    /// Print shell completions
    Completions(completions::Arguments),
}

/// Parses the command line, runs the command, reports what failed.
pub fn run() -> ExitCode {
    let Arguments { command, talk } = Arguments::parse();
    interrupt::catch();
    match act(command, &talk) {
        Ok(status) => status,
        Err(problems) => {
            outcome::complain(&problems);
            ExitCode::from(outcome::BAD_INPUT)
        }
    }
}

/// Runs `command`.
fn act(command: Command, talk: &Talk) -> Result<ExitCode> {
    match command {
        Command::Identify(arguments) => identify::run(&arguments, talk),
        Command::Evaluate(arguments) => evaluate::run(&arguments, talk),
        Command::Predict(arguments) => predict::run(&arguments, talk),
        Command::Interaction(arguments) => interaction::run(&arguments, talk),
        Command::Diagnose(arguments) => diagnose::run(&arguments, talk),
        Command::Check(arguments) => check::run(&arguments, talk),
        Command::Repeatability(arguments) => repeatability::run(&arguments, talk),
        Command::Compare(arguments) => compare::run(&arguments, talk),
        Command::Batch(arguments) => batch::run(&arguments, talk),
        Command::Fit(arguments) => fit::run(&arguments, talk),
        Command::Init(arguments) => init::run(&arguments, talk),
        Command::Import(arguments) => import::run(&arguments, talk),
        Command::Validate(arguments) => validate::run(&arguments, talk),
        Command::Excite(arguments) => excite::run(&arguments, talk),
        Command::Export(arguments) => export::run(&arguments, talk),
        Command::Model(arguments) => model::run(&arguments, talk),
        Command::Simulate(arguments) => simulate::run(&arguments, talk),
        Command::Capture(arguments) => capture::run(&arguments, talk),
        Command::Rig(arguments) => rig::run(&arguments, talk),
        Command::Effects(arguments) => effects::run(&arguments, talk),
        Command::Guide(arguments) => guide::run(&arguments, talk),
        Command::Demo(arguments) => demo::run(&arguments, talk),
        Command::Man(arguments) => man::run(&arguments, talk),
        Command::Completions(arguments) => completions::run(&arguments),
    }
}
