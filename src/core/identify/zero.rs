//! The zero of the position: one angle for all legs of both directions, estimated along with A and B.
//!
//! A joint that is at its reading plus z has G(q + z) = G(q) cos(z) + G'(q) sin(z). Each leg, with an A and a B of its own,
//! says what z is; their weighted mean is the estimate. What differs from leg to leg beyond each leg's own standard error
//! (DerSimonian and Laird) enters the weights, and the error of the mean is that of the scatter itself (Hartung and Knapp,
//! Statistics in Medicine 20:3875, 2001), which holds for correlated noise. What repeats at the same place in every leg does
//! not scatter: sums of errors over places, across legs, add what they have beyond independent errors.
//! A declared half width of the zero is a prior: where the legs say little it limits the answer and its interval.

use super::legs::{LegFit, LegZero};
use super::sums::{BLOCKS, LegSums};
use crate::model::{Both, Confidence, Direction, Model, Status};
use crate::numerics::statistics::{HALF_WIDTH, extent, half_width_of_sum};

/// Steps of Gauss-Newton: the problem is linear except for the sine of the angle.
const STEPS: usize = 6;
/// The largest zero looked for, rad: beyond, gravity might as well be another.
pub(super) const MOST_RAD: f64 = 0.5;
/// Places that the legs' errors are sorted into, as many as a leg has blocks.
const PLACES: usize = BLOCKS;
/// Sums of independent errors over places, squared, exceed the squares of the errors by this ratio once in twenty times: the 95 %
/// quantile of chi squared of 20 over 20. Below, nothing is common; chance alone would otherwise widen every second interval.
const BY_CHANCE: f64 = 1.57;
/// Deviations that repeat with position (a ripple, a spring) are correlated between neighbouring places: their products count too, up to
/// this many places apart, with decreasing weight (Newey and West, Econometrica 55:703, 1987). Of 300 joints with a ripple of 1 to 6
/// periods per rad the 95 % intervals of A hold the truth in 95.5 % with 3 places, of 150 of them in 93.7 % with 4, 96.0 % with 2, 83.7 %
/// with 8. A ripple of less than one period per rad cannot be distinguished from the load: 32 %, for any value here.
const NEIGHBOURS: usize = 3;
/// Degrees of freedom of a sum over places: three parameters are fitted within.
pub(super) const FREEDOM_OF_PLACES: f64 = PLACES as f64 - 3.0;
/// A zero of more than this many half widths is off beyond doubt (a chance of 1 in 300 where it is right), ...
const BEYOND_DOUBT: f64 = 1.5;
/// ... and worth a word when it is more than this, rad: 0.05 deg moves mu_c by 0.0005.
const NEGLIGIBLE_RAD: f64 = 8.7e-4;
/// A zero is known by the data when its interval is at most this share of what was declared.
const KNOWN: f64 = 0.5;

/// Its dotted name in `model.json`.
pub const NAME: &str = "dynamics.position_zero_rad";

/// The zero of the position and how well it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zero {
    /// The joint is at its reading plus this, rad.
    pub rad: f64,
    /// Half width of its 95 % interval, the declared one in it, rad.
    pub half_width_rad: f64,
    /// The declared half width, rad; 0 where the zero is taken as declared.
    pub declared_rad: f64,
    /// The zero that the legs of each direction alone ask for, and its standard error, rad; `None` where they tell nothing.
    pub by_direction: Both<Option<(f64, f64)>>,
}

/// A mean over legs.
struct Pooled {
    mean_rad: f64,
    se_rad: f64,
    half_width_rad: f64,
}

impl Zero {
    /// The zero as declared, exact.
    pub const DECLARED: Self =
        Self { rad: 0.0, half_width_rad: 0.0, declared_rad: 0.0, by_direction: Both { up: None, down: None } };

