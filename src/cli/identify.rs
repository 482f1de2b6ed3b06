//! `tautline identify`.

use super::interrupt;
use super::judged::campaign_name;
use super::outcome::Talk;
use super::progress;
use crate::identify::{self, CurveKind, Form, Settings, combination};
use crate::prepare::read_campaign;
use crate::problem::Result;
use crate::report::terminal::write_summary;
use crate::report::{identification, write_identification};
use clap::ValueEnum;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline identify data/elbow -o out
  tautline identify data/davinci_l4 -o out --estimate-backlash     no sweeps: fits whole series
  tautline identify data/elbow -o out --refine --json | jq .friction")]
pub struct Arguments {
    /// Folder with a campaign.toml and its logs
    campaign: PathBuf,
    /// Folder to write: model.json, report.html, trials.csv, plots/
    #[arg(short, long, default_value = "identified")]
    output: PathBuf,
    #[command(flatten)]
    form: FormArguments,
    #[command(flatten)]
    curve: CurveArguments,
    #[command(flatten)]
    zero: ZeroArguments,
    /// Refine all parameters together on the whole series, if that lowers the error on held-out trials
    #[arg(long)]
    refine: bool,
    /// Write the plots as PNG too
    #[arg(long)]
    png: bool,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

/// What the friction's fit may choose.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct FormArguments {
    /// Form of B(v) that the model takes
    #[arg(long, value_enum, default_value_t = FormChoice::Two)]
    form: FormChoice,
}

/// What is made of the zero of the position.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct ZeroArguments {
    /// Zero of the position
    #[arg(long, value_enum, default_value_t = ZeroChoice::Fitted)]
    zero: ZeroChoice,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ZeroChoice {
    /// Fitted along with A and B, within `position_zero_rad` of [uncertainty]
    Fitted,
    /// Taken as right, as in the paper: no interval knows of its error
    Declared,
}

impl ZeroArguments {
    pub fn is_as_declared(&self) -> bool {
        self.zero == ZeroChoice::Declared
    }
}

/// What the combination's fit may choose.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct CurveArguments {
    /// Curve of the combination [default: the one that the data support best]
    #[arg(long, value_enum)]
    combination: Option<CurveChoice>,
    /// Find the clearance X_cl from the reversals instead of taking backlash_m
    #[arg(long)]
    estimate_backlash: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum FormChoice {
    /// Two exponentials: the paper's seven parameters
    Two,
    /// One exponential
    One,
    /// Whichever the data support
    Supported,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum CurveChoice {
    Sign,
    Linear,
    Arctan,
    Power,
}

impl FormArguments {
    pub fn form(&self) -> Form {
        match self.form {
            FormChoice::Two => Form::Two,
            FormChoice::One => Form::One,
            FormChoice::Supported => Form::Supported,
        }
    }
}

impl CurveArguments {
    pub fn settings(&self) -> combination::Settings {
        let wanted = self.combination.map(|choice| match choice {
            CurveChoice::Sign => CurveKind::Sign,
            CurveChoice::Linear => CurveKind::Linear,
            CurveChoice::Arctan => CurveKind::Arctan,
            CurveChoice::Power => CurveKind::Power,
        });
        combination::Settings { wanted, estimate_backlash: self.estimate_backlash }
    }
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let campaign = read_campaign(&arguments.campaign)?;
    let output = interrupt::output(&arguments.output, arguments.force, "identify")?;
    output.made_from("campaign file", &campaign.file);
    let bar = progress::bar(talk, "reading", campaign.trials.len());
    let settings = Settings {
        form: arguments.form.form(),
        combination: arguments.curve.settings(),
        refine: arguments.refine,
        zero_as_declared: arguments.zero.is_as_declared(),
    };
    let found = identify::run(&campaign, settings, &|| {
        progress::step(&bar, "fitting");
    });
    bar.finish_and_clear();
    let found = found?;
    let name = campaign_name(&campaign);
    write_identification(&found, &name, &output, arguments.png)?;
    talk.finish(
        output,
        || identification::to_json(&found, &name),
        |out| write_summary(out, &found, &name, Some(&arguments.output)),
    )?;
    Ok(ExitCode::SUCCESS)
}
