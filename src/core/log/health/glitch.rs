//! Readings that the signal cannot have had: single samples, or a few in a row, far from those on both sides, which agree
//! with each other.
//!
//! What sets a glitch apart from a real event is that the signal returns at once: a jump of friction at a reversal, the edge
//! of a contact and the step of an encoder stay. What sets it apart from noise is its size, measured twice: against the
//! second differences of the whole log, and against the changes from sample to sample around it, so that neither a noisy
//! stretch of a quiet log nor a fast motion is taken for one (Hampel, J. Am. Stat. Assoc. 69:383, 1974: the median, not the
//! standard deviation, tells what is usual). Readings that drop to one constant again and again are known by that constant
//! too, where they hide in the noise.

use crate::numerics::statistics::quantile;
use std::cell::OnceCell;
use std::ops::Range;

/// A glitch lasts no longer than this, s: no torque behind a joint's inertia and no joint comes and goes so fast ...
const LONGEST_S: f64 = 0.005;
/// ... nor more samples than this, however short they are, unless they all read the same.
pub(super) const LONGEST: usize = 4;
/// A glitch exceeds by at least this factor the 80th percentile of the changes from sample to sample around it: 9 standard deviations of
/// white noise. A median would be too little where a sensor repeats readings before it chatters.
const LOCAL: f64 = 5.0;
const LOCAL_SHARE: f64 = 0.8;
/// Samples on either side that tell what is usual around a glitch.
const AROUND: usize = 16;
/// In the whole log, a glitch is at least this many times what one second difference in a hundred exceeds; of white noise that
/// is 6.5 of its standard deviations.
const GLOBAL: f64 = 2.5;
/// The hundredth largest second difference is this many times the tenth largest, of white noise; where far more, it is itself a glitch.
const TAIL: f64 = 1.57;
const HEAVY_TAIL: f64 = 4.0;
/// A glitch is at least this many times the last digit or step of the sensor ...
const QUANTA: f64 = 3.0;
/// ... and at least this share of the signal's range: below it a single sample moves nothing.
const RANGE_SHARE: f64 = 1e-3;
/// The readings before and after a glitch differ by less than this share of it.
const RETURN: f64 = 1.0 / 3.0;
/// The mean rate of a log that lacks single samples is too low by up to this share.
const RATE_ERROR: f64 = 0.01;
/// Second differences below this share of the range are rounding of binary numbers.
const DIGITS: f64 = 1e-13;
/// Second differences looked at to tell what is usual.
const LOOKED_AT: usize = 2_000;
/// Glitches at one constant from which on it is a drop-out.
const DROPOUTS_MIN: usize = 5;
/// Readings counted to find the most frequent one.
const COUNTED: usize = 1_000;
/// A value is one that the sensor drops to if it makes up at least this share of the log, is this many times as frequent as each of this
/// many neighbouring values on either side, and its neighbours in time are typically this many usual changes away from it.
const FREQUENT: f64 = 2e-3;
const SPIKE: usize = 8;
const NEXT: usize = 5;
const FAR: f64 = 3.0;
/// Samples looked at together.
const BLOCK: usize = 32;
/// Passes: replacing one glitch may uncover the next.
const PASSES: usize = 3;

/// What was found in one signal.
#[derive(Debug, Default)]
pub(super) struct Glitches {
    /// The samples, in order, neighbours joined.
    pub runs: Vec<Range<usize>>,
    /// The largest distance from the line between the readings beside it, in the signal's unit.
    pub largest: f64,
    /// The reading that most of them share.
    pub constant: Option<f64>,
}

impl Glitches {
    /// Their samples.
    pub fn samples(&self) -> usize {
        self.runs.iter().map(Range::len).sum()
    }
}

