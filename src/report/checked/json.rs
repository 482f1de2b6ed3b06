//! `check --json`.

use super::Names;
use crate::check::{Checked, Finding, Held, Outcome};
use serde_json::{Value, json};

/// Everything that was compared; numbers that are not finite are null.
pub fn to_json(checked: &Checked, names: &Names) -> Value {
    let count = |outcome: Outcome| checked.with(outcome).count();
    json!({
        "format": "check/1",
        "campaign": names.campaign,
        "baseline": names.baseline,
        "regressed": checked.is_regressed(),
        "counts": {
            "same": count(Outcome::Same),
            "rounded": count(Outcome::Rounded),
            "changed": count(Outcome::Changed),
            "within_confidence": count(Outcome::Within),
            "too_loosely_known": count(Outcome::Untold),
            "better": count(Outcome::Better),
            "regressed": count(Outcome::Regressed),
        },
        "findings": checked.findings.iter().map(finding).collect::<Vec<Value>>(),
        "provenance": { "tautline": env!("CARGO_PKG_VERSION"), "stored_by": names.stored_by },
    })
}

fn finding(finding: &Finding) -> Value {
    let held = |held: &Held| match held {
        Held::Nothing => Value::Null,
        Held::Text(text) => json!(text),
        Held::Number(number) => json!(number),
    };
    json!({
        "part": finding.part.name(),
        "name": finding.name,
        "unit": finding.unit,
        "before": held(&finding.before),
        "now": held(&finding.now),
        "moved": finding.moved(),
        "allowed": finding.allowed,
        "tolerances": finding.tolerances(),
        "outcome": finding.outcome.name(),
        "note": finding.note,
    })
}
