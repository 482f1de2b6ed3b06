//! Which coefficients of B(v) are physically possible.
//!
//! Where speeds are few, terms that cancel each other fit the points as well as any: a Coulomb friction of -100 N with a Stribeck term of
//! +140 N. Each part of friction dissipates energy, so their sizes add up to B, apart from the offset due to tension and the sensor's zero.
//! The total size of the terms over the recorded speeds is therefore limited.

use super::{ExponentialFit, Points};
use crate::model::decayed;
use crate::numerics::linear::LinearFit;
use nalgebra::{DMatrix, DVector};

/// The sizes of all terms together are at most this many times the largest |B| recorded: they are 1 to 1.3 times it where all
/// point one way; the rest is for a level that is shifted against them.
const TOGETHER: f64 = 2.5;
/// Halvings on the way from possible to impossible coefficients: 1 in 1000 of the way.
const HALVINGS: usize = 10;
/// Decades of the weight of size against misfit that are searched, and steps: 1 in 4 of a weight.
const DECADES: (f64, f64) = (-12.0, 6.0);
const WEIGHTS: usize = 24;

/// The limit of a direction's terms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Possible {
    limit_nm: f64,
    slowest_rad_s: f64,
    fastest_rad_s: f64,
}

impl Points {
    /// The limit for these points; `taken`, the fit that the model took, is within it.
    pub(super) fn possible(&self, taken: &ExponentialFit) -> Possible {
        let (slowest_rad_s, fastest_rad_s) = self.speed_range_rad_s();
        let largest_nm = self.b_nm.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        let any = Possible { limit_nm: TOGETHER * largest_nm, slowest_rad_s, fastest_rad_s };
        let taken_nm = any.size_nm(&taken.rates, taken.coefficients.iter());
        Possible { limit_nm: any.limit_nm.max(taken_nm), ..any }
    }
}

impl Possible {
    /// The largest that each term gets over the speeds recorded, per unit of its coefficient.
    fn largest<'a>(&self, rates: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let slowest_rad_s = self.slowest_rad_s;
        [1.0, self.fastest_rad_s].into_iter().chain(rates.iter().map(move |rate| decayed(*rate, slowest_rad_s)))
    }

    /// The sizes of all terms together, N m.
    fn size_nm<'c>(&self, rates: &[f64], coefficients: impl Iterator<Item = &'c f64>) -> f64 {
        self.largest(rates).zip(coefficients).map(|(x, c)| (x * c).abs()).sum()
    }

    /// Possible coefficients that cost at most `room` more than `fit`; `None` where there are none.
    ///
    /// Of those that cost as much, (1 + w V D)^-1 c has the smallest terms, for some weight w, V the unscaled covariance and D the
    /// squares of the terms' sizes (ridge regression): its cost is w^2 c' D V D c.
    pub fn start(&self, rates: &[f64], fit: &LinearFit, room: f64) -> Option<DVector<f64>> {
        let fits = |c: &DVector<f64>| self.size_nm(rates, c.iter()) <= self.limit_nm;
        if fits(&fit.coefficients) {
            return Some(fit.coefficients.clone());
        }
        let squares: Vec<f64> = self.largest(rates).map(|x| x * x).collect();
        let (n, covariance) = (squares.len(), fit.unscaled_covariance());
        (0..WEIGHTS).find_map(|i| {
            let share = i as f64 / (WEIGHTS - 1) as f64;
            // In units of what makes both count alike.
            let weight = 10f64.powf(DECADES.0 + share * (DECADES.1 - DECADES.0)) * room / self.limit_nm.powi(2);
            let system = DMatrix::from_fn(n, n, |i, j| f64::from(i == j) + weight * covariance[(i, j)] * squares[j]);
            let c = system.lu().solve(&fit.coefficients)?;
            let pull = DVector::from_fn(n, |i, _| weight * squares[i] * c[i]);
            let cost = pull.dot(&(&covariance * &pull));
            (cost <= room && fits(&c)).then_some(c)
        })
    }

    /// How far the coefficient at `place` may go from `start` towards `end` with all possible.
    pub fn reach(&self, rates: &[f64], start: &DVector<f64>, end: &DVector<f64>, place: usize) -> f64 {
        let at = |share: f64| start + (end - start) * share;
        let fits = |share: f64| self.size_nm(rates, at(share).iter()) <= self.limit_nm;
        if fits(1.0) {
            return end[place];
        }
        let (mut within, mut beyond) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = (within + beyond) / 2.0;
            *(if fits(middle) { &mut within } else { &mut beyond }) = middle;
        }
        at(within)[place]
    }
}
