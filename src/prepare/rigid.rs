//! The torque that a chain's own mass asks of the joint, along a recorded motion.

use crate::dynamics::{Motion, RigidTorque};
use crate::log::{Arm, Place};
use crate::numerics::difference::{acceleration, velocity};
use crate::numerics::filter::LowPass;

/// M a + C v + G of `arm`'s joint and the slope of G over its position, N m/rad, sample by sample; `own` is its filtered
/// position, velocity and acceleration, `others` are the recorded joints.
pub(super) fn along(arm: &Arm, own: [&[f64]; 3], others: &[Vec<Motion>]) -> Vec<(RigidTorque, f64)> {
    let place = |place: &Place, i: usize| match place {
        Place::Held(position) => Motion { position: *position, ..Motion::default() },
        Place::Column(column) => others[*column][i],
    };
    let mut moved = vec![Motion::default(); arm.others.len()];
    (0..own[0].len())
        .map(|i| {
            moved.iter_mut().zip(&arm.others).for_each(|(slot, other)| *slot = place(other, i));
            let joint = Motion { position: own[0][i], velocity: own[1][i], acceleration: own[2][i] };
            (arm.chain.torque(joint, &moved), arm.chain.gravity_slope_nm_rad(joint.position, &moved))
        })
        .collect()
}

/// Another joint's motion: its `recorded` positions through the same `filter`, differentiated.
pub(super) fn moving(recorded: &[f64], filter: &LowPass, rate_hz: f64) -> Vec<Motion> {
    let positions = filter.zero_phase(recorded);
    let (speeds, accelerations) = (velocity(&positions, rate_hz), acceleration(&positions, rate_hz));
    let motion = |((position, velocity), acceleration)| Motion { position, velocity, acceleration };
    positions.into_iter().zip(speeds).zip(accelerations).map(motion).collect()
}
