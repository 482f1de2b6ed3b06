//! What `diagnose` is at: a bar for those who watch, a table of where the time went for those who ask.

use super::outcome::Talk;
use super::progress;
use crate::diagnose::Progress;
use indicatif::ProgressBar;
use std::io::Write;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Listens to a diagnosis.
pub struct Stages {
    bar: ProgressBar,
    spent: Mutex<Spent>,
}

/// The phases in the order in which they began, with the time that each took.
#[derive(Default)]
struct Spent {
    phases: Vec<(String, Duration)>,
    since: Option<Instant>,
}

impl Spent {
    fn end(&mut self) {
        if let (Some(since), Some((_, spent))) = (self.since.take(), self.phases.last_mut()) {
            *spent += since.elapsed();
        }
    }
}

impl Stages {
    /// Before the first phase.
    pub fn new(talk: &Talk) -> Self {
        Self { bar: progress::bar(talk, "", 0), spent: Mutex::default() }
    }

    /// Hears what the diagnosis is at.
    pub fn hear(&self, told: Progress<'_>) {
        match told {
            Progress::Begins(phase) => {
                let mut spent = self.spent();
                spent.end();
                spent.phases.push((phase.to_string(), Duration::ZERO));
                spent.since = Some(Instant::now());
                self.bar.reset();
                self.bar.set_length(0);
                self.bar.set_message(phase.to_string());
            }
            Progress::Ahead(steps) => self.bar.inc_length(steps as u64),
            Progress::Done(what) => {
                self.bar.inc(1);
                if let Some((phase, _)) = self.spent().phases.last() {
                    self.bar.set_message(format!("{phase}: {what}"));
                }
            }
        }
    }

    /// The end of the last phase.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
        self.spent().end();
    }

    /// Says on standard error where the time went: phases, seconds, shares.
    pub fn say(&self) {
        let spent = self.spent();
        let whole_s = spent.phases.iter().map(|(_, spent)| spent.as_secs_f64()).sum::<f64>();
        let mut out = anstream::stderr().lock();
        let lines = spent.phases.iter().map(|(phase, spent)| (phase.as_str(), spent.as_secs_f64()));
        for (phase, spent_s) in lines.chain([("whole diagnosis", whole_s)]) {
            // Who closed standard error does not want to read it.
            let _ = writeln!(out, "{phase:<40} {spent_s:8.3} s {:5.1} %", 100.0 * spent_s / whole_s);
        }
    }

    fn spent(&self) -> MutexGuard<'_, Spent> {
        self.spent.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
