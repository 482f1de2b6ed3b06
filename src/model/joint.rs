//! The joint's geometry.

use crate::dynamics::JointKind;

/// What a ruler tells of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// r1, m.
    pub winch_radius_m: f64,
    /// r2, m.
    pub pulley_radius_m: f64,
    /// X_cl, the clearance as displacement on the cable, m.
    pub backlash_m: f64,
}

impl Joint {
    /// r1 / r2: a torque at the joint times this is a torque at the winch.
    pub fn transmission(&self) -> f64 {
        self.winch_radius_m / self.pulley_radius_m
    }

    /// The joint travel that takes up the clearance, X_cl / r2, rad.
    pub fn backlash_rad(&self) -> f64 {
        self.backlash_m / self.pulley_radius_m
    }
}
