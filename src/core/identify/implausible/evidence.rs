//! What the data say of gravity, friction and zero: one regression over all moving samples, with the legs' own where there are sweeps.

use super::super::legs::{amplitude, fit_legs, load_of_a_nm};
use super::super::reading::Reading;
use super::super::sums::LegSums;
use super::ZERO_MOST_RAD;
use crate::dynamics::JointKind;
use crate::log::{Campaign, Protocol};
use crate::model::Direction;
use crate::numerics::linear::solve;
use crate::numerics::statistics::{extent, mean, root_mean_square};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Samples used at most.
const SAMPLES: usize = 6000;
/// A speed below this share of the trial's fastest is too slow for its sign to count.
const MOVING: f64 = 0.05;
/// This share of a trial's range of position at either end is left out.
const ENDS: f64 = 0.1;
/// This share of the range is passed after a reversal before a sample counts: friction changes over there.
const REVERSAL: f64 = 0.05;
/// Friction that falls with speed is taken to have fallen at this share of the fastest; without sweeps it looks like load else.
const SLOW: f64 = 0.1;
/// The load must change by this share of itself for gravity to be told from an offset.
const LOAD_CHANGE: f64 = 0.2;

/// The load, as declared or as found, must make this share of the torque.
const LOAD_SHARE: f64 = 0.05;

/// What the data say of gravity, friction and zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Evidence {
    /// Torque that follows the declared load, over what the declared radii make of it: 1 / (1 - mu_c).
    pub gain: f64,
    /// Torque that friction takes, half the difference between up and down, N m; negative where it drives.
    pub friction_nm: f64,
    /// Angle by which the load leads the declared one, rad.
    pub zero_rad: f64,
    /// Root mean square of y, N m.
    pub torque_nm: f64,
    /// Whether the load changes enough along the motion, and is enough of the torque, for `gain` to mean something.
    pub has_load: bool,
}

/// One moving sample: load as seen at the sensor, its derivative, direction, speed, y.
pub(super) type Row = [f64; 5];

/// What the `readings` of `campaign` say; `None` without motion.
pub fn evidence(campaign: &Campaign, readings: &[Reading]) -> Option<Evidence> {
    let rows = rows_of(campaign, readings);
    let legs = legs_of(readings);
    Some(by_legs(campaign, fit(&rows, !legs.is_empty())?, &legs))
}

/// The moving samples of each of `readings`.
pub(super) fn rows_of(campaign: &Campaign, readings: &[Reading]) -> Vec<Vec<Row>> {
    readings.par_iter().map(|reading| moving(campaign, reading)).collect()
}

pub(super) fn legs_of(readings: &[Reading]) -> Vec<&LegSums> {
    readings.iter().flat_map(|reading| &reading.legs).collect()
}

/// `found` with the gain of A over the legs of sweeps, where there are any and the zero is not far off.
pub(super) fn by_legs(campaign: &Campaign, found: Evidence, legs: &[&LegSums]) -> Evidence {
    let scale = campaign.joint.transmission() * load_of_a_nm(campaign);
    let within_rad = if campaign.joint.kind == JointKind::Revolute { ZERO_MOST_RAD } else { 0.0 };
    let (_, fits) = fit_legs(legs, within_rad);
    let both = Direction::BOTH.map(|direction| amplitude(&fits, direction).map(|a| a.a_nm / scale));
    match both {
        [Some(up), Some(down)] if found.zero_rad.abs() < ZERO_MOST_RAD && (up + down).is_finite() => {
            Evidence { gain: (up + down) / 2.0, zero_rad: 0.0, ..found }
        }
        _ => found,
    }
}

/// The moving samples of `reading`, their load and speed through the torque's low-pass: the noise of a second derivative would else look
/// like a load that the torque does not follow.
fn moving(campaign: &Campaign, reading: &Reading) -> Vec<Row> {
    if reading.entry.protocol == Protocol::Interaction {
        return Vec::new();
    }
    let series = &reading.prepared.series;
    let ratio = campaign.joint.transmission();
    let load_nm = series.joint_torque_nm(&campaign.dynamics);
    let all = 0..series.torque_nm.len();
    let load_nm = reading.prepared.low_pass(&all.clone().map(load_nm).collect::<Vec<f64>>());
    let slope_nm_rad = reading.prepared.low_pass(&series.gravity_slope_nm_rad());
    let velocity_rad_s = reading.prepared.low_pass(&reading.speeds_rad_s());
    let fastest = velocity_rad_s.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let (low, high) = extent(&series.position_rad);
    let inner = low + ENDS * (high - low)..high - ENDS * (high - low);
    let passed_rad = since_reversal(&series.position_rad, &velocity_rad_s);
    let is_used = |i: &usize| {
        let is_moving = velocity_rad_s[*i].abs() > MOVING * fastest && passed_rad[*i] > REVERSAL * (high - low);
        is_moving && series.in_range[*i] && inner.contains(&series.position_rad[*i])
    };
    let used: Vec<usize> = all.filter(is_used).collect();
    let step = used.len().div_ceil(SAMPLES).max(1);
    let row = |i: usize| {
        let (load, slope) = (ratio * load_nm[i], ratio * slope_nm_rad[i]);
        [load, slope, velocity_rad_s[i].signum(), velocity_rad_s[i].abs(), series.torque_nm[i]]
    };
    used.into_iter().step_by(step).map(row).collect()
}

