//! The torque that a chain's own mass asks of the joint, along a recorded motion.

use super::Trial;
use crate::dynamics::{Motion, RigidTorque};
use crate::log::{Arm, Place};
use crate::numerics::difference::{acceleration_at, velocity_at};
use crate::numerics::filter::LowPass;

/// M a + C v + G of `arm`'s joint and the slope of G over its position, N m/rad, at each sample of `trial`.
pub(super) fn along(arm: &Arm, trial: &Trial) -> Vec<(RigidTorque, f64)> {
    let place = |place: &Place, i: usize| match place {
        Place::Held(position) => Motion { position: *position, ..Motion::default() },
        Place::Column(column) => trial.others[*column][i],
    };
    let mut moved = vec![Motion::default(); arm.others.len()];
    (0..trial.position_rad.len())
        .map(|i| {
            moved.iter_mut().zip(&arm.others).for_each(|(slot, other)| *slot = place(other, i));
            let joint = trial.motion(i);
            (arm.chain.torque(joint, &moved), arm.chain.gravity_slope_nm_rad(joint.position, &moved))
        })
        .collect()
}

/// Another joint's motion: its `recorded` positions through the same `filter`, differentiated.
pub(super) fn moving(recorded: &[f64], filter: &LowPass, rate_hz: f64) -> Vec<Motion> {
    let positions = filter.zero_phase(recorded);
    let motion = |at: usize| Motion {
        position: positions[at],
        velocity: velocity_at(&positions, rate_hz, at),
        acceleration: acceleration_at(&positions, rate_hz, at),
    };
    (0..positions.len()).map(motion).collect()
}
