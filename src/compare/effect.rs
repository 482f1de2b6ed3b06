//! What a change of parameters amounts to: friction at some speeds, and the torque predicted along the paper's motions.

use super::functions::known_nm;
use crate::model::{Direction, Model};
use crate::numerics::statistics::root_mean_square;
use crate::simulate::torque_nm;
use crate::trajectory::Trajectory;

/// Speeds at which friction is compared, rad/s: those of the paper's sweeps from the slowest to the fastest.
pub(super) const REFERENCE_SPEEDS_RAD_S: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 0.4];
/// Samples a second of the motions compared: enough for their fastest period of 1.6 s.
const RATE_HZ: f64 = 200.0;

/// Friction without load, B(v), at one speed in one direction, N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Level {
    /// Where the motion goes.
    pub direction: Direction,
    /// Its speed, rad/s.
    pub speed_rad_s: f64,
    /// Before.
    pub before_nm: f64,
    /// After.
    pub after_nm: f64,
}

/// The predicted torque along the paper's cosine cascade: after less before.
#[derive(Debug, Clone, PartialEq)]
pub struct Effect {
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Predicted before, N m.
    pub before_nm: Vec<f64>,
    /// Predicted after, N m.
    pub after_nm: Vec<f64>,
    /// RMS of the difference, N m.
    pub rms_nm: f64,
    /// Its mean, N m: a level that a tare would take away.
    pub mean_nm: f64,
    /// Its largest magnitude, N m.
    pub peak_nm: f64,
    /// RMS that the intervals of A and B(v) of both models may make of it, 95 %, N m; infinite where one of them is open.
    pub explained_nm: f64,
}

impl Effect {
    pub(super) fn new(before: &Model, after: &Model) -> Self {
        let positions_rad = Trajectory::cascade().on(before.joint.kind).positions_rad(RATE_HZ);
        let (before_nm, after_nm) =
            (torque_nm(before, &positions_rad, RATE_HZ), torque_nm(after, &positions_rad, RATE_HZ));
        let difference: Vec<f64> = after_nm.iter().zip(&before_nm).map(|(b, a)| b - a).collect();
        Self {
            time_s: (0..positions_rad.len()).map(|i| i as f64 / RATE_HZ).collect(),
            rms_nm: root_mean_square(&difference),
            explained_nm: known_nm(before, &positions_rad, RATE_HZ).hypot(known_nm(after, &positions_rad, RATE_HZ)),
            mean_nm: crate::numerics::statistics::mean(&difference),
            peak_nm: difference.iter().fold(0.0, |peak: f64, y| peak.max(y.abs())),
            before_nm,
            after_nm,
        }
    }
}

/// B(v) at `speeds_rad_s`, `up` first.
pub(super) fn levels(before: &Model, after: &Model, speeds_rad_s: &[f64]) -> Vec<Level> {
    let level = |direction, speed_rad_s| Level {
        direction,
        speed_rad_s,
        before_nm: before.b_nm(direction, speed_rad_s),
        after_nm: after.b_nm(direction, speed_rad_s),
    };
    Direction::BOTH.into_iter().flat_map(|d| speeds_rad_s.iter().map(move |v| level(d, *v))).collect()
}
