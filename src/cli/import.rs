//! `tautline import`.

use super::interrupt;
use super::outcome::{Talk, complain};
use super::progress;
use crate::import::{self, Picked, Series, picked, stretches, without_repeated_rows};
use crate::log::table::{Numbers, csv_bytes, parquet_bytes};
use crate::log::{Campaign, Part, TrialEntry, raw};
use crate::numerics::statistics::extent;
use crate::problem::{Problem, Problems, Result};
use crate::report::{Output, json_text};
use clap::ValueEnum;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::Write;
use std::ops::Range;
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
export (.csv, .txt: columns time in ms, channels by name). CSV and Parquet are taken as they are, unless rows repeat the row
before them (they are dropped); where time has gaps a trial is parted. What was done is said, and nothing is invented.")]
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
        done
    };
    let done: Vec<Result<Imported>> = campaign.trials.par_iter().zip(&names).map(one).collect();
    bar.finish_and_clear();
    let found = |done: &Result<Imported>| match done {
        Ok(imported) => imported.problems.clone(),
        Err(Problems(found)) => found.clone(),
    };
    let problems: Vec<Problem> = done.iter().flat_map(found).collect();
    let warnings: Vec<String> = problems.iter().map(Problem::to_string).collect();
    complain(&Problems(problems.clone()).unless_errors(Problems(problems))?);
    if let Some(arm) = &campaign.arm {
        let urdf = campaign.folder.join(&arm.urdf);
        let text =
            std::fs::read(&urdf).or_else(|e| Problem::error(&urdf, format!("cannot be read: {e}"), "").alone())?;
        output.copy(&arm.urdf, &text)?;
    }
    let done: Vec<Imported> = done.into_iter().flatten().collect();
    let made = Campaign { trials: parted(&campaign.trials, &done), ..campaign.clone() };
    output.write("campaign.toml", made.to_toml())?;
    let files = campaign.trials.iter().zip(&done).map(|(entry, done)| json!([entry.log(), done.name]));
    let told = json!({
        "format": "import/1", "campaign": folder, "from": draft,
        "files": files.collect::<Vec<_>>(),
        "warnings": warnings,
        "provenance": { "tautline": env!("CARGO_PKG_VERSION") },
    });
    output.write("imported.json", json_text(&told))?;
    let trials = made.trials.len();
    talk.finish(
        output,
        || told,
        |out| writeln!(out, "{}: {trials} trials; `tautline validate` checks them", folder.display()),
    )
}

/// The trials of the campaign made: those whose log has gaps parted there, the parts numbered as repeats of their own.
fn parted(trials: &[TrialEntry], done: &[Imported]) -> Vec<TrialEntry> {
    let mut last = trials.iter().map(|entry| entry.repeat).max().unwrap_or(0);
    let mut made = Vec::new();
    for (entry, imported) in trials.iter().zip(done) {
        let whole = TrialEntry { file: imported.name.clone(), ..entry.clone() };
        if let Some(part) = &entry.part {
            let part = Part { log: imported.name.clone(), ..part.clone() };
            made.push(TrialEntry { file: part.name(), part: Some(part), ..entry.clone() });
            continue;
        }
        if imported.stretches.len() < 2 {
            made.push(whole);
            continue;
        }
        for (number, rows) in imported.stretches.iter().enumerate() {
            let part = Part { log: imported.name.clone(), rows: rows.clone() };
            if number > 0 {
                last += 1;
            }
            let repeat = if number == 0 { entry.repeat } else { last };
            made.push(TrialEntry { file: part.name(), part: Some(part), repeat, ..whole.clone() });
        }
    }
    made
}

/// A log as it was written.
struct Imported {
    name: String,
    /// Its rows between gaps.
    stretches: Vec<Range<usize>>,
    /// What was mended.
    problems: Vec<Problem>,
}

/// What each trial's log will be called: its file's stem.
///
/// Errors: two that would be one file.
fn logs(campaign: &Campaign, format: Format) -> Result<Vec<String>> {
    let mut seen: BTreeMap<String, &str> = BTreeMap::new();
    let mut names = Vec::new();
    for entry in &campaign.trials {
        let file = Path::new(entry.log());
        let extension = match file.extension().and_then(|e| e.to_str()) {
            Some(same) if import::is_table(&campaign.folder.join(file)) => same,
            _ if format == Format::Csv => "csv",
            _ => "parquet",
        };
        let name = file.with_extension(extension).display().to_string().replace(['/', '\\'], "_");
        if let Some(other) = seen.insert(name.clone(), entry.log()).filter(|other| *other != entry.log()) {
            let what = format!("`{other}` and `{}` would both become {name}", entry.log());
            return Problem::error(&campaign.file, what, "rename one of them").alone();
        }
        names.push(name);
    }
    Ok(names)
}

/// Writes one trial's log, called `name`, to `output`: a table that needs no mending as it is.
fn log(campaign: &Campaign, entry: &TrialEntry, name: &str, output: &Output) -> Result<Imported> {
    let file = campaign.folder.join(entry.log());
    let wanted = campaign.columns.names();
    let wanted: Vec<&str> = wanted.iter().map(String::as_str).collect();
    let (mut all, is_table) = match import::read(&file)? {
        Some(all) => (all, false),
        None => (raw(&file, &campaign.files)?.columns, true),
    };
    let time = campaign.columns.rate_hz.is_none().then_some(campaign.columns.time.name.as_str());
    // Rows that another trial counts stay where they are.
    all.retain(|series| !is_table || wanted.contains(&series.name.as_str()));
    let repeated = if entry.part.is_some() || !is_table { 0 } else { without_repeated_rows(&mut all, time) };
    let mut problems = Vec::new();
    if repeated > 0 {
        let what = format!("{repeated} rows repeat the row before them in time and all readings");
        problems.push(Problem::warning(&file, what, "they are dropped"));
    }
    let clock = all
        .iter()
        .find(|series| Some(&series.name.as_str()) == wanted.get(usize::from(time.is_some())))
        .map(|series| series.clock);
    let is_time = |series: &&Series| Some(series.name.as_str()) == time && Some(series.clock) == clock;
    let times = all.iter().find(is_time).map(|series| &series.values);
    let stretches = times.map_or(Vec::new(), |times| stretches(times));
    if stretches.len() > 1 && entry.part.is_none() {
        let what = format!("time has {} gaps", stretches.len() - 1);
        problems.push(Problem::warning(&file, what, format!("the trial is parted there into {}", stretches.len())));
    }
    if is_table && repeated == 0 {
        let table = std::fs::read(&file).or_else(|e| Problem::error(&file, format!("cannot be read: {e}"), "").alone());
        return output.copy(name, &table?).map(|()| Imported { name: name.to_string(), stretches, problems });
    }
    let Picked { columns, warnings } = picked(&file, &all, &wanted)?;
    problems.extend(warnings);
    let numbers: Vec<Numbers<'_>> =
        wanted.iter().zip(&columns).map(|(name, values)| Numbers { name, values, decimals: DECIMALS }).collect();
    // What was text in some dialect is written anew as Parquet, which has none.
    let name = if is_table { with_ending(name, "parquet") } else { name.to_string() };
    let bytes = if name.ends_with("csv") { csv_bytes(&numbers) } else { parquet_bytes(Path::new(&name), &numbers)? };
    output.write(&name, bytes).map(|()| Imported { name, stretches, problems })
}

fn with_ending(name: &str, ending: &str) -> String {
    Path::new(name).with_extension(ending).to_string_lossy().into_owned()
}
