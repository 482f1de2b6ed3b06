//! Linear least squares with covariance.

use nalgebra::{DMatrix, DVector};

/// Columns whose scaled pivot is below this are dependent on the others: far above rounding (1e-16 times the condition
/// number of a usable design), far below any column that data could tell apart.
const DEPENDENT: f64 = 1e-10;

/// A solved linear least squares problem.
#[derive(Debug, Clone)]
pub struct LinearFit {
    /// One coefficient for each column of the design.
    pub coefficients: DVector<f64>,
    /// Sum of squared residuals.
    pub residual_sum: f64,
    /// The triangular factor of the design, its columns scaled to unit length, and those lengths.
    factor: DMatrix<f64>,
    scales: Vec<f64>,
}

impl LinearFit {
    /// (X' X)^-1: times the residual variance it is the covariance.
    pub fn unscaled_covariance(&self) -> DMatrix<f64> {
        let n = self.scales.len();
        let mut inverse = DMatrix::identity(n, n);
        // Cannot fail: no pivot is below `DEPENDENT`.
        self.factor.solve_upper_triangular_mut(&mut inverse);
        DMatrix::from_fn(n, n, |i, j| {
            let product = inverse.row(i).iter().zip(inverse.row(j).iter()).map(|(a, b)| a * b).sum::<f64>();
            product / (self.scales[i] * self.scales[j])
        })
    }
}

/// Minimises |X b - y|^2; `None` when the columns of `design` are dependent or outnumber its rows.
///
/// By modified Gram-Schmidt on columns scaled to unit length, so that their sizes (1, exp(-60), ...) do not decide their
/// rank. Written out rather than through a general factorisation: the search over rates solves this ten thousand times on a
/// few dozen rows, where a library's bookkeeping costs more than its arithmetic.
pub fn solve(design: DMatrix<f64>, y: DVector<f64>) -> Option<LinearFit> {
    let n = design.ncols();
    if design.nrows() < n {
        return None;
    }
    let mut q = design;
    let mut r = DMatrix::zeros(n, n);
    let mut scales = Vec::with_capacity(n);
    for mut column in q.column_iter_mut() {
        let scale = column.norm();
        if !(scale > 0.0 && scale.is_finite()) {
            return None;
        }
        column /= scale;
        scales.push(scale);
    }
    let mut rest = y;
    let mut projected = DVector::zeros(n);
    for i in 0..n {
        let length = q.column(i).norm();
        if length < DEPENDENT {
            return None;
        }
        r[(i, i)] = length;
        q.column_mut(i).unscale_mut(length);
        for j in i + 1..n {
            let (left, mut right) = q.columns_range_pair_mut(i, j);
            r[(i, j)] = left.dot(&right);
            right.axpy(-r[(i, j)], &left, 1.0);
        }
        projected[i] = q.column(i).dot(&rest);
        rest.axpy(-projected[i], &q.column(i), 1.0);
    }
    let mut coefficients = projected;
    if !r.solve_upper_triangular_mut(&mut coefficients) {
        return None;
    }
    coefficients.iter_mut().zip(&scales).for_each(|(coefficient, scale)| *coefficient /= scale);
    Some(LinearFit { coefficients, residual_sum: rest.norm_squared(), factor: r, scales })
}
