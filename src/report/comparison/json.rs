//! `comparison.json`.

use super::tables::function_unit;
use super::words::{in_torque, relative};
use crate::compare::{Cause, Change, Comparison, FunctionChange, FunctionKind, Level, Measure};
use crate::model::Direction;
use serde_json::{Value, json};

/// `c` for programs.
pub fn cause_json(c: &Cause) -> Value {
    json!({
        "what": c.kind.name(),
        "direction": c.direction.map(Direction::name),
        "change_nm": in_torque(c).then_some(c.change),
        "low_nm": in_torque(c).then_some(c.low),
        "high_nm": in_torque(c).then_some(c.high),
        "change_rad": (c.measure == Measure::Angle).then_some(c.change),
        "relative": relative(c).map(|ends| ends[0]),
        "relative_low": relative(c).map(|ends| ends[1]),
        "relative_high": relative(c).map(|ends| ends[2]),
        "parameters": c.kind.parameters(),
        "or": c.rivals.iter().map(|(kind, direction)| {
            json!({ "what": kind.name(), "direction": direction.map(Direction::name) })
        }).collect::<Vec<Value>>(),
    })
}

/// `found` between the models in the files called `names`; what is not known is null.
pub fn to_json(found: &Comparison, names: &[String; 2]) -> Value {
    let change = |c: &Change| {
        json!({
            "name": c.name, "unit": c.unit, "before": c.before, "after": c.after,
            "change": c.before.zip(c.after).map(|(a, b)| b - a), "low": c.low, "high": c.high,
            "verdict": c.verdict.name(),
        })
    };
    let level = |l: &Level| {
        json!({
            "direction": l.direction.name(), "speed_rad_s": l.speed_rad_s, "before_nm": l.before_nm,
            "after_nm": l.after_nm, "change_nm": l.after_nm - l.before_nm,
        })
    };
    let function = |f: &FunctionChange| {
        let unit = function_unit(found, f);
        json!({
            "function": f.kind.name(), "direction": f.direction.map(Direction::name), "speed_rad_s": f.speed_rad_s, "unit": unit,
            "before": f.before.0, "before_half_width": f.before.1, "after": f.after.0, "after_half_width": f.after.1,
            "change": f.change(), "half_width": f.half_width(),
        })
    };
    let unknown = |(kind, direction): &(FunctionKind, Direction)| json!({ "function": kind.name(), "direction": direction.name() });
    let known = found.attribution.is_known();
    json!({
        "format": "comparison/1",
        "joint": found.before.joint.name,
        "changed": known.then_some(found.attribution.differs()),
        "chance": known.then_some(found.attribution.chance),
        "what_changed": found.attribution.causes.iter().map(cause_json).collect::<Vec<Value>>(),
        "parameters": found.changes.iter().map(change).collect::<Vec<Value>>(),
        "functions": found.functions.iter().map(function).collect::<Vec<Value>>(),
        "not_known": found.unknown.iter().map(unknown).collect::<Vec<Value>>(),
        "friction": found.levels.iter().map(level).collect::<Vec<Value>>(),
        "combination": [found.before.combination.name(), found.after.combination.name()],
        "prediction": {
            "motion": "cosine cascade",
            "friction_alone": found.load_is_missing(),
            "rms_change_nm": found.effect.rms_nm,
            "mean_change_nm": found.effect.mean_nm,
            "peak_change_nm": found.effect.peak_nm,
            "explained_by_intervals_nm": found.effect.explained_nm.is_finite().then_some(found.effect.explained_nm),
        },
        "provenance": { "tautline": env!("CARGO_PKG_VERSION"), "before": names[0], "after": names[1] },
    })
}
