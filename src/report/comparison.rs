//! A comparison of two models as `comparison.json`, on the terminal, and as a page.

use super::number::{counted, interval, significant};
use super::page::{Block, Card, Page, Section, Table, cells};
use super::plots;
use super::terminal::{BOLD, DIM, heading, table, wrapped};
use super::wording::{Units, moving};
use crate::compare::{Cause, CauseKind, Change, Comparison, FunctionChange, FunctionKind, Level, Measure, Verdict};
use crate::model::{Direction, loss};
use serde_json::{Value, json};
use std::io::{self, Write};

/// `c` for programs.
pub(super) fn cause_json(c: &Cause) -> Value {
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

fn verdict_word(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Changed => "changed",
        Verdict::Within => "within its confidence",
        Verdict::Together => "correlated",
        Verdict::Unknown => "not known",
    }
}

/// The change of `cause` and its interval as shares of what was before; `None` where that is nothing.
fn relative(cause: &Cause) -> Option<[f64; 3]> {
    let ends = [cause.change, cause.low, cause.high];
    match cause.measure {
        Measure::Share | Measure::Load { .. } => Some(ends),
        Measure::Torque { before_nm } => (before_nm > 0.0).then(|| ends.map(|end| end / before_nm)),
        Measure::Angle => None,
    }
}

fn in_torque(cause: &Cause) -> bool {
    matches!(cause.measure, Measure::Torque { .. })
}

fn of_what(kind: CauseKind, direction: Option<Direction>) -> String {
    let where_to = direction.map_or(String::new(), |direction| format!(" moving {}", direction.name()));
    format!("{}{where_to}", kind.words())
}

/// One cause as a technician would tell it.
pub(super) fn told_cause(cause: &Cause, units: &Units) -> String {
    let percent = |ends: [f64; 3]| {
        let [change, low, high] = ends.map(|end| 100.0 * end);
        format!("{change:+.1} % [{low:.1}, {high:.1}]")
    };
    let speed = match cause.kind {
        CauseKind::Viscous => " at the fastest speed",
        CauseKind::Stribeck => " at the slowest speed",
        _ => "",
    };
    // Friction opposes the motion: moving down it is negative at the sensor.
    let sign = cause.direction.filter(|_| in_torque(cause)).map_or(1.0, Direction::sign);
    let size = match (cause.measure, relative(cause)) {
        (Measure::Angle, _) => {
            let [change, low, high] = [cause.change, cause.low, cause.high].map(f64::to_degrees);
            format!("{change:+.2} deg [{low:.2}, {high:.2}]")
        }
        (Measure::Share, Some(ends)) => percent(ends),
        (Measure::Load { mu_c }, Some(ends)) => {
            let [after, low, high] = ends.map(|share| significant(1.0 - loss(mu_c) / (1.0 + share), 3));
            format!(
                "{} of A and B(v), as from mu_c = {} to {after} [{low}, {high}]",
                percent(ends),
                significant(mu_c, 3)
            )
        }
        (_, ends) => {
            let share = ends.map_or(String::new(), |[change, low, high]| {
                let (low, high) = if sign < 0.0 { (-high, -low) } else { (low, high) };
                format!(", {} of the friction before", percent([sign * change, low, high]))
            });
            format!("{}{speed}{share}", units.torque(cause.change.abs()))
        }
    };
    let rivals: Vec<String> = cause.rivals.iter().map(|(kind, direction)| of_what(*kind, *direction)).collect();
    let or = match rivals.is_empty() {
        true => String::new(),
        false => format!(" (these data cannot tell it from {})", rivals.join(" or ")),
    };
    let changed = match (in_torque(cause), sign * cause.change > 0.0) {
        (false, _) => "changed",
        (true, true) => "rose",
        (true, false) => "fell",
    };
    format!("{} {changed} by {size}{or}", of_what(cause.kind, cause.direction))
}

/// What changed, decided on A and B(v) where both models have them.
fn told(found: &Comparison, units: &Units) -> String {
    let changed: Vec<&str> =
        found.changes.iter().filter(|c| c.verdict == Verdict::Changed).map(|c| c.name.as_str()).collect();
    let causes: Vec<String> = found.attribution.causes.iter().map(|cause| told_cause(cause, units)).collect();
    let parameters = match changed.len() {
        0 => "no single parameter changed beyond its interval".to_string(),
        n => format!(
            "{} changed beyond {}: {}",
            counted(n, "parameter", "parameters"),
            if n == 1 { "its interval" } else { "their intervals" },
            changed.join(", ")
        ),
    };
    match (found.attribution.is_known(), causes.is_empty(), open(found)) {
        (true, false, open) => {
            let open = open.map_or(String::new(), |open| format!("; {open}"));
            format!("{}{open}; {parameters}", causes.join("; "))
        }
        (true, true, _) if found.attribution.differs() => {
            format!("A and B(v) changed beyond their intervals, as no single cause explains; {parameters}")
        }
        (true, true, Some(open)) => format!(
            "What both models know of A and B(v) is the same within its intervals, but {open}: whether the prediction's change is real is \
             not known; {parameters}"
        ),
        (true, true, None) if found.effect.rms_nm > found.effect.explained_nm => format!(
            "A and B(v) are the same within their intervals at the speeds that both models know, but these explain only {} of the \
             prediction's change: the rest lies below those speeds or after reversals, and whether it is real is not known; {parameters}",
            units.torque(found.effect.explained_nm)
        ),
        (true, true, None) => format!(
            "A and B(v) are the same within their intervals, which explain up to {} of the prediction's change; {parameters}",
            units.torque(found.effect.explained_nm)
        ),
        (false, ..) => {
            let mut parameters = parameters;
            parameters[..1].make_ascii_uppercase();
            format!(
                "{parameters}; the models do not hold A and B(v) with intervals, so whether the prediction's change is real is not known"
            )
        }
    }
}

