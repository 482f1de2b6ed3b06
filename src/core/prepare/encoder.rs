//! The position that friction follows, and the travel back below which nothing counts as a reversal.
//!
//! The recorded position has its encoder's steps and noise, the filtered one rings at corners: it is followed, but within the recorded one's
//! error. A coarse encoder stands still and jumps: with 4096 counts per turn a clearance of 20 mrad is 13 steps, and friction changes most
//! in the first. Where it jumps, though, it tells the position exactly: half way between two counts.

use crate::model::Strokes;
use crate::numerics::statistics::deviation_by_median;
use std::ops::Range;

/// A reversal counts once the joint came back by this many standard deviations of the position's noise: two samples at
/// rest, the extremes of hundreds, differ by 6.
const DEADBAND_SIGMAS: f64 = 8.0;
/// The same of an encoder without other noise, in steps: between its jumps the position is made of them.
const DEADBAND_STEPS: f64 = 0.5;
/// The noise of the steps alone is 0.3 of a step (uniform within it): up to this share of one there is no other.
const STEPS_ALONE: f64 = 0.5;
/// The reading is this many standard deviations of its noise off at most, outliers aside, ...
const REACH_SIGMAS: f64 = 3.0;
/// ... that of an encoder without other noise this many steps.
const REACH_STEPS: f64 = 0.5;
/// The reading stands still where it is the same so many times: it is then not filtered.
const STILL: usize = 4;
/// Changes are one step of an encoder, or several, within this share of it: a table rounds them.
const ONE_STEP: f64 = 0.2;
/// A position is made of steps where this share of all changes are whole ones.
const WHOLE_SHARE: f64 = 0.9;
/// Steps matter where at least this share of all changes is a single one beside a sample without change; faster motion
/// hides them.
const LONE_SHARE: f64 = 0.5;
/// With fewer than this share of them even changes are those of a speed.
const LONE_SHARE_MIN: f64 = 0.1;

/// What friction follows.
pub struct Position {
    /// The motion, cut where the joint turns.
    pub strokes: Strokes,
    /// The deadband, rad.
    pub deadband_rad: f64,
    /// The encoder's step where it matters, else 0, rad.
    pub step_rad: f64,
}

impl Position {
    /// Of a position as recorded and the same filtered, rad. What the filter took out tells the noise; the median resists
    /// the corners, where it takes out motion.
    pub fn new(raw_rad: &[f64], filtered_rad: &[f64]) -> Self {
        // Every 7th sample is enough for a median and keeps it cheap.
        let mut taken: Vec<f64> = raw_rad.iter().zip(filtered_rad).step_by(7).map(|(r, f)| (r - f).abs()).collect();
        let sigma_rad = Some(deviation_by_median(&mut taken)).filter(|sigma| sigma.is_finite()).unwrap_or(0.0);
        let smallest_rad = smallest_change_rad(raw_rad, 0.0).filter(|step_rad| sigma_rad <= STEPS_ALONE * step_rad);
        let lone_share = smallest_rad.map_or(0.0, |step_rad| lone_share(raw_rad, step_rad));
        let is_made = |step_rad: &f64| lone_share >= LONE_SHARE_MIN && is_made_of_steps(raw_rad, *step_rad);
        let step_rad = smallest_rad.filter(is_made);
        let (reach_rad, deadband_rad) = match step_rad {
            Some(step_rad) => (REACH_STEPS * step_rad, (DEADBAND_SIGMAS * sigma_rad).min(DEADBAND_STEPS * step_rad)),
            None => (REACH_SIGMAS * sigma_rad, DEADBAND_SIGMAS * sigma_rad),
        };
        let mut position_rad = within(raw_rad, filtered_rad, reach_rad);
        let between_rad = step_rad.map(|step_rad| between_jumps(raw_rad, step_rad));
        let still_rad = between_rad.as_deref().unwrap_or(raw_rad);
        for still in raw_rad.chunk_by(|a, b| a == b).scan(0, ranges).filter(|still| still.len() >= STILL) {
            position_rad[still.clone()].copy_from_slice(&still_rad[still]);
        }
        let step_rad = step_rad.filter(|_| lone_share >= LONE_SHARE).unwrap_or(0.0);
        Self { strokes: Strokes::new(position_rad, deadband_rad), deadband_rad, step_rad }
    }
}

/// The samples of each of some neighbouring chunks, `begun` before it.
fn ranges(begun: &mut usize, chunk: &[f64]) -> Option<Range<usize>> {
    let range = *begun..*begun + chunk.len();
    *begun = range.end;
    Some(range)
}

/// The filtered position within `reach_rad` of the recorded one, rad; a single reading farther from it than that is an outlier.
fn within(raw_rad: &[f64], filtered_rad: &[f64], reach_rad: f64) -> Vec<f64> {
    let is_far = |i: usize| raw_rad.get(i).is_some_and(|raw| (raw - filtered_rad[i]).abs() > reach_rad);
    let nearest = |(i, filtered): (usize, &f64)| match is_far(i) && (is_far(i.wrapping_sub(1)) || is_far(i + 1)) {
        true => filtered.max(raw_rad[i] - reach_rad).min(raw_rad[i] + reach_rad),
        false => *filtered,
    };
    filtered_rad.iter().enumerate().map(nearest).collect()
}

