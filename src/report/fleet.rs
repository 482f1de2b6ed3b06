//! Many campaigns as `fleet.json`, on the terminal, and as a page.

use super::comparison::{cause_json, told_cause};
use super::life;
use super::number::{counted, interval, significant};
use super::page::{Block, Card, Page, Section, Table, Warning, cells};
use super::plots;
use super::terminal::{BOLD, DIM, YELLOW, heading, wrapped};
use super::wording::{Units, moving};
use crate::batch::{Drift, Fleet, Joint, Outlier, Row};
use crate::compare::{Attribution, parameters_of};
use crate::model::Direction;
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::Path;

/// Rows of a table on the page, and on the terminal; the files hold all.
const ON_THE_PAGE: usize = 200;
const ON_THE_TERMINAL: usize = 12;

/// The fleet for programs.
pub fn to_json(fleet: &Fleet) -> Value {
    let name = |at: usize| fleet.rows[at].entry.name.as_str();
    let causes = |of: &Attribution| of.causes.iter().map(cause_json).collect::<Vec<Value>>();
    let joint = |j: &Joint| {
        json!({
            "joint": j.name,
            "campaigns": j.rows.iter().map(|at| name(*at)).collect::<Vec<_>>(),
            "retensioned": j.retensioned,
            "since": name(j.since),
            "changed": j.drifted(),
            "what_changed": causes(&j.changed),
            "retensionings": life::events_json(fleet, j, true),
            "events": life::events_json(fleet, j, false),
            "quantities": j.lives.iter().map(|of| life::to_json(fleet, j, of)).collect::<Vec<Value>>(),
            "limits": j.limits.iter().map(|of| life::foreseen_json(fleet, j, of)).collect::<Vec<Value>>(),
            "drifted": j.drifts.iter().map(life::drift_json).collect::<Vec<Value>>(),
            "prediction_rms_change_nm": j.change_nm,
            "incomparable": j.incomparable,
        })
    };
    let outlier = |o: &Outlier| {
        json!({ "campaign": name(o.row), "joint": fleet.rows[o.row].joint(), "name": o.name, "value": o.value,
                "median": o.median, "deviations": o.deviations })
    };
    let failed = |row: &Row| json!({ "campaign": row.entry.name, "reason": row.record.failure });
    json!({
        "format": "fleet/1",
        "campaigns": fleet.rows.len(),
        "failed": fleet.failed().map(failed).collect::<Vec<Value>>(),
        "compared": fleet.compared,
        "joints": fleet.joints.iter().map(joint).collect::<Vec<Value>>(),
        "warnings": fleet.warnings,
        "outliers": fleet.outliers.iter().map(outlier).collect::<Vec<Value>>(),
        "provenance": { "tautline": env!("CARGO_PKG_VERSION") },
    })
}

fn sentence(fleet: &Fleet) -> String {
    let (drifted, failed) = (fleet.drifted().count(), fleet.failed().count());
    let joints = counted(fleet.joints.len(), "joint", "joints");
    let drift = match (drifted, fleet.compared) {
        (_, 0) => "no joint has two campaigns to compare".to_string(),
        (0, _) => "no joint drifted beyond its confidence".to_string(),
        (n, _) => format!("{} drifted since it was last retensioned", counted(n, "joint", "joints")),
    };
    let failures = match failed {
        0 => "all campaigns were identified".to_string(),
        n => format!("{} could not be identified", counted(n, "campaign", "campaigns")),
    };
    format!("{joints}: {drift}; {failures}.")
}

