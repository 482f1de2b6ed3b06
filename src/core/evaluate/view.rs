//! A trial as figures show it: thinned, whatever its rate.

use super::figures::Judged;
use crate::predict::Prediction;
use crate::prepare::Trial;

/// Samples kept of a trial: enough for a page-wide figure and a zoom into a tenth of it.
const SAMPLES: usize = 12_000;

/// One trial, thinned.
#[derive(Debug, Clone)]
pub struct View {
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Position, rad.
    pub position_rad: Vec<f64>,
    /// Speed, rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// Measured, low-passed, N m.
    pub torque_nm: Vec<f64>,
    /// Predicted, low-passed, N m.
    pub predicted_nm: Vec<f64>,
    /// Measured as recorded: lowest and highest in each stretch, N m.
    pub raw_nm: Vec<(f64, f64)>,
    /// Predicted, not filtered, N m.
    pub raw_predicted_nm: Vec<f64>,
    /// Measured less predicted, neither filtered: lowest and highest in each stretch, N m.
    pub raw_error_nm: Vec<(f64, f64)>,
    /// Predicted with each rival's curve, low-passed, N m.
    pub rivals_nm: Vec<Vec<f64>>,
    /// (r1/r2) G, N m.
    pub gravity_nm: Vec<f64>,
    /// (r1/r2) M a, N m.
    pub inertia_nm: Vec<f64>,
    /// (r1/r2) C v, N m.
    pub coriolis_nm: Vec<f64>,
    /// (r1/r2) times the measured load, N m.
    pub load_nm: Vec<f64>,
    /// Friction, N m.
    pub friction_nm: Vec<f64>,
    /// K_f.
    pub k_f: Vec<f64>,
    /// Whether the sample is in the figures.
    pub judged: Vec<bool>,
}

/// Samples of `n` for each that is kept.
fn step(n: usize) -> usize {
    n.div_ceil(SAMPLES).max(1)
}

impl View {
    /// `values` of a trial as a view holds them.
    pub(super) fn thinned(values: &[f64]) -> Vec<f64> {
        values.iter().step_by(step(values.len())).copied().collect()
    }

    /// Of `trial` under `prediction`, `filtered_nm` when low-passed; rivals are still to come.
    pub(super) fn new(trial: &Trial, prediction: &Prediction, filtered_nm: &[f64], judged: &Judged) -> Self {
        let n = trial.torque_nm.len();
        let (step, thin) = (step(n), Self::thinned);
        let extremes =
            |part: &mut dyn Iterator<Item = f64>| part.fold((f64::MAX, f64::MIN), |(l, h), y| (l.min(y), h.max(y)));
        let raw_nm = |part: &[f64]| extremes(&mut part.iter().copied());
        let raw_error_nm = |(y, p): (&[f64], &[f64])| extremes(&mut y.iter().zip(p).map(|(y, p)| y - p));
        let mut counted = vec![false; n];
        judged.samples.iter().for_each(|at| counted[*at] = true);
        Self {
            time_s: thin(&trial.log.time_s),
            position_rad: thin(&trial.position_rad),
            velocity_rad_s: (0..n).step_by(step).map(|i| trial.velocity_rad_s(i)).collect(),
            torque_nm: thin(&trial.torque_nm),
            predicted_nm: thin(filtered_nm),
            raw_nm: trial.log.torque_nm.chunks(step).map(raw_nm).collect(),
            raw_predicted_nm: thin(&prediction.torque_nm),
            raw_error_nm: trial
                .log
                .torque_nm
                .chunks(step)
                .zip(prediction.torque_nm.chunks(step))
                .map(raw_error_nm)
                .collect(),
            rivals_nm: Vec::new(),
            gravity_nm: thin(&prediction.gravity_nm),
            inertia_nm: thin(&prediction.inertia_nm),
            coriolis_nm: thin(&prediction.coriolis_nm),
            load_nm: thin(&prediction.load_nm),
            friction_nm: thin(&prediction.friction_nm),
            k_f: thin(&prediction.states.k_f),
            judged: counted.into_iter().step_by(step).collect(),
        }
    }
}
