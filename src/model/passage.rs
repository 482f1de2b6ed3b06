//! Where friction stands between its branches as the joint moves on: one sample at a time, the memory explicit.

use super::{Combination, Direction, Model, Transition};

/// K~ of a model along a motion: the clearance's transition, then what presliding makes of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    transition: Transition,
    curve: Combination,
    backlash_rad: f64,
    deadband_rad: f64,
    presliding_rad: f64,
    /// K~ after presliding, and where it was last brought up to date, rad.
    k_tilde: f64,
    at_rad: f64,
}

impl Passage {
    /// At `position_rad`, having moved in `direction` for long; travel back of less than `deadband_rad` is no reversal.
    pub fn after(model: &Model, direction: Direction, position_rad: f64, deadband_rad: f64) -> Self {
        let transition = Transition::after(direction, position_rad);
        Self {
            transition,
            curve: model.curve(),
            backlash_rad: model.backlash_m() / model.joint.pulley_radius_m,
            deadband_rad,
            presliding_rad: model.effects.iter().map(|e| e.effect.presliding_rad(&e.parameters)).sum(),
            k_tilde: transition.k_tilde,
            at_rad: position_rad,
        }
    }

    /// One sample on: the joint is now at `position_rad` and moves at `velocity_rad_s`; returns K~.
    ///
    /// With `Sign` and no presliding K~ follows the sign of the speed alone, as (20) has it: K = 1 for v >= 0.
    pub fn step(&mut self, position_rad: f64, velocity_rad_s: f64) -> f64 {
        let through_clearance = self.transition.step(position_rad, &self.curve, self.backlash_rad, self.deadband_rad);
        if self.presliding_rad <= 0.0 {
            return match self.curve {
                Combination::Sign => f64::from(u8::from(velocity_rad_s >= 0.0)),
                _ => through_clearance,
            };
        }
        let target = match self.curve {
            Combination::Sign => (self.transition.direction().sign() + 1.0) / 2.0,
            _ => through_clearance,
        };
        // ds = (K - s) |dx| / travel over one sample, K held: an exponential in the travel.
        let left = (-(position_rad - self.at_rad).abs() / self.presliding_rad).exp();
        self.at_rad = position_rad;
        self.k_tilde = target + (self.k_tilde - target) * left;
        self.k_tilde
    }

    /// K_f in [-1, 1].
    pub fn k_f(&self) -> f64 {
        self.transition.k_f
    }

    /// Whether friction is fully on one branch: |K_f| = 1.
    pub fn is_stable(&self) -> bool {
        self.transition.is_stable()
    }

    /// The direction of the motion that the state last followed.
    pub fn direction(&self) -> Direction {
        self.transition.direction()
    }
}

impl Model {
    /// How friction changes over: the model's own curve, or that of an effect in its place.
    pub fn curve(&self) -> Combination {
        self.added_curve().map_or(self.combination, |curve| Combination::arctan(curve.p))
    }

    /// X_cl, m: the joint's own, or that of an effect in its place.
    pub fn backlash_m(&self) -> f64 {
        self.added_curve().map_or(self.joint.backlash_m, |curve| curve.backlash_m)
    }

    fn added_curve(&self) -> Option<crate::effects::Curve> {
        self.effects.iter().rev().find_map(|e| e.effect.curve(&e.parameters))
    }
}
