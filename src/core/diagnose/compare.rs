//! One fit compared with another by what both leave on held-out units.
//!
//! Samples are strongly correlated, so statistics are taken over clusters: whole trials or cycles.

use super::fit::Fit;
use super::folds::Folds;
use super::policy::Policy;
use crate::numerics::statistics::standard_deviation;

/// Whether `other` does as well as `best` on held-out units, as far as they can tell.
pub fn is_tie(best: &Fit, other: &Fit, start: f64) -> bool {
    let (floor_square, policy) = (best.mask.floor_square(), &best.mask.data.policy);
    let behind = other.score() - best.score();
    if other.prior_penalty > best.prior_penalty + penalty_apart(best, other) {
        return false;
    }
    let uncertain = !leaves_more(best, other, policy.tie_errors);
    behind <= negligible(policy, best.score() - floor_square, start - floor_square, floor_square, spared(best, other))
        || (uncertain && behind <= policy.tie_gap_share_max * (start - floor_square).max(floor_square))
}

/// The excess of `other`'s prior penalty above which it is worse than `best`, squared standard deviations: more for each parameter fewer.
pub fn penalty_apart(best: &Fit, other: &Fit) -> f64 {
    let policy = &best.mask.data.policy;
    policy.prior_penalty_apart + policy.prior_penalty_per_parameter * spared(best, other)
}

/// How many parameters fewer `other` has.
fn spared(best: &Fit, other: &Fit) -> f64 {
    best.moves.len().saturating_sub(other.moves.len()) as f64
}

/// Difference that does not count against a cause, (N m)^2, where the best leaves `left` of a gap of `whole`, squares above a floor of
/// `floor_square`, and the cause has `spared` parameters fewer.
fn negligible(policy: &Policy, left: f64, whole: f64, floor_square: f64, spared: f64) -> f64 {
    let of_gap = policy.tie_gap_share * (1.0 + spared) * whole;
    of_gap.max(policy.tie_remainder_share * left).max(policy.tie_floor_share * floor_square)
}

/// Whether `other` leaves more than `best` on held-out units by more than `errors` standard errors over clusters.
pub fn leaves_more(best: &Fit, other: &Fit, errors: f64) -> bool {
    (other.score() - best.score()) * best.mask.rows() as f64 > errors * error_of_difference(best, other)
}

/// Standard error of the sum by which the squares that `other` leaves on held-out units exceed those of `best`, over clusters.
fn error_of_difference(best: &Fit, other: &Fit) -> f64 {
    let (a, b) = (best.prior_factor(), other.prior_factor());
    let differences = best.held_out.iter().zip(&other.held_out).map(|(x, y)| b * y - a * x);
    error_of_sum(&clusters(&best.mask.data.folds, differences))
}

/// Sums of `of_units` over each cluster.
pub fn clusters(folds: &Folds, of_units: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sums = vec![0.0; folds.cluster.iter().max().map_or(0, |last| last + 1)];
    folds.cluster.iter().zip(of_units).for_each(|(cluster, x)| sums[*cluster] += x);
    sums
}

/// Standard error of the sum of `values`.
pub fn error_of_sum(values: &[f64]) -> f64 {
    let sd = standard_deviation(values);
    if sd.is_finite() { sd * (values.len() as f64).sqrt() } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::{Policy, negligible};

    #[test]
    fn each_number_less_is_worth_a_thousandth_of_the_gap() {
        let policy = &Policy::default();
        let (left, whole, floor_square) = (0.001, 2.0, 0.05);
        assert_eq!(negligible(policy, left, whole, floor_square, 0.0), 0.002);
        assert_eq!(negligible(policy, left, whole, floor_square, 3.0), 0.008);
        // The remainder of the best above the floor is misfit of its formula, and so may the others' be.
        assert_eq!(negligible(policy, 1.0, whole, floor_square, 0.0), 0.05);
    }
}
