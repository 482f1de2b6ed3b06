//! What a fit knows of its parameters together: of any function of them, where single ones trade off or are not shown at all.

use crate::numerics::cluster;
use crate::numerics::rank::Shown;
use crate::numerics::statistics::{HALF_WIDTH, student_t};
use nalgebra::{DMatrix, DVector};

/// Covariance of all free parameters of a fit, those at a bound as free as the others.
#[derive(Debug, Clone)]
pub struct Together {
    matrix: DMatrix<f64>,
    shown: Shown,
    /// The parameters that `shown` is about.
    free: Vec<usize>,
}

/// A parameter that was held, and the standard error of the value that it was held at.
pub struct Held {
    /// Its place.
    pub at: usize,
    /// Standard error, in its unit.
    pub se: f64,
}

impl Together {
    /// Of a fit with this `jacobian` whose errors have these `scores`, one of each cluster. What a `held` parameter may be off by
    /// moves the others as the fit would have followed it.
    pub fn new(jacobian: &DMatrix<f64>, scores: &[DVector<f64>], held: Option<Held>) -> Self {
        let n = jacobian.ncols();
        let free: Vec<usize> = (0..n).filter(|i| held.as_ref().is_none_or(|held| held.at != *i)).collect();
        let columns = jacobian.select_columns(&free);
        let shown = Shown::new(&columns);
        let scores: Vec<DVector<f64>> = scores.iter().map(|score| score.select_rows(&free)).collect();
        // Of few clusters the size of the errors is itself uncertain.
        let wider = student_t(cluster::freedom(scores.len(), free.len())) / HALF_WIDTH;
        let of_free =
            cluster::covariance(shown.inverse(), &scores) * if wider.is_finite() { wider * wider } else { 1.0 };
        let mut matrix = DMatrix::zeros(n, n);
        for (i, a) in free.iter().enumerate() {
            for (j, b) in free.iter().enumerate() {
                matrix[(*a, *b)] = of_free[(i, j)];
            }
        }
        if let Some(held) = held {
            let mut moved = DVector::zeros(n);
            let followed = shown.inverse() * columns.tr_mul(&jacobian.column(held.at));
            free.iter().zip(followed.iter()).for_each(|(i, by)| moved[*i] = -by * held.se);
            moved[held.at] = held.se;
            matrix += &moved * moved.transpose();
        }
        Self { matrix, shown, free }
    }

    /// Covariance of two functions with these derivatives by the parameters; infinite where one rests on what the data do not show.
    pub fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        let of_free = |slopes: &[f64]| self.free.iter().map(|i| slopes[*i]).collect::<Vec<f64>>();
        if !self.shown.shows(&of_free(a)) || !self.shown.shows(&of_free(b)) {
            return f64::INFINITY;
        }
        let n = a.len();
        // A quantity that depends on none of the unknown parameters is known all the same.
        let term = |(i, j): (usize, usize)| if a[i] * b[j] == 0.0 { 0.0 } else { a[i] * b[j] * self.matrix[(i, j)] };
        let sum: f64 = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(term).sum();
        if sum.is_nan() { f64::INFINITY } else { sum }
    }

    /// Standard error of the parameter at `i`, all it is known to by itself.
    pub fn se(&self, i: usize) -> f64 {
        self.matrix[(i, i)].max(0.0).sqrt()
    }
}
