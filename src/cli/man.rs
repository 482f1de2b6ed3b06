//! `tautline man`.

use super::interrupt;
use super::outcome::Talk;
use crate::problem::{Problem, Result};
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Example:
  tautline man -o man1
  mkdir -p ~/.local/share/man/man1 && cp man1/* ~/.local/share/man/man1 && man tautline-identify")]
pub struct Arguments {
    /// Folder to write: tautline.1 and a page for each command
    #[arg(short, long)]
    output: PathBuf,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let mut whole = super::Arguments::command().disable_help_subcommand(true);
    whole.build();
    let mut pages = Vec::new();
    collect(&whole, &mut pages);
    let output = interrupt::output(&arguments.output, arguments.force, "man")?;
    for (name, command) in &pages {
        let mut page = Vec::new();
        let made = Man::new(command.clone()).title(name.to_uppercase()).render(&mut page);
        made.or_else(|error| Problem::error(name, format!("could not be made: {error}"), "report this").alone())?;
        output.write(&format!("{name}.1"), page)?;
    }
    let names: Vec<&String> = pages.iter().map(|(name, _)| name).collect();
    talk.finish(
        output,
        || json!({ "format": "man/1", "folder": arguments.output, "pages": names }),
        |out| writeln!(out, "{}: {} pages", arguments.output.display(), names.len()),
    )?;
    Ok(ExitCode::SUCCESS)
}

/// `command` and those below it, each called by the whole way there: `tautline-fit-trials`.
fn collect(command: &Command, pages: &mut Vec<(String, Command)>) {
    command.get_subcommands().filter(|below| !below.is_hide_set()).for_each(|below| collect(below, pages));
    let name = command.get_display_name().unwrap_or(command.get_name());
    pages.push((name.to_string(), command.clone()));
}
