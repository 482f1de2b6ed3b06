//! `tautline fit`: the steps of the protocol one by one, each writing what the next reads.

use super::identify::Choices;
use super::interrupt;
use super::outcome::Talk;
use super::progress;
use crate::identify::combination::fit_combination;
use crate::identify::friction::{self, fit_friction};
use crate::identify::{Reading, blank_model, legs, of_the_joint_alone, read_trials, with_friction};
use crate::log::Campaign;
use crate::model::Model;
use crate::problem::{Problem, Result};
use crate::report::wording::Units;
use crate::report::{identification, json_text, read_trials_csv, terminal, write_trials};
use clap::Subcommand;
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example, the three steps one by one:
  tautline fit trials data/elbow -o step2
  tautline fit friction data/elbow --trials step2/trials.csv -o step5
  tautline fit combination data/elbow --model step5/model.json -o combined")]
pub struct Arguments {
    #[command(subcommand)]
    step: Step,
}

#[derive(Debug, Subcommand)]
enum Step {
    /// Steps 2 to 4: A and B of every constant-speed leg -> trials.csv
    Trials {
        #[command(flatten)]
        common: Common,
    },
    /// Step 5: mu_c from A, the other six parameters from B(v) -> model.json
    Friction {
        #[command(flatten)]
        common: Common,
        /// The table that `fit trials` wrote
        #[arg(long)]
        trials: PathBuf,
        #[command(flatten)]
        choices: Choices,
    },
    /// The curve by which friction changes over after a reversal -> model.json
    Combination {
        #[command(flatten)]
        common: Common,
        /// The model that `fit friction` wrote
        #[arg(long)]
        model: PathBuf,
        #[command(flatten)]
        choices: Choices,
    },
}

#[derive(Debug, clap::Args)]
struct Common {
    /// Folder with a campaign.toml and its logs
    campaign: PathBuf,
    /// Folder to write
    #[arg(short, long)]
    output: PathBuf,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    match &arguments.step {
        Step::Trials { common } => trials(common, talk),
        Step::Friction { common, trials, choices } => friction(common, trials, choices, talk),
        Step::Combination { common, model, choices } => combination(common, model, choices, talk),
    }?;
    Ok(ExitCode::SUCCESS)
}

fn readings(campaign: &Campaign, talk: &Talk) -> Result<Vec<Reading>> {
    let bar = progress::bar(talk, "reading", campaign.trials.len());
    let readings = read_trials(campaign, &|| bar.inc(1));
    bar.finish_and_clear();
    readings
}

fn trials(common: &Common, talk: &Talk) -> Result<()> {
    let campaign = Campaign::read(&common.campaign)?;
    let output = interrupt::output(&common.output, common.force, &["trials.csv"])?;
    let mut legs: Vec<_> = readings(&campaign, talk)?.into_iter().flat_map(|r| r.legs).collect();
    let a = legs::amplitudes(&legs, legs::load_of_a_nm(&campaign), &campaign.file)?;
    legs::fix_a(&mut legs, &a);
    write_trials(&legs, &output)?;
    output.finish()?;
    let (up, down) = (a.up, a.down);
    talk.result(
        || {
            json!({
                "legs": legs.len(),
                "a_nm": { "up": up.a_nm, "down": down.a_nm },
                "a_sd_nm": { "up": up.sd_nm, "down": down.sd_nm },
            })
        },
        |out| {
            writeln!(out, "{} legs", legs.len())?;
            writeln!(out, "A up    {:.4} N m, SD {:.4}", up.a_nm, up.sd_nm)?;
            writeln!(out, "A down  {:.4} N m, SD {:.4}", down.a_nm, down.sd_nm)
        },
    )
}

fn friction(common: &Common, trials: &Path, choices: &Choices, talk: &Talk) -> Result<()> {
    let campaign = Campaign::read(&common.campaign)?;
    let legs = read_trials_csv(trials)?;
    let output = interrupt::output(&common.output, common.force, &["model.json"])?;
    let load_nm = legs::load_of_a_nm(&campaign);
    let a = legs::amplitudes(&legs, load_nm, trials)?;
    let data = friction::Data { legs: &legs, a: &a, joint: &campaign.joint, load_nm, campaign: trials };
    let fits = fit_friction(&data, choices.settings(false).form, None)?;
    let model = with_friction(blank_model(&campaign), &fits);
    let warnings: Vec<String> = [&fits.up, &fits.down].into_iter().flat_map(friction::warnings).collect();
    let mut json = model.to_json();
    json["warnings"] = json!(warnings);
    for fit in [&fits.up, &fits.down] {
        identification::write_covariance(&mut json["fit"][fit.direction.name()], fit);
    }
    json["forms"] = json!({
        "up": identification::branch_forms(&fits.up),
        "down": identification::branch_forms(&fits.down),
    });
    output.write("model.json", json_text(&json))?;
    output.finish()?;
    talk.result(
        || json,
        |out| {
            terminal::sweeps(out, &fits, &Units::of(model.joint.kind))?;
            terminal::parameter_table(out, &model)?;
            list(out, &warnings)
        },
    )
}

fn list(out: &mut impl Write, warnings: &[String]) -> std::io::Result<()> {
    warnings.iter().try_for_each(|warning| writeln!(out, "  ! {warning}"))
}

fn combination(common: &Common, model: &Path, choices: &Choices, talk: &Talk) -> Result<()> {
    let campaign = Campaign::read(&common.campaign)?;
    let mut model = Model::read(model)?;
    let output = interrupt::output(&common.output, common.force, &["model.json"])?;
    let (prepared, _) = of_the_joint_alone(readings(&campaign, talk)?);
    let settings = choices.settings(false).combination;
    let Some(fit) = fit_combination(&prepared, &model, campaign.signal.lowpass_hz, settings, None) else {
        let what = "no reversal could be used";
        return Problem::error(&campaign.file, what, "record motion that turns, out of clipping").alone();
    };
    model.combination = fit.curve().curve;
    model.joint.backlash_m = fit.curve().backlash_m;
    model.confidence.extend(fit.confidence.iter().cloned());
    let mut json = model.to_json();
    json["warnings"] = json!(fit.warnings);
    json["combinations"] = identification::combinations(&fit);
    output.write("model.json", json_text(&json))?;
    output.finish()?;
    talk.result(
        || json,
        |out| {
            terminal::curves(out, &fit, &Units::of(model.joint.kind))?;
            list(out, &fit.warnings)
        },
    )
}
