//! Least squares on sums of products: once the products of all columns are summed unit by unit, fitting on any choice of units
//! and judging on the others is a matter of small matrices.

use super::folds::{FOLDS, Folds};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// [`Prior::ridge`] of a fit: bounds the coefficients of dependent columns, without a visible effect on any other.
pub const RIDGE: f64 = 1e-7;
/// Rounds in which the noise and the weight of the priors settle.
const ROUNDS: usize = 3;
/// Priors also act as limits: the sum of squares of the moves stays within its expectation plus this many standard deviations. Otherwise a
/// gap with enough samples would draw the base beyond its confidence.
const SURPRISE_ERRORS: f64 = 3.0;
/// ... and each move within this many of its own standard deviations.
const MOVE_ERRORS: f64 = 3.0;
/// Until it does, the weight of the priors is raised by this factor, at most this often.
const FIRMER: f64 = 3.0;
const FIRMER_MAX: usize = 10;

/// Products of the columns and of the residual (last), for each unit.
#[derive(Debug, Clone, Default)]
pub struct Gram {
    units: Vec<DMatrix<f64>>,
    columns: usize,
}

/// What is known of the columns' coefficients before the data: standard deviations, infinite where nothing is.
#[derive(Debug, Clone, Copy)]
pub struct Prior<'a> {
    /// One for each column.
    pub deviations: &'a [f64],
    /// Rows that count in each unit.
    pub rows: &'a [usize],
    /// The floor's square: noise is never taken for less, (N m)^2.
    pub floor_square: f64,
    /// Rows per independent sample.
    pub rows_per_independent: f64,
    /// What holds every coefficient besides, as a share of its column's own square.
    pub ridge: f64,
}

/// Coefficients found.
#[derive(Debug, Clone)]
pub struct Solution {
    /// One for each column.
    pub x: DVector<f64>,
    /// Sum of squares left, (N m)^2.
    pub square: f64,
    /// Sum of (x / deviation)^2 over the columns that have a prior.
    pub prior_penalty: f64,
}

impl Gram {
    /// Of `columns` and `residual`, both 0 in rows that do not count.
    pub fn new(folds: &Folds, columns: &[&[f64]], residual: &[f64]) -> Self {
        Self::default().beside(folds, &[], columns, residual)
    }

    /// Of `known` columns, whose products with each other this holds, with `added` ones and another `residual`.
    pub fn beside(&self, folds: &Folds, known: &[&[f64]], added: &[&[f64]], residual: &[f64]) -> Self {
        let all: Vec<&[f64]> = known.iter().chain(added).copied().chain([residual]).collect();
        let n = all.len();
        let one = |(at, range): (usize, &std::ops::Range<usize>)| {
            let mut sums = DMatrix::zeros(n, n);
            for a in 0..n {
                for b in 0..=a {
                    let sum = match self.units.get(at) {
                        Some(unit) if a < known.len() => unit[(a, b)],
                        _ => dot(&all[a][range.clone()], &all[b][range.clone()]),
                    };
                    sums[(a, b)] = sum;
                    sums[(b, a)] = sum;
                }
            }
            sums
        };
        Self { units: folds.units.par_iter().enumerate().map(one).collect(), columns: n - 1 }
    }

    /// Sum over the units that `wanted` chooses.
    fn total(&self, wanted: impl Fn(usize) -> bool) -> DMatrix<f64> {
        let mut sum = DMatrix::zeros(self.columns + 1, self.columns + 1);
        self.units.iter().enumerate().filter(|(at, _)| wanted(*at)).for_each(|(_, unit)| sum += unit);
        sum
    }

    /// The best coefficients over all units.
    pub fn solve(&self, prior: Prior<'_>) -> Solution {
        solve(&self.total(|_| true), prior.rows.iter().sum(), prior)
    }

    /// How far the data decide each coefficient (the diagonal of the resolution matrix: Menke 2012, section 4.5): 1 where it has no prior,
    /// next to 0 where the prior holds it.
    pub fn resolution(&self, prior: Prior<'_>) -> Vec<f64> {
        let sum = self.total(|_| true);
        let noise_square = prior.floor_square.max(f64::MIN_POSITIVE) * prior.rows_per_independent;
        let square = |a: usize| if sum[(a, a)] > 0.0 { sum[(a, a)] } else { 1.0 };
        let scaled = DMatrix::from_fn(self.columns, self.columns, |a, b| sum[(a, b)] / (square(a) * square(b)).sqrt());
        let mut held = scaled.clone();
        (0..self.columns)
            .for_each(|a| held[(a, a)] += prior.ridge + noise_square / (prior.deviations[a].powi(2) * square(a)));
        let all = vec![1.0; self.columns];
        held.cholesky().map_or(all, |cholesky| cholesky.solve(&scaled).diagonal().iter().copied().collect())
    }

