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
    /// What is not to be passed, and is forecast.
    #[serde(default)]
    pub limits: Vec<Limit>,
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

/// A limit; one of `at_most` and `at_least` is needed.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limit {
    /// What is limited: `friction_nm`, or a parameter by its dotted name.
    pub what: String,
    /// The joint; every joint where absent.
    pub joint: Option<String>,
    /// Of `friction_nm`: the speed, rad/s.
    pub speed_rad_s: Option<f64>,
    /// Its magnitude is not to be above this, in the unit of what is limited.
    pub at_most: Option<f64>,
    /// Nor below this.
    pub at_least: Option<f64>,
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
