//! `tautline validate`.

use super::interrupt;
use super::outcome::{BAD_INPUT, Talk, complain};
use super::progress;
use crate::identify::{Doubt, Reading, Understood, check, examine_trials, implausible};
use crate::log::{Campaign, Survey};
use crate::prepare::left_out;
use crate::problem::{Problem, Problems, Result, Severity};
use crate::report::validation;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  tautline validate my-campaign\n  tautline validate my-campaign -o looked-at\n\nExit status: 0 usable (perhaps with warnings), 2 not."
)]
pub struct Arguments {
    /// Folder with a campaign.toml and its logs
    campaign: PathBuf,
    /// Make errors of doubts: declared scale, sign, zero, radii or gravity that the data contradict
    #[arg(long)]
    strict: bool,
    /// Folder to write: report.html and plots with each trial as it was understood, validation.json
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Replace an existing output folder
    #[arg(long, requires = "output")]
    force: bool,
    /// Write the figures as PNG too
    #[arg(long, requires = "output")]
    png: bool,
}

/// What was found.
#[derive(Default)]
struct Found {
    problems: Vec<Problem>,
    doubts: Vec<Doubt>,
    understood: Option<Understood>,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let (found, trials) = match Survey::read(&arguments.campaign) {
        Ok(survey) => (examine(&survey, arguments.strict, talk), survey.readable.len()),
        Err(Problems(problems)) => (Found { problems, ..Found::default() }, 0),
    };
    let Found { problems, doubts, understood } = found;
    let errors = problems.iter().filter(|p| p.severity == Severity::Error).count();
    let text = match (errors, problems.len()) {
        (0, 0) => format!("{}: {trials} trials, no problem found\n", arguments.campaign.display()),
        (0, n) => format!("{}: {trials} trials, usable; warnings: {n}\n", arguments.campaign.display()),
        (e, n) => format!("{}: not usable; errors: {e}, warnings: {}\n", arguments.campaign.display(), n - e),
    };
    let rows: Vec<Value> = problems.iter().map(problem_json).collect();
    let doubts: Vec<Value> = doubts.iter().map(doubt_json).collect();
    let json = json!({
        "campaign": arguments.campaign, "trials": trials, "errors": errors, "problems": rows, "doubts": doubts,
        "understood": understood.as_ref().map(validation::to_json),
    });
    let mut output = None;
    if let (Some(folder), Some(understood)) = (&arguments.output, &understood) {
        let made = interrupt::output(folder, arguments.force, "validate")?;
        validation::write(understood, &json, &problems, &made, arguments.png)?;
        output = Some(made);
    }
    complain(&Problems(problems));
    talk.finish(
        output,
        || json,
        |out| {
            understood.iter().try_for_each(|understood| validation::write_summary(out, understood))?;
            out.write_all(text.as_bytes())
        },
    )?;
    Ok(if errors == 0 { ExitCode::SUCCESS } else { ExitCode::from(BAD_INPUT) })
}

/// Every problem of `campaign.toml`, then of every trial by itself, then of all trials together.
fn examine(survey: &Survey, strict: bool, talk: &Talk) -> Found {
    let bar = progress::bar(talk, "checking", survey.readable.len());
    let mut problems = survey.problems.clone();
    let (mut doubts, mut understood) = (Vec::new(), None);
    match &survey.campaign {
        Some(campaign) => {
            let readable = Campaign { trials: survey.readable.clone(), ..campaign.clone() };
            let (readings, found): (Vec<_>, Vec<_>) = examine_trials(&readable, &|| bar.inc(1)).into_iter().unzip();
            for (entry, found) in readable.trials.iter().zip(found) {
                let is_stump = entry.is_incomplete() && found.iter().any(|p| p.severity == Severity::Error);
                problems.extend(if is_stump { vec![left_out(&readable, entry, &found)] } else { found });
            }
            let readings: Vec<Reading> = readings.into_iter().flatten().collect();
            if survey.is_whole {
                doubts = implausible(campaign, &readings);
                problems.splice(0..0, doubts.iter().map(|doubt| told(doubt, campaign, strict)));
                problems.extend(check(campaign, &readings));
                understood = Understood::of(campaign, &readings);
            }
        }
        None => {
            let found: Vec<Vec<Problem>> = survey.readable.par_iter().map(|entry| survey.problems_of(entry)).collect();
            problems.extend(found.concat());
        }
    }
    bar.finish_and_clear();
    Found { problems, doubts, understood }
}

fn told(doubt: &Doubt, campaign: &Campaign, strict: bool) -> Problem {
    let severity = if strict { Severity::Error } else { Severity::Warning };
    Problem { severity, ..doubt.problem(campaign) }
}

fn doubt_json(doubt: &Doubt) -> Value {
    let causes: Vec<&str> = doubt.causes.iter().map(|cause| cause.name()).collect();
    json!({ "causes": causes, "what": doubt.what, "cure": doubt.cure })
}

fn problem_json(problem: &Problem) -> Value {
    json!({
        "severity": match problem.severity { Severity::Error => "error", Severity::Warning => "warning" },
        "file": problem.file,
        "row": problem.row,
        "column": problem.column,
        "what": problem.what,
        "cure": problem.cure,
    })
}
