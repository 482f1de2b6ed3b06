//! From the coefficients of B(v) to the parameters of friction, each with what is known of it.

use super::confidence::interval;
use super::legs::Amplitude;
use super::stribeck::{ExponentialFit, Points, Profile};
use crate::model::{Confidence, Direction, Friction, Joint, Status};
use crate::numerics::statistics::{fisher_f, student_t};

/// A parameter's interval leaves both rates free to conspire with it: where they cannot be told apart, the interval of one
/// parameter alone is narrow just when it is wrong (in 150 simulated campaigns those so narrow as to be called pinned held
/// the truth 50 to 80 times in 100).
pub(super) const CONSPIRING: f64 = 3.0;
/// From the coefficients of B to the parameters: times (1 - mu_c) / r1 = G / (r2 A), signs by direction.
pub(super) struct Scale {
    direction: Direction,
    mu_c: f64,
    /// (1 - mu_c) / r1, N per N m.
    per_nm: f64,
    pulley_radius_m: f64,
    /// Relative half width of A; infinite where gravity does not reveal it.
    a_relative: f64,
    /// Half width of the shift of B that A's error makes, N m.
    shift_nm: f64,
}

impl Scale {
    pub fn new(a: &Amplitude, direction: Direction, joint: &Joint, gravity_nm: f64, mean_sine: f64) -> Self {
        // Without gravity (18) says nothing of mu_c: the load term is left out and marked flat.
        let mu_c = if gravity_nm == 0.0 { 0.0 } else { 1.0 - joint.transmission() * gravity_nm / a.a_nm };
        Self {
            direction,
            mu_c,
            per_nm: (1.0 - mu_c) / joint.winch_radius_m,
            pulley_radius_m: joint.pulley_radius_m,
            a_relative: if gravity_nm == 0.0 { f64::INFINITY } else { (a.half_width_nm / a.a_nm).abs() },
            // Not told by a table that someone else wrote: then at most 1.
            shift_nm: a.half_width_nm * mean_sine.abs().min(1.0),
        }
    }

    /// Signs of [a_j, b_c, c_c, b_j, c_j, d] against beta_0, amplitudes, rates and beta_1 in u = |v|.
    pub fn friction(&self, fit: &ExponentialFit) -> Friction {
        let sign = self.direction.sign();
        let (fast, slow) = (fit.rates.len().checked_sub(1), (!fit.rates.is_empty()).then_some(0));
        let rate = |i: Option<usize>| i.map_or(0.0, |i| sign * fit.rates[i]);
        let amplitude = |i: Option<usize>| i.map_or(0.0, |i| self.per_nm * fit.coefficients[2 + i]);
        let two = fit.rates.len() == 2;
        Friction {
            mu_c: self.mu_c,
            a_j: self.per_nm * fit.coefficients[0],
            b_c: if two { amplitude(fast) } else { 0.0 },
            c_c: rate(fast) / self.pulley_radius_m,
            b_j: amplitude(slow),
            c_j: rate(slow),
            d: sign * self.per_nm * fit.coefficients[1],
        }
    }

    pub fn confidence(&self, fit: &ExponentialFit, profile: Option<&Profile>, points: &Points) -> [Confidence; 7] {
        let freedom = points.b_nm.len() as f64 - fit.parameters() as f64;
        let t = (CONSPIRING * fisher_f(CONSPIRING, freedom.max(0.0))).sqrt();
        let sigma = (fit.residual_sum / freedom.max(1.0)).sqrt();
        let (sign, two) = (self.direction.sign(), fit.rates.len() == 2);
        let absent =
            Confidence { low: f64::NEG_INFINITY, high: f64::INFINITY, cv: f64::INFINITY, status: Status::Flat };
        // A coefficient of B, `i`, as the parameter that is `factor` times it.
        // With mu_c left out, not estimated, its error is nobody's.
        let scale_error = if self.a_relative.is_finite() { self.a_relative } else { 0.0 };
        let linear = |i: usize, factor: f64, shift_nm: f64| {
            let value = factor * fit.coefficients[i];
            let (low, high) = profile.map_or((f64::NEG_INFINITY, f64::INFINITY), |p| p.coefficients[i]);
            let beside = (scale_error * value).hypot(factor * shift_nm);
            let column = points.weighted_norm(|u| basis(i, u, &fit.rates));
            let alone = sigma / column / fit.coefficients[i].abs();
            interval(value, [factor * low, factor * high], beside, t, alone, false)
        };
        let rate = |i: usize, factor: f64| {
            let value = factor * fit.rates[i];
            let (low, high) = profile.map_or((0.0, f64::INFINITY), |p| p.rates[i]);
            let column = points.weighted_norm(|u| fit.coefficients[2 + i] * u * (-fit.rates[i] * u).exp());
            let alone = sigma / column / fit.rates[i];
            interval(value, [factor * low, factor * high], 0.0, t, alone, fit.at_bound[i])
        };
        let fast = fit.rates.len().saturating_sub(1);
        let per_nm = self.per_nm;
        let mu_half = (1.0 - self.mu_c) * self.a_relative;
        let mu_alone = if self.a_relative.is_finite() { 0.0 } else { f64::INFINITY };
        let any = !fit.rates.is_empty();
        [
            interval(self.mu_c, [self.mu_c - mu_half, self.mu_c + mu_half], 0.0, student_t(1e6), mu_alone, false),
            linear(0, per_nm, self.shift_nm),
            if two { linear(2 + fast, per_nm, 0.0) } else { absent },
            if two { rate(fast, sign / self.pulley_radius_m) } else { absent },
            if any { linear(2, per_nm, 0.0) } else { absent },
            if any { rate(0, sign) } else { absent },
            linear(1, sign * per_nm, 0.0),
        ]
    }
}

fn basis(i: usize, u: f64, rates: &[f64]) -> f64 {
    match i {
        0 => 1.0,
        1 => u,
        _ => (-rates[i - 2] * u).exp(),
    }
}
