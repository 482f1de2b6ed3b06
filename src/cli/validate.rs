//! `tautline validate`.

use super::outcome::{BAD_INPUT, Talk, complain};
use super::progress;
use crate::identify::{check, examine_trials};
use crate::log::{Campaign, Survey};
use crate::prepare::left_out;
use crate::problem::{Problem, Problems, Result, Severity};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  tautline validate my-campaign\n\nExit status: 0 usable (perhaps with warnings), 2 not."
)]
pub struct Arguments {
    /// Folder with a campaign.toml and its logs
    campaign: PathBuf,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let (problems, trials) = match Survey::read(&arguments.campaign) {
        Ok(survey) => (problems_of(&survey, talk), survey.readable.len()),
        Err(Problems(found)) => (found, 0),
    };
    let errors = problems.iter().filter(|p| p.severity == Severity::Error).count();
    let text = match (errors, problems.len()) {
        (0, 0) => format!("{}: {trials} trials, no problem found\n", arguments.campaign.display()),
        (0, n) => format!("{}: {trials} trials, usable; warnings: {n}\n", arguments.campaign.display()),
        (e, n) => format!("{}: not usable; errors: {e}, warnings: {}\n", arguments.campaign.display(), n - e),
    };
    let rows: Vec<Value> = problems.iter().map(problem_json).collect();
    let json = json!({ "campaign": arguments.campaign, "trials": trials, "errors": errors, "problems": rows });
    complain(&Problems(problems));
    talk.result(|| json, |out| out.write_all(text.as_bytes()))?;
    Ok(if errors == 0 { ExitCode::SUCCESS } else { ExitCode::from(BAD_INPUT) })
}

/// Every problem of `campaign.toml`, then of every trial by itself, then of all trials together.
fn problems_of(survey: &Survey, talk: &Talk) -> Vec<Problem> {
    let bar = progress::bar(talk, "checking", survey.readable.len());
    let mut problems = survey.problems.clone();
    match &survey.campaign {
        Some(campaign) => {
            let readable = Campaign { trials: survey.readable.clone(), ..campaign.clone() };
            let (readings, found): (Vec<_>, Vec<_>) = examine_trials(&readable, &|| bar.inc(1)).into_iter().unzip();
            for (entry, found) in readable.trials.iter().zip(found) {
                let is_stump = entry.is_incomplete() && found.iter().any(|p| p.severity == Severity::Error);
                problems.extend(if is_stump { vec![left_out(&readable, entry, &found)] } else { found });
            }
            if survey.is_whole {
                problems.extend(check(campaign, &readings.into_iter().flatten().collect::<Vec<_>>()));
            }
        }
        None => {
            let found: Vec<Vec<Problem>> = survey.readable.par_iter().map(|entry| survey.problems_of(entry)).collect();
            problems.extend(found.concat());
        }
    }
    bar.finish_and_clear();
    problems
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
