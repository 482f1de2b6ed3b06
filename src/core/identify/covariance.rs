//! What is known of a direction's friction parameters together: their covariance to first order.
//!
//! Sources that share nothing: the fit of B(v), whose coefficients and rates become parameters by `Scale`, and the error
//! of A, which moves mu_c (18), through 1 - mu_c every force, and through B = y - A sin(theta) the constant a_j:
//! C = S C_B S' + var(A) a a' + var(z) w w', with S the factors of the former, a the derivatives by A and w those by the
//! position's zero z, which moves A too.

use super::scale::Scale;
use super::stribeck::{ExponentialFit, Points};
use crate::model::Term;
use nalgebra::{DMatrix, DVector};

/// Covariance of the friction parameters of one direction that the fit left free.
#[derive(Debug, Clone, PartialEq)]
pub struct Covariance {
    /// Which.
    pub parameters: Vec<Term>,
    /// Their covariance, each in its own unit.
    pub matrix: DMatrix<f64>,
}

impl Covariance {
    /// Of the parameters that `scale` makes of `fit`. Errors, in words, where it cannot be computed.
    pub(super) fn new(scale: &Scale, fit: &ExponentialFit, points: &Points) -> Result<Self, &'static str> {
        let of_b = points.covariance(fit)?;
        let places = scale.places(fit);
        let free: Vec<usize> = (0..places.len()).filter(|i| !places[*i].held).collect();
        let factors = DMatrix::from_fn(free.len(), fit.parameters(), |i, j| {
            if places[free[i]].in_fit == Some(j) { places[free[i]].factor } else { 0.0 }
        });
        let by_a = DVector::from_fn(free.len(), |i, _| places[free[i]].by_a);
        let by_zero = DVector::from_fn(free.len(), |i, _| places[free[i]].by_zero);
        let variance_of_a = scale.variance_of_a();
        if !variance_of_a.is_finite() {
            return Err("A comes from a single leg: nothing is known of its error");
        }
        let matrix = &factors * of_b * factors.transpose()
            + &by_a * by_a.transpose() * variance_of_a
            + &by_zero * by_zero.transpose() * scale.variance_of_zero();
        Ok(Self { parameters: free.iter().map(|i| places[*i].term).collect(), matrix })
    }

    /// Correlation of the parameters at `i` and `j`, -1 to 1; NaN where one has no variance.
    pub fn correlation(&self, i: usize, j: usize) -> f64 {
        self.matrix[(i, j)] / (self.matrix[(i, i)] * self.matrix[(j, j)]).sqrt()
    }

    /// The `number` pairs that are correlated most, either way: where a change of one is made up for by the other.
    pub fn strongest(&self, number: usize) -> Vec<(Term, Term, f64)> {
        let n = self.parameters.len();
        let pairs = (0..n).flat_map(|i| (i + 1..n).map(move |j| (i, j)));
        let mut pairs: Vec<(Term, Term, f64)> =
            pairs.map(|(i, j)| (self.parameters[i], self.parameters[j], self.correlation(i, j))).collect();
        pairs.retain(|pair| pair.2.is_finite());
        pairs.sort_by(|a, b| b.2.abs().total_cmp(&a.2.abs()));
        pairs.truncate(number);
        pairs
    }
}
