//! What can change between two models of one joint, and by how much it did.

use crate::model::Direction;

/// One thing that changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Cause {
    /// What.
    pub kind: CauseKind,
    /// Moving where; `None` of what concerns both directions.
    pub direction: Option<Direction>,
    /// By how much, as `measure` says; viscous friction at the fastest speed, Stribeck friction at the slowest.
    pub change: f64,
    /// 95 % interval of the change.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
    /// What the change is measured in.
    pub measure: Measure,
    /// What would explain it as well.
    pub rivals: Vec<(CauseKind, Option<Direction>)>,
}

/// What a change is measured in.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Measure {
    /// A share of what was, dimensionless.
    Share,
    /// A share of A and B(v), which both go as 1 / (1 - mu_c) (18), (19).
    Load {
        /// mu_c before, dimensionless.
        mu_c: f64,
    },
    /// Torque at the sensor, N m, beside the largest friction before, N m; 0 of what is no friction.
    Torque {
        /// That friction.
        before_nm: f64,
    },
    /// An angle, rad.
    Angle,
}

/// What can change.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CauseKind {
    /// Friction that does not depend on speed, as by tension.
    Coulomb,
    /// Friction that grows with speed.
    Viscous,
    /// Friction of low speeds.
    Stribeck,
    /// Friction per load carried.
    LoadCoefficient,
    /// The scale of everything: the sensor's gain, or the load coefficient of both directions.
    Gain,
    /// What hangs on the joint, or a spring about it.
    Gravity,
    /// A torque that depends on nothing: the sensor's tare, or a constant load.
    Offset,
    /// The travel over which friction changes over after a reversal: clearance, or the curve's p or n.
    ChangeOver,
    /// The zero of the position.
    Zero,
}

impl CauseKind {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coulomb => "coulomb_friction",
            Self::Viscous => "viscous_friction",
            Self::Stribeck => "stribeck_friction",
            Self::LoadCoefficient => "friction_per_load",
            Self::Gain => "gain_or_load_coefficient",
            Self::Gravity => "gravity_or_spring",
            Self::Offset => "torque_offset",
            Self::ChangeOver => "change_over",
            Self::Zero => "position_zero",
        }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Coulomb => "Coulomb friction",
            Self::Viscous => "viscous friction",
            Self::Stribeck => "Stribeck friction",
            Self::LoadCoefficient => "load coefficient",
            Self::Gain => "scale of friction and load alike (sensor gain, or load coefficient in both directions)",
            Self::Gravity => "load that follows position (gravity, or a spring)",
            Self::Offset => "torque offset (the sensor's zero, or a constant load)",
            Self::ChangeOver => "travel of the change-over after a reversal",
            Self::Zero => "zero of the position",
        }
    }

    /// The parameters that it shows in.
    pub fn parameters(self) -> &'static [&'static str] {
        match self {
            Self::Coulomb => &["a_j"],
            Self::Viscous => &["d"],
            Self::Stribeck => &["b_c", "c_c", "b_j", "c_j"],
            Self::LoadCoefficient | Self::Gain | Self::Gravity => &["mu_c"],
            Self::Offset => &[],
            Self::ChangeOver => &["combination.p", "combination.n", "joint.backlash_m"],
            Self::Zero => &["dynamics.position_zero_rad"],
        }
    }
}
