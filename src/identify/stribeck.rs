//! B(v) of one direction as a constant, a line and up to two exponentials, fitted to the global optimum.
//!
//! With u = |v| and the rates fixed, (19) is linear in the rest:
//!
//! B(u) = beta_0 + beta_1 u + sum_i beta_{2+i} exp(-rate_i u)
//!
//! so only the rates are searched (variable projection). The sum of two exponentials has many local minima: walking each
//! rate while the other follows at its best finds the valleys, Levenberg-Marquardt polishes the best of them. The same walk
//! gives the confidence: at given rates the cost is a parabola in every linear coefficient, so the set where the cost stays
//! below the threshold, the profile likelihood interval, is the union over the rates of closed-form intervals. Nothing is
//! linearised, and nothing breaks where the covariance matrix is singular.

use crate::numerics::linear::{LinearFit, solve};
use crate::numerics::marquardt::{Residuals, Stopped, minimise};
use crate::numerics::statistics::{fisher_f, root_mean_square};
use nalgebra::{DMatrix, DVector};

/// Places looked at along each rate.
const GRID: usize = 32;
/// A valley is polished if it is among this many best.
const BASINS: usize = 6;
/// The slowest rate searched turns its term by this much over the fastest speed: slower is a straight line.
const SLOWEST: f64 = 0.2;
/// The fastest rate searched leaves exp(-5) = 0.7 % of its term at the slowest speed: faster is not seen by the data, and
/// its value at rest would be an extrapolation by more than 150 times.
const FASTEST: f64 = 5.0;
/// The fast rate is at least this much above the slow one, or the two columns are one.
const RATIO_MIN: f64 = 1.02;
/// A cost higher than the least by this share is as good.
const RIDGE: f64 = 0.008;
/// Steps of a search along one rate with the other held: golden sections between two grid cells, then halvings out to where
/// the cost crosses the threshold. 14 of them resolve 0.1 % of a cell.
const LINE_STEPS: usize = 14;
/// Points looked at across the region that one line search found.
const ACROSS: usize = 7;

/// B against speed, one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    /// |v|, rad/s.
    pub speed_rad_s: Vec<f64>,
    /// B, N m.
    pub b_nm: Vec<f64>,
    /// The points of one speed as one, by speed: no fit can tell them apart.
    speeds: Vec<Speed>,
    /// Weighted sum of squares of the points about the mean of their speed: no fit can remove it.
    within: f64,
}

/// All points of one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Speed {
    speed_rad_s: f64,
    b_nm: f64,
    weight: f64,
}

/// A fit of (19) with a given number of exponentials.
#[derive(Debug, Clone)]
pub struct ExponentialFit {
    /// Rates in s/rad, slow first; zero, one or two.
    pub rates: Vec<f64>,
    /// beta_0 (N m), beta_1 (N m s/rad), then one amplitude (N m) for each rate.
    pub coefficients: Vec<f64>,
    /// Weighted sum of squared residuals, (N m)^2: the cost.
    pub residual_sum: f64,
    /// Root mean square residual, unweighted, N m.
    pub rmse_nm: f64,
    /// Points fitted.
    pub points: usize,
    /// How the polishing stopped.
    pub stopped: Stopped,
    /// Rates that ended at the limit of the search.
    pub at_bound: Vec<bool>,
}

/// 95 % profile likelihood intervals.
#[derive(Debug, Clone)]
pub struct Profile {
    /// Of the rates, s/rad.
    pub rates: Vec<(f64, f64)>,
    /// Of the coefficients.
    pub coefficients: Vec<(f64, f64)>,
    /// Of B at `band_speed_rad_s`, N m.
    pub band_nm: Vec<(f64, f64)>,
    /// Speeds of the band, rad/s.
    pub band_speed_rad_s: Vec<f64>,
}

impl ExponentialFit {
    /// Parameters fitted.
    pub fn parameters(&self) -> usize {
        self.rates.len() + self.coefficients.len()
    }

    /// Akaike's criterion corrected for few points; infinite when there are too few for this form.
    pub fn aicc(&self) -> f64 {
        let (n, k) = (self.points as f64, self.parameters() as f64 + 1.0);
        if n - k - 1.0 <= 0.0 {
            return f64::INFINITY;
        }
        n * (self.residual_sum.max(f64::MIN_POSITIVE) / n).ln() + 2.0 * k + 2.0 * k * (k + 1.0) / (n - k - 1.0)
    }

