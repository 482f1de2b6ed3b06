//! What the points know of a fit: profile likelihood intervals, and the band of B.

use super::line::spaced;
use super::possible::Possible;
use super::{ExponentialFit, Points, row};
use crate::numerics::statistics::fisher_f;
use nalgebra::DVector;

/// Offsets from a rate at which the walk looks closer, each two thirds of the last: down to 0.3 % of it.
const CLOSER: i32 = 15;

/// A range that holds nothing yet.
const NOWHERE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

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

/// Costs up to which a place counts as possible.
#[derive(Debug, Clone, Copy)]
struct Thresholds {
    parameters: f64,
    band: f64,
}

impl Points {
    /// Profile likelihood intervals around `fit`, and the band of B at `band_speed_rad_s`.
    ///
    /// The intervals of the parameters hold for `dimensions` of them at once, the band at each speed by itself; coefficients are
    /// those that are physically possible where the model took `taken`. `None` when there are no more points than parameters:
    /// then nothing is known of the errors.
    pub fn profile(
        &self,
        fit: &ExponentialFit,
        taken: &ExponentialFit,
        band_speed_rad_s: Vec<f64>,
        dimensions: f64,
    ) -> Option<Profile> {
        let freedom = self.b_nm.len() as f64 - fit.parameters() as f64;
        if freedom < 1.0 {
            return None;
        }
        let cost_within = |d: f64| fit.residual_sum * (1.0 + d * fisher_f(d, freedom) / freedom);
        let thresholds = Thresholds { parameters: cost_within(dimensions), band: cost_within(1.0) };
        let possible = self.possible(taken);
        let mut profile = Profile {
            rates: vec![NOWHERE; fit.rates.len()],
            coefficients: vec![NOWHERE; fit.coefficients.len()],
            band_nm: band_speed_rad_s.iter().map(|u| (fit.b_nm(*u), fit.b_nm(*u))).collect(),
            band_speed_rad_s,
        };
        self.widen(&mut profile, &fit.rates, thresholds, &possible);
        // The region is a narrow valley that a grid of cells would miss: walk each rate and search along the other.
        for (place, at) in fit.rates.iter().enumerate() {
            for held in around(*at, self.rate_limits()) {
                for rates in self.region_along(&fit.rates, place, held, thresholds.parameters) {
                    self.widen(&mut profile, &rates, thresholds, &possible);
                }
            }
        }
        // Where nothing possible was found there is only the fit itself.
        let at_least = |range: &mut (f64, f64), value: f64| {
            if *range == NOWHERE {
                *range = (value, value);
            }
        };
        profile.rates.iter_mut().zip(&fit.rates).for_each(|(range, rate)| at_least(range, *rate));
        profile.coefficients.iter_mut().zip(&fit.coefficients).for_each(|(range, c)| at_least(range, *c));
        Some(profile)
    }

    /// Widens `profile` by what `rates` allow below the thresholds.
    fn widen(&self, profile: &mut Profile, rates: &[f64], thresholds: Thresholds, possible: &Possible) {
        let Some(fit) = self.project(rates).filter(|fit| fit.residual_sum <= thresholds.parameters) else { return };
        let stretch = |range: &mut (f64, f64), low: f64, high: f64| {
            *range = (range.0.min(low), range.1.max(high));
        };
        let covariance = fit.unscaled_covariance();
        let room = thresholds.parameters - fit.residual_sum;
        if let Some(start) = possible.start(rates, &fit, room) {
            for (range, rate) in profile.rates.iter_mut().zip(rates) {
                stretch(range, *rate, *rate);
            }
            for (i, range) in profile.coefficients.iter_mut().enumerate() {
                // The end of the ellipsoid of equal cost in this direction.
                let half = covariance.column(i) * (room / covariance[(i, i)]).sqrt();
                let ends = [&fit.coefficients - &half, &fit.coefficients + &half];
                let [low, high] = ends.map(|end| possible.reach(rates, &start, &end, i));
                stretch(range, low.min(high), low.max(high));
            }
        }
        let room = thresholds.band - fit.residual_sum;
        if room < 0.0 {
            return;
        }
        for (range, u) in profile.band_nm.iter_mut().zip(&profile.band_speed_rad_s) {
            let x = DVector::from_iterator(2 + rates.len(), row(*u, rates));
            let (middle, half) = (x.dot(&fit.coefficients), (room * x.dot(&(&covariance * &x))).sqrt());
            stretch(range, middle - half, middle + half);
        }
    }
}

/// Rates over the whole of `limits`, and closer by and by around `at`: a region may be a thousandth of the limits wide.
fn around(at: f64, limits: (f64, f64)) -> Vec<f64> {
    let near = (1..=CLOSER).map(|i| 1.5f64.powi(-i));
    let offsets = near.flat_map(|by| [at * (1.0 + by), at / (1.0 + by)]);
    spaced(limits).into_iter().chain(offsets.filter(|r| (limits.0..=limits.1).contains(r))).collect()
}
