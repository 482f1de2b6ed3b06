//! The constant-speed legs of a sweep: where (17) holds.

use crate::dynamics::JointKind;
use crate::log::Log;
use crate::model::{Direction, Joint};
use crate::numerics::statistics::{extent, quantile, reading_noise};
use crate::problem::{Problem, Result};
use std::ops::Range;

/// Speed is the mean over this share of the whole travel, long enough for a coarse encoder, short enough for a ramp to show ...
const WINDOW_TRAVEL: f64 = 0.02;
/// ... or over this many times the noise of a reading: the difference of two is off by 5 % of it at 3.5 standard deviations, ...
const WINDOW_NOISES: f64 = 99.0;
/// ... at most over this share of the travel.
const WINDOW_TRAVEL_MOST: f64 = 0.1;
/// A plateau's speed is within this share of the declared one.
const SPEED_TOLERANCE: f64 = 0.05;
/// A leg covers at least this share of the whole travel.
const MIN_TRAVEL: f64 = 0.2;
/// Left out at a leg's start: at least this share of its travel, should the declared backlash be too small ...
const REVERSAL_TRAVEL: f64 = 0.05;
/// ... and this many times the declared backlash.
const REVERSAL_BACKLASHES: f64 = 1.1;
/// Left out at both ends, in periods of the low-pass: where it carries in what lies outside the leg.
const FILTER_PERIODS: f64 = 1.5;
/// Fewest samples that a leg may have.
pub(super) const MIN_SAMPLES: usize = 20;

/// One stretch of motion at constant speed in one direction, transitions left out.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// Its direction.
    pub direction: Direction,
    /// Its samples in the trial.
    pub samples: Range<usize>,
    /// Those of them that a clipped or stuck sensor spoils; empty where it does not.
    pub left_out: Range<usize>,
}

impl Leg {
    /// The samples that can be used.
    pub fn used(&self) -> impl Iterator<Item = usize> + Clone {
        (self.samples.start..self.left_out.start).chain(self.left_out.end..self.samples.end)
    }
}

/// The legs of a sweep at `speed_rad_s` (declared, positive), in order of time.
///
/// `lowpass_hz` is the torque's cut-off. Errors: no plateau at the declared speed, or none of it left by the clearance.
pub fn find_legs(
    log: &Log,
    position_rad: &[f64],
    speed_rad_s: f64,
    joint: &Joint,
    lowpass_hz: f64,
) -> Result<Vec<Leg>> {
    let Cut { legs, half, longest_rad } = cut(position_rad, log.rate_hz, speed_rad_s, joint, lowpass_hz);
    let backlash_rad = joint.backlash_rad();
    if legs.is_empty() && longest_rad > 0.0 && REVERSAL_BACKLASHES * backlash_rad >= 0.5 * longest_rad {
        let what = format!(
            "after the declared clearance of {backlash_rad:.3} rad at the joint nothing is left of a leg of {longest_rad:.3} rad"
        );
        return Problem::error(&log.file, what, "correct backlash_m (metres on the cable) in campaign.toml").alone();
    }
    if legs.is_empty() {
        let speeds = (0..position_rad.len()).map(|i| window_speed(position_rad, half, log.rate_hz, i));
        return no_plateau(log, speeds, speed_rad_s, joint.kind).alone();
    }
    Ok(legs)
}

/// What cutting a sweep gives.
pub(super) struct Cut {
    pub legs: Vec<Leg>,
    /// Samples on either side over which the speed is measured.
    half: usize,
    /// Travel of the longest plateau, rad.
    longest_rad: f64,
}

pub(super) fn cut(position_rad: &[f64], rate_hz: f64, speed_rad_s: f64, joint: &Joint, lowpass_hz: f64) -> Cut {
    let (low, high) = extent(position_rad);
    let range_rad = high - low;
    let half = half_window(position_rad, rate_hz, speed_rad_s);
    let margin = (FILTER_PERIODS / lowpass_hz * rate_hz) as usize;
    let speed = |i: usize| window_speed(position_rad, half, rate_hz, i);
    let mut legs: Vec<Leg> = Vec::new();
    let mut longest_rad = 0f64;
    for direction in Direction::BOTH {
        for run in plateaus(speed, position_rad.len(), direction.sign() * speed_rad_s) {
            let travel = (position_rad[run.end - 1] - position_rad[run.start]).abs();
            longest_rad = longest_rad.max(travel);
            if travel >= MIN_TRAVEL * range_rad {
                legs.extend(trim(position_rad, direction, run, joint.backlash_rad(), margin));
            }
        }
    }
    legs.sort_by_key(|leg| leg.samples.start);
    Cut { legs, half, longest_rad }
}

