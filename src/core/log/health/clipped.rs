//! Readings at the end of the torque sensor's range.
//!
//! A sensor that clips gives its extreme value again and again while the joint moves on. So does, now and then, any
//! coarse sensor, and a smooth peak, and a noise-free simulation of constant friction. What tells them apart:
//!
//! - chance: with p the share of equal neighbours elsewhere in the log, a run of m equal readings among n samples
//!   is expected n p^(m-1) times;
//! - the histogram: at a smooth peak q - c t^2 the readings thin out gradually, the last step of the sensor being at
//!   most 1 / (sqrt 2 - 1) = 2.4 times as frequent as the one before it (3.8 for c t^3); at a clipped one the last
//!   reading stands alone;
//! - noise: a log that is at its extremes more often than not, and smooth elsewhere, was simulated without noise.

use crate::numerics::statistics::extent;
use std::ops::Range;

/// Equal readings in a row, from which on a run is looked at.
pub(super) const RUN_MIN: usize = 5;
/// Runs this unlikely, as an expected number in the whole log, are no chance.
const CHANCE_MAX: f64 = 1e-6;
/// Above this share of equal neighbours the sensor is coarse, and runs must matter in position too ...
const COARSE_SHARE: f64 = 0.2;
/// ... by spanning together this share of the position's range.
const SPAN_SHARE_MIN: f64 = 0.01;
/// The extreme reading must be this many times as frequent as each of the next readings (see above: 3.8 is smooth).
const SPIKE: usize = 8;
/// How many readings next to the extreme are compared with it.
const NEXT_READINGS: usize = 5;
/// Below this share of turning points a signal is smooth; noise turns at two samples of three.
const SMOOTH_SHARE: f64 = 0.1;
/// The joint moves where it is faster than this share of its mean speed ...
const MOVING_SHARE: f64 = 0.2;
/// ... over this time, s: long enough for an encoder to count.
const MOVING_WINDOW_S: f64 = 0.05;
/// ... and passes a place where it does so in one direction over this many times half that, before and after.
const PASSING: usize = 4;

/// One end of the sensor's range.
#[derive(Debug)]
pub(super) struct ClippedEnd {
    /// The reading there, in the log's unit.
    pub reading: f64,
    /// The runs of that reading, single samples too; not empty.
    pub runs: Vec<Range<usize>>,
}

/// The runs of both ends, in order.
pub(super) fn merge(ends: Vec<ClippedEnd>) -> Vec<Range<usize>> {
    let mut all: Vec<_> = ends.into_iter().flat_map(|end| end.runs).collect();
    all.sort_by_key(|run| run.start);
    all
}

/// The ends of its range that `torque` hit while `position` moved: none, one or both.
/// Among `runs` of equal readings of `torque`.
pub(super) fn find(position: &[f64], torque: &[f64], rate_hz: f64, runs: &[Range<usize>]) -> Vec<ClippedEnd> {
    if runs.is_empty() {
        return Vec::new();
    }
    let (low, high) = extent(torque);
    let at = |reading: f64| runs.iter().filter(|run| torque[run.start] == reading).cloned().collect();
    let ends = [low, high].map(|reading| ClippedEnd { reading, runs: at(reading) });
    if ends.iter().all(|end| end.runs.is_empty()) {
        return Vec::new();
    }
    let motion = Motion::of(position, rate_hz);
    let moving = motion.moving();
    let inner = Inner::of(torque, &moving, low, high);
    if inner.is_noise_free_plateau() {
        return Vec::new();
    }
    let clips =
        |end: &ClippedEnd| inner.are_no_chance(end.runs.iter(), &motion) && is_spike(torque, &moving, end.reading);
    // Long runs prove that the sensor clips; then every reading there is clipped, single ones as well.
    let whole = |end: ClippedEnd| ClippedEnd { runs: runs_of(torque, end.reading), ..end };
    ends.into_iter().filter(clips).map(whole).collect()
}

/// Runs of `reading`, single samples too.
fn runs_of(torque: &[f64], reading: f64) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut start = 0;
    for run in torque.chunk_by(|a, b| (*a == reading) == (*b == reading)) {
        if run[0] == reading {
            runs.push(start..start + run.len());
        }
        start += run.len();
    }
    runs
}

/// Runs of one reading, whichever, from `RUN_MIN` on.
pub(super) fn equal_runs(signal: &[f64]) -> Vec<Range<usize>> {
    let (mut runs, mut end) = (Vec::new(), 0);
    // Each run that is long enough holds a reading, equal to the one before it, at a multiple of this.
    for at in (RUN_MIN - 1..signal.len()).step_by(RUN_MIN - 1) {
        if at < end || signal[at] != signal[at - 1] {
            continue;
        }
        let is_other = |reading: &f64| *reading != signal[at];
        let start = signal[..at].iter().rposition(is_other).map_or(0, |last| last + 1);
        end = signal[at..].iter().position(is_other).map_or(signal.len(), |length| at + length);
        if end - start >= RUN_MIN {
            runs.push(start..end);
        }
    }
    runs
}

