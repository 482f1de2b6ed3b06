//! A reading that stays while the joint moves, inside the sensor's range: a frozen channel, or the last value held where a
//! frame was lost.
//!
//! Torque: as for a sensor that clips, a run must be too long for chance, must matter where the sensor is coarse, and is normal in a
//! simulation without noise. A coarse sensor reads the same for long, too, but then goes on by one step; a stuck one jumps on release to
//! where the torque has got meanwhile, and not because the motion starts, stops or turns round. Position: the reading stays and then jumps
//! by what the joint travelled, many steps of the encoder at once.

use super::clipped::{Inner, Motion, RUN_MIN, equal_runs};
use crate::numerics::statistics::{extent, quantile};
use std::ops::Range;

/// A release or an onset by more than this many steps of the sensor is no step of a coarse one.
const QUANTA: f64 = 2.5;
/// The position jumps on release by more than this many of its steps ...
const POSITION_QUANTA: f64 = 5.0;
/// ... and by this share of the way that it goes in as many samples afterwards.
const WAY_SHARE: f64 = 0.5;
/// Changes looked at for the smallest step of a sensor.
const LOOKED_AT: usize = 2_000;

/// The stretches in which `torque` is stuck while `position` moves, among `suspects`, its runs of equal readings; none at its
/// extremes, where it may clip instead.
pub(super) fn torque(
    position: &[f64],
    torque: &[f64],
    rate_hz: f64,
    mut suspects: Vec<Range<usize>>,
) -> Vec<Range<usize>> {
    if suspects.is_empty() {
        return suspects;
    }
    let (low, high) = extent(torque);
    let motion = Motion::of(position, rate_hz);
    let inner = Inner::of(torque, &motion.moving(), low, high);
    if inner.is_noise_free_plateau() {
        return Vec::new();
    }
    let quantum = quantum(torque);
    let jumps = |after: usize| {
        let change = if after < torque.len() { (torque[after] - torque[after - 1]).abs() } else { 0.0 };
        change > QUANTA * quantum && motion.passes(after)
    };
    suspects.retain(|run| {
        let is_inside = low < torque[run.start] && torque[run.start] < high;
        is_inside && inner.is_unlikely(run, &motion) && (run.start > 0 && jumps(run.start) || jumps(run.end))
    });
    if inner.are_no_chance(suspects.iter(), &motion) { suspects } else { Vec::new() }
}

/// The stretches in which `position` is stuck while the joint moves.
pub(super) fn position(position: &[f64]) -> Vec<Range<usize>> {
    let mut suspects = equal_runs(position);
    if suspects.is_empty() {
        return suspects;
    }
    let quantum = quantum(position);
    suspects.retain(|run| {
        let (Some(before), Some(after)) = (run.start.checked_sub(2), position.get(run.end)) else { return false };
        let jump = after - position[run.end - 1];
        if jump.abs() <= POSITION_QUANTA * quantum {
            return false;
        }
        let beside = [before..run.start, run.end..(run.end + run.len().max(RUN_MIN)).min(position.len())];
        let mut steps: Vec<f64> =
            beside.iter().flat_map(|part| position[part.clone()].windows(2)).map(|p| p[1] - p[0]).collect();
        let speed = quantile(&mut steps, 0.5);
        let way = speed * run.len() as f64;
        jump * way > 0.0 && jump.abs() > WAY_SHARE * way.abs() && jump.abs() > RUN_MIN as f64 * speed.abs() * WAY_SHARE
    });
    suspects
}

/// The smallest change of `signal`, its last digit or step; infinite where it never changes.
pub(super) fn quantum(signal: &[f64]) -> f64 {
    let changes = signal.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|change| *change > 0.0);
    let mut changes: Vec<f64> = changes.take(LOOKED_AT).collect();
    // A last digit that binary numbers round: not the least, but what one in a thousand is below.
    if changes.is_empty() { f64::INFINITY } else { quantile(&mut changes, 1e-3) }
}
