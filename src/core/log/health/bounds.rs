//! Readings that no joint and no sensor shows.

use crate::numerics::statistics::quantile;
use std::ops::Range;

/// No joint driven by cables turns or travels further, rad or m: 16 turns.
const POSITION_MAX: f64 = 100.0;
/// No torque sensor measures more, N m or N; squares and products of it stay finite.
const TORQUE_MAX: f64 = 1e9;
/// A torque this many times farther from the median than 19 samples in 20 is no load, contact or friction.
const FAR: f64 = 1000.0;
/// The share of samples that tell what is usual.
const USUAL: f64 = 0.95;
/// Samples looked at for that.
const LOOKED_AT: usize = 2_000;

/// The samples of a position, a reading times `factor` being rad or m, that are outside any joint's range.
pub(super) fn position(signal: &[f64], factor: f64) -> Option<Range<usize>> {
    beyond(signal, |reading| (reading * factor).abs() > POSITION_MAX)
}

/// The samples of a torque, a reading times `factor` being N m or N, that are no torque of this log.
pub(super) fn torque(signal: &[f64], factor: f64) -> Option<Range<usize>> {
    let stride = (signal.len() / LOOKED_AT).max(1);
    let mut readings: Vec<f64> = signal.iter().step_by(stride).copied().collect();
    let middle = quantile(&mut readings, 0.5);
    let mut distances: Vec<f64> = readings.iter().map(|reading| (reading - middle).abs()).collect();
    let usual = quantile(&mut distances, USUAL);
    let far = if usual > 0.0 { FAR * usual } else { f64::INFINITY };
    beyond(signal, |reading| (reading * factor).abs() > TORQUE_MAX || (reading - middle).abs() > far)
}

/// From the first to the last sample that is `outside`.
fn beyond(signal: &[f64], outside: impl Fn(f64) -> bool) -> Option<Range<usize>> {
    let first = signal.iter().position(|reading| outside(*reading))?;
    let last = signal.iter().rposition(|reading| outside(*reading))?;
    Some(first..last + 1)
}
