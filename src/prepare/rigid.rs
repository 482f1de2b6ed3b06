//! The torque that a chain's own mass asks of the joint, along a recorded motion.

use crate::dynamics::{Motion, RigidTorque};
use crate::log::{Arm, Place};
use crate::numerics::difference::{acceleration, velocity};
use crate::numerics::filter::LowPass;

/// M a + C v + G of `arm`'s joint, sample by sample; `own` is its filtered position, velocity and acceleration, `recorded` the
/// other joints' positions as recorded, which pass through the same `filter`.
pub(super) fn along(
    arm: &Arm,
    own: [&[f64]; 3],
    recorded: &[Vec<f64>],
    filter: &LowPass,
    rate_hz: f64,
) -> Vec<RigidTorque> {
    let others: Vec<Box<dyn Fn(usize) -> Motion>> = arm
        .others
        .iter()
        .map(|place| -> Box<dyn Fn(usize) -> Motion> {
            match place {
                Place::Held(position) => {
                    let still = Motion { position: *position, ..Motion::default() };
                    Box::new(move |_| still)
                }
                Place::Column(column) => {
                    let positions = filter.zero_phase(&recorded[*column]);
                    let (speeds, accelerations) = (velocity(&positions, rate_hz), acceleration(&positions, rate_hz));
                    Box::new(move |i| motion([&positions[..], &speeds, &accelerations], i))
                }
            }
        })
        .collect();
    let mut moved = vec![Motion::default(); others.len()];
    (0..own[0].len())
        .map(|i| {
            moved.iter_mut().zip(&others).for_each(|(slot, other)| *slot = other(i));
            arm.chain.torque(motion(own, i), &moved)
        })
        .collect()
}

fn motion([position, velocity, acceleration]: [&[f64]; 3], at: usize) -> Motion {
    Motion { position: position[at], velocity: velocity[at], acceleration: acceleration[at] }
}