/// Whether `extreme`, the least or greatest reading, is far more frequent than those next to it while moving.
fn is_spike(torque: &[f64], moving: &[bool], extreme: f64) -> bool {
    // Distinct readings by distance from the extreme, the nearest first, with their counts.
    let mut nearest: Vec<(f64, usize)> = Vec::new();
    for (reading, _) in torque.iter().zip(moving).filter(|(_, moving)| **moving) {
        let distance = (reading - extreme).abs();
        if nearest.len() > NEXT_READINGS && distance > nearest[NEXT_READINGS].0 {
            continue;
        }
        match nearest.binary_search_by(|(other, _)| other.total_cmp(&distance)) {
            Ok(place) => nearest[place].1 += 1,
            Err(place) => nearest.insert(place, (distance, 1)),
        }
        nearest.truncate(NEXT_READINGS + 1);
    }
    let at_extreme = nearest.first().filter(|(distance, _)| *distance == 0.0).map_or(0, |(_, count)| *count);
    nearest.iter().skip(1).all(|(_, count)| at_extreme >= SPIKE * count)
}

/// The moving samples away from both extremes.
pub(super) struct Inner {
    /// Samples of the whole log.
    samples: usize,
    /// Share of equal neighbours.
    equal_share: f64,
    /// Share of turning points.
    turning_share: f64,
    /// Share of the moving samples that are at an extreme.
    outside_share: f64,
}

impl Inner {
    pub fn of(torque: &[f64], moving: &[bool], low: f64, high: f64) -> Self {
        let inside = |sample: usize| moving[sample] && torque[sample] > low && torque[sample] < high;
        let (mut pairs, mut equal, mut triples, mut turns) = (0, 0, 0, 0);
        for sample in 1..torque.len() {
            if !(inside(sample - 1) && inside(sample)) {
                continue;
            }
            let step = torque[sample] - torque[sample - 1];
            pairs += 1;
            equal += usize::from(step == 0.0);
            if sample + 1 < torque.len() && inside(sample + 1) {
                triples += 1;
                turns += usize::from(step * (torque[sample + 1] - torque[sample]) < 0.0);
            }
        }
        let all = moving.iter().filter(|moving| **moving).count();
        let within = (0..torque.len()).filter(|sample| inside(*sample)).count();
        let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
        Self {
            samples: torque.len(),
            equal_share: share(equal, pairs),
            turning_share: share(turns, triples),
            outside_share: share(all - within, all),
        }
    }

    pub fn is_noise_free_plateau(&self) -> bool {
        self.outside_share > 0.5 && self.turning_share < SMOOTH_SHARE
    }

    /// Whether `run`, in motion, is longer than chance makes any of the log's.
    pub fn is_unlikely(&self, run: &Range<usize>, motion: &Motion<'_>) -> bool {
        motion.moves_through(run) && self.samples as f64 * self.equal_share.powi(run.len() as i32 - 1) < CHANCE_MAX
    }

    /// Whether some of `runs` are no chance and, where the sensor is coarse, matter.
    pub fn are_no_chance<'a>(&self, runs: impl Iterator<Item = &'a Range<usize>>, motion: &Motion<'_>) -> bool {
        let travels: Vec<f64> =
            runs.filter(|run| self.is_unlikely(run, motion)).map(|run| motion.travel(run)).collect();
        let matters = travels.iter().sum::<f64>() >= SPAN_SHARE_MIN * motion.travel(&(0..self.samples));
        !travels.is_empty() && (self.equal_share < COARSE_SHARE || matters)
    }
}

/// Where the joint moves.
pub(super) struct Motion<'a> {
    position: &'a [f64],
    /// Samples to either side over which speed is judged.
    reach: usize,
    /// Mean distance per sample, in the position's unit.
    mean_step: f64,
}

impl<'a> Motion<'a> {
    pub fn of(position: &'a [f64], rate_hz: f64) -> Self {
        // A rate that makes no sense must not reach beyond the log.
        let reach = ((rate_hz * MOVING_WINDOW_S / 2.0).ceil() as usize).clamp(1, position.len().max(1));
        let path: f64 = position.chunks(2 * reach).map(|chunk| (chunk[chunk.len() - 1] - chunk[0]).abs()).sum();
        Self { position, reach, mean_step: path / position.len() as f64 }
    }

    /// Of each sample, whether the joint moves there.
    pub fn moving(&self) -> Vec<bool> {
        (0..self.position.len()).map(|sample| self.is_moving(sample)).collect()
    }

    /// Whether the joint moves on in one direction from before `sample` to after it: where it starts, stops or turns round, torque
    /// jumps by itself.
    pub fn passes(&self, sample: usize) -> bool {
        let reach = PASSING * self.reach;
        let (first, last) = (sample.saturating_sub(reach), (sample + reach).min(self.position.len() - 1));
        let before = self.position[sample] - self.position[first];
        let after = self.position[last] - self.position[sample];
        let is_fast = |way: f64, samples: usize| way.abs() > MOVING_SHARE * self.mean_step * samples as f64;
        before * after > 0.0 && is_fast(before, sample - first) && is_fast(after, last - sample)
    }

    pub fn is_moving(&self, sample: usize) -> bool {
        let first = sample.saturating_sub(self.reach);
        let last = (sample + self.reach).min(self.position.len() - 1);
        let way = (self.position[last] - self.position[first]).abs();
        way > MOVING_SHARE * self.mean_step * (last - first) as f64
    }

    /// Whether the joint moves on during `run` itself: at rest a constant torque is no wonder.
    pub fn moves_through(&self, run: &Range<usize>) -> bool {
        self.travel(run) > MOVING_SHARE * self.mean_step * run.len() as f64
    }

    fn travel(&self, run: &Range<usize>) -> f64 {
        let part = &self.position[run.clone()];
        let fold = |pick: fn(f64, f64) -> f64| part.iter().copied().fold(part[0], pick);
        fold(f64::max) - fold(f64::min)
    }
}
