//! A reading that stays while the joint moves, inside the sensor's range: a frozen channel, or the last value held where a
//! frame was lost.
//!
//! Torque: with p the share of equal neighbours in the log, a run of m equal readings among n samples is expected n p^(m-1)
//! times. A coarse sensor reads the same for long, too, but then goes on by one step; a stuck one jumps on release to where
//! the torque has got meanwhile. Position: the reading stays and then jumps by what the joint travelled, many steps of
//! the encoder at once.

use super::clipped::Motion;
use crate::numerics::statistics::quantile;
use std::ops::Range;

/// Equal readings in a row, from which on a run is looked at.
const RUN_MIN: usize = 5;
/// Runs this unlikely, as an expected number in the whole log, are no chance.
const CHANCE_MAX: f64 = 1e-6;
/// A release or an onset by more than this many steps of the sensor is no step of a coarse one.
const QUANTA: f64 = 2.5;
/// The position jumps on release by more than this many of its steps ...
const POSITION_QUANTA: f64 = 5.0;
/// ... and by this share of the way that it goes in as many samples afterwards.
const WAY_SHARE: f64 = 0.5;
/// Changes looked at for the smallest step of a sensor.
const LOOKED_AT: usize = 2_000;

/// The stretches in which `torque` is stuck while `position` moves.
pub(super) fn torque(position: &[f64], torque: &[f64], rate_hz: f64) -> Vec<Range<usize>> {
    let (mut suspects, equal) = runs(torque, RUN_MIN);
    let equal_share = equal as f64 / torque.len() as f64;
    suspects.retain(|run| torque.len() as f64 * equal_share.powi(run.len() as i32 - 1) < CHANCE_MAX);
    if suspects.is_empty() {
        return suspects;
    }
    let quantum = quantum(torque);
    let jump = |a: usize, b: Option<usize>| b.map_or(0.0, |b| (torque[a] - torque[b]).abs());
    let motion = Motion::of(position, rate_hz);
    suspects.retain(|run| {
        let onset = jump(run.start, run.start.checked_sub(1));
        let release = jump(run.end - 1, (run.end < torque.len()).then_some(run.end));
        onset.max(release) > QUANTA * quantum && motion.moves_through(run)
    });
    suspects
}

/// The stretches in which `position` is stuck while the joint moves.
pub(super) fn position(position: &[f64]) -> Vec<Range<usize>> {
    let (mut suspects, _) = runs(position, RUN_MIN);
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

/// Runs of equal readings, from `shortest` on, and how many readings equal the one before.
fn runs(signal: &[f64], shortest: usize) -> (Vec<Range<usize>>, usize) {
    let (mut found, mut equal, mut start) = (Vec::new(), 0, 0);
    for (i, pair) in signal.windows(2).enumerate() {
        if pair[0] == pair[1] {
            equal += 1;
        } else {
            if i + 1 - start >= shortest {
                found.push(start..i + 1);
            }
            start = i + 1;
        }
    }
    if signal.len() - start >= shortest {
        found.push(start..signal.len());
    }
    (found, equal)
}

/// The smallest change of `signal`, its last digit or step; infinite where it never changes.
pub(super) fn quantum(signal: &[f64]) -> f64 {
    let changes = signal.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|change| *change > 0.0);
    let mut changes: Vec<f64> = changes.take(LOOKED_AT).collect();
    // A last digit that binary numbers round: not the least, but what one in a thousand is below.
    if changes.is_empty() { f64::INFINITY } else { quantile(&mut changes, 1e-3) }
}
