//! Runs of one joint under nominally the same conditions as `repeatability.json`, on the terminal, and as a page.

use super::number::{counted, significant};
use super::page::{Block, Card, Page, Section, Table, cells};
use super::plots;
use super::terminal::{BOLD, DIM, heading, table as write_table};
use crate::batch::{Quantity, Repeatability, Repeated};
use serde_json::{Value, json};
use std::io::{self, Write};

/// For programs; what is not known is null.
pub fn to_json(found: &[Repeatability]) -> Value {
    let quantity = |q: &Quantity| {
        let value = |value: &Option<(f64, f64)>| value.map(|(x, se)| json!({ "value": x, "standard_error": se }));
        let (condition, slope, half_width) = match &q.verdict {
            Repeated::DependsOn { condition, slope } => {
                (Some(condition), slope.map(|slope| slope.0), slope.map(|slope| slope.1))
            }
            _ => (None, None, None),
        };
        json!({
            "name": q.name, "unit": q.unit, "verdict": q.verdict.name(), "mean": q.mean,
            "claimed_half_width": q.claimed, "honest_half_width": q.honest,
            "condition": condition, "change_per_unit": slope, "change_per_unit_half_width": half_width,
            "runs": q.values.iter().map(value).collect::<Vec<_>>(),
        })
    };
    let joint = |of: &Repeatability| {
        let pair = |(a, b, r): &(String, String, f64)| json!({ "parameters": [a, b], "correlation": r });
        json!({
            "joint": of.joint,
            "runs": of.runs,
            "quantities": of.quantities.iter().map(quantity).collect::<Vec<Value>>(),
            "absorbed": of.absorbed.iter().map(pair).collect::<Vec<Value>>(),
        })
    };
    json!({
        "format": "repeatability/1",
        "joints": found.iter().map(joint).collect::<Vec<Value>>(),
        "provenance": { "tautline": env!("CARGO_PKG_VERSION") },
    })
}

/// The verdict in words.
fn verdict(q: &Quantity) -> String {
    match &q.verdict {
        Repeated::Repeatable => "repeatable".to_string(),
        Repeated::Scatters => format!("scatters {:.1} times its interval", q.wider()),
        Repeated::DependsOn { condition, slope: Some((slope, half)) } => {
            let unit = if q.unit.is_empty() { String::new() } else { format!(" {}", q.unit) };
            format!("depends on {condition}: {} +- {}{unit} per unit", significant(*slope, 3), significant(*half, 2))
        }
        Repeated::DependsOn { condition, slope: None } => format!("depends on {condition}"),
        Repeated::NotIdentifiable => "not identifiable".to_string(),
    }
}

fn sentence(of: &Repeatability) -> String {
    let verdicts = [
        ("repeatable", "repeatable within their intervals"),
        ("scatters_more_than_claimed", "scatter more than their intervals"),
        ("depends_on_condition", "depend on a recorded condition"),
        ("not_identifiable", "not identifiable"),
    ];
    let told = verdicts.iter().filter_map(|(name, words)| {
        let count = of.quantities.iter().filter(|q| q.verdict.name() == *name).count();
        (count > 0).then(|| format!("{count} {words}"))
    });
    let quantities = counted(of.quantities.len(), "quantity", "quantities");
    let runs = counted(of.runs.len(), "run", "runs");
    format!("{runs} of {}, {quantities}: {}.", of.joint, told.collect::<Vec<_>>().join(", "))
}

fn table(of: &Repeatability) -> Table {
    let number = |x: f64| if x.is_finite() { significant(x, 4) } else { "–".to_string() };
    let row = |q: &Quantity| {
        let name = if q.unit.is_empty() { q.name.clone() } else { format!("{} ({})", q.name, q.unit) };
        vec![name, number(q.mean), number(q.claimed), number(q.honest), verdict(q)]
    };
    Table {
        title: of.joint.clone(),
        intro: "Mean over the runs, and half width of one run's 95 % interval: as identified, and as the runs' scatter shows it. Not \
                identifiable: half of the runs or fewer show it."
            .to_string(),
        heads: ["", "mean", "± identified", "± by scatter", "verdict"].map(String::from).to_vec(),
        rows: of.quantities.iter().map(row).map(cells).collect(),
    }
}

fn absorbed(of: &Repeatability) -> Option<Table> {
    (!of.absorbed.is_empty()).then(|| Table {
        title: format!("What absorbs what, {}", of.joint),
        intro:
            "Parameters that change together from run to run: they are correlated, and each compensates for the other."
                .to_string(),
        heads: ["parameter", "with", "correlation"].map(String::from).to_vec(),
        rows: of.absorbed.iter().map(|(a, b, r)| cells(vec![a.clone(), b.clone(), format!("{r:+.2}")])).collect(),
    })
}

/// What to do next, a sentence each.
fn next(found: &[Repeatability]) -> Vec<String> {
    let named = |name: &str| found.iter().flat_map(|of| &of.quantities).any(|q| q.verdict.name() == name);
    let steps = [
        (
            "scatters_more_than_claimed",
            "Of what scatters more, use the interval by scatter, and look for what differs between the runs: \
          temperature, tension, the sensor's zero; conditions that campaign.toml records are tried as causes.",
        ),
        ("depends_on_condition", "Hold the named condition, or identify a model for each."),
        ("not_identifiable", "Do not use what is not identifiable as a value: compare A and B(v) instead."),
    ];
    let mut told: Vec<String> =
        steps.iter().filter(|(name, _)| named(name)).map(|(_, step)| (*step).to_string()).collect();
    if told.is_empty() {
        told.push("Trust the intervals of a single identification: the runs scatter as they say.".to_string());
    }
    told
}

/// The page of `found`.
pub fn page(found: &[Repeatability]) -> Page {
    let quantities = || found.iter().flat_map(|of| &of.quantities);
    let count = |name: &str| quantities().filter(|q| q.verdict.name() == name).count().to_string();
    let card = |name: &str, value: String, note: &str| Card { name: name.into(), value, note: note.into() };
    Page {
        kicker: "tautline repeatability".to_string(),
        title: found.iter().map(|of| of.joint.clone()).collect::<Vec<_>>().join(", "),
        subject: "repeatability".to_string(),
        short: found.iter().map(sentence).collect::<Vec<_>>().join(" "),
        cards: vec![
            card("repeatable", count("repeatable"), "scatter within their intervals"),
            card("scatter more", count("scatters_more_than_claimed"), "use the interval by scatter"),
            card("depend", count("depends_on_condition"), "on a recorded condition"),
            card("not identifiable", count("not_identifiable"), "in most of the runs"),
        ],
        lead: plots::repeatability::figures(found),
        next: next(found),
        sections: found
            .iter()
            .map(|of| {
                let tables = [Some(table(of)), absorbed(of)].into_iter().flatten();
                Section::open(&of.joint, tables.map(Block::Table).collect())
            })
            .collect(),
        ..Page::default()
    }
}

/// Writes the summary to `out`.
pub fn write_summary(out: &mut impl Write, found: &[Repeatability]) -> io::Result<()> {
    for of in found {
        writeln!(out, "{BOLD}{}{BOLD:#}  {DIM}{}{DIM:#}", of.joint, sentence(of))?;
        heading(out, "Mean, half width as identified and as the scatter shows it, verdict")?;
        let quantities = table(of);
        write_table(out, &quantities.heads, &quantities.texts())?;
        for (a, b, r) in &of.absorbed {
            writeln!(out, "  {DIM}{a} and {b} change together from run to run (correlation {r:+.2}){DIM:#}")?;
        }
    }
    Ok(())
}
