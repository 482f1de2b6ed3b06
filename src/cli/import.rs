//! `tautline import`.

use super::interrupt;
use super::outcome::{Talk, complain};
use super::progress;
use crate::import::{self, Picked, Series, picked};
use crate::log::table::{Numbers, csv_bytes, parquet_bytes};
use crate::log::{Campaign, TrialEntry};
use crate::numerics::statistics::extent;
use crate::problem::{Problem, Problems, Result};
use crate::report::{Output, json_text};
use clap::ValueEnum;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Digits after the point of what is written as CSV: a microdegree's thousandth.
const DECIMALS: usize = 10;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline import --list recorded/run_1.mat         what its columns are called
  tautline import recorded -o campaign              recorded/campaign.toml names columns and files as they are

Reads MATLAB .mat (v5 to v7: variables; v7.3: also fields of structures), ROS 2 recordings (.mcap with
sensor_msgs/msg/JointState: columns time in s, JOINT.position, JOINT.velocity, JOINT.effort) and TwinCAT Scope's text
export (.csv, .txt: columns time in ms, channels by name). CSV and Parquet are taken as they are.")]
pub struct Arguments {
    /// Folder with a campaign.toml whose trials name such files; with --list the files themselves
    #[arg(required = true)]
    from: Vec<PathBuf>,
    /// Folder to write: a campaign that every command reads
    #[arg(short, long, required_unless_present = "list")]
    output: Option<PathBuf>,
    /// Print the names of the columns instead
    #[arg(long, conflicts_with_all = ["output", "force"])]
    list: bool,
    /// Format of the logs written
    #[arg(long, value_enum, default_value_t = Format::Parquet)]
    format: Format,
    /// Replace an existing output folder
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, ValueEnum)]
enum Format {
    Csv,
    Parquet,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    match (&arguments.output, &arguments.from[..]) {
        (None, files) => list(files, talk)?,
        (Some(output), [draft]) => write(arguments, draft, output, talk)?,
        (Some(_), _) => {
            let cure = "name one folder with a campaign.toml; it lists the files";
            return Problem::error("command line", "a campaign is imported from several places", cure).alone();
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints what columns `files` have.
fn list(files: &[PathBuf], talk: &Talk) -> Result<()> {
    let mut read = Vec::new();
    for file in files {
        let Some(all) = import::read(file)? else {
            let cure = "a campaign takes it as it is, and its columns by the names that it holds";
            return Problem::error(file, "is a plain table", cure).alone();
        };
        read.push((file, all));
    }
    let one = |series: &Series| {
        let (low, high) = extent(&series.values);
        json!({ "name": series.name, "rows": series.values.len(), "low": low, "high": high })
    };
    let as_json = || -> Value {
        read.iter()
            .map(|(file, all)| json!({ "file": file, "columns": all.iter().map(one).collect::<Vec<_>>() }))
            .collect()
    };
    talk.result(as_json, |out| {
        for (file, all) in &read {
            writeln!(out, "{}", file.display())?;
            for series in all {
                let (low, high) = extent(&series.values);
                let range = match low <= high {
                    true => format!("{} to {}", quoted(low), quoted(high)),
                    false => "no number".to_string(),
                };
                writeln!(out, "  {:<40} {:>9} rows, {range}", series.name, series.values.len())?;
            }
        }
        Ok(())
    })
}

/// `value` as it stands in a file: infinity is quoted, no figure of ours.
fn quoted(value: f64) -> String {
    if value.is_finite() { value.to_string() } else { format!("`{value}`") }
}

fn write(arguments: &Arguments, draft: &Path, folder: &Path, talk: &Talk) -> Result<()> {
    let campaign = Campaign::read(draft)?;
    let names = logs(&campaign, arguments.format)?;
    let output = interrupt::output(folder, arguments.force, "import")?;
    let bar = progress::bar(talk, "importing", names.len());
    let one = |(entry, name): (&TrialEntry, &String)| {
        let done = log(&campaign, entry, name, &output);
        bar.inc(1);
        done.unwrap_or_else(|Problems(found)| found)
    };
    let problems: Vec<Problem> = campaign.trials.par_iter().zip(&names).map(one).collect::<Vec<_>>().concat();
    bar.finish_and_clear();
    let warnings: Vec<String> = problems.iter().map(Problem::to_string).collect();
    complain(&Problems(problems.clone()).unless_errors(Problems(problems))?);
    if let Some(arm) = &campaign.arm {
        let urdf = campaign.folder.join(&arm.urdf);
        let text =
            std::fs::read(&urdf).or_else(|e| Problem::error(&urdf, format!("cannot be read: {e}"), "").alone())?;
        output.copy(&arm.urdf, &text)?;
    }
    let trials =
        campaign.trials.iter().zip(&names).map(|(entry, name)| TrialEntry { file: name.clone(), ..entry.clone() });
    let made = Campaign { trials: trials.collect(), ..campaign.clone() };
    output.write("campaign.toml", made.to_toml())?;
    let told = json!({
        "format": "import/1", "campaign": folder, "from": draft,
        "files": campaign.trials.iter().zip(&names).map(|(entry, name)| json!([entry.file, name])).collect::<Vec<_>>(),
        "warnings": warnings,
        "provenance": { "tautline": env!("CARGO_PKG_VERSION") },
    });
    output.write("imported.json", json_text(&told))?;
    let trials = names.len();
    talk.finish(
        output,
        || told,
        |out| writeln!(out, "{}: {trials} trials; `tautline validate` checks them", folder.display()),
    )
}

/// What each trial's log will be called: its file's stem.
///
/// Errors: two that would be one file.
fn logs(campaign: &Campaign, format: Format) -> Result<Vec<String>> {
    let mut seen: BTreeMap<String, &str> = BTreeMap::new();
    let mut names = Vec::new();
    for entry in &campaign.trials {
        let file = Path::new(&entry.file);
        let extension = match file.extension().and_then(|e| e.to_str()) {
            Some(same) if import::is_table(&campaign.folder.join(file)) => same,
            _ if format == Format::Csv => "csv",
            _ => "parquet",
        };
        let name = file.with_extension(extension).display().to_string().replace(['/', '\\'], "_");
        if let Some(other) = seen.insert(name.clone(), &entry.file) {
            let what = format!("`{other}` and `{}` would both become {name}", entry.file);
            return Problem::error(&campaign.file, what, "rename one of them").alone();
        }
        names.push(name);
    }
    Ok(names)
}

/// Writes one trial's log, called `name`, to `output`, a table as it is; returns what was left out of it.
fn log(campaign: &Campaign, entry: &TrialEntry, name: &str, output: &Output) -> Result<Vec<Problem>> {
    let file = campaign.folder.join(&entry.file);
    let Some(all) = import::read(&file)? else {
        let table = std::fs::read(&file).or_else(|e| Problem::error(&file, format!("cannot be read: {e}"), "").alone());
        return output.copy(name, &table?).map(|()| Vec::new());
    };
    let wanted = campaign.columns.names();
    let Picked { columns, warnings } = picked(&file, &all, &wanted.iter().map(String::as_str).collect::<Vec<_>>())?;
    let numbers: Vec<Numbers> =
        wanted.iter().zip(&columns).map(|(name, values)| Numbers { name, values, decimals: DECIMALS }).collect();
    let bytes = if name.ends_with("csv") { csv_bytes(&numbers) } else { parquet_bytes(Path::new(name), &numbers)? };
    output.write(name, bytes).map(|()| warnings)
}
