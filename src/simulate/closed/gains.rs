//! A position controller's gains: given, or such as suit the joint.

use super::super::driven::asked;
use crate::dynamics::{Chain, Motion};
use crate::effects::Sample;
use crate::model::Model;
use crate::problem::{Problem, Result};
use std::f64::consts::{FRAC_PI_2, TAU};

/// How far the joint may stay from its command where it rests under its own weight and friction, rad.
const HELD_WITHIN_RAD: f64 = 0.01;
/// Natural frequencies of the controlled joint, Hz: below the first it would drift, above the second no drive follows.
const NATURAL_HZ: (f64, f64) = (2.0, 20.0);

/// The motor and the controller that drive the joint: torque = stiffness (command - position) + damping (its speed - speed),
/// taken to the winch, within the motor's limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// N m/rad at the joint; where absent, so that gravity and friction deflect the joint by 0.01 rad.
    pub stiffness_nm_rad: Option<f64>,
    /// N m s/rad at the joint; where absent, critical.
    pub damping_nm_s_rad: Option<f64>,
    /// The most that the motor gives at the winch, N m.
    pub torque_limit_nm: f64,
    /// Of rotor and gear about the winch, before the torque sensor, kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// What the controller knows of the joint, and adds along the command.
    pub feedforward: Option<Model>,
}

/// What the controller works with; stiffness and damping at the joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Gains {
    pub stiffness_nm_rad: f64,
    pub damping_nm_s_rad: f64,
}

impl Controller {
    /// The gains for `model`, those of its own given ones that there are.
    ///
    /// Errors: a joint without inertia, whose motion no torque decides.
    pub(super) fn gains(&self, model: &Model, chain: Option<&Chain>) -> Result<Gains> {
        let transmission = model.joint.transmission();
        let at_rest = |q: f64, acceleration: f64, k_tilde: f64| {
            let own = Motion { position: q, velocity: 0.0, acceleration };
            let sample = Sample { time_s: 0.0, elapsed_s: 0.0, own, others: &[] };
            model.driven_nm(&sample, asked(model, chain, own, &[]), k_tilde).torque_nm / transmission
        };
        let inertia_kg_m2 =
            at_rest(0.0, 1.0, 1.0) - at_rest(0.0, 0.0, 1.0) + self.motor_inertia_kg_m2 / transmission.powi(2);
        if inertia_kg_m2 <= 0.0 {
            let what = "the joint has no inertia, which decides how it moves under a torque";
            let cure = "set dynamics.inertia_kg_m2 in the model, or give --motor-inertia-kg-m2";
            return Problem::error("--closed-loop", what, cure).alone();
        }
        let positions = (-4..=4).map(|i| FRAC_PI_2 * f64::from(i) / 4.0);
        let held_nm = positions.flat_map(|q| [at_rest(q, 0.0, 0.0).abs(), at_rest(q, 0.0, 1.0).abs()]);
        let (slow, fast) = (NATURAL_HZ.0 * TAU, NATURAL_HZ.1 * TAU);
        let suits_nm_rad = (held_nm.fold(0.0, f64::max) / HELD_WITHIN_RAD)
            .clamp(inertia_kg_m2 * slow.powi(2), inertia_kg_m2 * fast.powi(2));
        let stiffness_nm_rad = self.stiffness_nm_rad.unwrap_or(suits_nm_rad);
        let critical_nm_s_rad = 2.0 * (stiffness_nm_rad * inertia_kg_m2).sqrt();
        Ok(Gains { stiffness_nm_rad, damping_nm_s_rad: self.damping_nm_s_rad.unwrap_or(critical_nm_s_rad) })
    }
}