    /// Estimates the zero of `legs`, declared to be 0 within `declared_rad`; 0 takes it as declared.
    pub fn estimate(legs: &[&LegSums], declared_rad: f64) -> Self {
        let pool = |rad: f64, which: &dyn Fn(&LegSums) -> bool| {
            let told: Vec<&LegSums> = legs.iter().copied().filter(|leg| which(leg)).collect();
            pooled(&told, rad)
        };
        if declared_rad == 0.0 || pool(0.0, &|_| true).is_none() {
            return Self::DECLARED;
        }
        let (mut rad, mut half_width_rad) = (0.0, declared_rad);
        for _ in 0..STEPS {
            let Some(found) = pool(rad, &|_| true) else { break };
            (rad, half_width_rad) = with_declaration(rad + found.mean_rad, found.half_width_rad, declared_rad);
            rad = rad.clamp(-MOST_RAD, MOST_RAD);
        }
        let alone =
            |direction: Direction| pool(rad, &|leg| leg.direction == direction).map(|p| (rad + p.mean_rad, p.se_rad));
        Self { rad, half_width_rad, declared_rad, by_direction: Both::make(alone) }
    }

    /// Whether it was estimated.
    pub fn is_fitted(&self) -> bool {
        self.declared_rad > 0.0
    }

    /// What is known of it: `flat` where the declaration says as much as the data.
    pub fn confidence(&self) -> Confidence {
        known(self.rad, self.half_width_rad, self.declared_rad)
    }
}

/// Mean and half width of a zero of `rad` within `half_width_rad` and the declaration that it is 0 within `declared_rad`.
pub(super) fn with_declaration(rad: f64, half_width_rad: f64, declared_rad: f64) -> (f64, f64) {
    let (data, prior) = (half_width_rad.powi(-2), declared_rad.powi(-2));
    if data.is_finite() { (data / (data + prior) * rad, (data + prior).powf(-0.5)) } else { (rad, 0.0) }
}

/// The weighted mean over `legs` of what each says of the zero about `rad`.
fn pooled(legs: &[&LegSums], rad: f64) -> Option<Pooled> {
    let (told, legs): (Vec<_>, Vec<&LegSums>) =
        legs.iter().filter_map(|leg| leg.zero(rad).map(|told| (told, *leg))).unzip();
    let number = told.len() as f64;
    if told.is_empty() {
        return None;
    }
    let steps: Vec<f64> = told.iter().map(|leg| leg.step_rad).collect();
    let variance = |blocks: &[f64]| {
        let count = blocks.len() as f64;
        blocks.iter().map(|x| x * x).sum::<f64>() * count / f64::max(count - 3.0, 1.0)
    };
    let variances: Vec<f64> = told.iter().map(|leg| variance(&leg.by_block_rad)).collect();
    let weights = weights(&steps, &variances);
    let mean_rad: f64 = steps.iter().zip(&weights).map(|(x, w)| x * w).sum();
    let scatter = steps.iter().zip(&weights).map(|(x, w)| w * (x - mean_rad).powi(2)).sum::<f64>();
    // Of a single leg its own error is all that there is.
    let (of_legs, freedom) = match told.len() {
        1 => (variances[0], FREEDOM_OF_PLACES),
        _ => (scatter / (number - 1.0), number - 1.0),
    };
    let weighted = |(leg, w): (&super::sums::ZeroOfLeg, &f64)| leg.by_block_rad.iter().map(|x| x * w).collect();
    let by_leg: Vec<Vec<f64>> = told.iter().zip(&weights).map(weighted).collect();
    let of_places = common(&legs, &by_leg);
    let half_width_rad = half_width_of_sum(&[(of_legs, freedom), (of_places, FREEDOM_OF_PLACES)]);
    Some(Pooled { mean_rad, se_rad: (of_legs + of_places).sqrt(), half_width_rad })
}

/// Weights of the legs, 1 together: the inverse of each one's own variance and of that between them; alike where one is exact.
fn weights(values: &[f64], variances: &[f64]) -> Vec<f64> {
    let number = values.len() as f64;
    if variances.iter().any(|v| !(v.is_finite() && *v > 0.0)) {
        return vec![1.0 / number; values.len()];
    }
    let precision: Vec<f64> = variances.iter().map(|v| 1.0 / v).collect();
    let total: f64 = precision.iter().sum();
    let middle = values.iter().zip(&precision).map(|(x, p)| x * p).sum::<f64>() / total;
    let excess = values.iter().zip(&precision).map(|(x, p)| p * (x - middle).powi(2)).sum::<f64>() - (number - 1.0);
    let scale = total - precision.iter().map(|p| p * p).sum::<f64>() / total;
    let between = if scale > 0.0 { (excess / scale).max(0.0) } else { 0.0 };
    let raw: Vec<f64> = variances.iter().map(|v| 1.0 / (v + between)).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|w| w / sum).collect()
}