/// The glitches of `signal`, sampled at `rate_hz`, which are replaced by straight lines; where the `motion` has a corner, so may
/// its torque.
pub(super) fn mend(signal: &mut [f64], rate_hz: f64, motion: Option<&Corners<'_>>) -> Glitches {
    let frequent = frequent_dropout(signal);
    let mut found = frequent.map_or(Vec::new(), |constant| mend_constant(signal, constant));
    let Some(usual) = Usual::of(signal, rate_hz) else { return Glitches::default() };
    let (mut values, mut largest) = (Vec::new(), 0f64);
    for _ in 0..PASSES {
        let before = found.len();
        let mut at = 0;
        while let Some((run, size)) = next(signal, at, &usual) {
            at = run.end;
            if motion.is_some_and(|motion| motion.are_at(&run)) {
                continue;
            }
            values.extend_from_slice(&signal[run.clone()]);
            largest = largest.max(size);
            bridge(signal, &run);
            found.push(run);
        }
        if found.len() == before {
            break;
        }
    }
    let rare = shared(&mut values);
    if let Some(constant) = rare {
        found.extend(mend_constant(signal, constant));
    }
    let constant = frequent.or(rare);
    Glitches { runs: joined(found), largest, constant }
}

/// What the signal usually does.
struct Usual {
    /// Smallest second difference that is worth a closer look.
    trigger: f64,
    /// Smallest second difference that is no noise and no step of the sensor.
    unusual: f64,
    /// Smallest glitch, in the signal's unit.
    smallest: f64,
    /// Longest glitch, samples.
    longest: usize,
}

impl Usual {
    fn of(signal: &[f64], rate_hz: f64) -> Option<Self> {
        if signal.len() < 2 * AROUND {
            return None;
        }
        let stride = (signal.len() / LOOKED_AT).max(1);
        let places = || (1..signal.len() - 1).step_by(stride);
        let mut seconds: Vec<f64> = places().map(|i| second(signal, i)).filter(|second| *second > 0.0).collect();
        let [tenth, hundredth] = [0.9, 0.99].map(|share| quantile(&mut seconds, share));
        let tail = if hundredth > HEAVY_TAIL * tenth { TAIL * tenth } else { hundredth };
        let mut readings: Vec<f64> = places().map(|i| signal[i]).collect();
        let range = quantile(&mut readings, 0.98) - quantile(&mut readings, 0.02);
        // In whole steps of the sensor, second differences are multiples of half a step, except for rounding of binary numbers.
        let steps = seconds.iter().copied().filter(|second| *second > DIGITS * range);
        let quantum = 2.0 * steps.fold(f64::INFINITY, f64::min);
        let unusual = (GLOBAL * tail).max(QUANTA * quantum);
        let smallest = unusual.max(RANGE_SHARE * range);
        let longest = ((LONGEST_S * rate_hz * (1.0 + RATE_ERROR)) as usize).clamp(1, LONGEST);
        Some(Self { trigger: 0.4 * smallest, unusual, smallest, longest }).filter(|usual| usual.smallest.is_finite())
    }
}

/// Where the speed of a position jumps from one sample to the next: mass asks for a torque there that lasts no longer.
pub(super) struct Corners<'a> {
    position: &'a [f64],
    rate_hz: f64,
    /// The second difference that is no noise, known once it is asked for: few logs have a glitch.
    unusual: OnceCell<f64>,
}

impl<'a> Corners<'a> {
    /// The corners of `position`, sampled at `rate_hz`.
    pub fn of(position: &'a [f64], rate_hz: f64) -> Self {
        Self { position, rate_hz, unusual: OnceCell::new() }
    }

    fn are_at(&self, run: &Range<usize>) -> bool {
        let usual = || Usual::of(self.position, self.rate_hz).map_or(f64::INFINITY, |usual| usual.unusual);
        let unusual = *self.unusual.get_or_init(usual);
        let places = run.start.saturating_sub(1).max(1)..(run.end + 1).min(self.position.len() - 1);
        places.into_iter().any(|i| second(self.position, i) > unusual)
    }
}