/// The heads of a table with its rows.
pub(super) type Cells<const N: usize> = ([&'static str; N], Vec<[String; N]>);

/// A drift's or outlier's name as a reader understands it, of the campaign `row`.
fn words(name: &str, row: &Row) -> String {
    let direction = Direction::BOTH.into_iter().find(|d| name.contains(&format!("_{}", d.name())));
    match (name.split('_').next(), direction) {
        (Some("a"), Some(direction)) => format!("A, {}", moving(direction)),
        (Some("level"), Some(direction)) => {
            let units = Units::of_kind(row.model.as_ref().map(|model| model.joint.kind).unwrap_or_default());
            let speed = row.figure("level_speed_rad_s").map_or_else(String::new, |v| significant(v, 3));
            format!("B(v) at {speed} {}, {}", units.speed, moving(direction))
        }
        (Some("rmse"), None) => "RMSE".to_string(),
        _ => name.to_string(),
    }
}

/// The same with the unit of its values; a figure's is a torque.
fn words_with_unit(name: &str, row: &Row) -> String {
    let of_figure = || row.model.as_ref().map_or("", |model| model.joint.kind.torque_unit());
    let parameters = row.model.as_ref().map(parameters_of).unwrap_or_default();
    let unit = parameters.into_iter().find(|parameter| parameter.0 == name).map_or_else(of_figure, |found| found.1);
    match unit {
        "" => words(name, row),
        unit => format!("{} ({unit})", words(name, row)),
    }
}

fn drifts(fleet: &Fleet) -> Cells<7> {
    let row = |joint: &Joint, d: &Drift| {
        let span = format!("{} to {}", when(fleet, joint.since), when(fleet, joint.last()));
        let change = d.after - d.before;
        [
            joint.name.clone(),
            span,
            words_with_unit(&d.name, &fleet.rows[joint.since]),
            significant(d.before, 4),
            significant(d.after, 4),
            significant(change, 3),
            interval(change, d.low, d.high),
        ]
    };
    let rows = fleet.drifted().flat_map(|joint| joint.drifts.iter().map(move |d| row(joint, d)));
    (["joint", "campaigns", "what", "before", "after", "change", "its interval"], rows.collect())
}

/// What A and B(v) say of a change, as a technician would.
pub(super) fn told(changed: &Attribution, units: &Units) -> String {
    let causes: Vec<String> = changed.causes.iter().map(|cause| told_cause(cause, units)).collect();
    match (changed.is_known(), causes.is_empty()) {
        (false, _) => "not known: no A and B(v) of both".to_string(),
        (true, false) => causes.join("; "),
        (true, true) if changed.differs() => "A and B(v) changed, as no single cause explains".to_string(),
        (true, true) => "nothing beyond the intervals".to_string(),
    }
}

fn changes(fleet: &Fleet) -> Cells<3> {
    let row = |joint: &Joint| {
        let kind = fleet.rows[joint.since].model.as_ref().map(|model| model.joint.kind).unwrap_or_default();
        let span = format!("{} to {}", when(fleet, joint.since), when(fleet, joint.last()));
        [joint.name.clone(), span, told(&joint.changed, &Units::of_kind(kind))]
    };
    (["joint", "campaigns", "what changed"], fleet.joints.iter().filter(|j| j.changed.differs()).map(row).collect())
}

fn outliers(fleet: &Fleet) -> Cells<5> {
    let row = |o: &Outlier| {
        [
            fleet.rows[o.row].entry.name.clone(),
            words_with_unit(&o.name, &fleet.rows[o.row]),
            significant(o.value, 4),
            significant(o.median, 4),
            format!("{:.1} SD", o.deviations),
        ]
    };
    (["campaign", "what", "value", "fleet's median", "away"], fleet.outliers.iter().map(row).collect())
}

fn failures(fleet: &Fleet) -> Cells<2> {
    let row = |row: &Row| [row.entry.name.clone(), row.record.failure.clone().unwrap_or_default()];
    (["campaign", "why"], fleet.failed().map(row).collect())
}

fn joints(fleet: &Fleet) -> Cells<7> {
    let row = |joint: &Joint| {
        let last = &fleet.rows[joint.last()];
        let figure = |name: &str| last.figure(name).map_or("–".to_string(), |x| significant(x, 3));
        let drifted = match (&joint.incomparable, joint.since == joint.last()) {
            (Some(why), _) => why.clone(),
            (None, true) => "one campaign since".to_string(),
            (None, false) if joint.drifts.is_empty() => if joint.changed.differs() { "yes" } else { "no" }.to_string(),
            _ => joint.drifts.iter().map(|d| words(&d.name, &fleet.rows[joint.since])).collect::<Vec<_>>().join("; "),
        };
        let diagnosis = last.record.diagnosis.as_ref();
        [
            joint.name.clone(),
            joint.rows.len().to_string(),
            when(fleet, joint.last()),
            figure("rmse_nm"),
            diagnosis.map_or("–".to_string(), |found| format!("{} {}", found.verdict, found.effects.join(", "))),
            joint.change_nm.map_or("–".to_string(), |x| significant(x, 3)),
            drifted,
        ]
    };
    (
        ["joint", "campaigns", "last", "RMSE (N m)", "verdict", "prediction's change (N m)", "drifted"],
        fleet.joints.iter().map(row).collect(),
    )
}

/// The day of the campaign at `at`, or its name.
pub(super) fn when(fleet: &Fleet, at: usize) -> String {
    let entry = &fleet.rows[at].entry;
    entry.date.clone().unwrap_or_else(|| entry.name.clone())
}

fn table<const N: usize>(title: &str, intro: &str, (heads, mut rows): Cells<N>) -> Option<Table> {
    let more = match rows.len() {
        0 => return None,
        n if n > ON_THE_PAGE => format!(" The first {ON_THE_PAGE} of {n}; fleet.json and table.csv hold all."),
        _ => String::new(),
    };
    rows.truncate(ON_THE_PAGE);
    Some(Table {
        title: title.to_string(),
        intro: format!("{intro}{more}"),
        heads: heads.map(String::from).to_vec(),
        rows: rows.into_iter().map(Vec::from).map(cells).collect(),
    })
}

/// The page of `fleet`, called `name`.
pub fn page(fleet: &Fleet, name: &str) -> Page {
    let card = |name: &str, value: String, note: &str| Card { name: name.into(), value, note: note.into() };
    let drawn = plots::fleet::figures(fleet);
    // From a row to the joint's figure.
    let linked = |mut table: Table| {
        for row in &mut table.rows {
            let figure = drawn.iter().find(|(joint, _)| joint.name == row[0].text);
            row[0].link = figure.map_or_else(String::new, |(_, figure)| figure.name.clone());
        }
        table
    };
    let mut sections: Vec<Section> = tables(fleet)
        .into_iter()
        .map(|mut table| Section::open(&std::mem::take(&mut table.title), vec![Block::Table(linked(table))]))
        .collect();
    let options: Vec<_> = drawn.into_iter().map(|(joint, figure)| (joint.name.clone(), vec![figure])).collect();
    if !options.is_empty() {
        sections.insert(0, Section::open("Joints over time", vec![Block::Choice("joint", options)]));
    }
    Page {
        kicker: "tautline batch".to_string(),
        title: name.to_string(),
        subject: "fleet".to_string(),
        short: sentence(fleet),
        cards: vec![
            card("campaigns", fleet.rows.len().to_string(), "in the table"),
            card("failed", fleet.failed().count().to_string(), "each with its reason"),
            card("joints drifted", fleet.drifted().count().to_string(), "beyond their confidence"),
            card("stand out", fleet.outliers.len().to_string(), "values far from the fleet's"),
        ],
        next: next(fleet),
        warnings: fleet.warnings.iter().map(Warning::from).collect(),
        sections,
        ..Page::default()
    }
}

/// What to do next, a sentence each.
fn next(fleet: &Fleet) -> Vec<String> {
    let drifted: Vec<&str> = fleet.drifted().map(|joint| joint.name.as_str()).take(ON_THE_TERMINAL).collect();
    let mut steps = Vec::new();
    if !drifted.is_empty() {
        steps.push(format!(
            "Look at what drifted ({}); tautline diagnose LAST_CAMPAIGN --model FIRST_MODEL -o FOLDER ranks causes. Retension the cables, \
             or use the last model.",
            drifted.join(", ")
        ));
    }
    if fleet.failed().next().is_some() {
        steps.push(
            "Mend the campaigns that failed: tautline validate CAMPAIGN names every fault with its cure.".to_string(),
        );
    }
    if steps.is_empty() {
        steps.push("Keep the models: no joint drifted beyond what its campaigns know.".to_string());
    }
    steps
}

/// The tables of the page that have rows, each with its title.
fn tables(fleet: &Fleet) -> Vec<Table> {
    let drift_intro = format!(
        "First campaign since the cables were last retensioned, or the first of all, against the last, both as the whole history has \
         them. {} followed; the intervals are wide enough to hold all together with 95 %. With five campaigns or more they hold the \
         scatter between sessions, with fewer only what each campaign knows of itself. A and B(v) are what parameters that are \
         correlated amount to.",
        counted(fleet.compared, "parameter or function", "parameters and functions")
    );
    let all = [
        table(
            "What changed since the cables were last retensioned",
            "Decided on A and B(v) of the first campaign since then and the last, with the intervals of both.",
            changes(fleet),
        ),
        table("When limits will be reached", life::LIMITS, life::limits(fleet)),
        table("Retensionings, and other changes at one time", life::EVENTS, life::events(fleet)),
        table("Slow drift", life::DRIFTS, life::drifts(fleet)),
        table("What follows the temperature", life::TEMPERATURE, life::temperature(fleet)),
        table("How much changed since", &drift_intro, drifts(fleet)),
        table("Campaigns that failed", "The others are complete.", failures(fleet)),
        table(
            "Outliers",
            "More than six standard deviations from the fleet's median, with the deviation estimated from the middle of the fleet; \
             only pinned parameters.",
            outliers(fleet),
        ),
        table("Joints", "RMSE and verdict are of the last campaign.", joints(fleet)),
    ];
    all.into_iter().flatten().collect()
}

/// Writes the summary to `out`; `written` is where the files went.
pub fn write_summary(out: &mut impl Write, fleet: &Fleet, written: &Path) -> io::Result<()> {
    writeln!(
        out,
        "{BOLD}{}{BOLD:#}  {DIM}{}{DIM:#}",
        counted(fleet.rows.len(), "campaign", "campaigns"),
        wrapped(&sentence(fleet), 15)
    )?;
    lines(out, "Changed since the cables were last retensioned", changes(fleet).1)?;
    lines(out, "Limits", life::limits(fleet).1)?;
    lines(out, "Changed at one time", life::events(fleet).1)?;
    lines(out, "Drifts slowly", life::drifts(fleet).1)?;
    lines(out, "Follows the temperature", life::temperature(fleet).1)?;
    lines(out, "Since the cables were last retensioned", drifts(fleet).1)?;
    lines(out, "Stand out", outliers(fleet).1)?;
    lines(out, "Failed", failures(fleet).1)?;
    lines(out, "Warnings", fleet.warnings.iter().map(|warning| [warning.clone()]).collect())?;
    writeln!(out, "\n  {}", written.join("report.html").display())
}

fn lines<const N: usize>(out: &mut impl Write, title: &str, rows: Vec<[String; N]>) -> io::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    heading(out, title)?;
    for row in rows.iter().take(ON_THE_TERMINAL) {
        writeln!(out, "  {YELLOW}!{YELLOW:#} {}", wrapped(&row.join(", "), 4))?;
    }
    match rows.len().saturating_sub(ON_THE_TERMINAL) {
        0 => Ok(()),
        more => writeln!(out, "  {DIM}and {more} more{DIM:#}"),
    }
}
