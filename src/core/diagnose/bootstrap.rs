//! Intervals by resampling whole clusters: the scatter between campaigns like this one.

use super::floor::Floor;
use super::folds::Folds;
use crate::numerics::statistics::quantile;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{ChiSquared, Distribution, Normal};

/// Resamplings.
const DRAWS: usize = 1000;
/// Their seed: the same campaign gives the same intervals.
const SEED: u64 = 0x5155_4152;

/// How often each cluster is drawn, resampling by resampling, and the floor's square that goes with it, (N m)^2.
#[derive(Debug)]
pub struct Resamples {
    weights: Vec<Vec<f64>>,
    floor_square: Vec<f64>,
    cluster: Vec<usize>,
}

/// A gap and what is left of it: both above the floor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shrink {
    /// 1 - after / before.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// What the parameters of a fit cost it on held-out units, because noise moved them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Numbers {
    /// How many of them the data decide.
    pub effective_dof: f64,
    /// What one costs in mean square, (N m)^2.
    pub each_square: f64,
}

impl Numbers {
    /// What all of them cost, (N m)^2.
    pub fn square(&self) -> f64 {
        self.effective_dof * self.each_square
    }
}

impl Resamples {
    /// For the clusters of `folds`.
    pub fn new(folds: &Folds, floor: &Floor) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        let count = folds.cluster.iter().max().map_or(0, |last| last + 1);
        let normal = Normal::new(1.0, floor.relative_error).ok();
        let mut weights = Vec::with_capacity(DRAWS);
        let mut floor_square = Vec::with_capacity(DRAWS);
        for _ in 0..DRAWS {
            let mut drawn = vec![0.0; count];
            (0..count).for_each(|_| drawn[random.random_range(0..count)] += 1.0);
            weights.push(drawn);
            let factor = normal.map_or(1.0, |normal| normal.sample(&mut random)).max(0.0);
            floor_square.push(factor * floor.rms_nm * floor.rms_nm);
        }
        Self { weights, floor_square, cluster: folds.cluster.clone() }
    }

    /// Mean square in each resampling of what has `squares` in each unit, over `rows` of them.
    pub fn mean_squares(&self, squares: &[f64], rows: &[f64]) -> Vec<f64> {
        let count = self.weights.first().map_or(0, Vec::len);
        let (mut s, mut n) = (vec![0.0; count], vec![0.0; count]);
        for ((cluster, square), row) in self.cluster.iter().zip(squares).zip(rows) {
            s[*cluster] += square;
            n[*cluster] += row;
        }
        let mean = |weights: &Vec<f64>| {
            let of = |values: &[f64]| weights.iter().zip(values).map(|(w, x)| w * x).sum::<f64>();
            of(&s) / of(&n).max(f64::MIN_POSITIVE)
        };
        self.weights.iter().map(mean).collect()
    }

    /// How far the gap shrinks from `before` to `after`, squares left in each unit, over `rows`, above the floor's square. No fit leaves
    /// less than the errors of its `numbers` do; only the upper end is from the units alone.
    pub fn shrink(&self, before: &[f64], after: &[f64], rows: &[f64], floor_square: f64, numbers: Numbers) -> Shrink {
        let all = |squares: &[f64]| squares.iter().sum::<f64>() / rows.iter().sum::<f64>().max(1.0);
        let share = |before: f64, after: f64, floor_square: f64, least_square: f64| {
            let gap = above(before, floor_square);
            if gap > 0.0 { 1.0 - (above(after, floor_square).max(least_square.sqrt()) / gap).min(1.0) } else { 0.0 }
        };
        let (b, a) = (self.mean_squares(before, rows), self.mean_squares(after, rows));
        let mut random = ChaCha8Rng::seed_from_u64(SEED);
        let luck = ChiSquared::new(numbers.effective_dof.max(1.0)).ok();
        let mut least =
            || luck.map_or(1.0, |luck| luck.sample(&mut random) / numbers.effective_dof.max(1.0)) * numbers.square();
        let mut lows: Vec<f64> = (0..b.len()).map(|i| share(b[i], a[i], self.floor_square[i], least())).collect();
        let mut highs: Vec<f64> = (0..b.len()).map(|i| share(b[i], a[i], self.floor_square[i], 0.0)).collect();
        let value = share(all(before), all(after), floor_square, numbers.square());
        Shrink { value, low: quantile(&mut lows, 0.025).min(value), high: quantile(&mut highs, 0.975).max(value) }
    }

    /// How often each unit is drawn in resampling `i`.
    pub fn of_units(&self, i: usize) -> Vec<f64> {
        self.cluster.iter().map(|cluster| self.weights[i][*cluster]).collect()
    }

    /// How many resamples there are.
    pub fn count(&self) -> usize {
        self.weights.len()
    }

    /// Share of the resamplings in which `holds` does, told the resampling's number.
    pub fn share(&self, holds: impl Fn(usize) -> bool) -> f64 {
        (0..self.weights.len()).filter(|i| holds(*i)).count() as f64 / self.weights.len().max(1) as f64
    }
}

/// What lies above the floor, as a root.
pub fn above(square: f64, floor_square: f64) -> f64 {
    (square - floor_square).max(0.0).sqrt()
}