/// Distance of sample `i` from the line between its neighbours.
fn second(signal: &[f64], i: usize) -> f64 {
    bend(&[signal[i - 1], signal[i], signal[i + 1]])
}

/// Distance of the second of `three` readings from the line between the others.
fn bend(three: &[f64]) -> f64 {
    (three[1] - 0.5 * three[0] - 0.5 * three[2]).abs()
}

/// The first glitch from sample `from` on, with its size.
fn next(signal: &[f64], from: usize, usual: &Usual) -> Option<(Range<usize>, f64)> {
    let last = signal.len() - 1;
    if from == 0
        && let Some(size) = at_an_end(signal, usual, |place| place)
    {
        return Some((0..1, size));
    }
    let mut block = from.max(1);
    while block < last {
        let end = (block + BLOCK).min(last);
        // Most blocks are quiet, and a comparison without a branch is quick.
        if signal[block - 1..=end].windows(3).fold(false, |any, three| any | (bend(three) > usual.trigger)) {
            let mut triggers = (block..end).filter(|i| second(signal, *i) > usual.trigger);
            if let Some(found) = triggers.find_map(|i| starting_at(signal, i, usual)) {
                return Some(found);
            }
        }
        block = end;
    }
    let size = (from <= last).then(|| at_an_end(signal, usual, |place| last - place))??;
    Some((last..last + 1, size))
}

/// The glitch that begins with sample `start`.
fn starting_at(signal: &[f64], start: usize, usual: &Usual) -> Option<(Range<usize>, f64)> {
    let before = signal[start - 1];
    for end in start + 1..=(start + LONGEST).min(signal.len() - 1) {
        let after = signal[end];
        let is_short = end - start <= usual.longest;
        if !is_short && signal[start..end].iter().any(|reading| *reading != signal[start]) {
            return None;
        }
        let step = (after - before) / (end + 1 - start) as f64;
        let off = |i: usize| signal[i] - before - step * (i + 1 - start) as f64;
        let side = off(start).signum();
        let least = (start..end).map(|i| side * off(i)).fold(f64::INFINITY, f64::min);
        if least <= usual.smallest || (after - before).abs() > RETURN * least {
            continue;
        }
        let quiet = |a: usize, b: Option<&f64>| b.is_some_and(|b| (b - signal[a]).abs() <= RETURN * least);
        let flanks =
            [quiet(start - 1, (start - 1).checked_sub(1).map(|i| &signal[i])), quiet(end, signal.get(end + 1))];
        if flanks.contains(&true) && least > LOCAL * change_around(signal, start..end) {
            let most = (start..end).map(|i| side * off(i)).fold(0.0, f64::max);
            return Some((start..end, most));
        }
    }
    None
}

/// The size of a glitch at the log's first sample, or at its last as `place` counts; twice as large as elsewhere, because
/// there is nothing on its other side.
fn at_an_end(signal: &[f64], usual: &Usual, place: impl Fn(usize) -> usize) -> Option<f64> {
    let size = (signal[place(0)] - signal[place(1)]).abs();
    let (one, other) = (place(0).min(place(1)), place(0).max(place(1)));
    let rest = (signal[place(1)] - signal[place(2)]).abs();
    let is_one = size > 2.0 * usual.smallest && rest < RETURN * size;
    (is_one && size > 2.0 * LOCAL * change_around(signal, one..other)).then_some(size)
}

/// What most changes from sample to sample around `run` stay below, the run itself left out.
fn change_around(signal: &[f64], run: Range<usize>) -> f64 {
    let change = |i: usize| (signal[i + 1] - signal[i]).abs();
    let before = run.start.saturating_sub(AROUND)..run.start.saturating_sub(1);
    let after = run.end..(run.end + AROUND).min(signal.len() - 1);
    let mut changes: Vec<f64> = before.chain(after).map(change).collect();
    // A sensor slower than its log repeats readings: what it changes by shows where it changes.
    changes.retain(|change| *change > 0.0);
    if changes.is_empty() { 0.0 } else { quantile(&mut changes, LOCAL_SHARE) }
}