/// The variance that errors common to all `legs` at one place add to a mean, whose error is the sum of `by_leg`, the parts of
/// each leg's blocks: squares and neighbours' products of the sums over places beyond the squares of the parts. 0 where errors may be
/// independent.
pub(super) fn common(legs: &[&LegSums], by_leg: &[Vec<f64>]) -> f64 {
    let all: Vec<f64> = legs.iter().flat_map(|leg| leg.positions_rad().iter().copied()).collect();
    let (low, high) = extent(&all);
    let mut places = [0.0; PLACES];
    let mut apart = 0.0;
    for (leg, parts) in legs.iter().zip(by_leg) {
        for (position, part) in leg.positions_rad().iter().zip(parts) {
            let at = ((position - low) / (high - low) * PLACES as f64) as usize;
            places[at.min(PLACES - 1)] += part;
            apart += part * part;
        }
    }
    let at_lag = |lag: usize| places.iter().zip(&places[lag..]).map(|(a, b)| a * b).sum::<f64>();
    if at_lag(0) <= BY_CHANCE * apart {
        return 0.0;
    }
    let weighted = |lag: usize| 2.0 * (1.0 - lag as f64 / (NEIGHBOURS + 1) as f64) * at_lag(lag);
    let together = at_lag(0) + (1..=NEIGHBOURS).map(weighted).sum::<f64>();
    (together - apart).max(0.0) * PLACES as f64 / FREEDOM_OF_PLACES
}

/// What is known of a zero of `rad` within `half_width_rad`. A relative error of what may be 0 says nothing: it is pinned
/// where the data say more of it than the declaration of `declared_rad`.
pub(super) fn known(rad: f64, half_width_rad: f64, declared_rad: f64) -> Confidence {
    let cv = half_width_rad / HALF_WIDTH / rad.abs();
    let status = if half_width_rad <= KNOWN * declared_rad { Status::Pinned } else { Status::Flat };
    Confidence { low: rad - half_width_rad, high: rad + half_width_rad, cv, status }
}

/// A word where the zero is off beyond doubt.
pub fn warning(zero: &Zero) -> Option<String> {
    told(zero.rad, zero.half_width_rad)
}

/// The same of a model whose zero was fitted on whole series.
pub fn warning_of_fit(model: &Model) -> Option<String> {
    let known = model.confidence.get(NAME)?;
    told(model.dynamics.position_zero_rad, (known.high - known.low) / 2.0)
}

fn told(rad: f64, half_width_rad: f64) -> Option<String> {
    let (deg, half_deg) = (rad.to_degrees(), half_width_rad.to_degrees());
    (rad.abs() > BEYOND_DOUBT * half_width_rad && rad.abs() > NEGLIGIBLE_RAD).then(|| {
        format!(
            "the position's zero is off by {deg:.2} deg +- {half_deg:.2} (95 %): the joint is at its reading {} {:.2} deg; the model \
             counts with it (position_zero_rad); correct the zero of the encoder, or look for what else pulls like gravity",
            if deg > 0.0 { "plus" } else { "less" },
            deg.abs()
        )
    })
}

/// The zero that `legs`, of a table, were fitted at; `declared_rad` is how far it may be off.
pub fn of_legs(legs: &[LegFit], declared_rad: f64) -> Zero {
    let Some(LegZero { zero_rad, half_width_rad, .. }) = legs.first().map(|leg| leg.zero) else {
        return Zero::DECLARED;
    };
    // Where the zero was not fitted its interval has no width.
    let declared_rad = if half_width_rad > 0.0 { declared_rad } else { 0.0 };
    Zero { rad: zero_rad, half_width_rad, declared_rad, ..Zero::DECLARED }
}