/// Speed at each sample of a sweep at `speed_rad_s`, rad/s, as its legs are judged by: the joint's own under a noisy or coarse
/// position too.
pub fn sweep_speeds(position_rad: &[f64], rate_hz: f64, speed_rad_s: f64) -> Vec<f64> {
    let half = half_window(position_rad, rate_hz, speed_rad_s);
    (0..position_rad.len()).map(|i| window_speed(position_rad, half, rate_hz, i)).collect()
}

/// Samples either side over which the speed of a sweep is taken.
fn half_window(position_rad: &[f64], rate_hz: f64, speed_rad_s: f64) -> usize {
    let (low, high) = extent(position_rad);
    let range_rad = (high - low).max(f64::MIN_POSITIVE);
    let share = (WINDOW_NOISES * reading_noise(position_rad) / range_rad).clamp(WINDOW_TRAVEL, WINDOW_TRAVEL_MOST);
    // Where the declared speed is far too slow, still a window that fits into the log.
    let window = (share * range_rad / speed_rad_s * rate_hz).min(share * position_rad.len() as f64);
    ((window / 2.0) as usize).max(2)
}

/// Mean speed over `half` samples either side of sample `i`, rad/s; zero where there are too few.
fn window_speed(position_rad: &[f64], half: usize, rate_hz: f64, i: usize) -> f64 {
    if i < half || i + half >= position_rad.len() {
        return 0.0;
    }
    (position_rad[i + half] - position_rad[i - half]) * rate_hz / (2 * half) as f64
}

/// Maximal runs of `samples` whose `speed` is `target_rad_s` (signed), within the tolerance.
fn plateaus(speed: impl Fn(usize) -> f64, samples: usize, target_rad_s: f64) -> Vec<Range<usize>> {
    let on = |i: usize| (speed(i) - target_rad_s).abs() <= SPEED_TOLERANCE * target_rad_s.abs();
    let mut runs = Vec::new();
    let mut start = None;
    for i in 0..samples {
        match (on(i), start) {
            (true, None) => start = Some(i),
            (false, Some(s)) => {
                runs.push(s..i);
                start = None;
            }
            _ => {}
        }
    }
    runs.extend(start.map(|s| s..samples));
    runs
}

/// The run without the transition after its reversal and without what the low-pass carries in from outside.
fn trim(
    position_rad: &[f64],
    direction: Direction,
    run: Range<usize>,
    backlash_rad: f64,
    margin: usize,
) -> Option<Leg> {
    let begin_rad = position_rad[run.start];
    let travel_rad = (position_rad[run.end - 1] - begin_rad).abs();
    let skip_rad = (REVERSAL_BACKLASHES * backlash_rad).max(REVERSAL_TRAVEL * travel_rad);
    let past = run.clone().find(|i| (position_rad[*i] - begin_rad) * direction.sign() >= skip_rad)?;
    // A fast leg may be short against the filter: then give up at most a sixth of it at each end.
    let margin = margin.min(run.len() / 6);
    let samples = past.max(run.start + margin)..run.end - margin;
    let left_out = samples.end..samples.end;
    (samples.len() >= MIN_SAMPLES).then_some(Leg { direction, samples, left_out })
}

/// Why there is no leg: how much of the motion is near the declared speed, or how fast it is instead.
fn no_plateau(log: &Log, speeds: impl Iterator<Item = f64>, speed_rad_s: f64, kind: JointKind) -> Problem {
    let mut magnitudes: Vec<f64> = speeds.map(f64::abs).filter(|v| *v > 0.0).collect();
    let moving = magnitudes.len();
    let near = magnitudes.iter().filter(|v| (*v - speed_rad_s).abs() <= SPEED_TOLERANCE * speed_rad_s).count();
    // At rest throughout there is no quantile.
    let [usual, top] = [0.5, 0.9].map(|share| quantile(&mut magnitudes, share).max(0.0));
    let unit = kind.speed_unit();
    let share = 100.0 * near as f64 / moving.max(1) as f64;
    let what = format!(
        "no plateau at the declared speed_rad_s = {speed_rad_s} {unit}: {share:.0} % of the motion is within {:.0} % of it, in no \
         stretch of {:.0} % of the travel and {MIN_SAMPLES} samples; half of the motion is faster than {usual:.4} {unit}, and the \
         joint moves at up to {top:.4} {unit}",
        100.0 * SPEED_TOLERANCE,
        100.0 * MIN_TRAVEL,
    );
    let cure = "correct speed_rad_s in campaign.toml or the position's unit, record longer sweeps at constant speed, or mark the \
                trial `free`";
    Problem::error(&log.file, what, cure)
}
