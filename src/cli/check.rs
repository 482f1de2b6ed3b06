//! `tautline check`.

use super::identify::{CurveArguments, FormArguments};
use super::judged::{campaign_for, campaign_name, model_file, model_name};
use super::outcome::{JUDGED_BAD, Talk, complain, say};
use crate::check::{Baseline, Checked, Recipe, Snapshot};
use crate::identify::Settings;
use crate::log::Campaign;
use crate::model::Model;
use crate::prepare::read_campaign;
use crate::problem::{Problem, Problems, Result};
use crate::report::checked::{Names, to_github, to_json, to_junit, write_summary};
use crate::report::gate;
use clap::ValueEnum;
use serde_json::json;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline check data/elbow --baseline data/elbow/baseline.json
  tautline check data/elbow --baseline elbow.json --update                    store what is true now
  tautline check data/arm --baseline arm.json --update --model out/model.json   judge this model, identify nothing
  tautline check data/elbow --baseline data/elbow/baseline.json --format junit > check.xml

Exit status: 0 within tolerance or stored, 1 regressed, 2 could not run.")]
pub struct Arguments {
    /// Folder with a campaign.toml and its logs
    campaign: PathBuf,
    /// The baseline's file, JSON
    #[arg(long)]
    baseline: PathBuf,
    /// Store the baseline anew, telling what moved since the last one, whose recipe it keeps unless told otherwise below
    #[arg(long)]
    update: bool,
    /// With --update: judge this model instead of identifying one
    #[arg(long, requires = "update", value_parser = model_file())]
    model: Option<PathBuf>,
    #[command(flatten)]
    form: FormArguments,
    #[command(flatten)]
    curve: CurveArguments,
    /// Polish all parameters together on the whole series
    #[arg(long, requires = "update")]
    refine: bool,
    /// How to tell it
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For people
    Text,
    /// Annotations of a GitHub workflow
    Github,
    /// JUnit XML, a test case for each thing compared
    Junit,
    /// All of it, as --json
    Json,
}

impl Arguments {
    fn settings(&self) -> Settings {
        Settings {
            form: self.form.form(),
            combination: self.curve.settings(),
            refine: self.refine,
            ..Default::default()
        }
    }

    /// How to identify belongs to storing a baseline: afterwards the baseline says it.
    fn check(&self) -> Result<()> {
        let says_how = self.settings() != Settings::default();
        if says_how && (!self.update || self.model.is_some()) {
            let (what, cure) = match self.update {
                false => {
                    ("--form, --combination and --estimate-backlash need --update", "the baseline says how to identify")
                }
                true => (
                    "--model goes without --form, --combination, --estimate-backlash, --refine",
                    "a model is only judged",
                ),
            };
            return Problem::error("command line", what, cure).alone();
        }
        Ok(())
    }
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    arguments.check()?;
    if arguments.update {
        return update(arguments, talk);
    }
    let baseline = Baseline::read(&arguments.baseline)?;
    let campaign = campaign_for(&baseline.model, &arguments.campaign)?;
    complain(&Problems(campaign.warnings.clone()));
    let checked = baseline.check(&campaign)?;
    tell(arguments, talk, &campaign, &baseline, &checked)?;
    Ok(if checked.is_regressed() { ExitCode::from(JUDGED_BAD) } else { ExitCode::SUCCESS })
}

fn update(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    // What is no baseline is never replaced.
    let old = if arguments.baseline.exists() { Some(Baseline::read(&arguments.baseline)?) } else { None };
    let given = arguments.model.as_ref().map(|model| Model::read(model)).transpose()?;
    let settings = arguments.settings();
    let (recipe, model) = match (&given, &old) {
        (Some(_), _) => (Recipe::Judge, given.clone()),
        (None, Some(old)) if settings == Settings::default() => match old.recipe {
            Recipe::Judge => (Recipe::Judge, Some(old.model.clone())),
            identify => (identify, None),
        },
        _ => (Recipe::Identify(settings), None),
    };
    let campaign = match &model {
        Some(model) => campaign_for(model, &arguments.campaign)?,
        None => read_campaign(&arguments.campaign)?,
    };
    complain(&Problems(campaign.warnings.clone()));
    let new = Baseline::record(&campaign, &campaign_name(&campaign), recipe, model.as_ref())?;
    let checked = old.as_ref().map(|old| old.check(&campaign)).transpose()?;
    store(&arguments.baseline, &new.to_json_text())?;
    let Snapshot { trials, figures, .. } = &new.snapshot;
    if let (Some(old), Some(checked)) = (&old, &checked) {
        tell(arguments, talk, &campaign, old, checked)?;
    }
    let file = arguments.baseline.display();
    if arguments.format == Format::Text && !talk.json && !talk.quiet {
        say(|out| writeln!(out, "stored to {file}: {} trials, {} figures", trials.len(), figures.len()))?;
    } else if checked.is_none() && (talk.json || arguments.format == Format::Json) {
        let told = json!({ "format": "check/1", "stored": file.to_string(), "trials": trials.len(), "figures": figures.len() });
        say(|out| writeln!(out, "{told:#}"))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn tell(arguments: &Arguments, talk: &Talk, campaign: &Campaign, baseline: &Baseline, checked: &Checked) -> Result<()> {
    let names = Names {
        campaign: &campaign_name(campaign),
        campaign_file: &campaign.file.display().to_string(),
        baseline: &model_name(&arguments.baseline),
        stored_by: &baseline.tautline,
    };
    match arguments.format {
        Format::Json => {
            let as_json = Talk { json: true, ..*talk };
            as_json.result(|| to_json(checked, &names), |out| write_summary(out, checked, &names))
        }
        _ if talk.json => talk.result(|| to_json(checked, &names), |out| write_summary(out, checked, &names)),
        Format::Github => say(|out| write!(out, "{}", to_github(checked, &names))),
        Format::Junit => match to_junit(checked, &names) {
            Ok(text) => say(|out| writeln!(out, "{text}")),
            Err(error) => Problem::error("JUnit", format!("could not be made: {error}"), "report this").alone(),
        },
        Format::Text => talk.result(|| to_json(checked, &names), |out| write_summary(out, checked, &names)),
    }
}

/// Writes `text`, JSON, to `file`, whole or not at all.
///
/// Errors: something is not a number where a figure is meant; the file cannot be written.
fn store(file: &Path, text: &str) -> Result<()> {
    gate::file(file, text)?;
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut builder = tempfile::Builder::new();
    builder.prefix(".tautline-");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let written = builder.tempfile_in(folder).and_then(|mut new| {
        new.write_all(text.as_bytes())?;
        new.persist(file).map_err(|error| error.error)
    });
    written.map(drop).or_else(|error| Problem::unwritable(file, "cannot be written", &error).alone())
}
