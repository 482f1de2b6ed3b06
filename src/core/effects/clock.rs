//! Laws of time.

use super::Sample;
use crate::numerics::scalar::Scalar;
use crate::numerics::statistics::{mean, standard_deviation};

/// Times at which a law is looked at: each crest of a drift's waves is met within 1 %.
const SCANNED: usize = 64;
/// What varies by less than this share of its mean is constant.
const VARIES: f64 = 0.1;

/// `time_s` or `elapsed_s` of `sample`: a clock that starts anew with each trial, or runs through the campaign.
pub(super) fn clock_s<S: Scalar>(restarts: f64, sample: &Sample<'_, S>) -> S {
    if restarts > 0.5 { sample.time_s } else { sample.elapsed_s }
}

/// `law` at even times up to `horizon_s`.
pub(super) fn scanned(law: impl Fn(f64) -> f64, horizon_s: f64) -> Vec<f64> {
    (0..=SCANNED).map(|i| law(horizon_s * i as f64 / SCANNED as f64)).collect()
}

/// Whether `law` varies up to `horizon_s`, rather than being a constant by another name.
pub(super) fn varies(law: impl Fn(f64) -> f64, horizon_s: f64) -> bool {
    let values = scanned(law, horizon_s);
    standard_deviation(&values) >= VARIES * mean(&values).abs()
}