/// Travel since the velocity last changed its sign, rad.
fn since_reversal(position_rad: &[f64], velocity_rad_s: &[f64]) -> Vec<f64> {
    let (mut from_rad, mut sign) = (position_rad.first().copied().unwrap_or(0.0), 0.0);
    let passed = position_rad.iter().zip(velocity_rad_s).map(|(position_rad, velocity_rad_s)| {
        if velocity_rad_s.signum() != sign {
            (from_rad, sign) = (*position_rad, velocity_rad_s.signum());
        }
        (position_rad - from_rad).abs()
    });
    passed.collect()
}

/// The regression over the rows of `trials`, which are `of_sweeps` or of motion at all speeds.
pub(super) fn fit(trials: &[Vec<Row>], of_sweeps: bool) -> Option<Evidence> {
    let step = trials.iter().map(Vec::len).sum::<usize>().div_ceil(SAMPLES).max(1);
    let rows: Vec<Row> = trials.iter().flatten().step_by(step).copied().collect();
    if rows.len() < 50 || [1.0, -1.0].iter().any(|sign| rows.iter().all(|row| row[2] != *sign)) {
        return None;
    }
    let column = |at: usize| rows.iter().map(|row| row[at]).collect::<Vec<f64>>();
    let change = |values: &[f64]| {
        let (low, high) = extent(values);
        (high - low) / low.abs().max(high.abs()).max(f64::MIN_POSITIVE)
    };
    let (load, slope) = (column(0), column(1));
    let has_load = change(&load) > LOAD_CHANGE;
    let has_slope = has_load && change(&slope) > LOAD_CHANGE;
    let speed = column(3);
    let has_speeds = change(&speed) > LOAD_CHANGE;
    let mut terms: Vec<Vec<f64>> = vec![column(2), vec![1.0; rows.len()]];
    let signed = |values: &[f64]| values.iter().zip(&rows).map(|(value, row)| value * row[2]).collect::<Vec<f64>>();
    let mut put = |is_there: bool, term: Vec<f64>| {
        is_there.then(|| {
            terms.push(term);
            terms.len() - 1
        })
    };
    let by_speed = put(has_speeds, signed(&speed));
    put(has_speeds, speed.clone());
    // Between the speeds of sweeps friction may be anything; over all speeds it bends.
    let fastest = speed.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let slow: Vec<f64> = speed.iter().map(|speed| (-speed / (SLOW * fastest)).exp()).collect();
    let by_slow = put(has_speeds && !of_sweeps, signed(&slow));
    put(has_speeds && !of_sweeps, slow.clone());
    let by_load = put(has_load, signed(&load));
    let of_load = put(has_load, load.clone());
    let of_slope = put(has_slope, slope);
    let design = DMatrix::from_fn(rows.len(), terms.len(), |i, j| terms[j][i]);
    let y = column(4);
    let found = solve(design, DVector::from_column_slice(&y))?.coefficients;
    let of = |term: Option<usize>| term.map_or(0.0, |at| found[at]);
    let (gain, torque_nm) = (of(of_load), root_mean_square(&y));
    let middle = mean(&load);
    let swing = root_mean_square(&load.iter().map(|load| load - middle).collect::<Vec<f64>>());
    Some(Evidence {
        gain,
        friction_nm: found[0] + of(by_speed) * mean(&speed) + of(by_slow) * mean(&slow) + of(by_load) * mean(&load),
        zero_rad: of(of_slope).atan2(of(of_load)),
        torque_nm,
        has_load: has_load && gain.abs().max(1.0) * swing > LOAD_SHARE * torque_nm,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_that_falls_with_speed_is_no_load() {
        let row = |i: usize| {
            let t = i as f64 / 100.0;
            let q = 0.9 + 0.5 * (0.9 * t).sin() + 0.2 * (2.1 * t + 1.0).sin();
            let v = 0.45 * (0.9 * t).cos() + 0.42 * (2.1 * t + 1.0).cos();
            let slow = (-v.abs() / 0.08).exp();
            [q.sin(), q.cos(), v.signum(), v.abs(), q.sin() + v.signum() * (0.3 + 0.6 * slow) + 0.1 * slow]
        };
        let rows: Vec<Row> = (0..4000).map(row).filter(|row| row[3] > 0.04).collect();
        let found = fit(&[rows], false).unwrap();
        assert!((found.gain - 1.0).abs() < 0.01 && found.zero_rad.abs() < 0.003, "{found:?}");
    }

    #[test]
    fn travel_is_counted_from_each_reversal() {
        let passed = since_reversal(&[0.0, 1.0, 2.0, 1.5, 1.0], &[1.0, 1.0, 1.0, -1.0, -1.0]);
        assert_eq!(passed, [0.0, 1.0, 2.0, 0.0, 0.5]);
    }
}
