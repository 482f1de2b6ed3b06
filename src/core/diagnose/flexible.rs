//! The ceiling: what a fit without any physics recovers of a gap from the recorded quantities alone.
//!
//! Sums of broken lines over position, speed, travel since a reversal, time, load and other joints, each alone and with the sign of the
//! motion, low-passed like the torque. Its residual on held-out units depends on no recorded quantity, or on too many of them at once.

use super::base::BaseModel;
use super::data::DataSet;
use super::gram::Gram;
use super::mask::Mask;
use super::record::Record;
use crate::numerics::statistics::{extent, root_mean_square};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Corners of the broken lines over position, time, and the others.
const CORNERS: usize = 9;
const CORNERS_FEW: usize = 6;
/// Travels since a reversal, as shares of the range, over which something may have decayed.
const TRAVELS: [f64; 4] = [0.005, 0.02, 0.06, 0.15];
/// Other joints considered.
const OTHERS: usize = 3;
/// A column may account for at most this multiple of the residual to be explained.
const WIDE: f64 = 3.0;

/// What depends on recorded quantities.
#[derive(Debug, Clone)]
pub struct Flexible {
    /// Mean square left on held-out units, (N m)^2.
    pub held_out: f64,
    /// Mean square of what it was fitted to, on the rows that it was fitted on, (N m)^2.
    pub of: f64,
    /// What it leaves at every row, N m.
    pub residual_nm: Vec<f64>,
}

/// What a row's features are made of.
struct State {
    /// -1 to 1, with the motion.
    sign: f64,
    position: f64,
    velocity: f64,
    acceleration: f64,
    /// Rad since the last reversal.
    travel: f64,
    time_s: f64,
    elapsed_s: f64,
    /// What gravity, inertia and a measured load ask of the joint, N m.
    load: f64,
}

/// Columns of the flexible fit at all rows, low-passed.
pub fn columns(base: &BaseModel<'_>, lines: &[f64]) -> Vec<Vec<f64>> {
    let states = states(base);
    let at = |of: &dyn Fn(&State) -> f64| extent(&states.iter().flatten().map(of).collect::<Vec<f64>>());
    let (low, high) = at(&|s| s.position);
    let range = high - low;
    let speed = base.data().extent.speed_rad_s;
    let log_speed = |s: &State| (s.velocity.abs().max(speed.0)).ln();
    let speeds = (speed.0.ln(), speed.1.ln());
    type Feature<'f> = Box<dyn Fn(&State) -> f64 + Send + Sync + 'f>;
    let mut features: Vec<Feature<'_>> = Vec::new();
    let mut both = |f: Feature<'static>| {
        let f = std::sync::Arc::new(f);
        let g = f.clone();
        features.push(Box::new(move |s| f(s)));
        features.push(Box::new(move |s| s.sign * g(s)));
    };
    for k in 0..CORNERS {
        both(Box::new(move |s| hat(s.position, (low, high), k, CORNERS)));
    }
    let load = |record: &Record, i: usize| record.load_nm(i, &base.model);
    let loads = extent(&base.data().records.rows(load));
    for k in 0..CORNERS_FEW {
        both(Box::new(move |s| hat(s.load, loads, k, CORNERS_FEW)));
    }
    for travel in TRAVELS {
        both(Box::new(move |s| (-s.travel / (travel * range)).exp()));
    }
    let (trial_s, campaign_s) = (base.data().extent.trial_s, base.data().extent.campaign_s);
    for k in 1..CORNERS_FEW {
        both(Box::new(move |s| hat(s.time_s, (0.0, trial_s), k, CORNERS_FEW)));
        both(Box::new(move |s| hat(s.elapsed_s, (0.0, campaign_s), k, CORNERS_FEW)));
        both(Box::new(move |s| s.velocity * hat(s.position, (low, high), k, CORNERS_FEW)));
    }
    both(Box::new(|s| s.acceleration));
    both(Box::new(|s| s.velocity * s.velocity));
    for k in 1..CORNERS_FEW {
        features.push(Box::new(move |s| s.sign * hat(log_speed(s), speeds, k, CORNERS_FEW)));
    }
    for periods in lines {
        for harmonic in [1.0, 2.0] {
            let angle = move |s: &State| TAU * harmonic * periods * s.position;
            features.push(Box::new(move |s| angle(s).sin()));
            features.push(Box::new(move |s| angle(s).cos()));
            features.push(Box::new(move |s| s.sign * angle(s).sin()));
            features.push(Box::new(move |s| s.sign * angle(s).cos()));
        }
    }
    let column = |feature: &Feature<'_>| base.data().records.low_passed(|at, _, i| feature(&states[at][i]));
    let mut columns: Vec<Vec<f64>> = features.par_iter().map(column).collect();
    columns.extend(of_others(base.data()));
    columns.extend(of_torque(base));
    columns
}

