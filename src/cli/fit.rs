//! `tautline fit`: the steps of the protocol one by one, each writing what the next reads.

use super::identify::{CurveArguments, FormArguments, ZeroArguments};
use super::interrupt;
use super::judged::model_file;
use super::outcome::Talk;
use super::progress;
use crate::identify::combination::fit_combination;
use crate::identify::friction::{self, fit_friction};
use crate::identify::{
    Form, Reading, Settings, at_zero, blank_model, legs, of_the_joint_alone, read_trials, with_friction, zero,
};
use crate::log::Campaign;
use crate::model::Model;
use crate::prepare::read_campaign;
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
        #[command(flatten)]
        zero: ZeroArguments,
    },
    /// Step 5: mu_c from A, the other six parameters from B(v) -> model.json
    Friction {
        #[command(flatten)]
        common: Common,
        /// The table that `fit trials` wrote
        #[arg(long)]
        trials: PathBuf,
        #[command(flatten)]
        form: FormArguments,
    },
    /// The curve by which friction changes over after a reversal -> model.json
    Combination {
        #[command(flatten)]
        common: Common,
        /// The model that `fit friction` wrote: its model.json, or the folder that holds it
        #[arg(long, value_parser = model_file())]
        model: PathBuf,
        #[command(flatten)]
        curve: CurveArguments,
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
        Step::Trials { common, zero } => trials(common, zero.is_as_declared(), talk),
        Step::Friction { common, trials, form } => friction(common, trials, form.form(), talk),
        Step::Combination { common, model, curve } => combination(common, model, curve, talk),
    }?;
    Ok(ExitCode::SUCCESS)
}

fn readings(campaign: &Campaign, talk: &Talk) -> Result<Vec<Reading>> {
    let bar = progress::bar(talk, "reading", campaign.trials.len());
    let readings = read_trials(campaign, &|| bar.inc(1));
    bar.finish_and_clear();
    readings
}

fn trials(common: &Common, zero_as_declared: bool, talk: &Talk) -> Result<()> {
    let campaign = read_campaign(&common.campaign)?;
    let output = interrupt::output(&common.output, common.force, "fit trials")?;
    let readings = readings(&campaign, talk)?;
    let mut warnings = warnings_of(&campaign, &readings);
    let sums: Vec<_> = readings.into_iter().flat_map(|r| r.legs).collect();
    let settings = Settings { zero_as_declared, ..Settings::default() };
    let (zero, mut legs) = legs::fit_legs(&sums.iter().collect::<Vec<_>>(), settings.zero_within_rad(&campaign));
    warnings.splice(0..0, zero::warning(&zero));
    let a = legs::amplitudes(&legs, legs::load_of_a_nm(&campaign), &campaign.file)?;
    legs::fix_a(&mut legs, &a);
    write_trials(&legs, &campaign.joint.name, &output)?;
    let (up, down) = (a.up, a.down);
    talk.finish(
        output,
        || {
            json!({
                "legs": legs.len(),
                "a_nm": { "up": up.a_nm, "down": down.a_nm },
                "a_sd_nm": { "up": up.sd_nm, "down": down.sd_nm },
                "position_zero_rad": zero.rad,
                "position_zero_half_width_rad": zero.half_width_rad,
                "warnings": warnings,
            })
        },
        |out| {
            writeln!(out, "{} legs", legs.len())?;
            writeln!(out, "A up    {:.4} N m, SD {:.4}", up.a_nm, up.sd_nm)?;
            writeln!(out, "A down  {:.4} N m, SD {:.4}", down.a_nm, down.sd_nm)?;
            list(out, &warnings)
        },
    )
}

fn friction(common: &Common, trials: &Path, form: Form, talk: &Talk) -> Result<()> {
    let campaign = read_campaign(&common.campaign)?;
    let legs = read_trials_csv(trials, &campaign)?;
    let output = interrupt::output(&common.output, common.force, "fit friction")?;
    let load_nm = legs::load_of_a_nm(&campaign);
    let a = legs::amplitudes(&legs, load_nm, trials)?;
    let uncertainty = &campaign.uncertainty;
    let data = friction::Data { legs: &legs, a: &a, joint: &campaign.joint, uncertainty, load_nm, campaign: trials };
    let fits = fit_friction(&data, form, None)?;
    let zero = zero::of_legs(&legs, campaign.uncertainty.position_zero_rad);
    let model = with_friction(at_zero(blank_model(&campaign), &zero), &fits);
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
    talk.finish(
        output,
        || json,
        |out| {
            terminal::sweeps(out, &fits, &Units::of(&model.joint))?;
            terminal::parameter_table(out, &model)?;
            list(out, &warnings)
        },
    )
}

