//! The global optimum: valleys found by walking each rate, the best of them polished.

use super::line::spaced;
use super::{ExponentialFit, Points, RATIO_MIN, row};
use crate::numerics::marquardt::{Residuals, minimise};
use nalgebra::{DMatrix, DVector};

/// A valley is polished if it is among this many best.
const BASINS: usize = 6;
/// A cost higher than the least by this share is as good.
const RIDGE: f64 = 0.008;

impl Points {
    /// The best fit with `exponentials` (0, 1 or 2) of them; `None` when the speeds are too few to hold it.
    pub fn fit(&self, exponentials: usize) -> Option<ExponentialFit> {
        if self.distinct_speeds() < 2 + 2 * exponentials {
            return None;
        }
        if exponentials == 0 {
            return self.with_rates(&[]);
        }
        let limits = self.rate_limits();
        let mut starts = match exponentials {
            1 => {
                valleys(spaced(limits).into_iter().filter_map(|rate| self.cost(&[rate]).map(|cost| (vec![rate], cost))))
            }
            _ => [0, 1].into_iter().flat_map(|place| self.valleys_along(place)).collect(),
        };
        starts.sort_by(|a, b| a.1.total_cmp(&b.1));
        let polished = starts.iter().take(BASINS).filter_map(|(rates, _)| self.polish(rates, limits));
        let best = polished.min_by(|a, b| a.residual_sum.total_cmp(&b.residual_sum))?;
        Some(self.tamest(best))
    }

    /// Of all fits about as good as `best`, the one whose terms are smallest.
    ///
    /// Where two exponentials can hardly be distinguished the cost is flat along a ridge on which ever larger terms cancel; its minimum is
    /// a matter of chance, and such a fit diverges beyond the recorded speeds. A cost higher by `RIDGE` is far within what noise does to it
    /// (one parameter's worth of noise is 1 / (points - parameters), some 2 %).
    fn tamest(&self, best: ExponentialFit) -> ExponentialFit {
        if best.rates.len() < 2 {
            return best;
        }
        let threshold = best.residual_sum * (1.0 + RIDGE);
        let (_, fastest) = self.speed_range_rad_s();
        let size = |fit: &ExponentialFit| -> f64 {
            fit.coefficients.iter().enumerate().map(|(i, c)| if i == 1 { c.abs() * fastest } else { c.abs() }).sum()
        };
        let near =
            spaced(self.rate_limits()).into_iter().flat_map(|slow| self.region_along(&best.rates, 0, slow, threshold));
        let fits = near.filter_map(|rates| self.at(&rates, best.stopped)).filter(|fit| fit.residual_sum <= threshold);
        let tamest = fits.min_by(|a, b| size(a).total_cmp(&size(b)));
        match tamest {
            Some(fit) if size(&fit) < size(&best) => fit,
            _ => best,
        }
    }

    /// The valleys of the cost as the rate at `place` is walked and the other follows at its best.
    ///
    /// A grid over both rates would miss the narrow ones, where a cell's corner stands high on the slope.
    fn valleys_along(&self, place: usize) -> Vec<(Vec<f64>, f64)> {
        let lines = spaced(self.rate_limits()).into_iter().filter_map(|held| self.line(place, held));
        valleys(lines.map(|line| (line.rates(line.lowest), line.cost)))
    }

    fn polish(&self, start: &[f64], limits: (f64, f64)) -> Option<ExponentialFit> {
        let search = RateSearch { points: self, limits };
        let bounds = vec![(0.0, 1.0); start.len()];
        let found = minimise(&search, &search.shares(start), &bounds, 60, 1e-12);
        let unpolished = self.at(start, found.stopped)?;
        match self.at(&search.rates(&found.parameters), found.stopped) {
            Some(fit) if fit.residual_sum <= unpolished.residual_sum => Some(fit),
            _ => Some(unpolished),
        }
    }
}

/// Those of `places`, with their costs, that neither neighbour undercuts.
fn valleys(places: impl Iterator<Item = (Vec<f64>, f64)>) -> Vec<(Vec<f64>, f64)> {
    let places: Vec<(Vec<f64>, f64)> = places.collect();
    let cost = |i: Option<usize>| i.and_then(|i| places.get(i)).map_or(f64::INFINITY, |p| p.1);
    let lowest = |i: &usize| places[*i].1 <= cost(i.checked_sub(1)) && places[*i].1 <= cost(Some(i + 1));
    (0..places.len()).filter(lowest).map(|i| places[i].clone()).collect()
}

/// The search over rates in the unit box: the slow rate by its share of the log range, the fast one by its share of what
/// is left above the slow one. Order and limits hold by construction.
struct RateSearch<'a> {
    points: &'a Points,
    limits: (f64, f64),
}

impl RateSearch<'_> {
    fn rates(&self, shares: &[f64]) -> Vec<f64> {
        let (low, high) = self.limits;
        let top = if shares.len() == 2 { high / RATIO_MIN } else { high };
        let slow = low * (top / low).powf(shares[0]);
        match shares.get(1) {
            None => vec![slow],
            Some(share) => vec![slow, slow * RATIO_MIN * (high / (slow * RATIO_MIN)).powf(*share)],
        }
    }

    fn shares(&self, rates: &[f64]) -> Vec<f64> {
        let (low, high) = self.limits;
        let top = if rates.len() == 2 { high / RATIO_MIN } else { high };
        let first = (rates[0] / low).ln() / (top / low).ln();
        let base = rates[0] * RATIO_MIN;
        let second = rates.get(1).map(|fast| (fast / base).ln() / (high / base).ln());
        std::iter::once(first).chain(second).map(|s| if s.is_finite() { s.clamp(0.0, 1.0) } else { 0.5 }).collect()
    }
}

impl Residuals for RateSearch<'_> {
    fn residuals(&self, shares: &[f64]) -> DVector<f64> {
        let rates = self.rates(shares);
        let speeds = &self.points.speeds;
        match self.points.project(&rates) {
            Some(fit) => DVector::from_fn(speeds.len(), |i, _| {
                let terms = row(speeds[i].speed_rad_s, &rates).zip(fit.coefficients.iter());
                speeds[i].weight.sqrt() * (terms.map(|(x, c)| x * c).sum::<f64>() - speeds[i].b_nm)
            }),
            // Rates that cannot be told apart explain nothing.
            None => DVector::from_fn(speeds.len(), |i, _| speeds[i].weight.sqrt() * speeds[i].b_nm),
        }
    }

    /// By central differences: two more projections a rate, exact enough for a search in two dimensions.
    fn jacobian(&self, shares: &[f64]) -> DMatrix<f64> {
        const STEP: f64 = 1e-5;
        let columns: Vec<DVector<f64>> = (0..shares.len())
            .map(|i| {
                let moved = |by: f64| {
                    let mut s = shares.to_vec();
                    s[i] += by;
                    self.residuals(&s)
                };
                (moved(STEP) - moved(-STEP)) / (2.0 * STEP)
            })
            .collect();
        DMatrix::from_columns(&columns)
    }
}
