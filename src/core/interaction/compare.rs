//! The extracted torque against one measured independently, both through the same low-pass.

use super::contacts::{Contact, contacts};
use super::extract::Extracted;
use super::quiet::Levels;
use crate::evaluate::Figures;
use crate::numerics::statistics::mean;

/// The delay is looked for up to this, s.
const DELAY_S: f64 = 0.5;
/// Samples a second at which it is looked for; a parabola through the best three finds it between samples.
const DELAY_RATE_HZ: f64 = 100.0;

/// Figures of agreement.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// RMSE, MAE, largest error, and their percent of the reference's range.
    pub error: Figures,
    /// Difference of the peaks, averaged over contacts that both show, N m; NaN without any. The paper's peak error.
    pub peak_error_nm: f64,
    /// How late the extracted torque is, by the peak of the correlation, s; NaN where the reference never moves.
    pub delay_s: f64,
    /// How late its onsets are, averaged over contacts that both show, s; NaN without any.
    pub onset_delay_s: f64,
    /// Extracted torque per reference, by least squares; 1 where both measure the same.
    pub slope: f64,
    /// Contacts of the reference.
    pub contacts: usize,
    /// Those of them that the extracted torque does not show.
    pub missed: usize,
    /// Contacts that only the extracted torque shows.
    pub spurious: usize,
}

impl Comparison {
    /// Of `trial`, if it has a reference.
    pub fn new(trial: &Extracted, levels: &Levels, lowpass_hz: f64) -> Option<Self> {
        let reference_nm = trial.reference_nm.as_ref()?;
        let used: Vec<usize> = (0..reference_nm.len()).filter(|at| trial.known[*at]).collect();
        let span = used.iter().map(|at| reference_nm[*at]);
        let (low, high) = span.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), r| (l.min(r), h.max(r)));
        let error = Figures::of(used.iter().map(|at| trial.torque_nm[*at] - reference_nm[*at]), high - low);
        let (product, square) = used.iter().fold((0.0, 0.0), |(product, square), at| {
            (product + trial.torque_nm[*at] * reference_nm[*at], square + reference_nm[*at] * reference_nm[*at])
        });
        let found = contacts(trial, &trial.torque_nm, levels, lowpass_hz);
        let real = contacts(trial, reference_nm, levels, lowpass_hz);
        let pairs: Vec<(&Contact, &Contact)> =
            real.iter().filter_map(|r| Some((r, found.iter().find(|f| overlap(r, f))?))).collect();
        let over_pairs =
            |of: fn(&Contact, &Contact) -> f64| mean(&pairs.iter().map(|(r, f)| of(r, f)).collect::<Vec<f64>>());
        Some(Self {
            error,
            peak_error_nm: over_pairs(|r, f| (r.peak_nm.abs() - f.peak_nm.abs()).abs()),
            delay_s: delay_s(trial, reference_nm),
            onset_delay_s: over_pairs(|r, f| f.onset_s - r.onset_s),
            slope: product / square,
            contacts: real.len(),
            missed: real.len() - pairs.len(),
            spurious: found.iter().filter(|f| !real.iter().any(|r| overlap(r, f))).count(),
        })
    }
}

fn overlap(a: &Contact, b: &Contact) -> bool {
    a.onset_s <= b.release_s && b.onset_s <= a.release_s
}

/// The lag at which the two correlate best.
fn delay_s(trial: &Extracted, reference_nm: &[f64]) -> f64 {
    let step = ((trial.rate_hz / DELAY_RATE_HZ) as usize).max(1);
    let rate_hz = trial.rate_hz / step as f64;
    let at: Vec<usize> = (0..reference_nm.len()).step_by(step).collect();
    let known: Vec<f64> = at.iter().map(|i| if trial.known[*i] { trial.torque_nm[*i] } else { 0.0 }).collect();
    let reference: Vec<f64> = at.iter().map(|i| if trial.known[*i] { reference_nm[*i] } else { 0.0 }).collect();
    let reach = ((DELAY_S * rate_hz) as i64).min(known.len() as i64 - 1);
    let correlation = |lag: i64| -> f64 {
        let pairs = (0..known.len() as i64).filter_map(|i| {
            let other = usize::try_from(i - lag).ok()?;
            Some(known[usize::try_from(i).ok()?] * reference.get(other)?)
        });
        pairs.sum()
    };
    let lags: Vec<f64> = (-reach..=reach).map(correlation).collect();
    let Some(best) = (0..lags.len()).max_by(|a, b| lags[*a].total_cmp(&lags[*b])) else { return f64::NAN };
    if lags[best] <= 0.0 || best == 0 || best + 1 == lags.len() {
        return f64::NAN;
    }
    let (before, top, after) = (lags[best - 1], lags[best], lags[best + 1]);
    let curvature = before - 2.0 * top + after;
    let between = if curvature < 0.0 { 0.5 * (before - after) / curvature } else { 0.0 };
    (best as f64 - reach as f64 + between) / rate_hz
}
