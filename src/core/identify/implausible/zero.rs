//! A load that leads or lags the declared one: the position's zero.

use super::super::sums::LegSums;
use super::super::zero::Zero;
use super::evidence::{Row, fit};
use super::{Cause, Doubt, Evidence, ZERO_MOST_RAD};
use crate::dynamics::JointKind;
use crate::log::Campaign;
use crate::numerics::statistics::quantile;
use std::slice;

/// A zero that is off by more than this, beyond its own scatter, is reported, rad: 3 deg.
const ZERO_RAD: f64 = 0.052;
/// The same without sweeps, where friction that changes with speed looks alike, rad: 6 deg.
const ZERO_OF_FREE_RAD: f64 = 0.105;
/// Standard errors of the mean over trials that a zero must be clear by.
const ZERO_ERRORS: f64 = 3.0;
/// Trials whose scatter says how well the zero is known.
const ZERO_TRIALS: usize = 3;

/// A load that leads or lags the declared one.
pub(super) fn zero(campaign: &Campaign, found: &Evidence, rows: &[Vec<Row>], legs: &[&LegSums]) -> Option<Doubt> {
    if campaign.joint.kind != JointKind::Revolute || campaign.dynamics.gravity_nm == 0.0 {
        return None;
    }
    let of_legs = Zero::estimate(legs, ZERO_MOST_RAD);
    let is_off = match of_legs.is_fitted() && found.zero_rad.abs() < ZERO_MOST_RAD {
        true => of_legs.rad.abs() - of_legs.half_width_rad > ZERO_RAD,
        false => is_off_in_all(found.zero_rad, rows),
    };
    if !is_off {
        return None;
    }
    let zero_rad =
        if of_legs.is_fitted() && found.zero_rad.abs() < ZERO_MOST_RAD { of_legs.rad } else { found.zero_rad };
    let degrees = zero_rad.to_degrees();
    Some(Doubt {
        causes: vec![Cause::Zero],
        what: format!(
            "gravity's torque is 0 at a reading of {:.1} deg, not at 0: the position's zero looks off",
            -degrees
        ),
        cure: format!(
            "add {degrees:.1} deg to the position (its column's `offset`), unless another load (a spring, a centre of mass off the line) does this"
        ),
    })
}

/// Whether the trials agree on a zero that is off like `zero_rad`.
fn is_off_in_all(zero_rad: f64, rows: &[Vec<Row>]) -> bool {
    let each: Vec<f64> = rows.iter().filter_map(|rows| Some(fit(slice::from_ref(rows), false)?.zero_rad)).collect();
    if each.len() < ZERO_TRIALS {
        return false;
    }
    let middle = quantile(&mut each.clone(), 0.5);
    let mut apart: Vec<f64> = each.iter().map(|zero| (zero - middle).abs()).collect();
    // The median of the distances times 1.48 is a normal scatter's standard deviation.
    let error = 1.48 * quantile(&mut apart, 0.5) / (each.len() as f64).sqrt();
    let size = middle.abs().min(zero_rad.abs());
    size - ZERO_ERRORS * error > ZERO_OF_FREE_RAD && middle.signum() == zero_rad.signum()
}
