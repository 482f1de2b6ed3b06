//! The rows of a data set that count, with the noise floor under them.
//!
//! Everything that is computed for one choice of rows holds its mask, so that sums of one cannot be solved with the row counts of
//! another.

use super::data::DataSet;
use super::gram::{Prior, RIDGE};
use std::ops::Range;
use std::sync::Arc;

/// The rows that count.
#[derive(Debug, Clone)]
pub struct Mask<'d> {
    /// The recordings.
    pub data: &'d DataSet,
    used: Vec<bool>,
    unit_rows: Vec<usize>,
    /// The noise floor, N m; 0 as long as it is unknown.
    pub floor_nm: f64,
}

impl<'d> Mask<'d> {
    /// Of the rows of `data` that are `used`.
    pub fn new(data: &'d DataSet, used: Vec<bool>, floor_nm: f64) -> Arc<Self> {
        Arc::new(Self { data, unit_rows: data.folds.rows(&used), used, floor_nm })
    }

    /// The same rows above another floor.
    pub fn above(&self, floor_nm: f64) -> Arc<Self> {
        Arc::new(Self { floor_nm, ..self.clone() })
    }

    /// The same without the rows of `stretches`.
    pub fn without(&self, stretches: impl IntoIterator<Item = Range<usize>>) -> Arc<Self> {
        let mut used = self.used.clone();
        stretches.into_iter().for_each(|rows| used[rows].fill(false));
        Self::new(self.data, used, self.floor_nm)
    }

    /// The same rows of the motions as the encoder would have read them once more.
    pub fn again(&self) -> Option<Arc<Self>> {
        let data = self.data.again()?;
        Some(Arc::new(Self { data, ..self.clone() }))
    }

    /// Whether row `i` counts.
    pub fn counts(&self, i: usize) -> bool {
        self.used[i]
    }

    /// Rows that count.
    pub fn rows(&self) -> usize {
        self.unit_rows.iter().sum()
    }

    /// The floor's square, (N m)^2.
    pub fn floor_square(&self) -> f64 {
        self.floor_nm * self.floor_nm
    }

    /// The prior of coefficients with the standard deviations `deviations`, for sums over these rows.
    pub fn prior<'p>(&'p self, deviations: &'p [f64]) -> Prior<'p> {
        Prior {
            deviations,
            rows: &self.unit_rows,
            floor_square: self.floor_square(),
            rows_per_independent: self.data.records.rows_per_independent,
            ridge: RIDGE,
        }
    }

    /// `values`, 0 where a row does not count.
    pub fn apply(&self, values: impl Iterator<Item = f64>) -> Vec<f64> {
        values.zip(&self.used).map(|(x, used)| if *used { x } else { 0.0 }).collect()
    }

    /// Measured less `predicted_nm`, 0 where a row does not count, N m.
    pub fn residual_nm(&self, predicted_nm: &[f64]) -> Vec<f64> {
        self.apply(self.data.measured_nm.iter().zip(predicted_nm).map(|(y, p)| y - p))
    }
}