    /// B at `speed_rad_s` (|v|), N m.
    pub fn b_nm(&self, speed_rad_s: f64) -> f64 {
        row(speed_rad_s, &self.rates).zip(&self.coefficients).map(|(x, c)| x * c).sum()
    }
}

fn row<'a>(speed_rad_s: f64, rates: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
    [1.0, speed_rad_s].into_iter().chain(rates.iter().map(move |rate| (-rate * speed_rad_s).exp()))
}

impl Points {
    /// Points (speed in rad/s, B in N m, weight in the sum of squares: the inverse of the variance, 1 on average).
    pub fn new(mut points: Vec<(f64, f64, f64)>) -> Self {
        // In one order, whatever order they came in: sums then agree to the last bit.
        points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let mut speeds: Vec<Speed> = Vec::new();
        let mut within = 0.0;
        for group in points.chunk_by(|a, b| a.0 == b.0) {
            let weight: f64 = group.iter().map(|p| p.2).sum();
            let b_nm = group.iter().map(|p| p.1 * p.2).sum::<f64>() / weight;
            within += group.iter().map(|p| p.2 * (p.1 - b_nm).powi(2)).sum::<f64>();
            speeds.push(Speed { speed_rad_s: group[0].0, b_nm, weight });
        }
        let (speed_rad_s, b_nm) = points.iter().map(|p| (p.0, p.1)).unzip();
        Self { speed_rad_s, b_nm, speeds, within }
    }

    /// How many different speeds there are.
    pub fn distinct_speeds(&self) -> usize {
        self.speeds.len()
    }

    /// The slowest and the fastest speed, rad/s.
    pub fn speed_range_rad_s(&self) -> (f64, f64) {
        let speed = |s: Option<&Speed>| s.map_or(f64::NAN, |s| s.speed_rad_s);
        (speed(self.speeds.first()), speed(self.speeds.last()))
    }

    /// The rates that the data could show, s/rad.
    pub fn rate_limits(&self) -> (f64, f64) {
        let (slowest, fastest) = self.speed_range_rad_s();
        (SLOWEST / fastest, FASTEST / slowest)
    }

    /// Root of the weighted sum of squares over all points of `slope` of the speed.
    pub fn weighted_norm(&self, slope: impl Fn(f64) -> f64) -> f64 {
        self.speeds.iter().map(|s| s.weight * slope(s.speed_rad_s).powi(2)).sum::<f64>().sqrt()
    }

    /// The best coefficients for `rates`; the cost is its residual sum and `within`.
    fn project(&self, rates: &[f64]) -> Option<LinearFit> {
        let columns = 2 + rates.len();
        let mut design = DMatrix::zeros(self.speeds.len(), columns);
        let mut b = DVector::zeros(self.speeds.len());
        for (i, speed) in self.speeds.iter().enumerate() {
            let root = speed.weight.sqrt();
            b[i] = root * speed.b_nm;
            for (j, x) in row(speed.speed_rad_s, rates).enumerate() {
                design[(i, j)] = root * x;
            }
        }
        let mut fit = solve(&design, &b)?;
        fit.residual_sum += self.within;
        Some(fit)
    }

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
    /// Where two exponentials are hardly told apart the cost is flat along a ridge on which ever larger terms cancel; its
    /// lowest point is chance, and beyond the speeds recorded such a fit runs away. A cost higher by `RIDGE` is far within
    /// what noise does to it (one parameter's worth of noise is 1 / (points - parameters), some 2 %).
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

    fn cost(&self, rates: &[f64]) -> Option<f64> {
        self.project(rates).map(|fit| fit.residual_sum)
    }

    /// The valleys of the cost as the rate at `place` is walked and the other follows at its best.
    ///
    /// A grid over both rates would miss the narrow ones, where a cell's corner stands high on the slope.
    fn valleys_along(&self, place: usize) -> Vec<(Vec<f64>, f64)> {
        let lines = spaced(self.rate_limits()).into_iter().filter_map(|held| self.line(place, held));
        valleys(lines.map(|line| (line.rates(line.lowest), line.cost)))
    }

