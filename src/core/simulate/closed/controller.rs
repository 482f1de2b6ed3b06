//! The motor and the position controller that drive a joint.

use super::super::driven::asked;
use crate::dynamics::{Chain, Motion};
use crate::effects::Sample;
use crate::log::{Controller as Law, Damped};
use crate::model::Model;
use crate::problem::{Problem, Result};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, TAU};

/// How far the joint may stay from its command where it rests under its own weight and friction, rad.
const HELD_WITHIN_RAD: f64 = 0.01;
/// Natural frequencies of the controlled joint, Hz: below the first it would drift, above the second no drive follows.
const NATURAL_HZ: (f64, f64) = (2.0, 20.0);
/// Speeds at which friction may fall, rad/s: those of the protocol's sweeps and slower ones, a factor of two apart.
const SPEEDS_RAD_S: [f64; 10] = [0.001, 0.002, 0.004, 0.008, 0.016, 0.03, 0.06, 0.12, 0.25, 0.5];

/// What is wanted of a controller; what is left open suits the joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Wanted {
    /// N m/rad at the joint; left open, weight and friction deflect the joint by 0.01 rad.
    pub stiffness_nm_rad: Option<f64>,
    /// N m s/rad at the joint; by default critical, plus the slope by which friction falls with speed.
    pub damping_nm_s_rad: Option<f64>,
    /// The most that the motor gives at the winch, N m; left open, it has no limit.
    pub torque_limit_nm: Option<f64>,
    /// Of motor and gear about the winch, before the torque sensor, kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// Whether the torque that is known to be needed along the command is added.
    pub feedforward: bool,
}

/// What a controller is told at one moment.
#[derive(Debug, Clone, Copy)]
pub(super) struct Command {
    pub position_rad: f64,
    pub velocity_rad_s: f64,
    pub feedforward_nm: f64,
}

/// Motor torque = (r1/r2) (stiffness (command - position) + damping (its speed - speed)) + feedforward, within the motor's limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Controller {
    /// At the joint, N m/rad.
    pub stiffness_nm_rad: f64,
    /// At the joint, N m s/rad.
    pub damping_nm_s_rad: f64,
    /// The most that the motor gives at the winch, N m.
    pub torque_limit_nm: f64,
    /// Of motor and gear about the winch, before the torque sensor, kg m^2.
    pub motor_inertia_kg_m2: f64,
    /// The joint as the controller knows it, whose torque along the command it adds.
    pub feedforward: Option<Model>,
}

impl Controller {
    /// As `wanted`, tuned to the inertia of `joint` and to weight and friction as they are `known`.
    ///
    /// Errors: a joint without inertia.
    pub fn new(wanted: Wanted, joint: &Model, known: &Model, chain: Option<&Chain>) -> Result<Self> {
        let inertia_kg_m2 = inertia_kg_m2(joint, chain, wanted.motor_inertia_kg_m2)?;
        let at = |position: f64, velocity: f64, k_tilde: f64| {
            asked_nm(known, chain, Motion { position, velocity, acceleration: 0.0 }, k_tilde)
        };
        let positions = (-4..=4).map(|i| FRAC_PI_2 * f64::from(i) / 4.0);
        let held_nm = positions.flat_map(|q| [at(q, 0.0, 0.0).abs(), at(q, 0.0, 1.0).abs()]).fold(0.0, f64::max);
        let stiffest = |hz: f64| inertia_kg_m2 * (TAU * hz).powi(2);
        let suits_nm_rad = (held_nm / HELD_WITHIN_RAD).clamp(stiffest(NATURAL_HZ.0), stiffest(NATURAL_HZ.1));
        let stiffness_nm_rad = wanted.stiffness_nm_rad.unwrap_or(suits_nm_rad);
        // Where friction falls with speed the joint drives itself: without damping beyond that it moves in fits and starts.
        let rise = |slow: f64, fast: f64, k_tilde| (at(0.0, fast, k_tilde) - at(0.0, slow, k_tilde)) / (fast - slow);
        let steepest = SPEEDS_RAD_S.windows(2).map(|v| rise(v[0], v[1], 1.0).min(rise(-v[0], -v[1], 0.0)));
        let falling_nm_s_rad = -steepest.fold(0.0, f64::min);
        let suits_nm_s_rad = 2.0 * (stiffness_nm_rad * inertia_kg_m2).sqrt() + falling_nm_s_rad;
        Ok(Self {
            stiffness_nm_rad,
            damping_nm_s_rad: wanted.damping_nm_s_rad.unwrap_or(suits_nm_s_rad),
            torque_limit_nm: wanted.torque_limit_nm.unwrap_or(f64::INFINITY),
            motor_inertia_kg_m2: wanted.motor_inertia_kg_m2,
            feedforward: wanted.feedforward.then(|| known.clone()),
        })
    }

    /// What the motor gives at the winch of a joint of this `transmission` in `own` motion, N m.
    pub(super) fn motor_nm(&self, transmission: f64, command: Command, own: Motion) -> f64 {
        let behind_nm = self.stiffness_nm_rad * (command.position_rad - own.position)
            + self.damping_nm_s_rad * (command.velocity_rad_s - own.velocity);
        let wanted_nm = command.feedforward_nm + transmission * behind_nm;
        wanted_nm.min(self.torque_limit_nm).max(-self.torque_limit_nm)
    }

    /// What `campaign.toml` says of it, all at the joint; what it adds as feedforward is not among it.
    pub fn law(&self, transmission: f64) -> Law {
        Law {
            speed_filter_s: 0.0,
            stiffness_nm_rad: Some(self.stiffness_nm_rad),
            damping_nm_s_rad: self.damping_nm_s_rad,
            damped: Damped::Error,
            torque_limit_nm: Some(self.torque_limit_nm / transmission).filter(|limit| limit.is_finite()),
        }
    }

    /// For people who want to know what was chosen; a limit that is infinite becomes null.
    pub fn to_json(&self) -> Value {
        json!({
            "stiffness_nm_rad": self.stiffness_nm_rad,
            "damping_nm_s_rad": self.damping_nm_s_rad,
            "torque_limit_nm": self.torque_limit_nm,
            "motor_inertia_kg_m2": self.motor_inertia_kg_m2,
            "feedforward": self.feedforward.is_some(),
        })
    }
}

/// What a motor of `motor_inertia_kg_m2` at the winch feels of the joint's inertia and its own, at the joint, kg m^2.
///
/// Errors: none, or less.
fn inertia_kg_m2(model: &Model, chain: Option<&Chain>, motor_inertia_kg_m2: f64) -> Result<f64> {
    let at = |acceleration| asked_nm(model, chain, Motion { acceleration, ..Motion::default() }, 1.0);
    let inertia_kg_m2 = at(1.0) - at(0.0) + motor_inertia_kg_m2 / model.joint.transmission().powi(2);
    if inertia_kg_m2 > 0.0 {
        return Ok(inertia_kg_m2);
    }
    let what = format!("the joint's inertia is {inertia_kg_m2} kg m^2, and no torque decides how it moves");
    let cure = "set dynamics.inertia_kg_m2 in the model, or give --motor-inertia-kg-m2";
    Problem::error("--closed-loop", what, cure).alone()
}

/// What `model` asks in `own` motion, the other joints at rest at 0, as a torque at the joint, N m.
fn asked_nm(model: &Model, chain: Option<&Chain>, own: Motion, k_tilde: f64) -> f64 {
    let sample = Sample { time_s: 0.0, elapsed_s: 0.0, own, others: &[] };
    model.driven_nm(&sample, asked(model, chain, own, &[]), k_tilde).torque_nm / model.joint.transmission()
}
