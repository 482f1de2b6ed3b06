//! The gap in motion in words and numbers: lines for the terminal and the page, figures for a card, JSON.

use crate::diagnose::{Cause, Follows, Kind, MotionGap, MotionPlace, MotionTrial, Verdict};
use crate::dynamics::JointKind;
use crate::report::number::{percent, significant};
use crate::report::wording::Units;
use serde_json::{Value, json};

/// Places told.
const PLACES: usize = 2;
/// A floor below this share of the difference is not told.
const FLOOR_MIN: f64 = 0.01;
/// Below this share of the square nothing is said to follow.
const FOLLOWS_MIN: f64 = 0.05;

/// What there is to say of `gap`, a sentence each, most important first.
pub fn lines(gap: &MotionGap, kind: JointKind) -> Vec<String> {
    let units = Units::of_kind(kind);
    let (rmse, peak) = (length(gap.rmse_rad, kind), length(gap.peak_rad(), kind));
    let torque = units.torque(gap.rmse_nm);
    if !gap.is_there {
        return vec![format!(
            "The joint moves as {} does: positions differ by {rmse} (RMS), torques by {torque}",
            gap.simulated
        )];
    }
    let floor = gap.floor_rad.filter(|floor| *floor > FLOOR_MIN * gap.rmse_rad);
    let floor = floor.map_or_else(String::new, |floor| format!("; repeats differ by {}", length(floor, kind)));
    let mut all = vec![format!(
        "The joint moves otherwise than {}: positions differ by {rmse} (RMS; at most {peak}{floor}), torques by {torque}",
        gap.simulated
    )];
    all.push(explanation(gap, kind));
    all.extend(gap.places.iter().take(PLACES).map(|place| {
        format!(
            "{} of it follows {}: {}",
            percent(place.share_of_gap),
            place.region.name().replace('_', " "),
            place.detail
        )
    }));
    all
}

/// The name of `gap`'s card, its figure and its note.
pub fn card(gap: &MotionGap, kind: JointKind) -> (String, String, String) {
    let note = match &gap.follows {
        _ if !gap.is_there => "none beside the simulator's log".to_string(),
        Some(follows) => format!("{} follows from {}", percent(follows.share.max(0.0)), names(&gap.separates, " or ")),
        None => format!("beside {}", gap.simulated),
    };
    ("gap in motion".to_string(), length(gap.rmse_rad, kind), note)
}

/// What the position difference comes from.
fn explanation(gap: &MotionGap, kind: JointKind) -> String {
    let whole = gap.follows_whole.filter(|follows| follows.share > FOLLOWS_MIN).map_or_else(
        || "; the torques' difference does not account for it: look at the commands and the controllers".to_string(),
        |follows| format!("; the whole difference in torque accounts for {}", percent(follows.share)),
    );
    match &gap.follows {
        Some(follows) if follows.share > FOLLOWS_MIN => format!(
            "{} of the difference's square is what the torque of {} does to the position controller ({}){whole}",
            percent(follows.share),
            names(&gap.separates, " or "),
            compliance(follows, kind),
        ),
        _ if gap.separates.is_empty() => format!("No cause is named that the simulator has not{whole}"),
        _ => format!("It does not follow from the torque of {}{whole}", names(&gap.separates, " or ")),
    }
}

/// How far the controller gives way: "0.8 mrad per mN m at the winch".
fn compliance(follows: &Follows, kind: JointKind) -> String {
    let (angle, torque) = match kind {
        JointKind::Revolute => ("mrad", "mN m"),
        JointKind::Prismatic => ("mm", "mN"),
    };
    format!("{} {angle} per {torque} at the winch", significant(follows.rad_per_nm.abs(), 2))
}

/// A difference in position, with three digits.
fn length(value_rad: f64, kind: JointKind) -> String {
    let unit = if kind == JointKind::Revolute { "mrad" } else { "mm" };
    format!("{} {unit}", significant(1e3 * value_rad, 3))
}

fn names(causes: &[Cause], between: &str) -> String {
    causes.iter().map(|cause| cause.name()).collect::<Vec<&str>>().join(between)
}

/// The gap in motion as in `diagnosis.json`, under `motion`.
pub fn to_json(gap: &MotionGap) -> Value {
    json!({
        "simulated": gap.simulated,
        "is_there": gap.is_there,
        "rmse_rad": gap.rmse_rad,
        "peak_rad": gap.peak_rad(),
        "floor_rad": gap.floor_rad,
        "rmse_nm": gap.rmse_nm,
        "peak_nm": gap.peak_nm(),
        "where": gap.places.iter().map(place).collect::<Vec<Value>>(),
        "separates": gap.separates.iter().map(|cause| cause.name()).collect::<Vec<&str>>(),
        "follows": gap.follows.as_ref().map(follows),
        "follows_whole_torque": gap.follows_whole.as_ref().map(follows),
        "simulator": simulator(&gap.simulator, gap.simulator_rmse_nm),
        "trials": gap.trials.iter().map(trial).collect::<Vec<Value>>(),
        "warnings": gap.warnings,
    })
}

fn place(place: &MotionPlace) -> Value {
    json!({
        "region": place.region.name(),
        "detail": place.detail,
        "share_of_gap": place.share_of_gap,
        "share_of_samples": place.share_of_samples,
        "rmse_rad": place.rmse_rad,
    })
}

fn follows(follows: &Follows) -> Value {
    json!({
        "share": follows.share,
        "rad_per_nm": follows.rad_per_nm,
        "rad_s_per_nm": follows.rad_s_per_nm,
        "offset_rad": follows.offset_rad,
    })
}

fn simulator(verdict: &Verdict, rmse_nm: f64) -> Value {
    let effects: Vec<&str> = verdict.effects.iter().map(|cause| cause.name()).collect();
    json!({
        "kind": verdict.kind.name(),
        "effects": if verdict.kind == Kind::None { Vec::new() } else { effects },
        "rmse_nm": rmse_nm,
        "gap_nm": verdict.gap_before_nm,
    })
}

fn trial(trial: &MotionTrial) -> Value {
    json!({
        "file": trial.file,
        "simulated": trial.partner,
        "lag_s": trial.lag_s,
        "shifted_s": trial.shifted_s,
        "samples": trial.time_s.len(),
        "rmse_rad": trial.rmse_rad(),
        "peak_rad": trial.peak_rad(),
        "rmse_nm": trial.rmse_nm(),
        "peak_nm": trial.peak_nm(),
    })
}
