//! The thresholds of a diagnosis: the one schema that is made from a list of values, [`ENTRIES`], and not from a type.

use crate::diagnose::{ENTRIES, POLICY_FORMAT, Policy, Threshold};
use schemars::{Schema, json_schema};
use serde_json::{Map, Value, json};

/// The schema of a policy: every threshold with its default, its unit and its reason.
pub fn schema() -> Schema {
    let default = Policy::default();
    let property = |threshold: &Threshold| {
        let (value, (unit, reason)) = (threshold.of(&default), threshold.unit_and_reason());
        let description = format!("Default {value}. {unit}: {reason}");
        let property = json!({ "description": description, "type": "number", "exclusiveMinimum": 0, "default": value });
        (threshold.name.to_string(), property)
    };
    let format = json!({ "description": format!("Always {POLICY_FORMAT}."), "const": POLICY_FORMAT });
    let properties: Map<String, Value> =
        std::iter::once(("format".to_string(), format)).chain(ENTRIES.iter().map(property)).collect();
    json_schema!({
        "title": "Policy",
        "description": "Thresholds by which a diagnosis decides; those that are not named keep their defaults.",
        "type": "object",
        "properties": properties,
        "required": ["format"],
        "additionalProperties": false,
    })
}