    /// The cost along one rate with the other, at `place`, `held`; `None` where the limits leave no room.
    fn line(&self, place: usize, held: f64) -> Option<Line> {
        let (low, high) = self.rate_limits();
        let (low, high) = if place == 0 { (held * RATIO_MIN, high) } else { (low, held / RATIO_MIN) };
        if low >= high {
            return None;
        }
        let mut line = Line { place, held, from: low.ln(), to: high.ln(), lowest: 0.0, cost: f64::INFINITY };
        let cost = |log: f64| self.cost(&line.rates(log)).unwrap_or(f64::INFINITY);
        let step = (line.to - line.from) / (GRID - 1) as f64;
        let at = |i: usize| line.from + step * i as f64;
        let costs: Vec<f64> = (0..GRID).map(|i| cost(at(i))).collect();
        let best = (0..GRID).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
        let lowest = valley(at(best.saturating_sub(1)), at((best + 1).min(GRID - 1)), &cost);
        // An end of the line may lie lower than all within.
        let lowest = [lowest, at(best)].into_iter().min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap_or(lowest);
        (line.lowest, line.cost) = (lowest, cost(lowest));
        Some(line)
    }

    /// The fit with these rates, slow first; `None` when they cannot be told apart.
    pub fn with_rates(&self, rates: &[f64]) -> Option<ExponentialFit> {
        self.at(rates, Stopped::Converged)
    }

