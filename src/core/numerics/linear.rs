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
    /// (X' X)^-1: times the residual variance it is the covariance.
    pub unscaled_covariance: DMatrix<f64>,
    /// Sum of squared residuals.
    pub residual_sum: f64,
}

/// Minimises |X b - y|^2; `None` when the columns of `design` are dependent or outnumber its rows.
///
/// By modified Gram-Schmidt on columns scaled to unit length, so that their sizes (1, exp(-60), ...) do not decide their
/// rank. Written out rather than through a general factorisation: the search over rates solves this ten thousand times on a
/// few dozen rows, where a library's bookkeeping costs more than its arithmetic.
pub fn solve(design: &DMatrix<f64>, y: &DVector<f64>) -> Option<LinearFit> {
    let n = design.ncols();
    if design.nrows() < n {
        return None;
    }
    let mut q = design.clone();
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
    let mut rest = y.clone();
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
    let inverse = r.solve_upper_triangular(&DMatrix::identity(n, n))?;
    let unscaled_covariance = DMatrix::from_fn(n, n, |i, j| {
        inverse.row(i).iter().zip(inverse.row(j).iter()).map(|(a, b)| a * b).sum::<f64>() / (scales[i] * scales[j])
    });
    let scaled_solution = &inverse * projected;
    let coefficients = DVector::from_fn(n, |i, _| scaled_solution[i] / scales[i]);
    Some(LinearFit { coefficients, unscaled_covariance, residual_sum: rest.norm_squared() })
}
