//! `tautline rig preset`: what is known of common drives and terminals.

use crate::capture::rig::preset::{PRESETS, Preset};
use crate::cli::outcome::Talk;
use crate::problem::{Problem, Result};
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Which one; without it all are listed
    name: Option<String>,
}

/// Prints the list, or one.
///
/// Errors: there is none of that name.
pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let chosen: Vec<&Preset> = match &arguments.name {
        Some(name) => PRESETS.iter().filter(|preset| preset.name == name.as_str()).collect(),
        None => PRESETS.iter().collect(),
    };
    if chosen.is_empty() {
        let names: Vec<&str> = PRESETS.iter().map(|preset| preset.name).collect();
        let name = arguments.name.as_deref().unwrap_or_default();
        return Problem::error(
            "rig preset",
            format!("there is no `{name}`"),
            format!("name one of {}", names.join(", ")),
        )
        .alone();
    }
    talk.result(
        || {
            json!(
                chosen
                    .iter()
                    .map(|preset| json!({
                        "name": preset.name, "title": preset.title, "vendor": preset.vendor, "notes": preset.notes,
                        "section": preset.section, "source": preset.source,
                    }))
                    .collect::<Vec<_>>()
            )
        },
        |out| match &arguments.name {
            None => chosen.iter().try_for_each(|preset| writeln!(out, "{:<10} {}", preset.name, preset.title)),
            Some(_) => chosen.iter().try_for_each(|preset| write!(out, "{}{}", preset.comment(), preset.section)),
        },
    )?;
    Ok(ExitCode::SUCCESS)
}
