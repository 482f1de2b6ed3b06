//! The gap in motion: a simulator's own log of the same commands beside the recordings.
//!
//! A joint under a position controller moves differently where its torque differs: with the same commands and the same
//! controller u = -K q - D dq/dt + (what the command asks), two joints differ by K dq + D d(dq)/dt = -du. So the torque that
//! separates the two is diagnosed first (what the recordings have and the simulator's log has not), and the difference in
//! position is then held against it.

mod align;
mod controller;
mod pairs;
mod places;

pub use align::MotionTrial;
pub use controller::Follows;
pub use places::MotionPlace;

use super::{Cause, Diagnosis, Kind, Listener, Policy, Verdict, run_by};
use crate::log::Campaign;
use crate::model::Model;
use crate::numerics::statistics::extent;
use crate::problem::Result;

/// A difference in position below this share of the travel is negligible.
const NEGLIGIBLE: f64 = 1e-4;
/// ... and so is one below this many floors.
const FLOORS: f64 = 1.5;

/// A gap between the model and the simulator's own log below this share of the recordings' gap separates nothing.
const SHARED: f64 = 0.1;

/// What separates the recordings from a simulator's log, in motion.
#[derive(Debug, Clone)]
pub struct MotionGap {
    /// What the simulator's campaign is called.
    pub simulated: String,
    /// The trials side by side.
    pub trials: Vec<MotionTrial>,
    /// RMS of the position difference over all trials, rad.
    pub rmse_rad: f64,
    /// What of it is different in each repeat, rad; nothing without repeats.
    pub floor_rad: Option<f64>,
    /// RMS of the torque difference over all trials, low-passed, N m.
    pub rmse_nm: f64,
    /// Whether there is a gap in motion at all.
    pub is_there: bool,
    /// Where it lies, most first.
    pub places: Vec<MotionPlace>,
    /// The model's verdict on the simulator's own log, which should include nothing that the model lacks.
    pub simulator: Verdict,
    /// RMSE of the model on the simulator's own log, N m.
    pub simulator_rmse_nm: f64,
    /// Causes that the recordings have and the simulator has not.
    pub separates: Vec<Cause>,
    /// The position difference as what those causes' torque does to the controller.
    pub follows: Option<Follows>,
    /// The same of the whole difference in torque.
    pub follows_whole: Option<Follows>,
    /// Warnings.
    pub warnings: Vec<String>,
}

impl MotionGap {
    /// The largest position difference, rad.
    pub fn peak_rad(&self) -> f64 {
        self.trials.iter().map(MotionTrial::peak_rad).fold(0.0, f64::max)
    }

    /// The largest torque difference, low-passed, N m.
    pub fn peak_nm(&self) -> f64 {
        self.trials.iter().map(MotionTrial::peak_nm).fold(0.0, f64::max)
    }
}

/// The diagnosis of `campaign` with `model`, and in it the gap in motion between `campaign` and `simulated`, a simulator's log
/// of the same commands, by the thresholds of `policy`. `listener` hears what it is at.
///
/// Errors: those of [`run_by`] on either campaign; no trial of one has a partner in the other.
pub fn beside(
    campaign: &Campaign,
    simulated: &Campaign,
    model: &Model,
    policy: &Policy,
    listener: Listener<'_>,
) -> Result<Diagnosis> {
    let (pairs, warnings) = pairs::pairs(campaign, simulated)?;
    // Both sides through the same low-pass.
    let signal = crate::log::Signal { torque_sign: simulated.signal.torque_sign, ..campaign.signal };
    let simulated = Campaign { signal, ..simulated.clone() };
    let trials = pairs.into_iter().map(|pair| align::trial(campaign, &simulated, pair)).collect::<Result<Vec<_>>>()?;
    let mut real = run_by(campaign, model, policy, listener)?;
    let simulator = run_by(&simulated, model, policy, listener)?;
    real.motion = Some(gap(&real, &simulator, &simulated, trials, warnings));
    Ok(real)
}

fn gap(
    real: &Diagnosis,
    simulator: &Diagnosis,
    simulated: &Campaign,
    trials: Vec<MotionTrial>,
    mut warnings: Vec<String>,
) -> MotionGap {
    let lowpass_hz = simulated.signal.lowpass_hz;
    let rmse_rad = pooled(&trials, MotionTrial::rmse_rad);
    let floor_rad = places::floor_rad(&trials);
    let (low, high) = extent(&trials.iter().flat_map(|trial| trial.position_rad.iter().copied()).collect::<Vec<f64>>());
    let is_there = rmse_rad > (NEGLIGIBLE * (high - low)).max(FLOORS * floor_rad.unwrap_or(0.0));
    let separates = separating(real, simulator);
    let of_causes = |trial: &MotionTrial| controller::of_causes_nm(real, trial);
    let names_causes = is_there && !separates.is_empty();
    warnings.extend(trials.iter().filter_map(MotionTrial::doubt));
    if differs(real, simulator) {
        warnings.push(simulator_differs(simulator));
    }
    let folder = std::path::absolute(&simulated.folder).unwrap_or_else(|_| simulated.folder.clone());
    MotionGap {
        simulated: folder.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned()),
        rmse_rad,
        floor_rad,
        rmse_nm: pooled(&trials, MotionTrial::rmse_nm),
        is_there,
        places: if is_there { places::locate(real, &trials, floor_rad.unwrap_or(0.0), lowpass_hz) } else { Vec::new() },
        simulator: simulator.verdict.clone(),
        simulator_rmse_nm: simulator.gap.rmse_nm,
        follows: names_causes.then(|| controller::follows(&trials, of_causes, simulated)).flatten(),
        follows_whole: is_there
            .then(|| controller::follows(&trials, MotionTrial::torque_difference_nm, simulated))
            .flatten(),
        separates,
        trials,
        warnings,
    }
}

/// Root of the mean square over all samples of `of` each trial.
fn pooled(trials: &[MotionTrial], of: impl Fn(&MotionTrial) -> f64) -> f64 {
    let count = |trial: &MotionTrial| trial.time_s.len() as f64;
    let whole: f64 = trials.iter().map(|trial| count(trial) * of(trial).powi(2)).sum();
    (whole / trials.iter().map(count).sum::<f64>().max(1.0)).sqrt()
}

/// Whether the model is not the simulator's, by more than hardly matters here.
fn differs(real: &Diagnosis, simulator: &Diagnosis) -> bool {
    simulator.verdict.tells_of_a_gap() && simulator.verdict.gap_before_nm > SHARED * real.verdict.gap_before_nm
}

/// Causes that `real` names and `simulator` does not.
fn separating(real: &Diagnosis, simulator: &Diagnosis) -> Vec<Cause> {
    let shared = |cause: &Cause| differs(real, simulator) && simulator.verdict.effects.contains(cause);
    match real.verdict.kind {
        Kind::None => Vec::new(),
        _ => real.verdict.effects.iter().copied().filter(|cause| !shared(cause)).collect(),
    }
}

fn simulator_differs(simulator: &Diagnosis) -> String {
    let verdict = &simulator.verdict;
    let names: Vec<&str> = verdict.effects.iter().map(|cause| cause.name()).collect();
    let what = if names.is_empty() { verdict.kind.name().to_string() } else { names.join(", ") };
    format!(
        "the model is not the simulator's: on the simulator's own log it leaves {:.4} N m above the floor ({what}); what both \
         have is not told as separating them",
        verdict.gap_before_nm
    )
}
