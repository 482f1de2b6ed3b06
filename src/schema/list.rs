//! A list of campaigns.

use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Campaigns for `tautline batch` and `tautline repeatability`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Batch {
    /// Always batch/1.
    pub format: BatchFormat,
    /// The campaigns.
    pub campaigns: Vec<Entry>,
    /// When cables were retensioned.
    #[serde(default)]
    pub retensioned: Vec<Retensioned>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum BatchFormat {
    /// Version 1.
    #[serde(rename = "batch/1")]
    V1,
}

/// A campaign of the list.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// Its folder, from the list's.
    pub path: String,
    /// What tables call it; its folder's name where absent.
    pub name: Option<String>,
    /// Its joint; the campaign's own where absent.
    pub joint: Option<String>,
    /// When it was recorded: 2026-03-02, or with a time.
    pub date: Option<String>,
    /// A model to be evaluated and diagnosed in place of its own.
    pub model: Option<String>,
    /// Whether others are compared with it.
    pub reference: Option<bool>,
    /// Conditions by name, in words or numbers.
    pub conditions: Option<BTreeMap<String, Condition>>,
}

/// A condition's value.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Condition {
    /// In numbers.
    Number(f64),
    /// In words.
    Word(String),
}

/// When the cables of a joint were retensioned.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Retensioned {
    /// The joint.
    pub joint: String,
    /// The date.
    pub date: String,
}
