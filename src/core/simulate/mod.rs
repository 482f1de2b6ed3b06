//! A joint driven along a prescribed motion, as its log would show it.

mod campaign;
mod closed;
mod contacts;
mod course;
mod driven;
mod log;
mod plan;
mod planned;
mod wander;

pub use closed::{Controller, Load, Machine, Wanted};
pub use course::Course;
pub use plan::{Plan, PlannedTrial, SimulatedArm};

use crate::dynamics::Chain;
use crate::effects::Evaluated;
use crate::model::Model;
use course::Motions;
use planned::Made;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// What the sensors add to the truth, beside the faults that the model holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensors {
    /// Standard deviation of white noise on the torque, N m.
    pub torque_noise_nm: f64,
    /// Counts of the encoder per revolution; 0 leaves the position exact.
    pub encoder_counts: f64,
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

/// What a sensor without noise reads of `model` along `positions_rad`, `rate_hz` a second, moving alone: y, N m.
pub fn torque_nm(model: &Model, positions_rad: &[f64], rate_hz: f64) -> Vec<f64> {
    let course = Course { position_rad: positions_rad.to_vec(), ..Course::default() };
    readings_along(model, None, &course, rate_hz)
}

/// The same along `course`, N m: over any number, to be differentiated; `chain` takes the place of the model's own gravity and inertia.
pub fn readings_along<S: Evaluated<Given = f64>>(
    model: &Model<S>,
    chain: Option<&Chain>,
    course: &Course,
    rate_hz: f64,
) -> Vec<S> {
    let motions = Motions::new(course, rate_hz);
    readings_nm(model, &motions, driven::torque_nm(model, chain, course, &motions), || 0.0)
}

/// `course` as recorded by `sensors`, repeatable by `seed`; `chain` takes the place of the model's own gravity and inertia.
pub fn record(
    model: &Model,
    chain: Option<&Chain>,
    course: &Course,
    rate_hz: f64,
    sensors: Sensors,
    seed: u64,
) -> Recording {
    let torque_nm = driven::torque_nm(model, chain, course, &Motions::new(course, rate_hz));
    recorded(model, course, torque_nm, rate_hz, sensors, seed)
}

/// `course` with `torque_nm` at the winch as recorded by `sensors`.
fn recorded(
    model: &Model,
    course: &Course,
    torque_nm: Vec<f64>,
    rate_hz: f64,
    sensors: Sensors,
    seed: u64,
) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    // A spread that is not finite or negative gives no noise rather than no simulation; the command line refuses it.
    let noise = Normal::new(0.0, sensors.torque_noise_nm).ok();
    let count_rad = std::f64::consts::TAU / sensors.encoder_counts;
    let measured = |x: &f64| if sensors.encoder_counts > 0.0 { (x / count_rad).round() * count_rad } else { *x };
    let motions = Motions::new(course, rate_hz);
    let noise_nm = || noise.map_or(0.0, |n| n.sample(&mut random));
    Recording {
        time_s: (0..course.position_rad.len()).map(|i| i as f64 / rate_hz).collect(),
        position_rad: course.position_rad.iter().map(measured).collect(),
        others_rad: course.others_rad.iter().map(|other| other.iter().map(measured).collect()).collect(),
        torque_nm: readings_nm(model, &motions, torque_nm, noise_nm),
    }
}

/// The sensor's readings of `torque_nm`: delay, scale, offset, noise, then clipping.
fn readings_nm<S: Evaluated<Given = f64>>(
    model: &Model<S>,
    motions: &Motions,
    torque_nm: Vec<S>,
    mut noise_nm: impl FnMut() -> f64,
) -> Vec<S> {
    let late_nm = model.late_nm(torque_nm, motions.rate_hz);
    let mut others = Vec::with_capacity(motions.others.len());
    let reading = |(i, y): (usize, S)| model.noisy_reading_nm(&motions.sample(i, &mut others), y, S::from(noise_nm()));
    late_nm.into_iter().enumerate().map(reading).collect()
}
