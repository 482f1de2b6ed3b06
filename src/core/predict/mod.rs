//! A model's prediction along a recorded motion: y and its terms, sample by sample, at the log's full rate.
//!
//! The prediction never uses the measured torque. All torques are as the sensor at the winch sees them, so that gravity,
//! inertia, Coriolis, load and friction add up to y.

mod state;

pub use state::{States, forgotten, states};

use crate::model::{Combination, Model};
use crate::prepare::Trial;

/// y and its parts, N m at the winch, none of them low-passed.
#[derive(Debug, Clone)]
pub struct Prediction {
    /// y.
    pub torque_nm: Vec<f64>,
    /// (r1/r2) G.
    pub gravity_nm: Vec<f64>,
    /// (r1/r2) M a.
    pub inertia_nm: Vec<f64>,
    /// (r1/r2) C v; zero for a joint moving alone.
    pub coriolis_nm: Vec<f64>,
    /// (r1/r2) times the measured load; zero where none is recorded.
    pub load_nm: Vec<f64>,
    /// What is left: friction, that of the load included.
    pub friction_nm: Vec<f64>,
    /// Where friction stands between its branches.
    pub states: States,
}

impl Prediction {
    /// Of `trial` by `model`.
    pub fn new(model: &Model, trial: &Trial) -> Self {
        let (torque_nm, states) = torque_nm(model, trial);
        let n = torque_nm.len();
        let mut made = Self {
            torque_nm,
            gravity_nm: Vec::with_capacity(n),
            inertia_nm: Vec::with_capacity(n),
            coriolis_nm: Vec::with_capacity(n),
            load_nm: Vec::with_capacity(n),
            friction_nm: Vec::new(),
            states,
        };
        let transmission = model.joint.transmission();
        for i in 0..n {
            let rigid = trial.rigid(i, model.joint.kind, &model.dynamics);
            made.gravity_nm.push(transmission * rigid.gravity_nm);
            made.inertia_nm.push(transmission * rigid.inertia_nm);
            made.coriolis_nm.push(transmission * rigid.coriolis_nm);
            made.load_nm.push(transmission * trial.load_nm(i));
        }
        let rigid_nm = |i: usize| made.gravity_nm[i] + made.inertia_nm[i] + made.coriolis_nm[i] + made.load_nm[i];
        made.friction_nm = (0..n).map(|i| made.torque_nm[i] - rigid_nm(i)).collect();
        made
    }
}

/// y of `trial` by `model` alone, N m, not low-passed, and where friction stands.
pub fn torque_nm(model: &Model, trial: &Trial) -> (Vec<f64>, States) {
    let states = states(model, trial);
    let mut others = Vec::with_capacity(trial.others.len());
    let driven_nm = |(i, k_tilde): (usize, &f64)| {
        let asked = trial.asked(i, model.joint.kind, &model.dynamics);
        model.driven_nm(&trial.sample(i, &mut others), asked, *k_tilde).torque_nm
    };
    let mut torque_nm: Vec<f64> = states.k_tilde.iter().enumerate().map(driven_nm).collect();
    read(model, trial, &mut torque_nm);
    (torque_nm, states)
}

/// Applies the sensor's errors to the torque along `trial`, in place: delay, scale, offset, clipping.
fn read(model: &Model, trial: &Trial, torque_nm: &mut Vec<f64>) {
    if model.effects.is_empty() {
        return;
    }
    *torque_nm = model.late_nm(std::mem::take(torque_nm), trial.log.rate_hz);
    let mut others = Vec::with_capacity(trial.others.len());
    for (i, y) in torque_nm.iter_mut().enumerate() {
        *y = model.reading_nm(&trial.sample(i, &mut others), *y);
    }
}

/// y of `trial` by `model` with another `curve` and clearance, N m: what changes when only the combination does.
pub fn with_curve(model: &Model, curve: &Combination, backlash_m: f64, trial: &Trial) -> Vec<f64> {
    let mut changed = model.clone();
    changed.joint.backlash_m = backlash_m;
    changed.combination = *curve;
    changed.effects.retain(|e| e.effect.curve(&e.parameters).is_none());
    torque_nm(&changed, trial).0
}
