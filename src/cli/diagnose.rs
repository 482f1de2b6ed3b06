//! `tautline diagnose`.

use super::interrupt;
use super::judged::{Judged, campaign_for, campaign_name, model_name};
use super::outcome::Talk;
use super::stages::Stages;
use crate::diagnose::{self, Policy};
use crate::problem::Result;
use crate::report::diagnosis::{to_json, write_diagnosis, write_summary};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline diagnose data/davinci_l4 --model data/davinci_l4/base_model.json -o diagnosed
  tautline evaluate data/davinci_l4 --model diagnosed -o judged
  tautline diagnose recorded --model model.json --simulated played -o diagnosed
                                            what separates a joint from its simulation, in motion too")]
pub struct Arguments {
    #[command(flatten)]
    judged: Judged,
    /// A simulator's own log of the same commands, as a campaign: the difference in motion is located and explained too. Trials are
    /// matched by their logs' names, else by protocol, speed, trajectory and repeat
    #[arg(long, value_name = "CAMPAIGN")]
    simulated: Option<PathBuf>,
    /// Thresholds to decide by in the place of the default ones: a file of the format policy/1 (`tautline schema policy`)
    #[arg(long, value_name = "FILE")]
    policy: Option<PathBuf>,
    /// Folder to write: diagnosis.json, model.json with what was added, report.html, plots/
    #[arg(short, long, default_value = "diagnosed")]
    output: PathBuf,
    /// Write the plots as PNG too
    #[arg(long)]
    png: bool,
    /// Say on standard error where the time went
    #[arg(long)]
    profile: bool,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let (campaign, model) = arguments.judged.read()?;
    let simulated = arguments.simulated.as_ref().map(|path| campaign_for(&model, path)).transpose()?;
    let policy = arguments.policy.as_deref().map(Policy::read).transpose()?.unwrap_or_default();
    let output = interrupt::output(&arguments.output, arguments.force, "diagnose")?;
    output.made_from("campaign file", &campaign.file);
    output.made_from("model file", &arguments.judged.model);
    if let Some(file) = &arguments.policy {
        output.made_from("policy file", file);
    }
    let stages = Stages::new(talk);
    let found = match &simulated {
        Some(simulated) => diagnose::beside(&campaign, simulated, &model, &policy, &|told| stages.hear(told)),
        None => diagnose::run_by(&campaign, &model, &policy, &|told| stages.hear(told)),
    };
    stages.finish();
    if arguments.profile {
        stages.say();
    }
    let found = found?;
    let (name, model_name) = (campaign_name(&campaign), model_name(&arguments.judged.model));
    write_diagnosis(&found, &name, &model_name, &output, arguments.png)?;
    talk.finish(
        output,
        || to_json(&found, &name, &model_name),
        |out| write_summary(out, &found, &name, &arguments.output),
    )?;
    Ok(ExitCode::SUCCESS)
}
