//! How commands talk: results on standard output, everything else on standard error.

use crate::problem::{Problems, Severity};
use anstyle::{AnsiColor, Style};
use clap::Args;
use serde_json::Value;
use std::io::{self, Write};

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
    pub fn result(&self, json: impl FnOnce() -> Value, text: impl FnOnce(&mut StdoutLock<'static>) -> io::Result<()>) {
        if self.json {
            say(|out| writeln!(out, "{:#}", json()));
        } else if !self.quiet {
            say(text);
        }
    }
}

/// Standard output, its colours dropped where `NO_COLOR` asks for it or nobody looks.
pub type StdoutLock<'a> = anstream::AutoStream<io::StdoutLock<'a>>;

/// Writes to standard output; a reader that went away (`| head`) is no failure of ours.
pub fn say(write: impl FnOnce(&mut StdoutLock<'static>) -> io::Result<()>) {
    let mut out = anstream::stdout().lock();
    let _ = write(&mut out).and_then(|()| out.flush());
}

/// Writes problems to standard error, one a line.
pub fn complain(problems: &Problems) {
    let mut out = anstream::stderr().lock();
    for problem in &problems.0 {
        let (word, colour) = match problem.severity {
            Severity::Error => ("error", AnsiColor::Red),
            Severity::Warning => ("warning", AnsiColor::Yellow),
        };
        let style = Style::new().bold().fg_color(Some(colour.into()));
        let _ = writeln!(out, "{style}{word}{style:#}: {problem}");
    }
}
