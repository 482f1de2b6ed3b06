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

mod covariance;
mod line;
mod possible;
mod profile;
mod search;

pub use profile::Profile;

use crate::model::{Level, decayed};
use crate::numerics::linear::{LinearFit, solve};
use crate::numerics::marquardt::Stopped;
use crate::numerics::statistics::{HALF_WIDTH, root_mean_square, student_t};
use nalgebra::{DMatrix, DVector};

/// The slowest rate searched turns its term by this much over the fastest speed: slower is a straight line.
const SLOWEST: f64 = 0.2;
/// The fastest rate searched leaves exp(-5) = 0.7 % of its term at the slowest speed: faster is not seen by the data, and
/// its value at rest would be an extrapolation by more than 150 times.
const FASTEST: f64 = 5.0;
/// The fast rate is at least this much above the slow one, or the two columns are one.
const RATIO_MIN: f64 = 1.02;
/// Repeats beyond the first, over all speeds, whose scatter tells the error of a single point.
const REPEATS_MIN: f64 = 6.0;
/// Degrees of freedom that the legs' own standard errors (from blocks) count for: two repeats at a few speeds say hardly more about the
/// differences between legs.
const CLAIMED: f64 = 4.0;

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
    /// Variance of a point of weight 1 as the legs themselves claim it, (N m)^2; `None` where that is not known.
    claimed: Option<f64>,
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

/// The rates that sweeps from the slowest to the fastest speed, rad/s, could show, s/rad.
pub fn rate_limits((slowest_rad_s, fastest_rad_s): (f64, f64)) -> (f64, f64) {
    (SLOWEST / fastest_rad_s, FASTEST / slowest_rad_s)
}

/// "no exponential", "one exponential", "two exponentials".
pub fn exponentials(number: usize) -> &'static str {
    ["no exponential", "one exponential", "two exponentials"].get(number).copied().unwrap_or("more exponentials")
}

impl ExponentialFit {
    /// Parameters fitted.
    pub fn parameters(&self) -> usize {
        self.rates.len() + self.coefficients.len()
    }

    /// Points beyond parameters: with none of them the form is exactly determined, and nothing is known of its errors.
    pub fn freedom(&self) -> f64 {
        self.points as f64 - self.parameters() as f64
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
    [1.0, speed_rad_s].into_iter().chain(rates.iter().map(move |rate| decayed(*rate, speed_rad_s)))
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
        Self { speed_rad_s, b_nm, speeds, within, claimed: None }
    }

    /// The same points, whose legs claim a variance of `variance_nm2` for one of weight 1.
    pub fn claiming(self, variance_nm2: Option<f64>) -> Self {
        Self { claimed: variance_nm2, ..self }
    }

    /// Mean B at each speed with its standard error: from the scatter of repeats where there are enough of them, else from the residual of
    /// `fit`; in both the legs' own standard errors count as `CLAIMED` degrees of freedom. NaN where none is known.
    ///
    /// With few degrees of freedom a standard error is itself uncertain: it is scaled so that 1.96 of it give the 95 % interval of
    /// Student's t.
    pub fn means(&self, fit: &ExponentialFit) -> impl Iterator<Item = Level> {
        let of_repeats = self.b_nm.len() as f64 - self.speeds.len() as f64;
        let (sum, freedom) = match of_repeats >= REPEATS_MIN {
            true => (self.within, of_repeats),
            false if fit.freedom() >= 1.0 => (fit.residual_sum, fit.freedom()),
            false => (0.0, 0.0),
        };
        let (claimed, counts) = self.claimed.map_or((0.0, 0.0), |variance| (variance, CLAIMED));
        let freedom = freedom + counts;
        let variance = (sum + counts * claimed) / freedom;
        let uncertain = student_t(freedom) / HALF_WIDTH;
        self.speeds.iter().map(move |s| Level {
            speed_rad_s: s.speed_rad_s,
            b_nm: s.b_nm,
            se_nm: uncertain * (variance / s.weight).sqrt(),
        })
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
        rate_limits(self.speed_range_rad_s())
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
        let mut fit = solve(design, b)?;
        fit.residual_sum += self.within;
        Some(fit)
    }

    fn cost(&self, rates: &[f64]) -> Option<f64> {
        self.project(rates).map(|fit| fit.residual_sum)
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
}
