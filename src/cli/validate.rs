//! `tautline validate`.

use super::outcome::{BAD_INPUT, Talk, complain};
use super::progress;
use crate::log::{Campaign, read_trial};
use crate::prepare::prepare;
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
    let (problems, trials) = match Campaign::read(&arguments.campaign) {
        Ok(campaign) => (problems_of(&campaign, talk), campaign.trials.len()),
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

/// Every problem of every trial, in the campaign's order.
fn problems_of(campaign: &Campaign, talk: &Talk) -> Vec<Problem> {
    let bar = progress::bar(talk, "checking", campaign.trials.len());
    let check = |index: usize| {
        let found = match read_trial(campaign, index).and_then(|log| prepare(campaign, index, log)) {
            Ok(trial) => trial.log.warnings,
            Err(Problems(found)) => found,
        };
        bar.inc(1);
        found
    };
    let found: Vec<Vec<Problem>> = (0..campaign.trials.len()).into_par_iter().map(check).collect();
    bar.finish_and_clear();
    found.into_iter().flatten().collect()
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
