//! How friction passes from one branch to the other where an effect declares it.

use crate::numerics::scalar::Scalar;

/// An exponent nearer to 1 than this is taken as 1 to the first order: the error is far below rounding in a log.
const NEARLY_EXPONENTIAL: f64 = 1e-6;
/// Friction this near to its branch, as a share of the way between both, has arrived: far below any sensor's resolution.
const ARRIVED: f64 = 1e-9;

/// Friction as bristles that bend before they slide: dk = sgn(K~ - k) |K~ - k|^exponent |dx| / travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Presliding<S = f64> {
    /// Travel in which a bristle bends, rad.
    pub travel_rad: S,
    /// Dahl's exponent, dimensionless: 1 is exponential.
    pub exponent: S,
}

impl<S: Scalar> Presliding<S> {
    /// What is left of a distance `left` in [0, 1] to the branch after `travel_rad` more.
    pub fn left(&self, left: S, travel_rad: S) -> S {
        if Self::has_arrived(left) { S::from(0.0) } else { self.relaxing(left)(travel_rad) }
    }

    /// Whether the distance to the branch is zero.
    pub fn has_arrived(left: S) -> bool {
        left.value() < ARRIVED
    }

    /// What is left of a distance `left` in [0, 1] to the branch after any travel more: the equation integrated,
    /// (left^p - p s)^(1/p) with p = 1 - exponent and s = travel over the bristle's. Near p = 0 it is
    /// left exp(-s + p s (2 ln left - s) / 2) to the first order in p. What depends on `left` alone is evaluated once.
    pub fn relaxing(&self, left: S) -> impl Fn(S) -> S {
        let bristle_rad = self.travel_rad;
        let power = S::from(1.0) - self.exponent;
        let is_exponential = power.is_zero();
        let is_nearly = power.value().abs() < NEARLY_EXPONENTIAL;
        let start = match (is_exponential, is_nearly) {
            (true, _) => S::from(0.0),
            (_, true) => left.ln(),
            _ => left.powf(power),
        };
        move |travel_rad| {
            let share = travel_rad / bristle_rad;
            if is_exponential {
                return left * (-share).exp();
            }
            if is_nearly {
                return left * (power * share * (start - share / 2.0) - share).exp();
            }
            (start - power * share).max(S::from(0.0)).powf(S::from(1.0) / power)
        }
    }
}

/// A change-over of friction: K~ = ( atan(2 p u) / atan(2 p) )^n over the share u of the clearance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve<S = f64> {
    /// X_cl, m on the cable.
    pub backlash_m: S,
    /// Steepness at its start, dimensionless.
    pub p: S,
    /// Exponent, dimensionless: above 1 the change begins slowly.
    pub n: S,
}

impl<S: Scalar> Curve<S> {
    /// How much of the change is done at the share `u` of the clearance.
    pub fn share(&self, u: S) -> S {
        ((self.p * 2.0 * u).atan() / (self.p * 2.0).atan()).powf(self.n)
    }
}