/// Changes from sample to sample of more than `above_rad`, rad.
fn changes_rad(raw_rad: &[f64], above_rad: f64) -> impl Iterator<Item = f64> {
    raw_rad.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(move |change| *change > above_rad)
}

/// The smallest change from sample to sample of more than `above_rad`, rad: of a coarse encoder its step.
pub fn smallest_change_rad(raw_rad: &[f64], above_rad: f64) -> Option<f64> {
    changes_rad(raw_rad, above_rad).min_by(f64::total_cmp)
}

/// Whether the position changes by whole steps of `step_rad`.
fn is_made_of_steps(raw_rad: &[f64], step_rad: f64) -> bool {
    let off = |change_rad: f64| (change_rad / step_rad - (change_rad / step_rad).round()).abs();
    let (mut all, mut whole) = (0usize, 0usize);
    for change_rad in changes_rad(raw_rad, 0.0) {
        all += 1;
        whole += usize::from(off(change_rad) < ONE_STEP);
    }
    whole as f64 >= WHOLE_SHARE * all as f64
}

/// The share of all changes that are single steps of `step_rad` beside a sample without change.
fn lone_share(raw_rad: &[f64], step_rad: f64) -> f64 {
    let is_lone = |four: &&[f64]| {
        let change_rad = (four[2] - four[1]).abs();
        let beside_rest = four[0] == four[1] || four[2] == four[3];
        change_rad > 0.0 && change_rad < (1.0 + ONE_STEP) * step_rad && beside_rest
    };
    let lone = raw_rad.windows(4).filter(is_lone).count();
    lone as f64 / changes_rad(raw_rad, 0.0).count().max(1) as f64
}

/// Straight lines between the jumps of an encoder of step `step_rad`; where it jumps back, the crest that the jumps before
/// and after make likely. A reading that wavers between two counts is a flat line.
fn between_jumps(raw_rad: &[f64], step_rad: f64) -> Vec<f64> {
    let jumps = jumps(raw_rad, step_rad);
    let (Some(first), Some(last)) = (jumps.first(), jumps.last()) else { return raw_rad.to_vec() };
    let mut out = Vec::with_capacity(raw_rad.len());
    out.resize(first.at.ceil() as usize, first.position_rad);
    for (k, pair) in jumps.windows(2).enumerate() {
        let [from, to] = [pair[0], pair[1]];
        let outer = k.checked_sub(1).and_then(|before| Some([*jumps.get(before)?, *jumps.get(k + 2)?]));
        let crest = if from.position_rad == to.position_rad { crest([from, to], outer, step_rad) } else { Crest::None };
        let between = out.len()..to.at.ceil() as usize;
        for (i, reading_rad) in between.clone().zip(&raw_rad[between]) {
            let share = (i as f64 - from.at) / (to.at - from.at);
            let line_rad = from.position_rad + (to.position_rad - from.position_rad) * share;
            out.push(match crest {
                Crest::None => line_rad,
                Crest::Parabola(height_rad) => line_rad + height_rad * 4.0 * share * (1.0 - share),
                Crest::Rest => *reading_rad,
            });
        }
    }
    out.resize(raw_rad.len(), last.position_rad);
    out
}

/// A place where the position is known.
#[derive(Clone, Copy)]
struct Jump {
    /// Time, samples.
    at: f64,
    /// Position, rad.
    position_rad: f64,
}

/// Half way between two counts where the reading changed by one step; by more, the two readings themselves: the motion is
/// then so fast that a step is little.
fn jumps(raw_rad: &[f64], step_rad: f64) -> Vec<Jump> {
    let mut jumps: Vec<Jump> = Vec::new();
    for (i, pair) in raw_rad.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]) {
        if (pair[1] - pair[0]).abs() < 1.5 * step_rad {
            jumps.push(Jump { at: i as f64 + 0.5, position_rad: (pair[0] + pair[1]) / 2.0 });
            continue;
        }
        if jumps.last().is_none_or(|last| last.at < i as f64) {
            jumps.push(Jump { at: i as f64, position_rad: pair[0] });
        }
        jumps.push(Jump { at: i as f64 + 1.0, position_rad: pair[1] });
    }
    jumps
}

/// What the joint did between a jump and the same jump back.
enum Crest {
    /// Nothing that shows.
    None,
    /// It turned, so far beyond the jump, rad.
    Parabola(f64),
    /// It rested before it turned.
    Rest,
}

/// Between the jumps `there_and_back` it turned on the parabola through them and the `outer` ones, if those are one step below. A parabola
/// that reached the next step would have caused a further jump, so such a stretch is a rest.
fn crest(there_and_back: [Jump; 2], outer: Option<[Jump; 2]>, step_rad: f64) -> Crest {
    let Some(outer) = outer else { return Crest::Rest };
    let height_rad = outer.map(|jump| there_and_back[0].position_rad - jump.position_rad);
    let is_step = |rad: f64| (rad.abs() / step_rad - 1.0).abs() < ONE_STEP;
    if height_rad[0] * height_rad[1] <= 0.0 || !height_rad.iter().all(|rad| is_step(*rad)) {
        return Crest::None;
    }
    let time = |[from, to]: [Jump; 2]| to.at - from.at;
    let share = time(there_and_back).powi(2) / (time(outer).powi(2) - time(there_and_back).powi(2));
    if share < 1.0 { Crest::Parabola(height_rad[0] * share) } else { Crest::Rest }
}
