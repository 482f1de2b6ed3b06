//! Steady-state friction of one cable, one branch per direction of motion.
//!
//! (14), (15): f = r1 ( mu_c T0 + a_j + b_c exp(-c_c r2 v) + b_j exp(-c_j v) + d v ). The load term mu_c T0 goes to the
//! left side of the prediction (`predict`), the rest is a function of speed alone. On the `down` branch a_j, b_c, b_j, c_c
//! and c_j are negative and v < 0, so the exponentials decay with speed there too.

use crate::dynamics::Direction;

/// The seven friction parameters of one branch, P = [mu_c, a_j, b_c, c_c, b_j, c_j, d] (Table II).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Friction {
    /// Equivalent friction coefficient of the cable, dimensionless: friction per tension carried.
    pub mu_c: f64,
    /// Coulomb friction as a force at the winch, N.
    pub a_j: f64,
    /// Stribeck amplitude of the cable, N.
    pub b_c: f64,
    /// Decay of the cable's Stribeck term per cable speed, s/m.
    pub c_c: f64,
    /// Stribeck amplitude of the joint, N.
    pub b_j: f64,
    /// Decay of the joint's Stribeck term per joint speed, s/rad.
    pub c_j: f64,
    /// Viscous friction, N s/rad.
    pub d: f64,
}

impl Friction {
    /// Names of the parameters as in files, in the order of `values`.
    pub const NAMES: [&'static str; 7] = ["mu_c", "a_j", "b_c", "c_c", "b_j", "c_j", "d"];

    /// Units of the parameters, in the order of `NAMES`.
    pub const UNITS: [&'static str; 7] = ["", "N", "N", "s/m", "N", "s/rad", "N s/rad"];

    /// The parameters in the order of `NAMES`.
    pub fn values(&self) -> [f64; 7] {
        [self.mu_c, self.a_j, self.b_c, self.c_c, self.b_j, self.c_j, self.d]
    }

    /// The branch whose parameters are `values`, in the order of `NAMES`.
    pub fn from_values(values: [f64; 7]) -> Self {
        let [mu_c, a_j, b_c, c_c, b_j, c_j, d] = values;
        Self { mu_c, a_j, b_c, c_c, b_j, c_j, d }
    }

    /// The part of (15) that does not depend on the load, as a torque at the winch, N m.
    ///
    /// The branch is evaluated at its own sign of speed (`+|v|` on up, `-|v|` on down): in a transition the other
    /// branch would otherwise be evaluated at the wrong sign and explode.
    pub fn unloaded_nm(
        &self,
        direction: Direction,
        speed_rad_s: f64,
        winch_radius_m: f64,
        pulley_radius_m: f64,
    ) -> f64 {
        let v = direction.sign() * speed_rad_s.abs();
        let stribeck = stribeck_n(self.b_c, self.c_c * pulley_radius_m, v) + stribeck_n(self.b_j, self.c_j, v);
        winch_radius_m * (self.a_j + stribeck + self.d * v)
    }
}

/// b exp(-c v), N; skipped when b = 0, which saves most of the time of a model without it.
fn stribeck_n(b_n: f64, c_s_rad: f64, v_rad_s: f64) -> f64 {
    if b_n == 0.0 { 0.0 } else { b_n * (-c_s_rad * v_rad_s).exp() }
}
