//! Many campaigns as `fleet.json`, on the terminal, and as a page.

mod json;
mod tables;

pub use json::to_json;
pub(super) use tables::{Cells, told, when};

use super::life;
use super::number::counted;
use super::page::{Block, Card, Page, Section, Table, Warning};
use super::plots;
use super::terminal::{BOLD, DIM, YELLOW, heading, wrapped};
use super::wording::Units;
use crate::batch::{Fleet, Joint};
use std::io::{self, Write};
use std::path::Path;
use tables::{changes, drifts, failures, outliers, tables, words};

/// Joints named in the verdict.
const IN_THE_SENTENCE: usize = 3;
/// Rows of a table on the terminal; the files hold all.
const ON_THE_TERMINAL: usize = 12;

fn sentence(fleet: &Fleet) -> String {
    let joints = counted(fleet.joints.len(), "joint", "joints");
    let changed: Vec<&Joint> = fleet.drifted().collect();
    let change = match (changed.len(), fleet.compared) {
        (_, 0) => format!("{joints}, none with two campaigns to compare"),
        (0, _) => format!("None of {joints} changed beyond its intervals"),
        (n, _) => {
            let more = match n.saturating_sub(IN_THE_SENTENCE) {
                0 => String::new(),
                more => format!("; and {more} more"),
            };
            let one = |joint: &&Joint| format!("{}, {}", joint.name, change_of(fleet, joint));
            let named = changed.iter().take(IN_THE_SENTENCE).map(one).collect::<Vec<_>>().join("; ");
            format!("{n} of {joints} changed since the cables were last retensioned: {named}{more}")
        }
    };
    let failures = match fleet.failed().count() {
        0 => "All campaigns were identified".to_string(),
        n => format!("{} could not be identified", counted(n, "campaign", "campaigns")),
    };
    format!("{change}. {failures}.")
}

/// What changed of `joint`: the cause, or the quantities whose change has none.
fn change_of(fleet: &Fleet, joint: &Joint) -> String {
    match joint.changed.differs() {
        true => told(&joint.changed, &units(fleet, joint)),
        false => joint.drifts.iter().map(|d| words(&d.name, &fleet.rows[joint.since])).collect::<Vec<_>>().join(", "),
    }
}

fn units(fleet: &Fleet, joint: &Joint) -> Units {
    Units::of_kind(fleet.rows[joint.since].model.as_ref().map(|model| model.joint.kind).unwrap_or_default())
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
            card("campaigns", fleet.rows.len().to_string(), "listed in table.csv"),
            card("failed", fleet.failed().count().to_string(), "campaigns without a model"),
            card("joints changed", fleet.drifted().count().to_string(), "beyond their 95 % intervals"),
            card("outliers", fleet.outliers.len().to_string(), "values far from the fleet's median"),
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
            "Find the cause of each change ({}): tautline diagnose LAST_CAMPAIGN --model FIRST_MODEL -o FOLDER ranks candidates. Correct it \
             (retension the cables, zero the sensor), or use the last model from now on.",
            drifted.join(", ")
        ));
    }
    if fleet.failed().next().is_some() {
        steps.push(
            "Correct the campaigns that failed: tautline validate CAMPAIGN reports every fault with its cure."
                .to_string(),
        );
    }
    if steps.is_empty() {
        steps.push("Keep the models: no joint changed beyond its intervals.".to_string());
    }
    steps
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
    lines(out, "Retensionings and other jumps", life::events(fleet).1)?;
    lines(out, "Slow drift", life::drifts(fleet).1)?;
    lines(out, "Temperature dependence", life::temperature(fleet).1)?;
    lines(out, "Quantities that changed since then", drifts(fleet).1)?;
    lines(out, "Outliers", outliers(fleet).1)?;
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