/// The reading that the signal drops to so often that drop-outs make up much of its tails: one that is much more frequent than the values
/// next to it, and far from its neighbours in time.
fn frequent_dropout(signal: &[f64]) -> Option<f64> {
    let stride = (signal.len() / COUNTED).max(1);
    let mut readings: Vec<f64> = signal.iter().step_by(stride).copied().collect();
    readings.sort_unstable_by(f64::total_cmp);
    let mut counts: Vec<(f64, usize)> = readings.chunk_by(|a, b| a == b).map(|chunk| (chunk[0], chunk.len())).collect();
    let most = (0..counts.len()).max_by_key(|place| counts[*place].1)?;
    let (constant, count) = counts[most];
    let beside = counts.drain(most.saturating_sub(NEXT)..(most + NEXT + 1).min(counts.len()));
    let next = beside.filter(|(reading, _)| *reading != constant).map(|(_, count)| count).max().unwrap_or(0);
    if count < DROPOUTS_MIN || (count as f64) < FREQUENT * readings.len() as f64 || count < SPIKE * next {
        return None;
    }
    let (mut onto, mut others) = (Vec::new(), Vec::new());
    for pair in signal.windows(2) {
        match (pair[0] == constant, pair[1] == constant) {
            (false, false) => others.push((pair[1] - pair[0]).abs()),
            (false, true) | (true, false) => onto.push((pair[1] - pair[0]).abs()),
            (true, true) => (),
        }
    }
    // A signal that stays at the constant is stuck, or at the end of its range.
    let stays = signal.iter().filter(|reading| **reading == constant).count() > LONGEST * onto.len() / 2;
    (!stays && quantile(&mut onto, 0.5) > FAR * quantile(&mut others, 0.5)).then_some(constant)
}

/// Straight lines where `signal` drops to `constant`.
fn mend_constant(signal: &mut [f64], constant: f64) -> Vec<Range<usize>> {
    let runs = short_runs(signal, constant);
    runs.iter().for_each(|run| bridge(signal, run));
    runs
}

/// The reading that at least half of `values` share.
fn shared(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let most = values.chunk_by(|a, b| a == b).max_by_key(|chunk| chunk.len())?;
    (most.len() >= DROPOUTS_MIN && 2 * most.len() >= values.len()).then(|| most[0])
}

/// Runs of `constant` no longer than a glitch. Between them and their neighbours a straight line hardly differs where the
/// signal passes through the constant by itself.
fn short_runs(signal: &[f64], constant: f64) -> Vec<Range<usize>> {
    let mut start = 0;
    let mut runs = Vec::new();
    for run in signal.chunk_by(|a, b| (*a == constant) == (*b == constant)) {
        let end = start + run.len();
        if run[0] == constant && run.len() <= LONGEST && start > 0 && end < signal.len() {
            runs.push(start..end);
        }
        start = end;
    }
    runs
}

/// A straight line across `run`; at an end of the log the nearest reading.
pub(super) fn bridge(signal: &mut [f64], run: &Range<usize>) {
    let before = run.start.checked_sub(1).map(|i| signal[i]);
    let after = signal.get(run.end).copied();
    let (Some(from), Some(to)) = (before.or(after), after.or(before)) else { return };
    let step = (to - from) / (run.len() + 1) as f64;
    for (k, i) in run.clone().enumerate() {
        signal[i] = from + step * (k + 1) as f64;
    }
}

/// `runs` in order, those that touch made one.
pub(super) fn joined(mut runs: Vec<Range<usize>>) -> Vec<Range<usize>> {
    runs.sort_by_key(|run| run.start);
    let mut out: Vec<Range<usize>> = Vec::with_capacity(runs.len());
    for run in runs {
        match out.last_mut() {
            Some(last) if run.start <= last.end => last.end = last.end.max(run.end),
            _ => out.push(run),
        }
    }
    out
}
