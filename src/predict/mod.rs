//! What a model makes of a recorded motion: y and its parts, sample by sample, at the log's full rate.
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
        let states = states(model, &model.combination, trial);
        let n = trial.torque_nm.len();
        let mut made = Self {
            torque_nm: Vec::with_capacity(n),
            gravity_nm: Vec::with_capacity(n),
            inertia_nm: Vec::with_capacity(n),
            coriolis_nm: Vec::with_capacity(n),
            load_nm: Vec::with_capacity(n),
            friction_nm: Vec::with_capacity(n),
            states,
        };
        let transmission = model.joint.transmission();
        for i in 0..n {
            let rigid = trial.rigid(i, model.joint.kind, &model.dynamics);
            let load_nm = trial.load_nm(i);
            let all = model.torque_nm(rigid.total_nm() + load_nm, trial.velocity_rad_s[i], made.states.k_tilde[i]);
            made.torque_nm.push(all.torque_nm);
            made.gravity_nm.push(transmission * rigid.gravity_nm);
            made.inertia_nm.push(transmission * rigid.inertia_nm);
            made.coriolis_nm.push(transmission * rigid.coriolis_nm);
            made.load_nm.push(transmission * load_nm);
            made.friction_nm.push(all.friction_nm);
        }
        made
    }
}

/// y of `trial` by `model` with another `curve` and clearance, N m: what changes when only the combination does.
pub fn with_curve(model: &Model, curve: &Combination, backlash_m: f64, trial: &Trial) -> Vec<f64> {
    let mut changed = model.clone();
    changed.joint.backlash_m = backlash_m;
    let states = states(&changed, curve, trial);
    let torque = |i: usize| {
        let rigid = trial.rigid(i, model.joint.kind, &model.dynamics).total_nm() + trial.load_nm(i);
        model.torque_nm(rigid, trial.velocity_rad_s[i], states.k_tilde[i]).torque_nm
    };
    (0..trial.torque_nm.len()).map(torque).collect()
}