/// What is doubtful about the logs.
fn warnings_of(campaign: &Campaign, readings: &[Reading]) -> Vec<String> {
    let of_trials = readings.iter().flat_map(|reading| &reading.warnings);
    campaign.warnings.iter().chain(of_trials).map(Problem::to_string).collect()
}

fn list(out: &mut impl Write, warnings: &[String]) -> std::io::Result<()> {
    warnings.iter().try_for_each(|warning| writeln!(out, "  ! {warning}"))
}

fn combination(common: &Common, file: &Path, curve: &CurveArguments, talk: &Talk) -> Result<()> {
    let campaign = read_campaign(&common.campaign)?;
    let mut model = Model::read(file)?;
    same_joint(&model, file, &campaign)?;
    let output = interrupt::output(&common.output, common.force, "fit combination")?;
    let mut readings = readings(&campaign, talk)?;
    let mut warnings = warnings_of(&campaign, &readings);
    let legs: Vec<_> = readings.iter_mut().flat_map(|r| std::mem::take(&mut r.legs)).collect();
    let legs: Vec<_> = legs.iter().map(|leg| leg.fit(model.dynamics.position_zero_rad)).collect();
    let (prepared, _) = of_the_joint_alone(readings);
    let (lowpass_hz, sliding_nm) = (campaign.signal.lowpass_hz, legs::sliding_nm(&legs));
    let Some(fit) = fit_combination(&prepared, &model, lowpass_hz, curve.settings(), sliding_nm) else {
        let what = "no reversal could be used";
        return Problem::error(&campaign.file, what, "record motion that turns, out of clipping").alone();
    };
    model.combination = fit.curve().curve;
    model.joint.backlash_m = fit.curve().backlash_m;
    model.confidence.extend(fit.confidence.iter().cloned());
    warnings.extend(fit.warnings.iter().cloned());
    let mut json = model.to_json();
    json["warnings"] = json!(warnings);
    json["combinations"] = identification::combinations(&fit);
    output.write("model.json", json_text(&json))?;
    talk.finish(
        output,
        || json,
        |out| {
            terminal::curves(out, &fit, &Units::of(&model.joint))?;
            terminal::combination_table(out, &model)?;
            list(out, &warnings)
        },
    )
}

/// Errors: `model`, read from `file`, is of another joint than `campaign`: its friction would be fitted to motion that is not
/// its own.
fn same_joint(model: &Model, file: &Path, campaign: &Campaign) -> Result<()> {
    let (theirs, ours) = (&model.joint, &campaign.joint);
    let mut differ = Vec::new();
    if theirs.name != ours.name {
        differ.push(format!("name is `{}`, here `{}`", theirs.name, ours.name));
    }
    if theirs.kind != ours.kind {
        differ.push(format!("kind is {}, here {}", theirs.kind.name(), ours.kind.name()));
    }
    for (key, theirs, ours) in [
        ("winch_radius_m", theirs.winch_radius_m, ours.winch_radius_m),
        ("pulley_radius_m", theirs.pulley_radius_m, ours.pulley_radius_m),
        ("gravity_nm", model.dynamics.gravity_nm, campaign.dynamics.gravity_nm),
        ("inertia_kg_m2", model.dynamics.inertia_kg_m2, campaign.dynamics.inertia_kg_m2),
    ] {
        if theirs != ours {
            differ.push(format!("{key} is {theirs}, here {ours}"));
        }
    }
    if differ.is_empty() {
        return Ok(());
    }
    let what = format!("is of another joint than {}: {}", campaign.file.display(), differ.join("; "));
    Problem::error(file, what, "name the model that `fit friction` made of this campaign").alone()
}
