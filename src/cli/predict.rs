//! `tautline predict`.

use super::interrupt;
use super::judged::{Judged, campaign_name, model_name};
use super::outcome::Talk;
use super::progress;
use crate::evaluate::fitted;
use crate::log::read_trial;
use crate::prepare::prepare;
use crate::problem::{Problems, Result};
use crate::report::json_text;
use crate::report::predicted::{csv_names, trial_csv};
use rayon::prelude::*;
use serde_json::json;
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
    /// Folder to write: prediction.json, a CSV per trial
    #[arg(short, long)]
    output: PathBuf,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let (campaign, model) = arguments.judged.read()?;
    let (campaign, model, mut warnings) = fitted(&campaign, &model)?;
    let names = csv_names(&campaign, campaign.trials.iter())?;
    let output = interrupt::output(&arguments.output, arguments.force, "predict")?;
    let bar = progress::bar(talk, "predicting", names.len());
    let one = |(index, name): (usize, &String)| {
        let trial = read_trial(&campaign, index).and_then(|log| prepare(&campaign, index, log))?;
        output.write(name, trial_csv(&campaign, &model, &trial))?;
        bar.inc(1);
        Ok::<Vec<String>, Problems>(trial.log.warnings.iter().map(ToString::to_string).collect())
    };
    let found: Vec<Vec<String>> = names.par_iter().enumerate().with_max_len(1).map(one).collect::<Result<_>>()?;
    bar.finish_and_clear();
    warnings.extend(found.concat());
    let told = json!({
        "format": "prediction/1", "files": names, "warnings": warnings,
        "provenance": { "tautline": env!("CARGO_PKG_VERSION"), "campaign": campaign_name(&campaign), "model": model_name(&arguments.judged.model) },
    });
    output.write("prediction.json", json_text(&told))?;
    talk.finish(
        output,
        || told,
        |out| {
            warnings.iter().try_for_each(|warning| writeln!(out, "! {warning}"))?;
            writeln!(out, "{}: {} tables", arguments.output.display(), names.len())
        },
    )?;
    Ok(ExitCode::SUCCESS)
}
