//! How commands talk: results on standard output, everything else on standard error.

use crate::limits::{PROBLEMS_PRINTED, listed};
use crate::problem::{Problem, Problems, Result, Severity, visible, visible_styled};
use crate::report::{Output, gate, json_text};
use anstyle::{AnsiColor, Style};
use clap::Args;
use serde_json::Value;
use std::collections::HashMap;
use std::io::{self, Write};
use std::path::Path;
use std::process::Command;

/// Exit status of a judgement that failed.
pub const JUDGED_BAD: u8 = 1;
/// Exit status of bad input or usage.
pub const BAD_INPUT: u8 = 2;

/// Exit status where the torque of a real drive is not shown to be off.
pub const TORQUE_ON: u8 = 3;

/// How much a command says, and in what form.
#[derive(Debug, Clone, Copy, Args)]
pub struct Talk {
    /// Print the result as JSON on standard output, and nothing else there
    #[arg(long, global = true)]
    pub json: bool,
    /// Say nothing but errors
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Open the report in the browser once it is written
    #[arg(long, global = true)]
    pub open: bool,
}

impl Talk {
    /// Whether progress may be shown.
    pub fn shows_progress(&self) -> bool {
        !self.json && !self.quiet
    }

    /// Prints the result: `json` with `--json`, `text` without, nothing with `--quiet` alone.
    ///
    /// Errors: something is not a number where a figure is meant.
    pub fn result(
        &self,
        json: impl FnOnce() -> Value,
        text: impl FnOnce(&mut Vec<u8>) -> io::Result<()>,
    ) -> Result<()> {
        self.finish(None, json, text)
    }

    /// The same, once `output` has been put in its place: what does not pass the gate leaves no file either.
    ///
    /// Errors: something is not a number where a figure is meant; the output cannot be put in place.
    pub fn finish(
        &self,
        output: impl Into<Option<Output>>,
        json: impl FnOnce() -> Value,
        text: impl FnOnce(&mut Vec<u8>) -> io::Result<()>,
    ) -> Result<()> {
        // Both forms, whichever is wanted: a figure may stand in one alone.
        self.conclude(output.into(), &json(), &written(text))
    }

    fn conclude(&self, output: Option<Output>, json: &Value, text: &str) -> Result<()> {
        gate::json(STDOUT, json)?;
        gate::shown(STDOUT, text)?;
        let report = output.as_ref().map(|output| output.path().join(REPORT)).filter(|_| self.open);
        output.map_or(Ok(()), Output::finish)?;
        report.filter(|report| report.is_file()).map_or(Ok(()), |report| open(&report))?;
        match self {
            Self { json: true, .. } => print(&json_text(json)),
            Self { quiet: true, .. } => Ok(()),
            _ => print(text),
        }
    }
}

/// The page that `--open` opens.
const REPORT: &str = "report.html";

/// Opens `page` in the system's browser, without waiting for it.
///
/// Errors: the system has no program that opens files.
fn open(page: &Path) -> Result<()> {
    let (program, first): (&str, &[&str]) = match std::env::consts::OS {
        "macos" => ("open", &[]),
        "windows" => ("cmd", &["/C", "start", ""]),
        _ => ("xdg-open", &[]),
    };
    let silent = std::process::Stdio::null;
    let started = Command::new(program).args(first).arg(page).stdin(silent()).stdout(silent()).stderr(silent()).spawn();
    match started {
        Ok(_) => Ok(()),
        Err(error) => {
            let what = format!("cannot be opened: {program}: {error}");
            Problem::error(page, what, "the page is written; open it in a browser").alone()
        }
    }
}

/// What messages call standard output.
const STDOUT: &str = "standard output";

/// What `write` writes.
fn written(write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> String {
    let mut bytes = Vec::new();
    // Writing to memory cannot fail.
    let _ = write(&mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Writes to standard output, without colours where `NO_COLOR` is set or the output is not a terminal, and everything else that would act
/// on a terminal made visible. A reader that went away (`| head`) is no failure of ours, a full disk is.
pub fn say(write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> Result<()> {
    print(&written(write))
}

fn print(text: &str) -> Result<()> {
    let mut out = anstream::stdout().lock();
    match out.write_all(visible_styled(text).as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Problem::error("standard output", format!("cannot be written: {error}"), "the files are in place").alone()
        }
        _ => Ok(()),
    }
}

/// Writes problems to standard error, one a line; what is wrong in many places in the same words is said once, with all of
/// the places.
pub fn complain(problems: &Problems) {
    let mut out = anstream::stderr().lock();
    let words = |problem: &Problem| (problem.what.clone(), problem.cure.clone(), problem.column.clone());
    let mut groups: Vec<Vec<&Problem>> = Vec::new();
    let mut known: HashMap<_, usize> = HashMap::new();
    for problem in &problems.0 {
        let group = *known.entry((words(problem), problem.severity == Severity::Error)).or_insert(groups.len());
        match groups.get_mut(group) {
            Some(group) => group.push(problem),
            None => groups.push(vec![problem]),
        }
    }
    let unsaid = groups.len().saturating_sub(PROBLEMS_PRINTED);
    if unsaid > 0 {
        groups.sort_by_key(|group| group[0].severity != Severity::Error);
    }
    for group in groups.iter().take(PROBLEMS_PRINTED) {
        let problem = group[0];
        let (word, colour) = match problem.severity {
            Severity::Error => ("error", AnsiColor::Red),
            Severity::Warning => ("warning", AnsiColor::Yellow),
        };
        let style = Style::new().bold().fg_color(Some(colour.into()));
        let places = group.windows(2).map(|pair| place(pair[1], pair[0]));
        let others: Vec<String> = places.filter(|place| !place.is_empty()).collect();
        let others = listed(others.iter().map(String::as_str));
        let more = if others.is_empty() { String::new() } else { format!(" (the same: {others})") };
        let _ = writeln!(out, "{style}{word}{style:#}: {problem}{more}");
    }
    if unsaid > 0 {
        let _ = writeln!(out, "and {unsaid} more problems; `tautline validate --json` lists all of a campaign");
    }
}

/// Where `problem` stands, after one `before` in the same words: its file if that is another, its row.
fn place(problem: &Problem, before: &Problem) -> String {
    let name = problem.file.file_name().map_or_else(|| problem.file.to_string_lossy(), |name| name.to_string_lossy());
    let file = (problem.file != before.file).then(|| visible(&name).into_owned());
    let row = problem.row.map(|row| format!("row {row}"));
    file.into_iter().chain(row).collect::<Vec<_>>().join(" ")
}
