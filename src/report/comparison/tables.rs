//! The tables of a comparison.

use crate::compare::{Change, Comparison, FunctionChange, FunctionKind, Level, Verdict};
use crate::report::number::{interval, significant};
use crate::report::page::{Table, cells};
use crate::report::wording::{Units, moving};

fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Changed => "changed",
        Verdict::Within => "within its interval",
        Verdict::Together => "correlated",
        Verdict::Unknown => "not known",
    }
}

pub(super) fn parameters_table(found: &Comparison) -> Table {
    let number = |x: Option<f64>| x.map_or("–".to_string(), |x| significant(x, 4));
    let row = |c: &Change| {
        let change = c.before.zip(c.after).map(|(a, b)| b - a);
        let range = change.map_or(String::new(), |change| interval(change, c.low, c.high));
        vec![
            c.name.clone(),
            c.unit.to_string(),
            number(c.before),
            number(c.after),
            number(change),
            range,
            verdict_word(c.verdict).to_string(),
        ]
    };
    Table {
        title: String::new(),
        intro: "The change with its 95 % interval, from the intervals of both models (± 5 % where a model file gives none). Parameters that are \
                correlated with others are not compared one by one: compare the friction that they add up to."
            .to_string(),
        heads: ["parameter", "unit", "before", "after", "change", "95 % interval", "verdict"].map(String::from).to_vec(),
        rows: found.changes.iter().map(row).map(cells).collect(),
    }
}

/// The unit of `f` in files.
pub(super) fn function_unit(found: &Comparison, f: &FunctionChange) -> &'static str {
    if f.kind == FunctionKind::ChangeOver { "m" } else { found.before.joint.kind.torque_unit() }
}

pub(super) fn functions_table(found: &Comparison, units: &Units) -> Table {
    let row = |f: &FunctionChange| {
        let written = |value: f64| match f.kind {
            FunctionKind::ChangeOver => format!("{} mm", significant(1e3 * value, 3)),
            _ => units.torque(value),
        };
        let speed = f.speed_rad_s.map(|speed| format!("{} {}", significant(speed, 2), units.speed));
        let known = |(value, half): (f64, f64)| format!("{} ± {}", written(value), written(half));
        vec![
            f.kind.words().to_string(),
            f.direction.map_or(String::new(), |direction| moving(direction).to_string()),
            speed.unwrap_or_default(),
            known(f.before),
            known(f.after),
            known((f.change(), f.half_width())),
            if f.change().abs() > f.half_width() { "changed" } else { "within" }.to_string(),
        ]
    };
    Table {
        title: String::new(),
        intro: "Functions of the parameters that the data determine even where single parameters trade off, ± the half width of the 95 % \
                interval. Each row is tested by itself: of twenty that did not change, one is called changed by chance. The verdict at the top \
                tests all of them together."
            .to_string(),
        heads: ["", "direction", "speed", "before", "after", "change", "verdict"].map(String::from).to_vec(),
        rows: found.functions.iter().map(row).map(cells).collect(),
    }
}

pub(super) fn friction_table(found: &Comparison, units: &Units) -> Table {
    let row = |l: &Level| {
        vec![
            moving(l.direction).to_string(),
            format!("{} {}", significant(l.speed_rad_s, 2), units.speed),
            units.torque(l.before_nm),
            units.torque(l.after_nm),
            units.torque(l.after_nm - l.before_nm),
        ]
    };
    Table {
        title: String::new(),
        intro: "B(v) at the torque sensor, from the friction parameters.".to_string(),
        heads: ["direction", "speed", "before", "after", "change"].map(String::from).to_vec(),
        rows: found.levels.iter().map(row).map(cells).collect(),
    }
}
