//! Least squares on sums of products: once the products of all columns are summed unit by unit, fitting on any choice of units
//! and judging on the others is a matter of small matrices.

use super::parts::{FOLDS, Parts};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Share of a column's own square added to it: keeps dependent columns from running away, changes no fit that means anything.
const RIDGE: f64 = 1e-7;
/// Rounds in which the noise and the weight of the priors settle.
const ROUNDS: usize = 3;
/// Priors are limits, too: the sum of squares of their moves stays within its expectation and so many standard deviations. A
/// gap would else draw the base beyond its confidence wherever it has samples enough.
const SURPRISE_ERRORS: f64 = 3.0;
/// Until it does, priors weigh so many times more, at most so often.
const FIRMER: f64 = 3.0;
const FIRMER_MAX: usize = 10;

/// Products of the columns and of the residual (last), for each unit.
#[derive(Debug, Clone)]
pub struct Gram {
    units: Vec<DMatrix<f64>>,
    rows: Vec<usize>,
    columns: usize,
}

/// What is known of the columns' coefficients before the data: standard deviations, infinite where nothing is.
#[derive(Debug, Clone, Copy)]
pub struct Prior<'a> {
    /// One for each column.
    pub deviations: &'a [f64],
    /// The floor's square: noise is never taken for less, (N m)^2.
    pub floor_square: f64,
    /// Rows per independent sample.
    pub rows_per_independent: f64,
}

/// Coefficients found.
#[derive(Debug, Clone)]
pub struct Solution {
    /// One for each column.
    pub x: DVector<f64>,
    /// Sum of squares left, (N m)^2.
    pub square: f64,
    /// Sum of (x / deviation)^2 over the columns that have a prior.
    pub surprise: f64,
    /// Noise that it was weighed with, (N m)^2.
    pub noise_square: f64,
}

impl Gram {
    /// Of `columns` and `residual` over the rows of `parts` that are `used`.
    pub fn new(parts: &Parts, used: &[bool], columns: &[&[f64]], residual: &[f64]) -> Self {
        let all: Vec<&[f64]> = columns.iter().copied().chain([residual]).collect();
        let n = all.len();
        let one = |range: &std::ops::Range<usize>| {
            let rows: Vec<usize> = range.clone().filter(|i| used[*i]).collect();
            let kept: Vec<Vec<f64>> = all.iter().map(|column| rows.iter().map(|i| column[*i]).collect()).collect();
            let mut sums = DMatrix::zeros(n, n);
            for a in 0..n {
                for b in 0..=a {
                    let sum: f64 = kept[a].iter().zip(&kept[b]).map(|(x, y)| x * y).sum();
                    sums[(a, b)] = sum;
                    sums[(b, a)] = sum;
                }
            }
            (sums, rows.len())
        };
        let (units, rows) = parts.units.par_iter().map(one).unzip();
        Self { units, rows, columns: n - 1 }
    }

    /// Rows of each unit.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Sum over the units that `wanted` chooses, and their rows.
    fn total(&self, wanted: impl Fn(usize) -> bool) -> (DMatrix<f64>, usize) {
        let mut sum = DMatrix::zeros(self.columns + 1, self.columns + 1);
        let mut rows = 0;
        for (at, unit) in self.units.iter().enumerate().filter(|(at, _)| wanted(*at)) {
            sum += unit;
            rows += self.rows[at];
        }
        (sum, rows)
    }

    /// The best coefficients over all units.
    pub fn solve(&self, prior: Prior<'_>) -> Solution {
        let (sum, rows) = self.total(|_| true);
        solve(&sum, rows, prior)
    }

    /// Sum of squares left in each unit by coefficients that were fitted without its fold.
    pub fn held_out(&self, parts: &Parts, prior: Prior<'_>) -> Vec<f64> {
        let mut left = vec![0.0; self.units.len()];
        for fold in 0..FOLDS {
            let (sum, rows) = self.total(|at| parts.fold[at] != fold);
            let x = solve(&sum, rows, prior).x;
            for (at, unit) in self.units.iter().enumerate().filter(|(at, _)| parts.fold[*at] == fold) {
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
            rows += self.rows[at] as f64 * weights[at];
        }
        solve(&sum, rows as usize, prior)
    }
}

/// |r - X x|^2.
fn square_left(unit: &DMatrix<f64>, x: &DVector<f64>) -> f64 {
    let n = x.len();
    let mut left = unit[(n, n)];
    for a in 0..n {
        left -= 2.0 * x[a] * unit[(a, n)];
        for b in 0..n {
            left += x[a] * x[b] * unit[(a, b)];
        }
    }
    left.max(0.0)
}

/// Minimises |r - X x|^2 + s^2 sum (x / deviation)^2, with s^2 the noise of one independent sample spread over its rows; the
/// noise is what the fit itself leaves, but no less than the floor.
fn solve(sum: &DMatrix<f64>, rows: usize, prior: Prior<'_>) -> Solution {
    let n = sum.nrows() - 1;
    // What moves nothing stays where it is.
    let scale = |square: f64| if square > 0.0 { square.sqrt() } else { 1.0 };
    let scales: Vec<f64> = (0..n).map(|i| scale(sum[(i, i)])).collect();
    let per_row = |square: f64| square / rows.max(1) as f64;
    let known = prior.deviations.iter().filter(|d| d.is_finite()).count() as f64;
    let limit = known + SURPRISE_ERRORS * (2.0 * known).sqrt();
    let mut found =
        Solution { x: DVector::zeros(n), square: sum[(n, n)], surprise: 0.0, noise_square: per_row(sum[(n, n)]) };
    let mut firmness = 1.0;
    for round in 0..ROUNDS + FIRMER_MAX {
        if round >= ROUNDS {
            if found.surprise <= limit {
                break;
            }
            firmness *= FIRMER;
        }
        let noise_square = per_row(found.square).max(prior.floor_square).max(f64::MIN_POSITIVE);
        let weight = firmness * noise_square * prior.rows_per_independent;
        let normal = DMatrix::from_fn(n, n, |a, b| {
            let own = if a == b { RIDGE + weight / (prior.deviations[a] * scales[a]).powi(2) } else { 0.0 };
            sum[(a, b)] / (scales[a] * scales[b]) + own
        });
        let right = DVector::from_fn(n, |a, _| sum[(a, n)] / scales[a]);
        let Some(cholesky) = normal.cholesky() else { break };
        let scaled = cholesky.solve(&right);
        let x = DVector::from_fn(n, |a, _| scaled[a] / scales[a]);
        let surprise = (0..n).map(|a| (x[a] / prior.deviations[a]).powi(2)).sum();
        found = Solution { square: square_left(sum, &x), x, surprise, noise_square };
    }
    found
}
