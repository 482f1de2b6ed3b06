//! From the coefficients of B(v) to the parameters of friction, each with what is known of it.

use super::confidence::interval;
use super::legs::Amplitude;
use super::stribeck::{ExponentialFit, Points, Profile};
use crate::log::Uncertainty;
use crate::model::{Confidence, Direction, Friction, Joint, SharedError, Status, Term, decayed, loss};
use crate::numerics::statistics::{HALF_WIDTH, fisher_f};

/// A parameter's interval leaves both rates free to conspire with it: where they cannot be told apart, the interval of one
/// parameter alone is narrow just when it is wrong (in 150 simulated campaigns those so narrow as to be called pinned held
/// the truth 50 to 80 times in 100).
pub(super) const CONSPIRING: f64 = 3.0;
/// Degrees of freedom beyond which the size of the errors counts as known.
const MANY: f64 = 1e6;

/// From the coefficients of B to the parameters: times (1 - mu_c) / r1 = G / (r2 A), signs by direction.
pub(super) struct Scale {
    direction: Direction,
    a: Amplitude,
    mu_c: f64,
    /// (1 - mu_c) / r1, N per N m.
    per_nm: f64,
    pulley_radius_m: f64,
    /// Relative half width of A; infinite where no load reveals it.
    a_relative: f64,
    /// Mean over the legs of sin(theta) with any measured load: what A's error shifts B by.
    mean_sine: f64,
    /// Mean over the legs of what that changes by with the position's zero.
    mean_slope: f64,
    /// How far what is declared may be off.
    uncertainty: Uncertainty,
}

/// Where a parameter comes from.
pub(super) struct Place {
    /// Which.
    pub term: Term,
    /// Its place among the fit's coefficients and rates; `None` of mu_c.
    pub in_fit: Option<usize>,
    /// The parameter per coefficient or rate there.
    pub factor: f64,
    /// Its derivative by A, per N m.
    pub by_a: f64,
    /// Its derivative by the position's zero, per rad.
    pub by_zero: f64,
    /// Whether it was not free: a rate at its limit, mu_c without a load.
    pub held: bool,
}

