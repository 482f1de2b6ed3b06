//! The independent observations: motion cycles, and the folds that are held out in turn.
//!
//! Samples of a filtered signal are no independent observations, cycles nearly are. Whole trials are held out where there are enough of them:
//! their motion is new then. Else cycles are, and where the gap wanders from trial to trial, so that nothing foresees a whole one.

use super::record::Record;
use super::records::Records;
use crate::numerics::statistics::extent;
use std::ops::Range;

/// Folds held out in turn.
pub const FOLDS: usize = 4;
/// From this many trials on, trials are held out, from twice as many on they are resampled; with fewer, cycles.
const TRIALS_MIN: usize = 4;
/// A reversal is one after travel back of this share of the range.
const REVERSAL: f64 = 0.05;
/// Cycles are joined until they have this many rows: about twenty independent samples.
const ROWS_MIN: usize = 50;
/// A campaign with fewer cycles is cut into this many pieces of time.
const PIECES: usize = 8;

/// The rows cut into units.
#[derive(Debug, Clone)]
pub struct Folds {
    /// Rows of each unit.
    pub units: Vec<Range<usize>>,
    /// The fold in which each unit is held out.
    pub fold: Vec<usize>,
    /// What is resampled as a whole, for each unit: its trial, or itself.
    pub cluster: Vec<usize>,
    /// Whether whole trials are held out, not cycles; and whether they are resampled.
    by_trial: bool,
    trials_resampled: bool,
}

impl Folds {
    /// How many rows of each unit are `used`.
    pub fn rows(&self, used: &[bool]) -> Vec<usize> {
        self.units.iter().map(|unit| used[unit.clone()].iter().filter(|used| **used).count()).collect()
    }

    /// `rows` that are all one.
    pub fn whole(rows: usize) -> Self {
        Self {
            units: std::iter::once(0..rows).collect(),
            fold: vec![0],
            cluster: vec![0],
            by_trial: false,
            trials_resampled: false,
        }
    }

    /// Of `records`: trials are held out where there are enough of them.
    pub fn new(records: &Records) -> Self {
        Self::of(records, usable(records) >= TRIALS_MIN)
    }

    /// Of `records`: cycles are held out; nothing where that is what [`Self::new`] does.
    pub fn of_cycles(&self, records: &Records) -> Option<Self> {
        self.by_trial.then(|| Self::of(records, false))
    }

    fn of(records: &Records, by_trial: bool) -> Self {
        let (mut units, mut record_of) = (Vec::new(), Vec::new());
        for (at, (record, range)) in records.all.iter().zip(&records.ranges).enumerate() {
            let mut cuts = cycles(record);
            if !by_trial && cuts.len() * records.all.len() < PIECES {
                cuts = pieces(record.rows.len(), PIECES.div_ceil(records.all.len()));
            }
            for cut in cuts.into_iter().filter(|cut| !cut.is_empty()) {
                units.push(range.start + cut.start..range.start + cut.end);
                record_of.push(at);
            }
        }
        let fold = match by_trial {
            true => record_of.iter().map(|at| at % FOLDS).collect(),
            false => (0..units.len()).map(|at| at % FOLDS).collect(),
        };
        let trials_resampled = usable(records) >= 2 * TRIALS_MIN;
        let cluster = if trials_resampled { record_of } else { (0..units.len()).collect() };
        Self { units, fold, cluster, by_trial, trials_resampled }
    }

    /// What is held out, for people.
    pub fn held_out(&self) -> &'static str {
        if self.by_trial { "trials" } else { "motion cycles" }
    }

    /// What is resampled as a whole, for people.
    pub fn resampled(&self) -> &'static str {
        if self.trials_resampled { "trials" } else { "motion cycles" }
    }
}

/// How many of `records` have rows.
fn usable(records: &Records) -> usize {
    records.all.iter().filter(|record| !record.rows.is_empty()).count()
}

/// The rows of each cycle of `record`: from one lower reversal to the next.
fn cycles(record: &Record) -> Vec<Range<usize>> {
    let positions: Vec<f64> = record.rows.iter().map(|i| record.own[*i].position).collect();
    let (low, high) = extent(&positions);
    let back = REVERSAL * (high - low);
    let (mut cuts, mut start, mut crest, mut rising, mut turn) = (Vec::new(), 0, low, true, 0);
    for (i, q) in positions.iter().enumerate() {
        let ahead = if rising { q - crest } else { crest - q };
        if ahead >= 0.0 {
            (crest, turn) = (*q, i);
        } else if -ahead > back {
            rising = !rising;
            if rising && turn - start >= ROWS_MIN {
                cuts.push(start..turn);
                start = turn;
            }
            (crest, turn) = (*q, i);
        }
    }
    match cuts.last_mut() {
        Some(last) if positions.len() - start < ROWS_MIN => last.end = positions.len(),
        _ => cuts.push(start..positions.len()),
    }
    cuts
}

fn pieces(rows: usize, count: usize) -> Vec<Range<usize>> {
    (0..count).map(|i| rows * i / count..rows * (i + 1) / count).collect()
}
