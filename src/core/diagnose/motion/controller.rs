//! A position difference as what a torque difference does to a position controller.
//!
//! K dq + D d(dq)/dt = -dtau gives, for motions slower than the controller, dq = a dtau + b d(dtau)/dt with a = -1/K and
//! b = D/K^2, K and D as the winch sees them; c is left for encoders that count from different zeros.

use super::MotionTrial;
use crate::diagnose::{Cause, Diagnosis};
use crate::log::Campaign;
use crate::numerics::difference::velocity;
use crate::numerics::filter::LowPass;
use crate::numerics::linear;
use crate::numerics::resample::between;
use nalgebra::{DMatrix, DVector};

/// Fewer samples are not fitted.
const SAMPLES_MIN: usize = 20;

/// How far a position difference follows a torque difference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Follows {
    /// Share of its square, scored on the held-out half; at most 1, negative where it does not follow at all.
    pub share: f64,
    /// a: position per torque, rad/(N m).
    pub rad_per_nm: f64,
    /// b: position per rate of torque, rad s/(N m).
    pub rad_s_per_nm: f64,
    /// c: a difference that is there without any torque, rad.
    pub offset_rad: f64,
}

/// One sample: what is explained, what explains it, and the rate of that.
type Row = [f64; 3];

/// What the causes that `real` names add to the model's torque along `trial`, N m; not a number where nothing is known of it. Where contact
/// is among them, the model's residual within its stretches counts as theirs.
pub(super) fn of_causes_nm(real: &Diagnosis, trial: &MotionTrial) -> Vec<f64> {
    let unknown = vec![f64::NAN; trial.time_s.len()];
    let Some(view) = real.views.iter().find(|view| view.file == trial.file) else { return unknown };
    let &[first_s, next_s, ..] = &view.time_s[..] else { return unknown };
    let last_s = view.time_s[view.time_s.len() - 1];
    let is_contact = real.verdict.effects.contains(&Cause::CONTACT);
    let in_contact = |t: f64| {
        let mut contacts = real.contacts.iter().filter(|contact| contact.file == view.file);
        is_contact && contacts.any(|contact| (contact.from_s..=contact.to_s).contains(&t))
    };
    let added = |(i, t): (usize, &f64)| {
        let with = if in_contact(*t) { view.measured_nm[i] } else { view.after_nm[i] };
        with - view.before_nm[i]
    };
    let added_nm: Vec<f64> = view.time_s.iter().enumerate().map(added).collect();
    let at = |t: f64| match (first_s..=last_s).contains(&t) {
        true => between(&added_nm, (t - first_s) / (next_s - first_s)),
        false => f64::NAN,
    };
    trial.time_s.iter().map(|t| at(t + trial.shifted_s)).collect()
}

/// How far the position differences of `trials` follow the torque `of` each; nothing where that never changes.
pub(super) fn follows(
    trials: &[MotionTrial],
    of: impl Fn(&MotionTrial) -> Vec<f64>,
    campaign: &Campaign,
) -> Option<Follows> {
    let signal = &campaign.signal;
    let of_trial = |trial: &MotionTrial| {
        rows(trial, &of(trial), LowPass::new(signal.lowpass_order, signal.lowpass_hz, trial.rate_hz).as_ref())
    };
    let all: Vec<Vec<Row>> = trials.iter().map(of_trial).collect();
    let halves = match &all[..] {
        [only] => [&only[..only.len() / 2], &only[only.len() / 2..]].map(<[Row]>::to_vec),
        many => [0, 1].map(|half| many.iter().skip(half).step_by(2).flatten().copied().collect()),
    };
    let (mut left, mut whole) = (0.0, 0.0);
    for (seen, held_out) in [(0, 1), (1, 0)] {
        let [a, b, _] = fit(&halves[seen])?;
        left += halves[held_out].iter().map(|[dq, x, rate]| (dq - a * x - b * rate).powi(2)).sum::<f64>();
        whole += halves[held_out].iter().map(|[dq, ..]| dq * dq).sum::<f64>();
    }
    let [a, b, c] = fit(&halves.concat())?;
    let share = 1.0 - left / whole.max(f64::MIN_POSITIVE);
    Some(Follows { share, rad_per_nm: a, rad_s_per_nm: b, offset_rad: c })
}

/// Mean square of the torque difference of `trial` that is not the controller's answer to the position difference, (N m)^2:
/// K dq + D d(dq)/dt = -dtau as it stands, for positions are known better than torques.
pub(super) fn left_square(trial: &MotionTrial, lowpass: Option<&LowPass>) -> f64 {
    let apart_rad = low_passed(trial.position_difference_rad(), lowpass);
    let rate = velocity(&apart_rad, trial.rate_hz);
    let row = |(i, y): (usize, f64)| [y, apart_rad[i], rate[i]];
    let rows: Vec<Row> = trial.torque_difference_nm().into_iter().enumerate().map(row).collect();
    let [k, d, c] = fit(&rows).unwrap_or_default();
    rows.iter().map(|[y, dq, rate]| (y - k * dq - d * rate - c).powi(2)).sum::<f64>() / rows.len().max(1) as f64
}

/// The samples of `trial` at which `torque_nm` is known, its position low-passed as the torque is.
fn rows(trial: &MotionTrial, torque_nm: &[f64], lowpass: Option<&LowPass>) -> Vec<Row> {
    let apart_rad = low_passed(trial.position_difference_rad(), lowpass);
    let rate = velocity(torque_nm, trial.rate_hz);
    let row = |i: usize| [apart_rad[i], torque_nm[i], rate[i]];
    (0..apart_rad.len()).map(row).filter(|row| row.iter().all(|x| x.is_finite())).collect()
}

fn low_passed(values: Vec<f64>, lowpass: Option<&LowPass>) -> Vec<f64> {
    lowpass.map_or_else(|| values.clone(), |lowpass| lowpass.zero_phase(&values))
}

/// a, b and c of y = a x + b z + c by least squares; without c where an x that never changes leaves no room for it.
fn fit(rows: &[Row]) -> Option<[f64; 3]> {
    if rows.len() < SAMPLES_MIN {
        return None;
    }
    let y = DVector::from_iterator(rows.len(), rows.iter().map(|row| row[0]));
    let column = |row: &Row, at: usize| if at == 2 { 1.0 } else { row[at + 1] };
    let solved = |columns: usize| {
        let design = DMatrix::from_fn(rows.len(), columns, |i, at| column(&rows[i], at));
        linear::solve(design, y.clone()).map(|fit| fit.coefficients)
    };
    let x = solved(3).or_else(|| solved(2)).or_else(|| solved(1))?;
    Some([0, 1, 2].map(|at| x.get(at).copied().unwrap_or(0.0)))
}
