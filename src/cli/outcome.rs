//! How commands talk: results on standard output, everything else on standard error.

use crate::problem::{Problem, Problems, Result, Severity};
use anstyle::{AnsiColor, Style};
use clap::Args;
use serde_json::Value;
use std::io::{self, Write};

/// Exit status of a judgement that failed.
pub const JUDGED_BAD: u8 = 1;
/// Exit status of bad input or usage.
pub const BAD_INPUT: u8 = 2;

/// How much a command says, and in what form.
#[derive(Debug, Clone, Copy, Args)]
pub struct Talk {
    /// Print the result as JSON on standard output, and nothing else there
    #[arg(long, global = true)]
    pub json: bool,
    /// Say nothing but errors
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

impl Talk {
    /// Whether progress may be shown.
    pub fn shows_progress(&self) -> bool {
        !self.json && !self.quiet
    }

    /// Prints the result: `json` with `--json`, `text` without, nothing with `--quiet` alone.
    pub fn result(
        &self,
        json: impl FnOnce() -> Value,
        text: impl FnOnce(&mut StdoutLock<'static>) -> io::Result<()>,
    ) -> Result<()> {
        if self.json {
            say(|out| writeln!(out, "{:#}", json()))
        } else if !self.quiet {
            say(text)
        } else {
            Ok(())
        }
    }
}

/// Standard output, its colours dropped where `NO_COLOR` asks for it or nobody looks.
pub type StdoutLock<'a> = anstream::AutoStream<io::StdoutLock<'a>>;

/// Writes to standard output; a reader that went away (`| head`) is no failure of ours, a full disk is.
pub fn say(write: impl FnOnce(&mut StdoutLock<'static>) -> io::Result<()>) -> Result<()> {
    let mut out = anstream::stdout().lock();
    match write(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Problem::error("standard output", format!("cannot be written: {error}"), "the files are in place").alone()
        }
        _ => Ok(()),
    }
}

/// Writes problems to standard error, one a line; what is wrong with many files in the same words is said once.
pub fn complain(problems: &Problems) {
    let mut out = anstream::stderr().lock();
    let same = |a: &Problem, b: &Problem| (&a.what, &a.cure, a.severity) == (&b.what, &b.cure, b.severity);
    for (i, problem) in problems.0.iter().enumerate() {
        if problems.0[..i].iter().any(|earlier| same(earlier, problem)) {
            continue;
        }
        let (word, colour) = match problem.severity {
            Severity::Error => ("error", AnsiColor::Red),
            Severity::Warning => ("warning", AnsiColor::Yellow),
        };
        let style = Style::new().bold().fg_color(Some(colour.into()));
        let more = match problems.0[i + 1..].iter().filter(|later| same(problem, later)).count() {
            0 => String::new(),
            n => format!(" (and the same in {n} other places)"),
        };
        let _ = writeln!(out, "{style}{word}{style:#}: {problem}{more}");
    }
}
