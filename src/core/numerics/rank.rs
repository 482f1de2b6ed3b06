//! What a least squares design shows of its parameters: which combinations of them change nothing that is observed.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// A combination of the columns, each of unit length, whose square is below this share of the largest counts as zero: far above rounding
/// (1e-16 times the number of columns), far below anything that data could determine.
const UNSEEN: f64 = 1e-12;
/// A function rests on such a combination if this share of its slope does.
const RESTS: f64 = 1e-6;
/// Rotations after which the eigenvalues of a usable matrix are long found.
const ROTATIONS: usize = 10_000;

/// What a design shows.
#[derive(Debug, Clone)]
pub struct Shown {
    inverse: DMatrix<f64>,
    /// Orthonormal combinations of the columns at unit length that change nothing.
    unseen: Vec<DVector<f64>>,
    scales: Vec<f64>,
}

impl Shown {
    /// Of the columns of `jacobian`.
    pub fn new(jacobian: &DMatrix<f64>) -> Self {
        let n = jacobian.ncols();
        let length = |norm: f64| if norm > 0.0 { norm } else { 1.0 };
        let scales: Vec<f64> = jacobian.column_iter().map(|column| length(column.norm())).collect();
        let normal =
            DMatrix::from_fn(n, n, |i, j| jacobian.column(i).dot(&jacobian.column(j)) / (scales[i] * scales[j]));
        // Of no columns there are no parts to ask for.
        let is_usable = n > 0 && normal.iter().all(|x| x.is_finite());
        let parts = is_usable.then(|| SymmetricEigen::try_new(normal, f64::EPSILON, ROTATIONS)).flatten();
        let Some(parts) = parts else {
            let unseen = (0..n).map(|i| DVector::from_fn(n, |j, _| f64::from(u8::from(i == j)))).collect();
            return Self { inverse: DMatrix::zeros(n, n), unseen, scales };
        };
        let least = UNSEEN * parts.eigenvalues.max();
        let (mut inverse, mut unseen) = (DMatrix::zeros(n, n), Vec::new());
        for (value, vector) in parts.eigenvalues.iter().zip(parts.eigenvectors.column_iter()) {
            if *value > least {
                inverse += vector * vector.transpose() / *value;
            } else {
                unseen.push(vector.into_owned());
            }
        }
        let inverse = DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (scales[i] * scales[j]));
        Self { inverse, unseen, scales }
    }

    /// (J' J)^-1, of what is not shown the part that is.
    pub fn inverse(&self) -> &DMatrix<f64> {
        &self.inverse
    }

    /// Whether the design shows a function of the parameters with these derivatives.
    pub fn shows(&self, slopes: &[f64]) -> bool {
        let scaled = DVector::from_fn(slopes.len(), |i, _| slopes[i] / self.scales[i]);
        self.unseen.iter().all(|of| of.dot(&scaled).abs() <= RESTS * scaled.norm())
    }

    /// Whether it shows the parameter at `i` by itself.
    pub fn shows_parameter(&self, i: usize) -> bool {
        self.unseen.iter().all(|of| of[i].abs() <= RESTS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two columns that are one, one of nothing, one of its own.
    #[test]
    fn what_trades_off_wholly_is_shown_as_a_sum() {
        let rows: Vec<f64> = (0..20).map(f64::from).collect();
        let design = DMatrix::from_fn(20, 4, |i, j| [rows[i], 2.0 * rows[i], 0.0, (rows[i] - 9.5).powi(2)][j]);
        let shown = Shown::new(&design);
        assert_eq!([0, 1, 2, 3].map(|i| shown.shows_parameter(i)), [false, false, false, true]);
        assert!(shown.shows(&[1.0, 2.0, 0.0, 5.0]) && !shown.shows(&[1.0, -2.0, 0.0, 0.0]));
        assert!(!shown.shows(&[0.0, 0.0, 1.0, 0.0]));
        // x a + 2 x b: the sum's variance is that of the one column.
        let slopes = DVector::from_vec(vec![1.0, 2.0, 0.0, 0.0]);
        let alone = Shown::new(&design.select_columns(&[0, 3]));
        let (together, single) = ((shown.inverse() * &slopes).dot(&slopes), alone.inverse()[(0, 0)]);
        assert!((together / single - 1.0).abs() < 1e-9, "{together} {single}");
    }

    #[test]
    fn of_no_columns_all_that_rests_on_none_is_shown() {
        let shown = Shown::new(&DMatrix::zeros(5, 0));
        assert!(shown.shows(&[]) && shown.inverse().is_empty());
    }

    #[test]
    fn a_design_that_is_no_number_shows_nothing() {
        let shown = Shown::new(&DMatrix::from_element(5, 2, f64::NAN));
        assert!(!shown.shows_parameter(0) && !shown.shows_parameter(1));
    }
}
