//! A recorded velocity against the recorded position.
//!
//! Over any stretch the integral of the velocity is the way of the position. The log is cut wherever the position has moved
//! on by a share of its range, so that neither rest nor the steps of an encoder count, and the one is regressed on the other:
//! the slope is 1, or the velocity has another unit, another sign, or no life.

use super::Log;
use super::columns::Wanted;
use crate::dynamics::JointKind;
use crate::problem::Problem;
use crate::units::{Quantity, Unit};
use std::ops::RangeInclusive;

/// The log is cut where the position moved on by this share of its range.
const CUT_TRAVEL: f64 = 0.02;
/// The joint moves if the range of its position is this many times the common step from sample to sample; noise at rest,
/// and an encoder that wavers between two counts, stay far below.
const MOVING_STEPS: f64 = 20.0;
/// Slopes that a poor differentiation, a delay or a slipping tachometer may leave.
const SLOPES: RangeInclusive<f64> = 0.8..=1.25;
/// A slope this near another unit's tells that unit.
const UNIT_TOLERANCE: f64 = 0.1;

/// What is wrong with the velocity of `log`, if it has one and the joint moves.
pub(super) fn check(log: &Log, wanted: &[Wanted], kind: JointKind) -> Option<Problem> {
    let velocity = log.velocity_rad_s.as_ref()?;
    let want = wanted.iter().find(|want| want.quantity == Quantity::Velocity)?;
    let slope = slope(&log.position_rad, velocity, log.rate_hz).filter(|slope| !SLOPES.contains(slope))?;
    let what = format!(
        "is {} times the change of the position with time, where 1 was expected",
        if slope.abs() < 1e-3 { "0".to_string() } else { format!("{slope:.3}") }
    );
    Some(Problem::error(&log.file, what, cure(slope, want, kind)).in_column(&want.column.name))
}

/// Slope of the integrated velocity over the way of the position; `None` at rest.
fn slope(position_rad: &[f64], velocity_rad_s: &[f64], rate_hz: f64) -> Option<f64> {
    let (low, high) = position_rad.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
    let mut steps: Vec<f64> = position_rad.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    steps.retain(|step| *step > 0.0);
    if steps.is_empty() {
        return None;
    }
    let middle = steps.len() / 2;
    let common_rad = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    if high - low < MOVING_STEPS * common_rad {
        return None;
    }
    let (mut from_rad, mut integral_rad) = (position_rad[0], 0.0);
    let (mut square, mut product) = (0.0, 0.0);
    for (positions, velocities) in position_rad.windows(2).zip(velocity_rad_s.windows(2)) {
        integral_rad += (velocities[0] + velocities[1]) / (2.0 * rate_hz);
        let way_rad = positions[1] - from_rad;
        if way_rad.abs() >= CUT_TRAVEL * (high - low) {
            square += way_rad * way_rad;
            product += way_rad * integral_rad;
            (from_rad, integral_rad) = (positions[1], 0.0);
        }
    }
    Some(product / square).filter(|slope| slope.is_finite())
}

fn cure(slope: f64, want: &Wanted, kind: JointKind) -> String {
    let (key, unit) = (&want.key, want.column.unit);
    let is_unit = |other: &&Unit| {
        let expected = unit.factor() / other.factor();
        (slope.abs() / expected - 1.0).abs() < UNIT_TOLERANCE
    };
    let units = want.quantity.units(kind);
    let delete = format!("delete columns.{key} from campaign.toml: speed then comes from the position");
    match units.iter().find(is_unit).filter(|other| **other != unit) {
        Some(other) if slope > 0.0 => {
            format!("correct its unit in campaign.toml (now `{}`) to `{}`, or {delete}", unit.name(), other.name())
        }
        _ if (-1.25..=-0.8).contains(&slope) => format!("turn its sign in the log, or {delete}"),
        _ => format!("correct its unit in campaign.toml (now `{}`) if that is wrong, or {delete}", unit.name()),
    }
}
