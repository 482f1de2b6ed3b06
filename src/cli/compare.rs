//! `tautline compare`.

use super::interrupt;
use super::judged::{model_file, model_name};
use super::outcome::Talk;
use crate::compare::compare;
use crate::model::Model;
use crate::problem::Result;
use crate::report::comparison::{to_json, write_summary};
use crate::report::write_comparison;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline compare before after
  tautline compare before/model.json after/model.json -o compared --png
  tautline compare before/model.json after/model.json --json | jq '.parameters[] | select(.verdict == \"changed\")'")]
pub struct Arguments {
    /// The earlier model: a model.json, or the folder that holds it
    #[arg(value_parser = model_file())]
    before: PathBuf,
    /// The later model
    #[arg(value_parser = model_file())]
    after: PathBuf,
    /// Folder to write: comparison.json, report.html, plots/
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Write the plots as PNG too
    #[arg(long, requires = "output")]
    png: bool,
    /// Replace an existing output folder
    #[arg(long, requires = "output")]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let found = compare(&Model::read(&arguments.before)?, &Model::read(&arguments.after)?)?;
    let names = [&arguments.before, &arguments.after].map(|file| model_name(file));
    let begin = |folder| interrupt::output(folder, arguments.force, "compare");
    let output = arguments.output.as_deref().map(begin).transpose()?;
    if let Some(output) = &output {
        output.made_from("model before", &arguments.before);
        output.made_from("model after", &arguments.after);
    }
    output.iter().try_for_each(|output| write_comparison(&found, &names, output, arguments.png))?;
    talk.finish(
        output,
        || to_json(&found, &names),
        |out| {
            write_summary(out, &found, &names)?;
            match &arguments.output {
                Some(folder) => writeln!(out, "\nwritten to {}: comparison.json, report.html, plots", folder.display()),
                None => Ok(()),
            }
        },
    )?;
    Ok(ExitCode::SUCCESS)
}
