//! What a joint's quantities are called in text, and in which units.

use crate::dynamics::JointKind;
use crate::model::Joint;
use std::f64::consts::PI;

/// The units in which a joint's quantities are told, each with what an SI value is multiplied by.
pub struct Measures {
    /// Of an angle or a length.
    pub position: (&'static str, f64),
    /// Of a speed.
    pub speed: (&'static str, f64),
    /// Of an acceleration.
    pub acceleration: (&'static str, f64),
    /// What the sensor reads.
    pub load: &'static str,
    /// What a simulator gives in its place.
    pub simulated_load: &'static str,
    /// Of either.
    pub torque: (&'static str, f64),
}

impl Measures {
    /// Those of `joint`.
    pub fn of(joint: &Joint) -> Self {
        let (position, speed, acceleration) = match joint.kind {
            JointKind::Revolute => (("deg", 180.0 / PI), ("rad/s", 1.0), ("rad/s^2", 1.0)),
            JointKind::Prismatic => (("mm", 1e3), ("mm/s", 1e3), ("m/s^2", 1.0)),
        };
        let (load, simulated_load, torque) = match joint.reads_force() {
            true => ("force", "simulated force", ("N", 1.0)),
            false => ("torque", "simulated torque", ("N m", 1.0)),
        };
        Self { position, speed, acceleration, load, simulated_load, torque }
    }
}
