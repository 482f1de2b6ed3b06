//! `tautline repeatability`.

use super::identify::{CurveArguments, FormArguments};
use super::interrupt;
use super::outcome::Talk;
use super::progress;
use crate::batch::{self, Batch, Entry, RUNS_MIN, Repeatability, Row, Settings, Store};
use crate::identify;
use crate::problem::{Problem, Result};
use crate::report::repeatability::{to_json, write_summary};
use crate::report::write_repeatability;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline repeatability runs -o repeated                 every campaign below the folder
  tautline repeatability runs.toml -o repeated            those that a list names (batch/1), with their conditions:

  [[campaigns]]
  path = \"elbow/monday\"
  conditions = { payload_kg = 0.5, operator = \"ann\" }

Each campaign is identified by itself. A condition in numbers is judged by its slope, one in words by its groups.")]
pub struct Arguments {
    /// A list of campaigns (batch/1), a folder with campaigns somewhere below it, or a pattern of such folders; any number of them
    #[arg(required = true, value_name = "WHAT")]
    what: Vec<PathBuf>,
    /// Folder to write: repeatability.json, report.html, plots/
    #[arg(short, long)]
    output: Option<PathBuf>,
    #[command(flatten)]
    form: FormArguments,
    #[command(flatten)]
    curve: CurveArguments,
    /// Write the plots as PNG too
    #[arg(long, requires = "output")]
    png: bool,
    /// Replace an existing output folder
    #[arg(long, requires = "output")]
    force: bool,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let all = Batch::read(&arguments.what)?;
    let begin = |folder| interrupt::output(folder, arguments.force, "repeatability");
    let output = arguments.output.as_deref().map(begin).transpose()?;
    let settings = Settings {
        identify: identify::Settings {
            form: arguments.form.form(),
            combination: arguments.curve.settings(),
            ..identify::Settings::default()
        },
        diagnose: false,
    };
    let scratch = tempfile::tempdir().or_else(|error| {
        let what = format!("cannot be written: {error}");
        Problem::error(std::env::temp_dir(), what, "check free space and permissions").alone()
    })?;
    let store = Store::open(scratch.path())?;
    let entries: Vec<&Entry> = all.entries.iter().collect();
    let bar = progress::bar(talk, "identifying", entries.len());
    let told = |_| progress::step(&bar, "comparing");
    let done = batch::run(&entries, &settings, &store, true, rayon::current_num_threads(), &told);
    bar.finish_and_clear();
    done?;
    let rows: Vec<Row> = entries.iter().map(|entry| Row::read(entry, &store)).collect();
    if let Some(row) = rows.iter().find(|row| row.model.is_none()) {
        let why = row.record.failure.clone().unwrap_or_default();
        return Problem::error(&row.entry.path, format!("cannot be identified: {why}"), "mend it, or leave it out")
            .alone();
    }
    let found = Repeatability::of(&rows);
    if found.is_empty() {
        let what = format!("no joint has {RUNS_MIN} campaigns");
        return Problem::error(&arguments.what[0], what, "record the same joint at least that many times").alone();
    }
    output.iter().try_for_each(|output| write_repeatability(&found, output, arguments.png))?;
    talk.finish(
        output,
        || to_json(&found),
        |out| {
            write_summary(out, &found)?;
            match &arguments.output {
                Some(folder) => {
                    writeln!(out, "\nwritten to {}: repeatability.json, report.html, plots", folder.display())
                }
                None => Ok(()),
            }
        },
    )?;
    Ok(ExitCode::SUCCESS)
}