/// Other joints: position, speed, acceleration, direction.
fn of_others(data: &DataSet) -> Vec<Vec<f64>> {
    let joint = |joint: usize| {
        let reach = |of: &dyn Fn(crate::dynamics::Motion) -> f64| {
            extent(&data.records.rows(|record, i| record.other(joint, i)).into_iter().map(of).collect::<Vec<f64>>())
        };
        let span = reach(&|m| m.position);
        let soft = 0.1 * reach(&|m| m.velocity).1.max(1e-9);
        let hats = (1..CORNERS_FEW)
            .map(|k| data.records.low_passed(move |_, r, i| hat(r.other(joint, i).position, span, k, CORNERS_FEW)));
        let mut columns: Vec<Vec<f64>> = hats.collect();
        columns.push(data.records.low_passed(|_, r, i| r.other(joint, i).velocity));
        columns.push(data.records.low_passed(|_, r, i| (r.other(joint, i).velocity / soft).tanh()));
        columns.push(data.records.low_passed(|_, r, i| r.other(joint, i).acceleration));
        columns.push(data.records.low_passed(|_, r, i| r.other(joint, i).acceleration * r.own[i].position.cos()));
        columns.push(data.records.low_passed(|_, r, i| r.other(joint, i).position * r.own[i].position));
        columns
    };
    (0..data.extent.others.min(OTHERS)).flat_map(joint).collect()
}

/// The predicted torque itself, its slope in time, and its ends.
fn of_torque(base: &BaseModel<'_>) -> Vec<Vec<f64>> {
    let predicted_nm = &base.predicted_nm;
    let span = extent(predicted_nm);
    let slope = |i: usize| match (i.checked_sub(1), predicted_nm.get(i + 1)) {
        (Some(before), Some(after)) => after - predicted_nm[before],
        _ => 0.0,
    };
    let hats = (0..CORNERS_FEW).map(|k| predicted_nm.iter().map(|y| hat(*y, span, k, CORNERS_FEW)).collect());
    hats.chain([(0..base.data().measured_nm.len()).map(slope).collect()]).collect()
}

/// The states of every record's thinned samples.
fn states(base: &BaseModel<'_>) -> Vec<Vec<State>> {
    let of = |(record, k_tilde): (&super::record::Record, &Vec<f64>)| {
        let travel = record.travel_rad();
        (0..record.own.len())
            .map(|i| State {
                sign: 2.0 * k_tilde[i] - 1.0,
                position: record.own[i].position,
                velocity: record.own[i].velocity,
                acceleration: record.own[i].acceleration,
                travel: travel[i],
                time_s: record.time_s[i],
                elapsed_s: record.elapsed_s(i),
                load: record.load_nm(i, &base.model),
            })
            .collect()
    };
    base.data().records.all.iter().zip(&base.passages).map(of).collect()
}

/// The `k`th of `count` tents that stand side by side over a range: 1 at its own corner, 0 at the next ones.
fn hat(x: f64, (low, high): (f64, f64), k: usize, count: usize) -> f64 {
    let at = if high > low { (x - low) / (high - low) * (count - 1) as f64 } else { 0.0 };
    (1.0 - (at - k as f64).abs()).max(0.0)
}

/// Holds what is predicted at rows that did not count to the range of it at those that did: beyond the states that it was fitted in a fit
/// may say anything.
fn hold_within(predicted_nm: &mut [f64], counts: impl Fn(usize) -> bool) {
    let counted: Vec<f64> = (0..predicted_nm.len()).filter(|row| counts(*row)).map(|row| predicted_nm[row]).collect();
    let (low_nm, high_nm) = if counted.is_empty() { (0.0, 0.0) } else { extent(&counted) };
    predicted_nm.iter_mut().for_each(|nm| *nm = nm.max(low_nm).min(high_nm));
}

/// Fits `columns` to `target_nm` over the rows that count.
pub fn fit(mask: &Mask<'_>, columns: &[Vec<f64>], target_nm: &[f64]) -> Flexible {
    let size = root_mean_square(target_nm);
    let counted = |values: &[f64]| mask.apply(values.iter().copied());
    let masked: Vec<Vec<f64>> = columns.par_iter().map(|column| counted(column)).collect();
    let all: Vec<&[f64]> = masked.iter().map(Vec::as_slice).collect();
    let deviations: Vec<f64> =
        columns.iter().map(|column| WIDE * size / root_mean_square(column).max(f64::MIN_POSITIVE)).collect();
    let (prior, folds) = (mask.prior(&deviations), &mask.data.folds);
    let gram = Gram::new(folds, &all, &counted(target_nm));
    let x = gram.solve(prior).x;
    let mut predicted_nm = vec![0.0; target_nm.len()];
    for (column, x) in columns.iter().zip(x.iter()) {
        predicted_nm.iter_mut().zip(column).for_each(|(p, c)| *p += x * c);
    }
    hold_within(&mut predicted_nm, |row| mask.counts(row));
    let residual_nm = target_nm.iter().zip(predicted_nm).map(|(y, p)| y - p).collect();
    let mean = |squares: f64| squares / mask.rows().max(1) as f64;
    let held_out = mean(gram.held_out(folds, prior).iter().sum());
    Flexible { held_out, of: mean(counted(target_nm).iter().map(|y| y * y).sum()), residual_nm }
}

#[cfg(test)]
mod tests {
    use super::hold_within;

    #[test]
    fn a_fit_predicts_no_more_where_it_was_not_fitted() {
        let held = |counts: &dyn Fn(usize) -> bool| {
            let mut predicted_nm = vec![-1.0, 0.5, 9.0, 2.0, -7.0];
            hold_within(&mut predicted_nm, counts);
            predicted_nm
        };
        assert_eq!(held(&|row| ![2, 4].contains(&row)), [-1.0, 0.5, 2.0, 2.0, -1.0]);
        assert_eq!(held(&|_| true), [-1.0, 0.5, 9.0, 2.0, -7.0]);
        assert_eq!(held(&|_| false), [0.0; 5]);
    }
}
