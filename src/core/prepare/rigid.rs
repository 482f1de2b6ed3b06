//! The torque that a chain's own mass asks of the joint, along a recorded motion.

use super::Trial;
use crate::dynamics::{Chain, Motion, RigidTorque};
use crate::log::Place;
use crate::numerics::difference::{acceleration_at, velocity_at};
use crate::numerics::filter::LowPass;

/// M a + C v + G of `chain`'s joint and the slope of G over its position, N m/rad, at the samples `at` of `trial`; `places` says where
/// each of its other joints stands.
pub fn along<'a>(
    chain: &'a Chain,
    places: &'a [Place],
    trial: &'a Trial,
    at: impl Iterator<Item = usize> + 'a,
) -> impl Iterator<Item = (RigidTorque, f64)> + 'a {
    let place = |place: &Place, i: usize| match place {
        Place::Held(position) => Motion { position: *position, ..Motion::default() },
        Place::Column(column) => trial.others[*column][i],
    };
    let mut moved = vec![Motion::default(); places.len()];
    at.map(move |i| {
        moved.iter_mut().zip(places).for_each(|(slot, other)| *slot = place(other, i));
        let joint = trial.motion(i);
        (chain.torque(joint, &moved), chain.gravity_slope_nm_rad(joint.position, &moved))
    })
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
