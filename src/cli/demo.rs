//! `tautline demo`: the other commands, one after the other, on recordings that it makes.

use super::outcome::{Talk, say};
use crate::problem::{Problem, Result};
use crate::report::number::significant;
use clap::Parser;
use serde_json::{Value, json};
use std::io::Write;
use std::path::{Path, PathBuf};
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
        "The model is evaluated on all of it. (The sweeps gave its friction, the cosines how it changes over at reversals.)",
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
    let found = Found::read(&folder.join("diagnosed/diagnosis.json"))?;
    let page = folder.join("diagnosed/report.html");
    talk.result(
        || json!({ "format": "demo/1", "folder": folder, "steps": told }),
        |out| {
            writeln!(out, "\nWithheld from tautline: {WITHHELD}")?;
            writeln!(out, "Found from the logs:    {}", found.told)?;
            writeln!(
                out,
                "Gap above the floor:    {} mN m before, {} mN m with the cause added",
                found.before_mnm, found.after_mnm
            )?;
            writeln!(out, "Figure:                 {}", page.display())?;
            writeln!(out, "Your own logs:          tautline init FOLDER -o my-campaign")
        },
    )?;
    Ok(ExitCode::SUCCESS)
}

/// What was changed before the second recording, and no command was told.
const WITHHELD: &str = "an elastic spring of 0.25 N m/rad (a stiffened sheath)";

/// What the diagnosis found.
struct Found {
    /// The causes, the spring's stiffness, and how probable that is.
    told: String,
    before_mnm: String,
    after_mnm: String,
}

impl Found {
    /// Of the file that `diagnose` wrote.
    fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)
            .or_else(|error| Problem::error(path, format!("cannot be read: {error}"), "run the demo again").alone())?;
        let written: Value = serde_json::from_str(&text)
            .or_else(|error| Problem::error(path, format!("is no JSON: {error}"), "report this").alone())?;
        let verdict = &written["verdict"];
        let torque = |key: &str| verdict[key].as_f64().map_or("?".to_string(), |x| significant(1e3 * x, 3));
        let named: Vec<&str> = verdict["effects"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        let causes = if named.is_empty() { vec!["nothing"] } else { named };
        let spring = &written["causes"][0]["parameters"]["stiffness_nm_rad"];
        let stiffness = spring.as_f64().map_or_else(String::new, |k| format!(" of {} N m/rad", significant(k, 3)));
        let sure = verdict["confidence"].as_f64().map_or("?".to_string(), |p| format!("{:.0}", 100.0 * p));
        Ok(Self {
            told: format!("{}{stiffness}; probability {sure} %", causes.join(", ")),
            before_mnm: torque("gap_before_nm"),
            after_mnm: torque("gap_after_nm"),
        })
    }
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
    super::act(parsed.command, &Talk { json: false, quiet, open: false })?;
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
