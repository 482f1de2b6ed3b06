//! `tautline demo`: the other commands, one after the other, on recordings that it makes.

use super::outcome::{Talk, say};
use crate::problem::{Problem, Result};
use clap::Parser;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

/// The joint that is recorded: the bundled elbow's, part of the program.
const JOINT: &str = include_str!("../../data/elbow/truth/model.json");

/// What happens, in words, and the command; `DEMO` stands for the folder.
const STEPS: [(&str, &str); 6] = [
    (
        "An elbow is recorded: sweeps at constant speed, and a cascade of cosines. (Simulated, with noise.)",
        "simulate --model DEMO/joint.json -o DEMO/recorded --speeds 10 --repeats 2 --cosines 2 --rate-hz 200 --seed 1",
    ),
    ("Its model is identified from the sweeps.", "identify DEMO/recorded -o DEMO/identified"),
    (
        "The model is judged on the cosines, which it has not seen.",
        "evaluate DEMO/recorded --model DEMO/identified -o DEMO/judged",
    ),
    (
        "Months later it is recorded again. A sheath has stiffened meanwhile; nobody knows.",
        "simulate --model DEMO/joint.json -o DEMO/later --speeds 5 --repeats 2 --cosines 3 --rate-hz 100 --seed 2 \
         --effect elastic_spring:stiffness_nm_rad=0.25,preload_nm=-0.1",
    ),
    ("Why do model and joint differ now?", "diagnose DEMO/later --model DEMO/identified -o DEMO/diagnosed"),
    (
        "The model with what was found, as code for a controller.",
        "export DEMO/diagnosed/model.json -o DEMO/exported --only c,rust,markdown",
    ),
];

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  tautline demo\n\nTakes less than a minute. It shows each command before it runs it; all stay in the folder to be looked at."
)]
pub struct Arguments {
    /// Folder to write
    #[arg(short, long, default_value = "tautline-demo")]
    output: PathBuf,
    /// Replace what a former demo wrote
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let folder = &arguments.output;
    let Some(name) = folder.to_str().filter(|name| !name.contains(char::is_whitespace)) else {
        let what = "has a name with blanks, and the demo shows commands to be typed";
        return Problem::error(folder, what, "name another with -o").alone();
    };
    if folder.exists() && !arguments.force {
        return Problem::error(folder, "exists", "name another with -o, or add --force after a former demo").alone();
    }
    let joint = folder.join("joint.json");
    std::fs::create_dir_all(folder)
        .and_then(|()| std::fs::write(&joint, JOINT))
        .or_else(|error| Problem::unwritable(&joint, "cannot be written", &error).alone())?;
    let mut told = Vec::new();
    for (words, command) in STEPS {
        told.push(step(words, &command.replace("DEMO", name), arguments.force, talk)?);
    }
    talk.result(
        || json!({ "format": "demo/1", "folder": folder, "steps": told }),
        |out| {
            let page = |of: &str| folder.join(of).join("report.html").display().to_string();
            writeln!(out, "\nNow open {} and {}.", page("identified"), page("diagnosed"))?;
            writeln!(out, "With recordings of your own: tautline validate --help")
        },
    )?;
    Ok(ExitCode::SUCCESS)
}

/// Shows and runs one command.
fn step(words: &str, command: &str, force: bool, talk: &Talk) -> Result<Value> {
    let quiet = talk.json || talk.quiet;
    if !quiet {
        say(|out| writeln!(out, "\n# {words}\n$ tautline {command}\n"))?;
    }
    let typed = std::iter::once("tautline").chain(command.split_whitespace()).chain(force.then_some("--force"));
    let parsed = super::Arguments::try_parse_from(typed)
        .or_else(|error| Problem::error("demo", error.to_string(), "report this").alone())?;
    let began = Instant::now();
    super::act(parsed.command, &Talk { json: false, quiet })?;
    Ok(json!({ "command": format!("tautline {command}"), "means": words, "took_s": began.elapsed().as_secs_f64() }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_is_a_command_that_exists() {
        for (_, command) in STEPS {
            let typed = std::iter::once("tautline").chain(command.split_whitespace());
            assert!(super::super::Arguments::try_parse_from(typed).is_ok(), "{command}");
        }
    }
}
