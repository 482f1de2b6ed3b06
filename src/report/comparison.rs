//! A comparison of two models as `comparison.json`, on the terminal, and as a page.

use super::number::{counted, interval, significant};
use super::page::{Card, Drawing, Page, Table};
use super::terminal::{BOLD, DIM, heading};
use super::wording::{Units, moving};
use crate::compare::{Change, Comparison, Level, Verdict};
use serde_json::{Value, json};
use std::io::{self, Write};

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
    json!({
        "format": "comparison/1",
        "joint": found.before.joint.name,
        "parameters": found.changes.iter().map(change).collect::<Vec<Value>>(),
        "friction": found.levels.iter().map(level).collect::<Vec<Value>>(),
        "combination": [found.before.combination.name(), found.after.combination.name()],
        "prediction": {
            "motion": "cosine cascade",
            "friction_alone": found.load_is_missing(),
            "rms_change_nm": found.effect.rms_nm,
            "mean_change_nm": found.effect.mean_nm,
            "peak_change_nm": found.effect.peak_nm,
        },
        "provenance": { "tautline": env!("CARGO_PKG_VERSION"), "before": names[0], "after": names[1] },
    })
}

fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Changed => "changed",
        Verdict::Within => "within its confidence",
        Verdict::Together => "known only with others",
        Verdict::Unknown => "not known",
    }
}

fn sentence(found: &Comparison, units: &Units) -> String {
    let changed: Vec<&str> =
        found.changes.iter().filter(|c| c.verdict == Verdict::Changed).map(|c| c.name.as_str()).collect();
    let told = match changed.len() {
        0 => "No parameter changed beyond its confidence".to_string(),
        n => format!("{} changed beyond confidence: {}", counted(n, "parameter", "parameters"), changed.join(", ")),
    };
    let (a, b) = (found.before.combination.name(), found.after.combination.name());
    let curve = if a == b { String::new() } else { format!("; the combination passes from {a} to {b}") };
    let share = if found.load_is_missing() { " (friction alone: gravity and inertia are the chain's)" } else { "" };
    format!(
        "{told}{curve}. Along the paper's cosine cascade the prediction changes by {} RMS, {} at most{share}.",
        units.torque(found.effect.rms_nm),
        units.torque(found.effect.peak_nm)
    )
}

fn parameters_table(found: &Comparison) -> Table {
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
        title: "Parameters".to_string(),
        intro: "The change with its 95 % interval, from the confidence of both models; a parameter without any is taken as known \
                within 5 %. Parameters known only together with others are not judged one by one: see the friction that they \
                amount to."
            .to_string(),
        heads: ["parameter", "unit", "before", "after", "change", "95 % interval", "verdict"].map(String::from).to_vec(),
        rows: found.changes.iter().map(row).collect(),
    }
}

fn friction_table(found: &Comparison, units: &Units) -> Table {
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
        title: "Friction without load, B(v)".to_string(),
        intro: "What the friction parameters amount to at the sensor.".to_string(),
        heads: ["direction", "speed", "before", "after", "change"].map(String::from).to_vec(),
        rows: found.levels.iter().map(row).collect(),
    }
}

/// The page of `found`, with its `drawings`.
pub fn page(found: &Comparison, names: &[String; 2], drawings: Vec<Drawing>) -> Page {
    let units = Units::of(found.before.joint.kind);
    let card = |name: &str, value: String, note: &str| Card { name: name.into(), value, note: note.into() };
    let changed = found.changes.iter().filter(|c| c.verdict == Verdict::Changed).count();
    Page {
        kicker: format!("tautline compare · {} · {}", names[0], names[1]),
        title: found.before.joint.name.clone(),
        subject: "comparison".to_string(),
        short: sentence(found, &units),
        cards: vec![
            card("changed", counted(changed, "parameter", "parameters"), "beyond the confidence of both models"),
            card("prediction, RMS", units.torque(found.effect.rms_nm), "along the cosine cascade"),
            card("prediction, mean", units.torque(found.effect.mean_nm), "a level, as a tare would take away"),
            card("prediction, peak", units.torque(found.effect.peak_nm), "largest change"),
        ],
        tables: vec![parameters_table(found), friction_table(found, &units)],
        drawings,
        provenance: vec![
            ("tautline", env!("CARGO_PKG_VERSION").to_string()),
            ("before", names[0].clone()),
            ("after", names[1].clone()),
        ],
        ..Page::default()
    }
}

/// Writes the summary to `out`.
pub fn write_summary(out: &mut impl Write, found: &Comparison, names: &[String; 2]) -> io::Result<()> {
    let units = Units::of(found.before.joint.kind);
    writeln!(out, "{BOLD}{}{BOLD:#}  {DIM}{} -> {}{DIM:#}", found.before.joint.name, names[0], names[1])?;
    heading(
        out,
        "Parameters, and their change with its 95 % interval (5 % of a value where nobody said how well it is known)",
    )?;
    let head = ["", "unit", "before", "after", "change", "95 % interval", "verdict"];
    writeln!(
        out,
        "  {DIM}{:<22} {:<8} {:>10}    {:>10}  {:>10}  {:<26} {}{DIM:#}",
        head[0], head[1], head[2], head[3], head[4], head[5], head[6]
    )?;
    for row in parameters_table(found).rows {
        let [name, unit, before, after, change, range, verdict] = &row[..] else { continue };
        writeln!(out, "  {name:<22} {unit:<8} {before:>10} -> {after:>10}  {change:>10}  {range:<26} {verdict}")?;
    }
    heading(out, "Friction without load, B(v)")?;
    for row in friction_table(found, &units).rows {
        let [direction, speed, before, after, change] = &row[..] else { continue };
        writeln!(out, "  {direction:<12} {speed:<12} {before:>12} -> {after:>12}  {change:>12}")?;
    }
    writeln!(out, "\n  {}", sentence(found, &units))
}