/// The functions that one of the models leaves open, in words; `None` of none.
fn open(found: &Comparison) -> Option<String> {
    let name = |(kind, direction): &(FunctionKind, Direction)| format!("{} {}", kind.words(), moving(*direction));
    let names: Vec<String> = found.unknown.iter().map(name).collect();
    (!names.is_empty()).then(|| format!("one of the models does not know {}", names.join(", ")))
}

fn sentence(found: &Comparison, units: &Units) -> String {
    let told = told(found, units);
    let (a, b) = (found.before.combination.name(), found.after.combination.name());
    let curve = if a == b { String::new() } else { format!("; the change-over curve passes from {a} to {b}") };
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
        title: String::new(),
        intro: "The change with its 95 % interval, from the confidence of both models; a parameter without any is taken as known \
                within 5 %. Parameters that are correlated with others are not compared one by one: see the friction that they \
                amount to."
            .to_string(),
        heads: ["parameter", "unit", "before", "after", "change", "95 % interval", "verdict"].map(String::from).to_vec(),
        rows: found.changes.iter().map(row).map(cells).collect(),
    }
}

/// The unit of `f` in files.
fn function_unit(found: &Comparison, f: &FunctionChange) -> &'static str {
    if f.kind == FunctionKind::ChangeOver { "m" } else { found.before.joint.kind.torque_unit() }
}

fn functions_table(found: &Comparison, units: &Units) -> Table {
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
        intro: "What is known well even where parameters trade off, with the half width of its 95 % interval. Each row is judged by \
                itself: of twenty that did not change one is called changed by chance; what changed is decided on all together, above."
            .to_string(),
        heads: ["", "direction", "speed", "before", "after", "change", "verdict"].map(String::from).to_vec(),
        rows: found.functions.iter().map(row).map(cells).collect(),
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
        title: String::new(),
        intro: "What the friction parameters amount to at the sensor.".to_string(),
        heads: ["direction", "speed", "before", "after", "change"].map(String::from).to_vec(),
        rows: found.levels.iter().map(row).map(cells).collect(),
    }
}

/// What to do next, a sentence each.
fn next(found: &Comparison) -> Vec<String> {
    let changed = found.attribution.differs() || found.changes.iter().any(|c| c.verdict == Verdict::Changed);
    let mut steps = Vec::new();
    if !found.attribution.is_known() {
        let step = "To know whether the prediction's change is real, compare models that tautline identify wrote: they hold A and B(v) \
                    with intervals.";
        steps.push(step.to_string());
    }
    if changed {
        let step = "Use the model of the later recordings. If nothing was changed on purpose, look for the cause: cable tension, wear, \
                    temperature, the sensor's zero; tautline diagnose LATER_CAMPAIGN --model EARLIER_MODEL -o FOLDER ranks causes.";
        steps.push(step.to_string());
    } else if found.attribution.is_known() {
        steps.push("Keep the earlier model: these recordings do not show that it is out of date.".to_string());
    }
    steps
}

/// The page of `found`.
pub fn page(found: &Comparison, names: &[String; 2]) -> Page {
    let mut figures = plots::comparison::figures(found);
    let rest = figures.split_off(1);
    let units = Units::of(&found.before.joint);
    let card = |name: &str, value: String, note: &str| Card { name: name.into(), value, note: note.into() };
    let changed = found.changes.iter().filter(|c| c.verdict == Verdict::Changed).count();
    let functions =
        if found.functions.is_empty() { Vec::new() } else { vec![Block::Table(functions_table(found, &units))] };
    let sections = [
        Section::open("What it does to the prediction", rest.into_iter().rev().map(Block::Figure).collect()),
        Section::open("What is known even where parameters trade off", functions),
        Section::open("Parameters", vec![Block::Table(parameters_table(found))]),
        Section::folded("Friction without load, B(v)", vec![Block::Table(friction_table(found, &units))]),
    ];
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
        lead: figures,
        next: next(found),
        sections: sections.into_iter().filter(|section| !section.blocks.is_empty()).collect(),
        provenance: vec![("before", names[0].clone()), ("after", names[1].clone())],
        ..Page::default()
    }
}

/// Writes the summary to `out`.
pub fn write_summary(out: &mut impl Write, found: &Comparison, names: &[String; 2]) -> io::Result<()> {
    let units = Units::of(&found.before.joint);
    writeln!(out, "{BOLD}{}{BOLD:#}  {DIM}{} -> {}{DIM:#}", found.before.joint.name, names[0], names[1])?;
    heading(
        out,
        "Parameters, and their change with its 95 % interval (5 % of a value where nobody said how well it is known)",
    )?;
    let parameters = parameters_table(found);
    table(out, &parameters.heads, &parameters.texts())?;
    let (known, title) = match found.functions.is_empty() {
        true => (friction_table(found, &units), "Friction without load, B(v)"),
        false => (functions_table(found, &units), "What is known even where parameters trade off, with 95 % intervals"),
    };
    heading(out, title)?;
    table(out, &known.heads, &known.texts())?;
    writeln!(out, "\n  {}", wrapped(&sentence(found, &units), 2))
}