    /// Sum of squares left in each unit by coefficients that were fitted without its fold.
    pub fn held_out(&self, folds: &Folds, prior: Prior<'_>) -> Vec<f64> {
        let mut left = vec![0.0; self.units.len()];
        for fold in 0..FOLDS {
            let kept = |at: usize| folds.fold[at] != fold;
            let rows = prior.rows.iter().enumerate().filter(|(at, _)| kept(*at)).map(|(_, rows)| rows).sum();
            let x = solve(&self.total(kept), rows, prior).x;
            for (at, unit) in self.units.iter().enumerate().filter(|(at, _)| folds.fold[*at] == fold) {
                left[at] = square_left(unit, &x);
            }
        }
        left
    }

    /// The best coefficients over clusters drawn `times` each, for an interval by resampling.
    pub fn solve_weighted(&self, weights: &[f64], prior: Prior<'_>) -> Solution {
        let mut sum = DMatrix::zeros(self.columns + 1, self.columns + 1);
        let mut rows = 0.0;
        for (at, unit) in self.units.iter().enumerate().filter(|(at, _)| weights[*at] > 0.0) {
            sum += unit * weights[at];
            rows += prior.rows[at] as f64 * weights[at];
        }
        solve(&sum, rows as usize, prior)
    }
}

/// |r - X x|^2; infinite where it is no number: what cannot be computed explains nothing.
pub fn square_left(unit: &DMatrix<f64>, x: &DVector<f64>) -> f64 {
    let n = x.len();
    let mut left = unit[(n, n)];
    for a in 0..n {
        left -= 2.0 * x[a] * unit[(a, n)];
        for b in 0..n {
            left += x[a] * x[b] * unit[(a, b)];
        }
    }
    if left.is_nan() { f64::INFINITY } else { left.max(0.0) }
}

/// Minimises |r - X x|^2 + s^2 sum (x / deviation)^2, with s^2 the noise of one independent sample spread over its rows; the noise is the
/// residual of the fit itself, but no less than the floor.
pub fn solve(sum: &DMatrix<f64>, rows: usize, prior: Prior<'_>) -> Solution {
    let n = sum.nrows() - 1;
    // A column of zeros keeps its coefficient.
    let scale = |square: f64| if square > 0.0 { square.sqrt() } else { 1.0 };
    let scales: Vec<f64> = (0..n).map(|i| scale(sum[(i, i)])).collect();
    let per_row = |square: f64| square / rows.max(1) as f64;
    let known = prior.deviations.iter().filter(|d| d.is_finite()).count() as f64;
    let limit = known + SURPRISE_ERRORS * (2.0 * known).sqrt();
    let mut found = Solution { x: DVector::zeros(n), square: sum[(n, n)], prior_penalty: 0.0 };
    let mut firmness = vec![1.0; n];
    for round in 0..ROUNDS + FIRMER_MAX {
        if round >= ROUNDS {
            let is_beyond =
                |a: usize| found.prior_penalty > limit || found.x[a].abs() > MOVE_ERRORS * prior.deviations[a];
            let beyond: Vec<usize> = (0..n).filter(|a| is_beyond(*a)).collect();
            if beyond.is_empty() {
                break;
            }
            beyond.into_iter().for_each(|a| firmness[a] *= FIRMER);
        }
        let noise_square = per_row(found.square).max(prior.floor_square).max(f64::MIN_POSITIVE);
        let weight = noise_square * prior.rows_per_independent;
        let normal = DMatrix::from_fn(n, n, |a, b| {
            let own = if a == b {
                prior.ridge + firmness[a] * weight / (prior.deviations[a] * scales[a]).powi(2)
            } else {
                0.0
            };
            sum[(a, b)] / (scales[a] * scales[b]) + own
        });
        let right = DVector::from_fn(n, |a, _| sum[(a, n)] / scales[a]);
        let Some(cholesky) = normal.cholesky() else { break };
        let scaled = cholesky.solve(&right);
        let x = DVector::from_fn(n, |a, _| scaled[a] / scales[a]);
        let prior_penalty = (0..n).map(|a| (x[a] / prior.deviations[a]).powi(2)).sum();
        found = Solution { square: square_left(sum, &x), x, prior_penalty };
    }
    found
}

/// Sum of products, in eight sums side by side: one alone waits for each addition.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (mut sums, whole) = ([0.0; 8], a.len() / 8 * 8);
    for (x, y) in a[..whole].chunks_exact(8).zip(b[..whole].chunks_exact(8)) {
        for ((sum, x), y) in sums.iter_mut().zip(x).zip(y) {
            *sum += x * y;
        }
    }
    let rest: f64 = a[whole..].iter().zip(&b[whole..]).map(|(x, y)| x * y).sum();
    sums.iter().sum::<f64>() + rest
}
