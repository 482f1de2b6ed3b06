//! Where friction stands between its branches along a motion.

use crate::model::{Model, Passage, STABLE_K_F, settle};
use crate::prepare::Trial;

/// K~ and its like for every sample of a trial.
#[derive(Debug, Clone)]
pub struct States {
    /// K~: 0 on `down`, 1 on `up`.
    pub k_tilde: Vec<f64>,
    /// K_f: -1 on `down`, 1 on `up`.
    pub k_f: Vec<f64>,
    /// The first sample at which K_f is known; before, it depends on what went before the log.
    pub known_from: usize,
}

impl States {
    /// Whether friction is fully on one branch at sample `at`: |K_f| = 1.
    pub fn is_stable(&self, at: usize) -> bool {
        self.k_f[at].abs() >= STABLE_K_F
    }
}

/// Periods of the low-pass after which it has forgotten what it was fed before: a wrong branch, 1 N m off, then shows by less than
/// 5 mN m (the slowest pole of the 4th order decays as exp(-0.38 2 pi t) in periods).
const FORGOTTEN_PERIODS: f64 = 2.5;

/// Samples at `rate_hz` after which a low-pass at `lowpass_hz` has forgotten what it was fed before K_f was known.
pub fn forgotten(rate_hz: f64, lowpass_hz: f64) -> usize {
    (FORGOTTEN_PERIODS / lowpass_hz * rate_hz) as usize
}

/// The states of `trial` under `model`'s clearance and curve.
///
/// K_f follows the position as recorded, or as reconstructed from the jumps of a coarse encoder: a filtered one would ring at corners. With
/// `Sign` K~ follows the direction alone, as (20) has it; K_f still says where a transition through the clearance would be.
pub fn states(model: &Model, trial: &Trial) -> States {
    let positions = trial.followed_rad();
    let backlash_rad = model.backlash_m() / model.joint.pulley_radius_m;
    let (direction, known_from) = settle(positions, backlash_rad, trial.deadband_rad);
    let start_rad = positions.first().copied().unwrap_or(0.0);
    let mut state = Passage::after(model, direction, start_rad, trial.deadband_rad);
    let (mut k_tilde, mut k_f) = (Vec::with_capacity(positions.len()), Vec::with_capacity(positions.len()));
    let moving = trial.directions(&trial.turns());
    for (i, x) in positions.iter().enumerate() {
        k_tilde.push(state.step(*x, Some(moving[i])));
        k_f.push(state.k_f());
    }
    States { k_tilde, k_f, known_from }
}
