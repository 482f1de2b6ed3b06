//! `tautline diagnose`.

use super::interrupt;
use super::judged::{Judged, campaign_name, model_name};
use super::outcome::Talk;
use super::progress;
use crate::diagnose;
use crate::problem::Result;
use crate::report::diagnosis::{DIAGNOSIS_FILES, to_json, write_diagnosis, write_summary};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline diagnose data/davinci_l4 --model data/davinci_l4/base_model.json -o diagnosed
  tautline evaluate data/davinci_l4 --model diagnosed -o judged")]
pub struct Arguments {
    #[command(flatten)]
    judged: Judged,
    /// Folder to write: diagnosis.json, model.json with what was added, report.html, plots/
    #[arg(short, long)]
    output: PathBuf,
    /// Write the plots as PNG too
    #[arg(long)]
    png: bool,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let (campaign, model) = arguments.judged.read()?;
    let output = interrupt::output(&arguments.output, arguments.force, DIAGNOSIS_FILES)?;
    let bar = progress::bar(talk, "reading", campaign.trials.len());
    let found = diagnose::run(&campaign, &model, &|| progress::step(&bar, "trying causes"));
    bar.finish_and_clear();
    let found = found?;
    let (name, model_name) = (campaign_name(&campaign), model_name(&arguments.judged.model_file()));
    write_diagnosis(&found, &name, &model_name, &output, arguments.png)?;
    output.finish()?;
    talk.result(|| to_json(&found, &name, &model_name), |out| write_summary(out, &found, &name, &arguments.output))?;
    Ok(ExitCode::SUCCESS)
}
