//! `tautline interaction`.

use super::follow;
use super::interrupt;
use super::judged::{Judged, campaign_name, model_name};
use super::outcome::Talk;
use super::progress;
use crate::interaction::{self, Frame, Settings};
use crate::log::Protocol;
use crate::problem::{Problem, Result};
use crate::report::interaction::{to_json, write_summary};
use crate::report::predicted::csv_names;
use crate::report::write_interaction;
use clap::ValueEnum;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline interaction my-campaign --model out/model.json -o touched
  tautline interaction my-campaign --model out/model.json -o touched --causal
  recorder | tautline interaction my-campaign --model out/model.json --follow > torque.csv

The campaign's cosine, free and uniform trials must be quiet: what the model leaves of them sets the
threshold of a contact and the uncertainty. With --follow, standard input is CSV with a header, in the
columns and units that the campaign declares; one line goes out for each that comes in, late by the
filters' delay, which is told on standard error (not with --quiet or --json). The stream is not searched
for readings at the end of the sensor's range.")]
pub struct Arguments {
    #[command(flatten)]
    judged: Judged,
    /// Folder to write: interaction.json, a CSV per trial, report.html, plots/
    #[arg(short, long, required_unless_present = "follow", conflicts_with = "follow")]
    output: Option<PathBuf>,
    /// Where the torque is wanted: at the winch, as (31) has it, or at the joint, through the transmission
    #[arg(long, value_enum, default_value_t = At::Winch)]
    at: At,
    /// Filter forwards only, as on a stream
    #[arg(long)]
    causal: bool,
    /// Threshold of a contact, N m, in place of the one that quiet trials give
    #[arg(long, allow_negative_numbers = true)]
    threshold_nm: Option<f64>,
    /// Read samples from standard input as they come, and write the torque of each
    #[arg(long)]
    follow: bool,
    /// Sample rate of the stream, Hz [default: that of the campaign's first trial]
    #[arg(long, requires = "follow")]
    rate_hz: Option<f64>,
    /// Write the plots as PNG too
    #[arg(long)]
    png: bool,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum At {
    Winch,
    Joint,
}

impl Arguments {
    /// Errors: a number that makes no sense.
    fn settings(&self) -> Result<Settings> {
        for (name, value) in [("threshold-nm", self.threshold_nm), ("rate-hz", self.rate_hz)] {
            if let Some(value) = value.filter(|value| !value.is_finite() || *value <= 0.0) {
                return Problem::error("command line", format!("--{name} is {value}"), "expected a number above 0")
                    .alone();
            }
        }
        let frame = match self.at {
            At::Winch => Frame::Winch,
            At::Joint => Frame::Joint,
        };
        Ok(Settings { frame, causal: self.causal || self.follow, threshold_nm: self.threshold_nm })
    }
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let settings = arguments.settings()?;
    let (campaign, model) = arguments.judged.read()?;
    let Some(folder) = &arguments.output else {
        return follow::run(&campaign, &model, settings, arguments.rate_hz, talk);
    };
    let touched = campaign.trials.iter().filter(|trial| trial.protocol == Protocol::Interaction);
    let tables = csv_names(&campaign, touched)?;
    let output = interrupt::output(folder, arguments.force, "interaction")?;
    output.made_from("campaign file", &campaign.file);
    output.made_from("model file", &arguments.judged.model);
    let bar = progress::bar(talk, "extracting", campaign.trials.len());
    let found = interaction::run(&campaign, &model, settings, &|| progress::step(&bar, "drawing"));
    bar.finish_and_clear();
    let found = found?;
    let (name, model_name) = (campaign_name(&campaign), model_name(&arguments.judged.model));
    write_interaction(&found, &tables, &name, &model_name, &output, arguments.png)?;
    talk.finish(output, || to_json(&found, &name, &model_name), |out| write_summary(out, &found, &name, folder))?;
    Ok(ExitCode::SUCCESS)
}