    fn at(&self, rates: &[f64], stopped: Stopped) -> Option<ExponentialFit> {
        let fit = self.project(rates)?;
        let (low, high) = self.rate_limits();
        let at_bound = rates.iter().map(|r| *r <= low * 1.001 || *r >= high * 0.999).collect();
        let mut found = ExponentialFit {
            rates: rates.to_vec(),
            coefficients: fit.coefficients.iter().copied().collect(),
            residual_sum: fit.residual_sum,
            rmse_nm: 0.0,
            points: self.b_nm.len(),
            stopped,
            at_bound,
        };
        let residuals: Vec<f64> = self.speed_rad_s.iter().zip(&self.b_nm).map(|(u, b)| found.b_nm(*u) - b).collect();
        found.rmse_nm = root_mean_square(&residuals);
        Some(found)
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

    /// Profile likelihood intervals around `fit`, and the band of B at `band_speed_rad_s`.
    ///
    /// The intervals of the parameters hold for `dimensions` of them at once, the band at each speed by itself. `None` when
    /// there are no more points than parameters: then nothing is known of the errors.
    pub fn profile(&self, fit: &ExponentialFit, band_speed_rad_s: Vec<f64>, dimensions: f64) -> Option<Profile> {
        let freedom = self.b_nm.len() as f64 - fit.parameters() as f64;
        if freedom < 1.0 {
            return None;
        }
        let cost_within = |d: f64| fit.residual_sum * (1.0 + d * fisher_f(d, freedom) / freedom);
        let thresholds = Thresholds { parameters: cost_within(dimensions), band: cost_within(1.0) };
        let mut profile = Profile {
            rates: fit.rates.iter().map(|r| (*r, *r)).collect(),
            coefficients: fit.coefficients.iter().map(|c| (*c, *c)).collect(),
            band_nm: band_speed_rad_s.iter().map(|u| (fit.b_nm(*u), fit.b_nm(*u))).collect(),
            band_speed_rad_s,
        };
        self.widen(&mut profile, &fit.rates, thresholds);
        // The region is a narrow valley that a grid of cells would miss: walk each rate and search along the other.
        for (place, at) in fit.rates.iter().enumerate() {
            for held in around(*at, self.rate_limits()) {
                for rates in self.region_along(&fit.rates, place, held, thresholds.parameters) {
                    self.widen(&mut profile, &rates, thresholds);
                }
            }
        }
        Some(profile)
    }

    /// Rates inside the region whose `place` is `held`: across the interval of the other rate where the cost stays below
    /// `threshold`. With one rate, that rate itself.
    fn region_along(&self, best: &[f64], place: usize, held: f64, threshold: f64) -> Vec<Vec<f64>> {
        if best.len() == 1 {
            return vec![vec![held]];
        }
        let Some(line) = self.line(place, held).filter(|line| line.cost <= threshold) else { return Vec::new() };
        let below = |log: f64| self.cost(&line.rates(log)).is_some_and(|cost| cost <= threshold);
        let (first, last) = (crossing(line.lowest, line.from, below), crossing(line.lowest, line.to, below));
        (0..ACROSS).map(|i| line.rates(first + (last - first) * i as f64 / (ACROSS - 1) as f64)).collect()
    }

    /// Widens `profile` by what `rates` allow below the thresholds.
    fn widen(&self, profile: &mut Profile, rates: &[f64], thresholds: Thresholds) {
        let Some(fit) = self.project(rates).filter(|fit| fit.residual_sum <= thresholds.parameters) else { return };
        let stretch = |range: &mut (f64, f64), middle: f64, half: f64| {
            *range = (range.0.min(middle - half), range.1.max(middle + half));
        };
        for (range, rate) in profile.rates.iter_mut().zip(rates) {
            stretch(range, *rate, 0.0);
        }
        let room = thresholds.parameters - fit.residual_sum;
        for (i, range) in profile.coefficients.iter_mut().enumerate() {
            stretch(range, fit.coefficients[i], (room * fit.unscaled_covariance[(i, i)]).sqrt());
        }
        let room = thresholds.band - fit.residual_sum;
        if room < 0.0 {
            return;
        }
        for (range, u) in profile.band_nm.iter_mut().zip(&profile.band_speed_rad_s) {
            let x = DVector::from_iterator(2 + rates.len(), row(*u, rates));
            stretch(range, x.dot(&fit.coefficients), (room * x.dot(&(&fit.unscaled_covariance * &x))).sqrt());
        }
    }
}

/// Costs up to which a place counts as possible.
#[derive(Debug, Clone, Copy)]
struct Thresholds {
    parameters: f64,
    band: f64,
}

/// `GRID` rates, evenly spaced in their logarithm.
fn spaced((low, high): (f64, f64)) -> Vec<f64> {
    (0..GRID).map(|i| low * (high / low).powf(i as f64 / (GRID - 1) as f64)).collect()
}

/// Rates over the whole of `limits`, and closer by and by around `at`: a region may be a thousandth of the limits wide.
fn around(at: f64, limits: (f64, f64)) -> Vec<f64> {
    let near = (1..GRID / 2).map(|i| 1.5f64.powi(-(i as i32)));
    let offsets = near.flat_map(|by| [at * (1.0 + by), at / (1.0 + by)]);
    spaced(limits).into_iter().chain(offsets.filter(|r| (limits.0..=limits.1).contains(r))).collect()
}

/// One rate held, the other free between `from` and `to` (logarithms), with its lowest place and the cost there.
#[derive(Debug, Clone, Copy)]
struct Line {
    place: usize,
    held: f64,
    from: f64,
    to: f64,
    lowest: f64,
    cost: f64,
}

impl Line {
    /// Both rates, slow first, where the free one's logarithm is `log`.
    fn rates(&self, log: f64) -> Vec<f64> {
        if self.place == 0 { vec![self.held, log.exp()] } else { vec![log.exp(), self.held] }
    }
}

/// Those of `places`, with their costs, that neither neighbour undercuts.
fn valleys(places: impl Iterator<Item = (Vec<f64>, f64)>) -> Vec<(Vec<f64>, f64)> {
    let places: Vec<(Vec<f64>, f64)> = places.collect();
    let cost = |i: Option<usize>| i.and_then(|i| places.get(i)).map_or(f64::INFINITY, |p| p.1);
    let lowest = |i: &usize| places[*i].1 <= cost(i.checked_sub(1)) && places[*i].1 <= cost(Some(i + 1));
    (0..places.len()).filter(lowest).map(|i| places[i].clone()).collect()
}

/// The lowest place of `cost` between `a` and `b`, by golden section.
fn valley(mut a: f64, mut b: f64, cost: &impl Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    for _ in 0..LINE_STEPS {
        let (c, d) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
        if cost(c) < cost(d) { b = d } else { a = c }
    }
    (a + b) / 2.0
}

/// Where between `inside` and `outside` the condition ceases to hold, by halving; `outside` itself if it holds there.
fn crossing(mut inside: f64, mut outside: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if holds(outside) {
        return outside;
    }
    for _ in 0..LINE_STEPS {
        let middle = (inside + outside) / 2.0;
        if holds(middle) { inside = middle } else { outside = middle }
    }
    inside
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
