//! Two snapshots of one campaign: what moved, and whether it matters.

use super::finding::{Finding, Held, Outcome, Part};
use super::sketch::Relation;
use super::{Figure, Snapshot, TrialMark};
use crate::numerics::statistics::together;
use std::collections::BTreeMap;

/// A campaign held against its baseline.
#[derive(Debug, Clone)]
pub struct Checked {
    /// Everything compared: settings, data, stages, choices, figures, each in the baseline's order.
    pub findings: Vec<Finding>,
}

impl Checked {
    /// Those with this outcome.
    pub fn with(&self, outcome: Outcome) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |finding| finding.outcome == outcome)
    }

    /// Whether anything regressed.
    pub fn is_regressed(&self) -> bool {
        self.with(Outcome::Regressed).next().is_some()
    }
}

/// Holds `now` against `before`.
pub fn judge(before: &Snapshot, now: &Snapshot) -> Checked {
    let mut findings = texts(Part::Setting, &before.settings, &now.settings);
    let settings_differ = findings.iter().any(|finding| finding.outcome != Outcome::Same);
    let data = trials(&before.trials, &now.trials);
    let differs: Vec<&str> =
        data.iter().filter(|finding| finding.outcome != Outcome::Same).map(|finding| finding.name.as_str()).collect();
    let stages = now.refused.iter().map(|(stage, why)| {
        let (before, now) = (Held::Text("done".to_string()), Held::Text("refused".to_string()));
        Finding::text(Part::Stage, stage, before, now, Outcome::Regressed, why)
    });
    let stages: Vec<Finding> = stages.collect();
    let has_changed = |figure: &Figure| {
        settings_differ || figure.file.as_ref().map_or(!differs.is_empty(), |file| differs.contains(&file.as_str()))
    };
    let choices = if now.refused.contains_key("identification") {
        Vec::new()
    } else {
        texts(Part::Choice, &before.choices, &now.choices)
    };
    let figures = figures(before, now, has_changed);
    findings.extend(data.iter().cloned());
    findings.extend(stages);
    findings.extend(choices);
    findings.extend(figures);
    Checked { findings }
}

/// Texts by name: whatever differs has regressed.
fn texts(part: Part, before: &BTreeMap<String, String>, now: &BTreeMap<String, String>) -> Vec<Finding> {
    let held = |text: Option<&String>| text.map_or(Held::Nothing, |text| Held::Text(text.clone()));
    let added = now.keys().filter(|name| !before.contains_key(*name));
    let one = |name: &String| {
        let (a, b) = (before.get(name), now.get(name));
        let outcome = if a == b { Outcome::Same } else { Outcome::Regressed };
        Finding::text(part, name, held(a), held(b), outcome, "")
    };
    before.keys().chain(added).map(one).collect()
}

/// The trials: lost, added, declared otherwise, holding other data.
fn trials(before: &[TrialMark], now: &[TrialMark]) -> Vec<Finding> {
    let same_file = |mark: &TrialMark, all: &[TrialMark]| all.iter().position(|other| other.file == mark.file);
    let mut found: Vec<Finding> = Vec::new();
    for mark in before {
        let held = Held::Text(mark.declared.clone());
        found.push(match same_file(mark, now) {
            None => Finding::text(Part::Data, &mark.file, held, Held::Nothing, Outcome::Regressed, "trial lost"),
            Some(at) => {
                let (outcome, note) = trial(mark, &now[at], before);
                Finding::text(Part::Data, &mark.file, held, Held::Text(now[at].declared.clone()), outcome, &note)
            }
        });
    }
    for mark in now.iter().filter(|mark| same_file(mark, before).is_none()) {
        let held = Held::Text(mark.declared.clone());
        let twin = before.iter().find(|other| other.holds_same(mark));
        let note =
            twin.map_or("trial added".to_string(), |twin| format!("trial added; holds the data of {}", twin.file));
        found.push(Finding::text(Part::Data, &mark.file, Held::Nothing, held, Outcome::Regressed, &note));
    }
    found
}

