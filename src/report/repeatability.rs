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
    let count = |name: &str| of.quantities.iter().filter(|q| q.verdict.name() == name).count();
    format!(
        "{} of {}: {} repeatable within their intervals, {} scatter more than their intervals claim, {} depend on a named condition, \
         {} not identifiable.",
        counted(of.runs.len(), "run", "runs"),
        of.joint,
        count("repeatable"),
        count("scatters_more_than_claimed"),
        count("depends_on_condition"),
        count("not_identifiable")
    )
}

fn table(of: &Repeatability) -> Table {
    let number = |x: f64| if x.is_finite() { significant(x, 4) } else { "–".to_string() };
    let row = |q: &Quantity| {
        let name = if q.unit.is_empty() { q.name.clone() } else { format!("{} ({})", q.name, q.unit) };
        vec![name, number(q.mean), number(q.claimed), number(q.honest), verdict(q)]
    };
    Table {
        title: of.joint.clone(),
        intro: "Mean over the runs; half width of one run's 95 % interval as identified (claimed) and as the runs' scatter shows it \
                (honest). Not identifiable: half of the runs or fewer show it."
            .to_string(),
        heads: ["", "mean", "claimed", "honest", "verdict"].map(String::from).to_vec(),
        rows: of.quantities.iter().map(row).map(cells).collect(),
    }
}

fn absorbed(of: &Repeatability) -> Option<Table> {
    (!of.absorbed.is_empty()).then(|| Table {
        title: format!("What absorbs what, {}", of.joint),
        intro: "Parameters that change together from run to run: each takes up what the other leaves.".to_string(),
        heads: ["parameter", "with", "correlation"].map(String::from).to_vec(),
        rows: of.absorbed.iter().map(|(a, b, r)| cells(vec![a.clone(), b.clone(), format!("{r:+.2}")])).collect(),
    })
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
            card("repeatable", count("repeatable"), "scatter as their intervals claim"),
            card("scatter more", count("scatters_more_than_claimed"), "use the honest interval"),
            card("depend", count("depends_on_condition"), "on a named condition"),
            card("not identifiable", count("not_identifiable"), "in most of the runs"),
        ],
        lead: plots::repeatability::figures(found),
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
        heading(out, "Mean, half width as claimed and as the scatter shows it, verdict")?;
        let quantities = table(of);
        write_table(out, &quantities.heads, &quantities.texts())?;
        for (a, b, r) in &of.absorbed {
            writeln!(out, "  {DIM}{a} and {b} change together from run to run (correlation {r:+.2}){DIM:#}")?;
        }
    }
    Ok(())
}
