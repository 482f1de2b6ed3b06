//! A comparison of two models as `comparison.json`, on the terminal, and as a page.
//!
//! | file | what it makes |
//! |---|---|
//! | `json` | `comparison.json` |
//! | `words` | the sentence that says what changed |
//! | `tables` | parameters, A and B(v), friction by speed |

mod json;
mod tables;
mod words;

pub(super) use json::cause_json;
pub use json::to_json;
pub(super) use words::told_cause;

use super::number::counted;
use super::page::{Block, Card, Page, Section};
use super::plots;
use super::terminal::{BOLD, DIM, heading, table, wrapped};
use super::wording::Units;
use crate::compare::{Comparison, Verdict};
use std::io::{self, Write};
use tables::{friction_table, functions_table, parameters_table};
use words::sentence;

/// What to do next, a sentence each.
fn next(found: &Comparison) -> Vec<String> {
    let changed = found.attribution.differs() || found.changes.iter().any(|c| c.verdict == Verdict::Changed);
    let mut steps = Vec::new();
    if !found.attribution.is_known() {
        let step = "To find out whether the prediction's change is real, compare models that tautline identify wrote: these hold A and B(v) \
                    with intervals.";
        steps.push(step.to_string());
    }
    if changed {
        let step = "Use the model of the later recordings. If nothing was changed on purpose, look for the cause: cable tension, wear, \
                    temperature, the sensor's zero; tautline diagnose LATER_CAMPAIGN --model EARLIER_MODEL -o FOLDER ranks causes.";
        steps.push(step.to_string());
    } else if found.attribution.is_known() {
        steps.push("Keep the earlier model: the later recordings do not show that it is out of date.".to_string());
    }
    steps
}

/// The page of `found`.
pub fn page(found: &Comparison, names: &[String; 2]) -> Page {
    let mut figures = plots::comparison::figures(found);
    let rest = figures.split_off(1);
    let units = Units::of(&found.before.joint);
    let card = |name: &str, value: String, note: &str| Card { name: name.into(), value, note: note.into() };
    let parameters = found.changes.iter().filter(|c| c.verdict == Verdict::Changed).count();
    let parameters = counted(parameters, "parameter", "parameters");
    let changed = match found.attribution.is_known() {
        true => (
            counted(found.attribution.causes.len(), "cause", "causes"),
            format!("found from A and B(v); {parameters} changed beyond the interval"),
        ),
        false => (parameters, "beyond the 95 % interval of the change".to_string()),
    };
    let functions =
        if found.functions.is_empty() { Vec::new() } else { vec![Block::Table(functions_table(found, &units))] };
    let sections = [
        Section::open("Effect on the prediction", rest.into_iter().rev().map(Block::Figure).collect()),
        Section::open("A, B(v), hysteresis and change-over", functions),
        Section::open("Parameters", vec![Block::Table(parameters_table(found))]),
        Section::folded("Friction without load, B(v)", vec![Block::Table(friction_table(found, &units))]),
    ];
    Page {
        kicker: format!("tautline compare · {} · {}", names[0], names[1]),
        title: found.before.joint.name.clone(),
        subject: "comparison".to_string(),
        short: sentence(found, &units),
        cards: vec![
            card("changed", changed.0, &changed.1),
            card("change of prediction, RMS", units.torque(found.effect.rms_nm), "along the cosine cascade"),
            card("its mean", units.torque(found.effect.mean_nm), "a constant offset, which taring removes"),
            card("its peak", units.torque(found.effect.peak_nm), "largest change"),
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
    heading(out, "Parameters, and their change with its 95 % interval (from ± 5 % where a model file gives none)")?;
    let parameters = parameters_table(found);
    table(out, &parameters.heads, &parameters.texts())?;
    let (known, title) = match found.functions.is_empty() {
        true => (friction_table(found, &units), "Friction without load, B(v)"),
        false => (functions_table(found, &units), "A, B(v), hysteresis and change-over, with 95 % intervals"),
    };
    heading(out, title)?;
    table(out, &known.heads, &known.texts())?;
    writeln!(out, "\n  {}", wrapped(&sentence(found, &units), 2))
}
