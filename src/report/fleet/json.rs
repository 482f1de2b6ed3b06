//! `fleet.json`.

use crate::batch::{Fleet, Joint, Outlier, Row};
use crate::compare::Attribution;
use crate::report::comparison::cause_json;
use crate::report::life;
use serde_json::{Value, json};

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
