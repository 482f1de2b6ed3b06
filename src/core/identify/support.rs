//! Which of several candidates the data support: more parameters must earn their place.

use crate::numerics::statistics::{mean, standard_deviation};

/// By how much `sums` (sums of squares over the same stretches of data as `others`) are larger on average, and the standard
/// error of that over the stretches; NaN of a single stretch.
pub fn excess(sums: &[f64], others: &[f64]) -> (f64, f64) {
    let excess: Vec<f64> = sums.iter().zip(others).map(|(a, b)| a - b).collect();
    (mean(&excess), standard_deviation(&excess) / (excess.len() as f64).sqrt())
}

/// A reduction of the squares by less than this share counts as none: it only shows some curvature, as with a change-over curve for a
/// clearance that the motion hardly shows.
const IMMATERIAL: f64 = 1e-3;

/// The best of `candidates`, each given by its sums of squares, the simplest first; or the simplest of those that
/// `may_stand_in` for it and are no worse by more than one standard error, or by next to nothing.
pub fn supported(candidates: &[Vec<f64>], may_stand_in: impl Fn(usize) -> bool) -> usize {
    let total = |i: &usize| candidates[*i].iter().sum::<f64>();
    let best = (0..candidates.len()).min_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or(0);
    let as_good = |i: &usize| {
        let (excess, error) = excess(&candidates[*i], &candidates[best]);
        may_stand_in(*i) && excess <= error.max(IMMATERIAL * mean(&candidates[best]))
    };
    (0..best).find(as_good).unwrap_or(best)
}
