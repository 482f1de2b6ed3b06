//! What mass does: gravity and inertia of one joint moving alone, or of a chain of bodies.

mod chain;
mod direction;
mod payload;
mod urdf;

use crate::numerics::scalar::Scalar;
pub use chain::{Chain, GRAVITY_M_S2, Motion, RigidTorque};
pub use direction::{AT_REST_RAD_S, Both, Direction};
pub use payload::{INERTIA, NUMBERS, Payload};

/// How the joint moves. For a prismatic joint the `_rad` quantities hold metres and the `_nm` quantities newtons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum JointKind {
    /// Turns: position in rad, torque in N m.
    #[default]
    Revolute,
    /// Slides: position in m, force in N, both radii 1.
    Prismatic,
}

impl JointKind {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
        }
    }

    /// Unit of its torque.
    pub fn torque_unit(self) -> &'static str {
        match self {
            Self::Revolute => "N m",
            Self::Prismatic => "N",
        }
    }

    /// Gravity at `position_rad` as a share of the joint's largest, and how that changes with the position, 1/rad.
    pub fn gravity_share<S: Scalar>(self, position_rad: S) -> (S, S) {
        match self {
            Self::Revolute => position_rad.sin_cos(),
            Self::Prismatic => (S::from(1.0), S::from(0.0)),
        }
    }

    /// The unit of its speed inside the program.
    pub fn speed_unit(self) -> &'static str {
        match self {
            Self::Revolute => "rad/s",
            Self::Prismatic => "m/s",
        }
    }
}

/// Rigid-body parameters of one joint moving alone.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Dynamics<S = f64> {
    /// Gravity torque about the joint at theta = 90 deg, N m (M3 g r3x in (17)); for a prismatic joint the constant force, N.
    pub gravity_nm: S,
    /// Inertia about the joint, kg m^2; for a prismatic joint the moving mass, kg.
    pub inertia_kg_m2: S,
    /// Error of the position's zero, rad: a revolute joint is at its reading plus this. Always 0 for a prismatic joint.
    pub position_zero_rad: S,
    /// What the last link of a chain carries beyond what the URDF says; nothing where the joint moves alone.
    pub payload: Payload<S>,
}

impl<S: Scalar> Dynamics<S> {
    /// G and dG/dq (N m, N m/rad) computed at the position as read -> both where the joint is.
    ///
    /// The gravity torque about a revolute joint is a sinusoid of its own angle whatever the chain, G(q) = a sin(q) + b cos(q):
    /// therefore G(q + z) = G(q) cos(z) + G'(q) sin(z) exactly.
    pub fn at_true_position(&self, gravity_nm: S, slope_nm_rad: S) -> (S, S) {
        if self.position_zero_rad.is_zero() {
            return (gravity_nm, slope_nm_rad);
        }
        let (sin, cos) = self.position_zero_rad.sin_cos();
        (gravity_nm * cos + slope_nm_rad * sin, slope_nm_rad * cos - gravity_nm * sin)
    }

    /// dG/dq at the joint, N m/rad.
    pub fn gravity_slope_nm_rad(&self, kind: JointKind, position_rad: S::Given) -> S {
        self.gravity_nm * kind.gravity_share(position_rad + self.position_zero_rad).1
    }

    /// G at the joint, N m: zero when a revolute joint hangs at theta = 0.
    pub fn gravity_nm(&self, kind: JointKind, position_rad: S::Given) -> S {
        self.gravity_nm * kind.gravity_share(position_rad + self.position_zero_rad).0
    }
}
