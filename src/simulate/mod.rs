//! A joint driven along a prescribed motion, as its log would show it.

mod campaign;
mod contacts;

pub use campaign::{Plan, PlannedTrial, SimulatedArm};

use crate::dynamics::{Chain, Motion};
use crate::effects::Sample;
use crate::model::{Asked, Direction, Model, Passage};
use crate::numerics::difference::{acceleration, velocity};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// What the sensors add to the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// Standard deviation of white noise on the torque, N m.
    pub torque_noise_nm: f64,
    /// Counts of the encoder per revolution; 0 leaves the position exact.
    pub encoder_counts: f64,
}

/// What happens in a trial, sample by sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Course {
    /// Position of the joint, rad.
    pub position_rad: Vec<f64>,
    /// Positions of a chain's other joints, in their order, rad or m.
    pub others_rad: Vec<Vec<f64>>,
    /// What a person adds at the winch, N m; nothing where empty.
    pub contact_nm: Vec<f64>,
    /// When the trial begins, s since the campaign did.
    pub began_s: f64,
}

/// Samples of a motion: what a log would hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Time from the start, s.
    pub time_s: Vec<f64>,
    /// Position as measured, rad.
    pub position_rad: Vec<f64>,
    /// Positions of the other joints as measured, rad or m.
    pub others_rad: Vec<Vec<f64>>,
    /// y as measured, N m; the log holds it times the campaign's torque sign.
    pub torque_nm: Vec<f64>,
}

/// The torque of `model` along `positions_rad`, `rate_hz` a second, moving alone and without any sensor: y, N m.
pub fn torque_nm(model: &Model, positions_rad: &[f64], rate_hz: f64) -> Vec<f64> {
    let course = Course { position_rad: positions_rad.to_vec(), ..Course::default() };
    course_torque_nm(model, None, &course, rate_hz)
}

/// y along `course`, N m; `chain` takes the place of the model's own gravity and inertia.
pub fn course_torque_nm(model: &Model, chain: Option<&Chain>, course: &Course, rate_hz: f64) -> Vec<f64> {
    let own = moving(&course.position_rad, rate_hz);
    let others: Vec<Vec<Motion>> = course.others_rad.iter().map(|positions| moving(positions, rate_hz)).collect();
    let Some(first) = own.first() else { return Vec::new() };
    let start = match own.iter().find(|m| m.position != first.position) {
        Some(m) if m.position < first.position => Direction::Down,
        _ => Direction::Up,
    };
    let mut passage = Passage::after(model, start, first.position, 0.0);
    let mut moved = vec![Motion::default(); others.len()];
    let torque = |(i, motion): (usize, &Motion)| {
        moved.iter_mut().zip(&others).for_each(|(slot, other)| *slot = other[i]);
        let asked = asked(model, chain, *motion, &moved);
        let time_s = i as f64 / rate_hz;
        let sample = Sample { time_s, elapsed_s: course.began_s + time_s, own: *motion, others: &moved };
        let k_tilde = passage.step(motion.position, motion.velocity);
        let contact_nm = course.contact_nm.get(i).copied().unwrap_or(0.0);
        model.driven_nm(&sample, asked, k_tilde).torque_nm + contact_nm
    };
    own.iter().enumerate().map(torque).collect()
}

/// What mass asks of the joint.
fn asked(model: &Model, chain: Option<&Chain>, own: Motion, others: &[Motion]) -> Asked {
    let (kind, dynamics) = (model.joint.kind, &model.dynamics);
    match chain {
        Some(chain) => Asked { torque_nm: chain.torque(own, others).total_nm(), slope_nm_rad: 0.0 },
        None => Asked {
            torque_nm: dynamics.gravity_nm(kind, own.position) + dynamics.inertia_kg_m2 * own.acceleration,
            slope_nm_rad: dynamics.gravity_slope_nm_rad(kind, own.position),
        },
    }
}

fn moving(positions: &[f64], rate_hz: f64) -> Vec<Motion> {
    let (speeds, accelerations) = (velocity(positions, rate_hz), acceleration(positions, rate_hz));
    let motion = |((position, velocity), acceleration): ((&f64, f64), f64)| Motion {
        position: *position,
        velocity,
        acceleration,
    };
    positions.iter().zip(speeds).zip(accelerations).map(motion).collect()
}

/// The same as recorded by `sensors`, repeatable by `seed`.
pub fn record(
    model: &Model,
    chain: Option<&Chain>,
    course: &Course,
    rate_hz: f64,
    sensors: Sensors,
    seed: u64,
) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    // A spread that is not finite or negative gives no noise rather than no simulation; the command line refuses it.
    let noise = Normal::new(0.0, sensors.torque_noise_nm).ok();
    let count_rad = std::f64::consts::TAU / sensors.encoder_counts;
    let measured = |x: &f64| if sensors.encoder_counts > 0.0 { (x / count_rad).round() * count_rad } else { *x };
    let torque = course_torque_nm(model, chain, course, rate_hz);
    Recording {
        time_s: (0..course.position_rad.len()).map(|i| i as f64 / rate_hz).collect(),
        position_rad: course.position_rad.iter().map(measured).collect(),
        others_rad: course.others_rad.iter().map(|other| other.iter().map(measured).collect()).collect(),
        torque_nm: torque.iter().map(|y| y + noise.map_or(0.0, |n| n.sample(&mut random))).collect(),
    }
}
