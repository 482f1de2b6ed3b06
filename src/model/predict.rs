//! The prediction: the paper's model as one formula, never using the measured torque.
//!
//! The load term of (15) uses the cable's own tension (r1 T0 = y), so (4) is solved for y:
//!
//! y = [ (r1/r2) (G + M a) + Bd + K~ (Bu - Bd) ] / ( 1 - mu_down - K~ (mu_up - mu_down) )
//!
//! with Bu, Bd the unloaded parts of the two branches (`Friction::unloaded_nm`). At K~ = 1 and 0 this is (17) with A and
//! B of each direction.

use super::{Direction, Model};

/// What the model makes of one sample, all as torques at the winch, N m.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Components {
    /// y, the predicted signal.
    pub torque_nm: f64,
    /// (r1/r2) times the rigid-body torque: what the winch would see without friction.
    pub rigid_nm: f64,
    /// The rest: friction.
    pub friction_nm: f64,
}

impl Model {
    /// y for a rigid-body torque `joint_torque_nm` at the joint (gravity, inertia, measured load), at `velocity_rad_s` and
    /// with friction combined by `k_tilde`.
    pub fn torque_nm(&self, joint_torque_nm: f64, velocity_rad_s: f64, k_tilde: f64) -> Components {
        let (r1, r2) = (self.joint.winch_radius_m, self.joint.pulley_radius_m);
        let up = self.friction.up.unloaded_nm(Direction::Up, velocity_rad_s, r1, r2);
        let down = self.friction.down.unloaded_nm(Direction::Down, velocity_rad_s, r1, r2);
        let (mu_up, mu_down) = (self.friction.up.mu_c, self.friction.down.mu_c);
        let rigid_nm = self.joint.transmission() * joint_torque_nm;
        let loss = 1.0 - mu_down - k_tilde * (mu_up - mu_down);
        let torque_nm = (rigid_nm + down + k_tilde * (up - down)) / loss;
        Components { torque_nm, rigid_nm, friction_nm: torque_nm - rigid_nm }
    }
}
