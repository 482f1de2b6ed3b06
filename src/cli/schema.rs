//! `tautline schema`.

use super::outcome::{Talk, say};
use crate::problem::Result;
use crate::report::json_text;
use crate::schema::{FILES, File};
use clap::builder::PossibleValuesParser;
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline schema
  tautline schema campaign > campaign.schema.json      for an editor that checks TOML while you type")]
pub struct Arguments {
    /// The kind of file [default: a list of them]
    #[arg(value_parser = PossibleValuesParser::new(FILES.iter().map(|file| file.name)))]
    name: Option<String>,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let wanted = |file: &&File| arguments.name.as_deref() == Some(file.name);
    match FILES.iter().find(wanted) {
        Some(file) => say(|out| write!(out, "{}", json_text((file.schema)().as_value())))?,
        None if talk.json => {
            let names: Vec<_> = FILES.iter().map(|file| json!({ "name": file.name, "about": file.about })).collect();
            say(|out| write!(out, "{}", json_text(&json!({ "format": "schema/1", "files": names }))))?;
        }
        None if talk.quiet => {}
        None => say(|out| FILES.iter().try_for_each(|file| writeln!(out, "{:<12} {}", file.name, file.about)))?,
    }
    Ok(ExitCode::SUCCESS)
}