impl Scale {
    /// `load_nm` is the load at the joint that A belongs to: gravity's, or 1 N m of a measured one; 0 without either.
    ///
    /// `means` are those of the regressor over the legs and of its change with the position's zero.
    pub fn new(
        a: &Amplitude,
        direction: Direction,
        joint: &Joint,
        load_nm: f64,
        [mean_sine, mean_slope]: [f64; 2],
        uncertainty: &Uncertainty,
    ) -> Self {
        // Without a load (18) says nothing of mu_c: the load term is left out and marked flat.
        let mu_c = if load_nm == 0.0 { 0.0 } else { 1.0 - joint.transmission() * load_nm / a.a_nm };
        Self {
            direction,
            a: *a,
            mu_c,
            per_nm: loss(mu_c) / joint.winch_radius_m,
            pulley_radius_m: joint.pulley_radius_m,
            a_relative: if load_nm == 0.0 { f64::INFINITY } else { (a.half_width_nm / a.a_nm).abs() },
            // Not told by a table that someone else wrote: then at most 1.
            mean_sine: if mean_sine.is_nan() { 1.0 } else { mean_sine },
            mean_slope,
            uncertainty: *uncertainty,
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

    /// Where each parameter of the form of `fit` comes from, in the order of [`Term::ALL`].
    pub fn places(&self, fit: &ExponentialFit) -> Vec<Place> {
        let (sign, per_nm, number) = (self.direction.sign(), self.per_nm, fit.rates.len());
        let with_load = self.a_relative.is_finite();
        // By (18) 1 - mu_c, and with it every force, goes as 1 / A.
        let relative = if with_load { 1.0 / self.a.a_nm } else { 0.0 };
        let force = |term, i: usize, factor: f64, shift: f64| {
            let by_a = -factor * (fit.coefficients[i] * relative + shift);
            // The zero moves A, and B = y - A R by R itself.
            let direct = if shift == 0.0 { 0.0 } else { factor * self.a.a_nm * self.mean_slope };
            Place { term, in_fit: Some(i), factor, by_a, by_zero: by_a * self.a.by_zero_nm_rad - direct, held: false }
        };
        let rate = |term, i: usize, factor: f64| {
            let in_fit = Some(fit.coefficients.len() + i);
            Place { term, in_fit, factor, by_a: 0.0, by_zero: 0.0, held: fit.at_bound[i] }
        };
        let by_a = loss(self.mu_c) * relative;
        let by_zero = by_a * self.a.by_zero_nm_rad;
        let mut places = vec![Place { term: Term::Load, in_fit: None, factor: 0.0, by_a, by_zero, held: !with_load }];
        places.push(force(Term::Coulomb, 0, per_nm, self.mean_sine));
        if number == 2 {
            places.push(force(Term::CableStribeck, 3, per_nm, 0.0));
            places.push(rate(Term::CableDecay, 1, sign / self.pulley_radius_m));
        }
        if number > 0 {
            places.push(force(Term::JointStribeck, 2, per_nm, 0.0));
            places.push(rate(Term::JointDecay, 0, sign));
        }
        places.push(force(Term::Viscous, 1, sign * per_nm, 0.0));
        places
    }

    /// What A's own error and that of the position's zero add to A and to all points B = y - A R alike.
    pub fn errors(&self) -> [SharedError; 2] {
        let se = |half_nm: f64| if half_nm.is_finite() { half_nm / HALF_WIDTH } else { 0.0 };
        let (own_nm, zero_rad) = (self.a.given_zero_nm, self.a.zero_half_width_rad);
        let b_by_zero_nm_rad = self.a.by_zero_nm_rad * self.mean_sine + self.a.a_nm * self.mean_slope;
        [
            SharedError { a_nm: se(own_nm), b_nm: -se(own_nm * self.mean_sine) },
            SharedError { a_nm: se(self.a.by_zero_nm_rad * zero_rad), b_nm: -se(b_by_zero_nm_rad * zero_rad) },
        ]
    }

    /// Variance of the position's zero, rad^2.
    pub fn variance_of_zero(&self) -> f64 {
        (self.a.zero_half_width_rad / HALF_WIDTH).powi(2)
    }

    /// Variance of A were the zero known, (N m)^2.
    pub fn variance_of_a(&self) -> f64 {
        if self.a.given_zero_nm == 0.0 { 0.0 } else { self.a.sd_nm.powi(2) / self.a.legs as f64 }
    }

    /// What is known of each parameter, in the order of [`Term::ALL`].
    pub fn confidence(
        &self,
        fit: &ExponentialFit,
        profile: Option<&Profile>,
        points: &Points,
    ) -> [Confidence; Term::COUNT] {
        let sigma = (fit.residual_sum / fit.freedom().max(1.0)).sqrt();
        let known_half_widths = (CONSPIRING * fisher_f(CONSPIRING, MANY)).sqrt();
        let (sign, two) = (self.direction.sign(), fit.rates.len() == 2);
        let absent =
            Confidence { low: f64::NEG_INFINITY, high: f64::INFINITY, cv: f64::INFINITY, status: Status::Flat };
        let places = self.places(fit);
        // What A, the zero and what is declared add to the interval of the parameter `term`; with mu_c left out, not
        // estimated, its error is nobody's.
        let beside = |term: Term, value: f64| {
            let Some(place) = places.iter().find(|place| place.term == term) else { return 0.0 };
            let of_a = if self.a.given_zero_nm.is_finite() { place.by_a * self.a.given_zero_nm } else { f64::INFINITY };
            let of_torque = if term == Term::Coulomb { place.factor * self.uncertainty.torque_zero_nm } else { 0.0 };
            let of_zero = place.by_zero * self.a.zero_half_width_rad;
            of_a.hypot(of_zero).hypot(of_torque).hypot(value * self.uncertainty.of_force())
        };
        // A coefficient of B, `i`, as the parameter that is `factor` times it; without a profile nothing is known of it.
        let linear = |term: Term, i: usize, factor: f64| {
            let Some(profile) = profile else { return absent };
            let value = factor * fit.coefficients[i];
            let (low, high) = profile.coefficients[i];
            let beside = beside(term, value);
            let column = points.weighted_norm(|u| basis(i, u, &fit.rates));
            let alone = sigma / column / fit.coefficients[i].abs();
            interval(value, [factor * low, factor * high], beside, known_half_widths, alone, false)
        };
        let rate = |i: usize, factor: f64| {
            let Some(profile) = profile else { return absent };
            let value = factor * fit.rates[i];
            let (low, high) = profile.rates[i];
            let column = points.weighted_norm(|u| fit.coefficients[2 + i] * u * decayed(fit.rates[i], u));
            let alone = sigma / column / fit.rates[i];
            interval(value, [factor * low, factor * high], 0.0, known_half_widths, alone, fit.at_bound[i])
        };
        let fast = fit.rates.len().saturating_sub(1);
        let per_nm = self.per_nm;
        let mu_half = loss(self.mu_c) * self.a_relative.hypot(self.uncertainty.of_loss());
        let mu_alone = if self.a_relative.is_finite() { 0.0 } else { f64::INFINITY };
        let any = !fit.rates.is_empty();
        [
            interval(self.mu_c, [self.mu_c - mu_half, self.mu_c + mu_half], 0.0, HALF_WIDTH, mu_alone, false),
            linear(Term::Coulomb, 0, per_nm),
            if two { linear(Term::CableStribeck, 2 + fast, per_nm) } else { absent },
            if two { rate(fast, sign / self.pulley_radius_m) } else { absent },
            if any { linear(Term::JointStribeck, 2, per_nm) } else { absent },
            if any { rate(0, sign) } else { absent },
            linear(Term::Viscous, 1, sign * per_nm),
        ]
    }
}

fn basis(i: usize, u: f64, rates: &[f64]) -> f64 {
    match i {
        0 => 1.0,
        1 => u,
        _ => decayed(rates[i - 2], u),
    }
}
