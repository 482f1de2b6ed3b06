//! How friction passes from one branch to the other where an effect says so.

/// Friction as bristles that bend before they slide: dk = sgn(K~ - k) |K~ - k|^exponent |dx| / travel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Presliding {
    /// Travel in which a bristle bends, rad.
    pub travel_rad: f64,
    /// Dahl's exponent, dimensionless: 1 is exponential.
    pub exponent: f64,
}

impl Presliding {
    /// What is left of a distance `left` in [0, 1] to the branch after `travel_rad` more: the equation integrated.
    pub fn left(&self, left: f64, travel_rad: f64) -> f64 {
        let share = travel_rad / self.travel_rad;
        if left <= 0.0 || (self.exponent - 1.0).abs() < 1e-6 {
            return left * (-share).exp();
        }
        let power = 1.0 - self.exponent;
        (left.powf(power) - power * share).max(0.0).powf(1.0 / power)
    }
}

/// A change-over of friction: K~ = ( atan(2 p u) / atan(2 p) )^n over the share u of the clearance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Curve {
    /// X_cl, m on the cable.
    pub backlash_m: f64,
    /// Steepness at its start, dimensionless.
    pub p: f64,
    /// Exponent, dimensionless: above 1 the change begins slowly.
    pub n: f64,
}

impl Curve {
    /// How much of the change is done at the share `u` of the clearance.
    pub fn share(&self, u: f64) -> f64 {
        ((2.0 * self.p * u).atan() / (2.0 * self.p).atan()).powf(self.n)
    }
}
