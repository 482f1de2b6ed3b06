//! Many campaigns -> one result each, kept as files -> the whole fleet at a glance.
//!
//! | file | what it does |
//! |---|---|
//! | `manifest` | what to do: a list, a folder tree, a pattern |
//! | `digest` | what a result depends on, as one number |
//! | `work` | one campaign: identify, evaluate, diagnose |
//! | `record` | its result, as a file holds it |
//! | `store` | the results' folder: a file each, whole or not at all |
//! | `table` | a row for each campaign |
//! | `quantities` | what several campaigns of a joint know of it: parameters and functions |
//! | `life` | what happened to a parameter or function over time, and when a limit will be reached |
//! | `events` | retensionings and other times at which something changed |
//! | `fleet` | by joint, over time: what happened to it |
//! | `outliers` | what stands out |
//! | `repeatability` | runs under the same conditions: what comes out the same |

mod calendar;
mod condition;
mod digest;
mod events;
mod fleet;
mod life;
mod manifest;
mod outliers;
mod quantities;
mod record;
mod repeatability;
mod store;
mod table;
mod work;

pub use calendar::{date_of, day};
pub use events::{Drift, Event};
pub use fleet::{Fleet, Foreseen, Joint};
pub use life::{Change, Forecast, Happened, Life, Limit, Part};
pub use manifest::{Batch, Entry, Reference};
pub use outliers::Outlier;
pub use record::{Diagnosed, Record};
pub use repeatability::{Quantity, RUNS_MIN, Repeatability, Verdict as Repeated};
pub use store::Store;
pub use table::{Row, columns};
pub use work::Settings;

use crate::problem::{Problem, Problems, Result};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// One part of a batch: every `of`-th campaign, beginning with number `part`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 1.
    pub part: usize,
    /// Number of parts.
    pub of: usize,
}

impl Shard {
    /// Whether the campaign at `index` belongs to it.
    pub fn holds(self, index: usize) -> bool {
        index % self.of == self.part - 1
    }
}

/// How a campaign came by its result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Came {
    /// It was there already.
    Kept,
    /// It was worked out now.
    Done,
    /// It was tried now, and failed.
    Failed,
}

/// Works out what `store` lacks of `entries`, on `threads` threads; `told` hears of each campaign.
///
/// A thread takes one campaign at a time, so that memory is bounded by the threads, however many campaigns there are. A
/// result is kept if it was worked out by this version from the same files with the same settings, and did not fail;
/// `afresh` keeps none.
///
/// Errors: a result cannot be written. What is wrong with a campaign is its result.
pub fn run(
    entries: &[&Entry],
    settings: &Settings,
    store: &Store,
    afresh: bool,
    threads: usize,
    told: &(dyn Fn(Came) + Sync),
) -> Result<()> {
    let workers = threads.min(entries.len()).max(1);
    let (next, trouble) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let worker = || {
        while let Some(entry) = entries.get(next.fetch_add(1, Ordering::Relaxed)) {
            match one(entry, settings, store, afresh) {
                Ok(came) => told(came),
                Err(Problems(found)) => {
                    next.store(entries.len(), Ordering::Relaxed);
                    trouble.lock().unwrap_or_else(PoisonError::into_inner).extend(found);
                }
            }
        }
    };
    // Each worker has its own pool, most often of one thread. In a common pool a thread that waits for part of its campaign would begin
    // another one meanwhile, and another in that: there would be no bound on how many are in memory.
    std::thread::scope(|scope| {
        for at in 0..workers {
            let share = threads / workers + usize::from(at < threads % workers);
            match rayon::ThreadPoolBuilder::new().num_threads(share.max(1)).build() {
                Ok(pool) => drop(scope.spawn(move || pool.install(worker))),
                Err(error) => {
                    let problem =
                        Problem::error("--threads", format!("a thread cannot be started: {error}"), "ask for fewer");
                    trouble.lock().unwrap_or_else(PoisonError::into_inner).push(problem);
                }
            }
        }
    });
    let trouble = trouble.into_inner().unwrap_or_else(PoisonError::into_inner);
    if trouble.is_empty() { Ok(()) } else { Err(Problems(trouble)) }
}

fn one(entry: &Entry, settings: &Settings, store: &Store, afresh: bool) -> Result<Came> {
    let inputs = digest::of(entry, settings);
    let known = Row::read(entry, store);
    if known.model.is_some() && known.record.inputs == inputs && !afresh {
        return Ok(Came::Kept);
    }
    let record = work::record(entry, settings, inputs);
    store.write(&record)?;
    Ok(if record.failure.is_some() { Came::Failed } else { Came::Done })
}
