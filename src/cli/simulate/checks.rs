//! What `tautline simulate` refuses before it begins.

use crate::dynamics::JointKind;
use crate::effects::Added;
use crate::model::{Joint, Model};
use crate::prepare::fastest_sweep_rad_s;
use crate::problem::{Problem, Result};
use crate::simulate::{Plan, PlannedTrial};
use std::collections::BTreeSet;

/// Errors: sweeps that nothing could be identified from.
pub fn check_sweeps(plan: &Plan, joint: &Joint) -> Result<()> {
    if plan.speeds == 0 || plan.repeats == 0 {
        return Ok(());
    }
    let refuse = |what: String, cure: String| Problem::error("command line", what, cure).alone();
    if joint.kind == JointKind::Prismatic {
        let what = format!("--speeds is {}, and the joint is prismatic", plan.speeds);
        let cure = "add `--speeds 0`: sweeps serve y = A sin(theta) + B, and here is no angle; cosine trials remain";
        return refuse(what, cure.to_string());
    }
    let (slowest, fastest) = (plan.slowest_rad_s, plan.fastest_rad_s);
    if !plan.sweeps().speeds_rad_s().is_sorted_by(|a, b| a < b) {
        let what = format!("--speeds is {} from {slowest} to {fastest} rad/s", plan.speeds);
        return refuse(what, "speeds must differ by 0.0001 rad/s: take fewer, or a wider range".to_string());
    }
    match fastest_sweep_rad_s(slowest, fastest, plan.rate_hz, joint, plan.signal.lowpass_hz) {
        Some(feasible) if feasible == fastest => Ok(()),
        Some(feasible) => {
            let what = format!("--fastest-rad-s is {fastest}: a sweep of 90 deg has no constant speed left");
            refuse(what, format!("at this rate, {:.2} is the fastest", (100.0 * feasible).floor() / 100.0))
        }
        None => {
            let what = format!("--slowest-rad-s is {slowest}: not even that sweep has a leg of constant speed");
            refuse(what, "raise --rate-hz, or correct backlash_m in the model".to_string())
        }
    }
}

/// Errors: no trial, one without a sample, a sweep of a joint without an angle, or two that would be one file.
pub fn check_trials(trials: &[PlannedTrial], kind: JointKind) -> Result<()> {
    let refuse = |what: String, cure: &str| Problem::error("command line", what, cure).alone();
    if trials.is_empty() {
        return refuse("asks for no trial".to_string(), "give --speeds, --cosines or --trajectory");
    }
    if let Some(trial) = trials.iter().find(|trial| trial.samples < 2) {
        let what = format!("{} would hold {} rows", trial.entry.file, trial.samples);
        return refuse(what, "a longer trajectory or a higher --rate-hz gives more");
    }
    let is_sweep = |trial: &&PlannedTrial| trial.entry.protocol.speed_rad_s().is_some();
    if let Some(sweep) = trials.iter().find(is_sweep).filter(|_| kind == JointKind::Prismatic) {
        let what = format!("{} is `uniform`, and the joint is prismatic", sweep.entry.file);
        return refuse(what, "delete `protocol` in its trajectory");
    }
    let mut files = BTreeSet::new();
    match trials.iter().map(|trial| &trial.entry.file).find(|file| !files.insert(*file)) {
        Some(file) => refuse(format!("two trials would be called {file}"), "give each trajectory a `name` of its own"),
        None => Ok(()),
    }
}

/// Errors: a trajectory that moves more joints than the arm has, an effect of a joint that is not recorded.
pub fn check_others(plan: &Plan, model: &Model) -> Result<()> {
    let recorded = plan.other_joints().len();
    if let Some(trajectory) = plan.trajectories.iter().find(|trajectory| trajectory.others.len() > recorded) {
        let what =
            format!("`{}` moves {} other joints, the arm has {recorded}", trajectory.name, trajectory.others.len());
        return Problem::error("command line", what, "delete [[others]] of the trajectory, or leave out --urdf")
            .alone();
    }
    let named = |effect: &Added| effect.named().find(|(p, _)| p.name == "joint").map(|(_, joint)| joint as usize);
    for effect in &model.effects {
        if let Some(joint) = named(effect).filter(|joint| *joint > recorded) {
            let what = format!("effect `{}` is of other joint {joint}, and {recorded} are recorded", effect.id());
            return Problem::error("command line", what, format!("add --other-joints {joint}")).alone();
        }
    }
    Ok(())
}
