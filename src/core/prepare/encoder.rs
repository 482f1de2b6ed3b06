//! The position that K_f follows, and the travel back below which nothing counts as a reversal.
//!
//! K_f needs the position without the ringing that a filter leaves at a corner, so as recorded. But a coarse encoder stands
//! still and jumps: with 4096 counts per turn a clearance of 20 mrad is 13 steps, and friction changes most in the first.
//! Where it jumps, though, it tells the position exactly: half way between two counts.

use crate::numerics::statistics::deviation_by_median;

/// A reversal counts once the joint came back by this many standard deviations of the position's noise: two samples at
/// rest, the extremes of hundreds, differ by 6.
const DEADBAND_SIGMAS: f64 = 8.0;
/// The same of an encoder without other noise, in steps: between its jumps the position is made of them.
const DEADBAND_STEPS: f64 = 0.5;
/// The noise of the steps alone is 0.3 of a step (uniform within it): up to this share of one there is no other.
const STEPS_ALONE: f64 = 0.5;
/// Changes are one step of an encoder within this share of it: a table rounds them.
const ONE_STEP: f64 = 0.2;
/// Steps matter where at least this share of all changes is a single one beside a sample without change; faster motion
/// hides them.
const LONE_SHARE: f64 = 0.5;

/// What K_f follows.
pub struct Position {
    /// What an encoder's jumps say of the position, rad; `None` where it is as recorded.
    pub between_jumps_rad: Option<Vec<f64>>,
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
        let sigma_rad = deviation_by_median(&mut taken);
        match encoder_step_rad(raw_rad) {
            Some(step_rad) if sigma_rad <= STEPS_ALONE * step_rad => Self {
                between_jumps_rad: Some(between_jumps(raw_rad, step_rad)),
                deadband_rad: (DEADBAND_SIGMAS * sigma_rad).min(DEADBAND_STEPS * step_rad),
                step_rad,
            },
            _ => Self {
                between_jumps_rad: None,
                deadband_rad: if sigma_rad.is_finite() { DEADBAND_SIGMAS * sigma_rad } else { 0.0 },
                step_rad: 0.0,
            },
        }
    }
}

/// Changes from sample to sample of more than `above_rad`, rad.
fn changes_rad(raw_rad: &[f64], above_rad: f64) -> impl Iterator<Item = f64> {
    raw_rad.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(move |change| *change > above_rad)
}

/// The smallest change from sample to sample of more than `above_rad`, rad: of a coarse encoder its step.
pub fn smallest_change_rad(raw_rad: &[f64], above_rad: f64) -> Option<f64> {
    changes_rad(raw_rad, above_rad).min_by(f64::total_cmp)
}

/// The step of the encoder, rad; `None` where the position does not move in steps, or so fast that they do not matter.
fn encoder_step_rad(raw_rad: &[f64]) -> Option<f64> {
    let changes = || changes_rad(raw_rad, 0.0);
    let step_rad = smallest_change_rad(raw_rad, 0.0)?;
    let is_lone = |four: &&[f64]| {
        let change_rad = (four[2] - four[1]).abs();
        let beside_rest = four[0] == four[1] || four[2] == four[3];
        change_rad > 0.0 && change_rad < (1.0 + ONE_STEP) * step_rad && beside_rest
    };
    let lone = raw_rad.windows(4).filter(is_lone).count();
    (lone as f64 >= LONE_SHARE * changes().count() as f64).then_some(step_rad)
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
