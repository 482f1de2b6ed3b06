//! `tautline batch`.

use super::identify::{CurveArguments, FormArguments};
use super::interrupt;
use super::outcome::{JUDGED_BAD, Talk};
use super::progress;
use crate::batch::{self, Batch, Came, Entry, Fleet, Row, Settings, Shard, Store};
use crate::identify;
use crate::problem::Result;
use crate::report::fleet::{to_json, write_summary};
use crate::report::output::check_replaceable;
use crate::report::write_fleet;
use rayon::prelude::*;
use serde_json::json;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline batch fleet -o out                        every campaign below the folder
  tautline batch fleet.toml -o out --diagnose        those that a list names (batch/1)
  tautline batch 'fleet/elbow-*/2026-*' -o out       those that a pattern finds
  tautline batch fleet.toml -o out --shard 3/100     the third of a hundred parts; then, once all are done:
  tautline batch fleet.toml -o out                   the table and the report of all

Killed and started again, it goes on where it was. Exit status: 0 done, 1 a campaign failed (the table says why), 2 bad input or usage.")]
pub struct Arguments {
    /// A list of campaigns (batch/1), a folder with campaigns somewhere below it, or a pattern of such folders; any number of them
    #[arg(required = true, value_name = "WHAT")]
    what: Vec<PathBuf>,
    /// Folder to write: fleet/table.csv, fleet/table.parquet, fleet/report.html, and campaigns/ with each one's result
    #[arg(short, long)]
    output: PathBuf,
    /// Look for what separates each campaign from its model too
    #[arg(long)]
    diagnose: bool,
    #[command(flatten)]
    form: FormArguments,
    #[command(flatten)]
    curve: CurveArguments,
    /// Refine all parameters together on the whole series, if that lowers the error on held-out trials
    #[arg(long)]
    refine: bool,
    /// Only this part of the campaigns, as K/N, for one of many machines; writes results, no table
    #[arg(long, value_name = "K/N", value_parser = shard)]
    shard: Option<Shard>,
    /// Threads [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Write the plots as PNG too
    #[arg(long)]
    png: bool,
    /// Work out again what is done already
    #[arg(long)]
    force: bool,
}

/// "3/100" as a shard.
fn shard(text: &str) -> std::result::Result<Shard, String> {
    let expected = || "expected K/N with K from 1 to N, for instance 3/100".to_string();
    let (part, of) = text.split_once('/').ok_or_else(expected)?;
    let (part, of) = part.parse().ok().zip(of.parse().ok()).ok_or_else(expected)?;
    if (1..=of).contains(&part) { Ok(Shard { part, of }) } else { Err(expected()) }
}

/// How many campaigns came by their results in each way.
#[derive(Default)]
struct Tally {
    kept: AtomicUsize,
    done: AtomicUsize,
    failed: AtomicUsize,
}

impl Tally {
    fn add(&self, came: Came) {
        let count = match came {
            Came::Kept => &self.kept,
            Came::Done => &self.done,
            Came::Failed => &self.failed,
        };
        count.fetch_add(1, Ordering::Relaxed);
    }

    /// Kept, done and failed.
    fn counts(&self) -> [usize; 3] {
        [&self.kept, &self.done, &self.failed].map(|count| count.load(Ordering::Relaxed))
    }
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let all = Batch::read(&arguments.what)?;
    let mine = |index: &usize| arguments.shard.is_none_or(|shard| shard.holds(*index));
    let entries: Vec<&Entry> = (0..all.entries.len()).filter(mine).map(|index| &all.entries[index]).collect();
    let store = Store::open(&arguments.output)?;
    if arguments.shard.is_none() {
        // Not after hours of work.
        check_replaceable(&arguments.fleet(), true, FLEET)?;
    }
    let tally = Tally::default();
    let bar = progress::bar(talk, "identifying", entries.len());
    let told = |came| {
        tally.add(came);
        progress::step(&bar, "drawing");
    };
    let threads = arguments.threads.map_or_else(rayon::current_num_threads, usize::from);
    let done = batch::run(&entries, &arguments.settings(), &store, arguments.force, threads, &told);
    bar.finish_and_clear();
    done?;
    match arguments.shard {
        Some(shard) => tell_part(shard, &tally, talk)?,
        None => {
            store.sweep();
            tell_all(arguments, &all, &store, &tally, talk)?;
        }
    }
    Ok(if tally.counts()[2] > 0 { ExitCode::from(JUDGED_BAD) } else { ExitCode::SUCCESS })
}

/// Who writes the table and the report.
const FLEET: &str = "batch";

impl Arguments {
    /// Where the table and the report will stand.
    fn fleet(&self) -> PathBuf {
        self.output.join("fleet")
    }

    fn settings(&self) -> Settings {
        let identify = identify::Settings {
            form: self.form.form(),
            combination: self.curve.settings(),
            refine: self.refine,
            ..Default::default()
        };
        Settings { identify, diagnose: self.diagnose }
    }
}

fn tell_part(shard: Shard, tally: &Tally, talk: &Talk) -> Result<()> {
    let [kept, done, failed] = tally.counts();
    let Shard { part, of } = shard;
    talk.result(
        || json!({ "format": "batch-part/1", "part": part, "of": of, "kept": kept, "done": done, "failed": failed }),
        |out| {
            writeln!(out, "part {part} of {of}: {done} done, {kept} were there already, {failed} failed")?;
            writeln!(out, "once all parts are done, the same command without --shard writes the table")
        },
    )
}

/// Writes the table and the report from the results, which stand as files: whoever worked them out, and whenever.
fn tell_all(arguments: &Arguments, all: &Batch, store: &Store, tally: &Tally, talk: &Talk) -> Result<()> {
    let rows: Vec<Row> = all.entries.par_iter().map(|entry| Row::read(entry, store)).collect();
    let fleet = Fleet::new(all, rows);
    let written = arguments.fleet();
    let output = interrupt::output(&written, true, FLEET)?;
    arguments.what.iter().filter(|what| what.is_file()).for_each(|what| output.made_from("list", what));
    let named = if let [one] = &arguments.what[..] { one.file_stem() } else { None };
    let name = named.map_or_else(|| "fleet".to_string(), |name| name.to_string_lossy().into_owned());
    write_fleet(&fleet, &name, &output, arguments.png)?;
    let to_json = || {
        let [kept, done, failed] = tally.counts();
        let mut json = to_json(&fleet);
        json["work"] = json!({ "kept": kept, "done": done, "failed": failed });
        json
    };
    talk.finish(output, to_json, |out| write_summary(out, &fleet, &written))
}
