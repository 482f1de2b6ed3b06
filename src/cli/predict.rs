//! `tautline predict`.

use super::interrupt;
use super::judged::Judged;
use super::outcome::Talk;
use super::progress;
use crate::evaluate::fitted;
use crate::log::{Campaign, read_trial};
use crate::prepare::prepare;
use crate::problem::{Problem, Problems, Result};
use crate::report::predicted::{PREDICTION_FILES, csv_name, trial_csv};
use rayon::prelude::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example:
  tautline predict data/elbow --model out/model.json -o predicted

One table per trial: measured torque, prediction and its parts, N m at the winch, as recorded;
columns that end in _filtered_nm passed through the campaign's low-pass. The parts add up to
predicted_nm. `judged` is 0 where K_f is not known yet or the sensor was at its limit.")]
pub struct Arguments {
    #[command(flatten)]
    judged: Judged,
    /// Folder to write: a CSV per trial
    #[arg(short, long)]
    output: PathBuf,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let (campaign, model) = arguments.judged.read()?;
    let (model, warnings) = fitted(&campaign, &model)?;
    let names = names(&campaign)?;
    let output = interrupt::output(&arguments.output, arguments.force, PREDICTION_FILES)?;
    let bar = progress::bar(talk, "predicting", names.len());
    let one = |(index, name): (usize, &String)| {
        let trial = read_trial(&campaign, index).and_then(|log| prepare(&campaign, index, log))?;
        output.write(name, trial_csv(&campaign, &model, &trial))?;
        bar.inc(1);
        Ok::<(), Problems>(())
    };
    names.par_iter().enumerate().with_max_len(1).try_for_each(one)?;
    bar.finish_and_clear();
    output.finish()?;
    talk.result(
        || json!({ "output": arguments.output, "files": names, "warnings": warnings }),
        |out| {
            warnings.iter().try_for_each(|warning| writeln!(out, "! {warning}"))?;
            writeln!(out, "{}: {} tables", arguments.output.display(), names.len())
        },
    )?;
    Ok(ExitCode::SUCCESS)
}

/// The table of each trial. Errors: two trials whose tables would have one name.
fn names(campaign: &Campaign) -> Result<Vec<String>> {
    let names: Vec<String> = campaign.trials.iter().map(|t| csv_name(&t.file)).collect();
    let mut seen = BTreeMap::new();
    for (name, entry) in names.iter().zip(&campaign.trials) {
        if let Some(other) = seen.insert(name, &entry.file) {
            let what = format!("`{other}` and `{}` would both become {name}", entry.file);
            return Problem::error(&campaign.file, what, "rename one of the logs").alone();
        }
    }
    Ok(names)
}
