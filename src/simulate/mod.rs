//! A joint driven along a prescribed motion, as its log would show it.

mod campaign;

pub use campaign::{Plan, PlannedTrial};

use crate::model::{Direction, Model, Transition};
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

/// Samples of a motion: what a log would hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Time from the start, s.
    pub time_s: Vec<f64>,
    /// Position as measured, rad.
    pub position_rad: Vec<f64>,
    /// y as measured, N m; the log holds it times the campaign's torque sign.
    pub torque_nm: Vec<f64>,
}

/// The torque of `model` along `positions_rad`, `rate_hz` a second, without any sensor: y, N m.
pub fn torque_nm(model: &Model, positions_rad: &[f64], rate_hz: f64) -> Vec<f64> {
    let speeds = velocity(positions_rad, rate_hz);
    let accelerations = acceleration(positions_rad, rate_hz);
    let Some(first) = positions_rad.first() else { return Vec::new() };
    let start = match positions_rad.iter().find(|x| **x != *first) {
        Some(x) if x < first => Direction::Down,
        _ => Direction::Up,
    };
    let mut transition = Transition::after(start, *first);
    let backlash_rad = model.joint.backlash_rad();
    positions_rad
        .iter()
        .zip(&speeds)
        .zip(&accelerations)
        .map(|((x, v), a)| {
            let k_tilde = transition.step(*x, &model.combination, backlash_rad, 0.0);
            let rigid_nm = model.dynamics.gravity_nm(model.joint.kind, *x) + model.dynamics.inertia_kg_m2 * a;
            model.torque_nm(rigid_nm, *v, k_tilde).torque_nm
        })
        .collect()
}

/// The same as recorded by `sensors`, repeatable by `seed`.
pub fn record(model: &Model, positions_rad: &[f64], rate_hz: f64, sensors: Sensors, seed: u64) -> Recording {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    // A spread that is not finite or negative gives no noise rather than no simulation; the command line refuses it.
    let noise = Normal::new(0.0, sensors.torque_noise_nm).ok();
    let count_rad = std::f64::consts::TAU / sensors.encoder_counts;
    let measured = |x: &f64| if sensors.encoder_counts > 0.0 { (x / count_rad).round() * count_rad } else { *x };
    let torque = torque_nm(model, positions_rad, rate_hz);
    Recording {
        time_s: (0..positions_rad.len()).map(|i| i as f64 / rate_hz).collect(),
        position_rad: positions_rad.iter().map(measured).collect(),
        torque_nm: torque.iter().map(|y| y + noise.map_or(0.0, |n| n.sample(&mut random))).collect(),
    }
}
