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
mod schema;
mod simulate;
mod stages;
mod validate;
mod wire;

use crate::problem::Result;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use outcome::Talk;
use std::process::ExitCode;

/// Identify, evaluate and diagnose models of cable-driven robot joints from recorded logs.
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
    /// Evaluate a model on recorded motions, best on held-out ones
    Evaluate(evaluate::Arguments),
    /// Write the prediction of every sample, and its parts
    Predict(predict::Arguments),
    /// Extract the torque that a person adds, from logs or a stream
    Interaction(interaction::Arguments),
    /// Find where model and recordings differ, and what causes it
    Diagnose(diagnose::Arguments),
    /// Compare a campaign's results with a stored baseline, for CI
    Check(check::Arguments),
    /// Compare runs of one joint under the same conditions
    Repeatability(repeatability::Arguments),
    /// Compare two models of one joint, before and after
    Compare(compare::Arguments),
    /// Identify many campaigns: one table, one report of the fleet
    Batch(batch::Arguments),
    /// Run one step of the protocol alone
    Fit(fit::Arguments),
    /// Draft a campaign.toml from logs: columns, units, motions
    Init(Box<init::Arguments>),
    /// Make a campaign of MATLAB, ROS 2 or TwinCAT Scope recordings
    Import(import::Arguments),
    /// List every problem of a campaign
    Validate(validate::Arguments),
    /// Make motions to record, within the joint's limits
    Excite(Box<excite::Arguments>),
    /// Write the model as C, Rust, MuJoCo, URDF, tables
    Export(export::Arguments),
    /// Make a model of a joint from a robot's URDF or MuJoCo XML
    Model(model::Arguments),
    /// Record a campaign from a model
    Simulate(Box<simulate::Arguments>),
    /// Drive a joint over EtherCAT along a plan and record it
    Capture(capture::Arguments),
    /// List and check what is on an EtherCAT bus, zero its sensor
    Rig(rig::Arguments),
    /// List the effects that a model may have beyond the formula
    Effects(effects::Arguments),
    /// Print the JSON Schema of a kind of file
    Schema(schema::Arguments),
    /// Print a page of the guide
    Guide(guide::Arguments),
    /// See it work in a minute, on recordings that it makes
    Demo(demo::Arguments),
    /// Write manual pages
    Man(man::Arguments),
    /// Print shell completions
    Completions(completions::Arguments),
}

/// The commands by what they are for, as the help lists them.
const GROUPS: [(&str, &[&str]); 6] = [
    ("Start", &["demo", "guide"]),
    ("Logs and campaigns", &["init", "import", "validate", "excite", "simulate", "capture", "rig"]),
    ("Model a joint", &["identify", "fit", "model", "effects", "export", "schema"]),
    ("Use and test a model", &["evaluate", "predict", "interaction", "diagnose"]),
    ("Compare and watch", &["compare", "repeatability", "check", "batch"]),
    ("Install", &["man", "completions"]),
];

/// The whole command line; its help lists the commands by `GROUPS`.
pub fn command() -> clap::Command {
    let command = Arguments::command();
    let about = |name: &str| {
        let found = command.find_subcommand(name).and_then(clap::Command::get_about);
        found.map_or_else(String::new, ToString::to_string)
    };
    let line = |name: &&str| format!("  {name:<14} {}\n", about(name));
    let group =
        |(title, names): &(&str, &[&str])| format!("{title}:\n{}\n", names.iter().map(line).collect::<String>());
    let groups: String = GROUPS.iter().map(group).collect();
    command.help_template(format!(
        "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{groups}Options:\n{{options}}\n{{after-help}}\n"
    ))
}

/// Parses the command line, runs the command, reports what failed.
pub fn run() -> ExitCode {
    let matches = command().get_matches();
    let Arguments { command, talk } = Arguments::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
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
        Command::Schema(arguments) => schema::run(&arguments, talk),
        Command::Guide(arguments) => guide::run(&arguments, talk),
        Command::Demo(arguments) => demo::run(&arguments, talk),
        Command::Man(arguments) => man::run(&arguments, talk),
        Command::Completions(arguments) => completions::run(&arguments),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn help_lists_every_command_once_in_lines_of_80_columns() {
        let mut grouped: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| names.iter().copied()).collect();
        let command = Arguments::command();
        let mut all: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        grouped.sort_unstable();
        all.sort_unstable();
        assert_eq!(grouped, all);
        let help = super::command().term_width(80).render_help().to_string();
        let long: Vec<&str> = help.lines().filter(|line| line.chars().count() > 80).collect();
        assert!(long.is_empty(), "{long:#?}");
    }
}