fn trial(before: &TrialMark, now: &TrialMark, all: &[TrialMark]) -> (Outcome, String) {
    if now.declared != before.declared {
        return (Outcome::Regressed, "declared otherwise".to_string());
    }
    if now == before {
        return (Outcome::Same, String::new());
    }
    if now.holds_same(before) {
        return (Outcome::Rounded, "the same except for rounding".to_string());
    }
    if let Some(twin) = all.iter().find(|other| other.file != before.file && other.holds_same(now)) {
        return (Outcome::Regressed, format!("holds the data of {}", twin.file));
    }
    (Outcome::Changed, changes(before, now))
}

/// What changed in a log, column by column.
fn changes(before: &TrialMark, now: &TrialMark) -> String {
    let mut told: Vec<String> = Vec::new();
    if before.rows != now.rows {
        told.push(format!("{} rows, not {}", now.rows, before.rows));
    }
    for (name, sketch) in &now.columns {
        match before.columns.get(name) {
            None => told.push(format!("{name} is new")),
            Some(old) if sketch.is_same(old) => {}
            Some(_) if before.rows != now.rows => {}
            Some(old) => {
                told.push(sketch.relation(old, now.rows).map_or(name.clone(), |r| format!("{name}{}", words(r))))
            }
        }
    }
    told.extend(
        before.columns.keys().filter(|name| !now.columns.contains_key(*name)).map(|name| format!("{name} is gone")),
    );
    told.join("; ")
}

/// A factor and an offset in words.
fn words(Relation { times, plus }: Relation) -> String {
    let plain = |x: f64| format!("{x:.4e}").parse::<f64>().unwrap_or(x);
    let times = match plain(times) {
        1.0 => String::new(),
        -1.0 => " with its sign turned".to_string(),
        times => format!(" times {times}"),
    };
    let plus = if plus == 0.0 { String::new() } else { format!(" plus {}", plain(plus)) };
    format!("{times}{plus}")
}

/// The figures. Those of trials and stages that are gone are not told again.
fn figures(before: &Snapshot, now: &Snapshot, has_changed: impl Fn(&Figure) -> bool) -> Vec<Finding> {
    let known: BTreeMap<&str, &Figure> = now.figures.iter().map(|figure| (figure.name.as_str(), figure)).collect();
    let is_there = |file: &String| now.trials.iter().any(|mark| mark.file == *file);
    // Of hundreds of figures some always leave their own 95 % interval.
    let wider = together(before.figures.len());
    let mut found = Vec::new();
    for figure in &before.figures {
        let figure = &Figure { tolerance: wider * figure.tolerance, ..figure.clone() };
        let finding = |now: Held, allowed: f64, outcome: Outcome, note: &str| Finding {
            part: Part::Figure,
            name: figure.name.clone(),
            unit: figure.unit.clone(),
            before: Held::Number(figure.value),
            now,
            allowed,
            outcome,
            note: note.to_string(),
        };
        match known.get(figure.name.as_str()) {
            Some(new) => {
                let changed = has_changed(figure);
                let allowed = if changed { figure.tolerance.max(figure.rounding) } else { figure.rounding };
                let outcome = outcome(figure, new.value, changed);
                let note = if outcome == Outcome::Regressed && !changed { "on the same data" } else { "" };
                found.push(finding(Held::Number(new.value), allowed, outcome, note));
            }
            None if !now.refused.is_empty() || figure.file.as_ref().is_some_and(|file| !is_there(file)) => {}
            // The other choice that was made, or the trials that it needs, are reported already.
            None if has_changed(figure) => found.push(finding(Held::Nothing, f64::NAN, Outcome::Changed, "gone")),
            None => found.push(finding(Held::Nothing, f64::NAN, Outcome::Regressed, "gone, on the same data")),
        }
    }
    found
}

fn outcome(figure: &Figure, now: f64, changed: bool) -> Outcome {
    let moved = now - figure.value;
    match () {
        () if figure.value.is_nan() && now.is_nan() || moved.abs() <= figure.rounding => Outcome::Same,
        () if moved.is_nan() || !changed => Outcome::Regressed,
        () if figure.tolerance.is_infinite() => Outcome::Untold,
        () if moved.abs() <= figure.tolerance => Outcome::Within,
        () if figure.is_error && moved < 0.0 => Outcome::Better,
        () => Outcome::Regressed,
    }
}
