//! `tautline diagnose`.

use super::judged::Judged;
use super::outcome::Talk;
use super::progress;
use crate::diagnose;
use crate::problem::Result;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    judged: Judged,
    /// Folder to write: diagnosis.json, model.json, report.html, plots/
    #[arg(short, long)]
    output: PathBuf,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let (campaign, model) = arguments.judged.read()?;
    let bar = progress::bar(talk, "reading", campaign.trials.len());
    diagnose::run(&campaign, &model, &|| progress::step(&bar, "trying causes"))?;
    bar.finish_and_clear();
    Ok(ExitCode::SUCCESS)
}
