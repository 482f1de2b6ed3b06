//! The result of one campaign, as a file holds it.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;

/// The format's name and version.
pub const FORMAT: &str = "batch-result/1";

/// The result of one campaign.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Record {
    /// `FORMAT`.
    pub format: String,
    /// The campaign's name in the batch.
    pub name: String,
    /// What it was worked out from (`digest`).
    pub inputs: String,
    /// By which version of tautline.
    pub tautline: String,
    /// Why there is no result; nothing below means anything then.
    pub failure: Option<String>,
    /// The model as in `model.json`.
    pub model: Option<Value>,
    /// "sweeps" or "free": how it was found.
    pub route: String,
    /// Trials read.
    pub trials: usize,
    /// Rows read.
    pub rows: usize,
    /// Figures by their names in the table; those that are not known are absent.
    pub figures: BTreeMap<String, f64>,
    /// What separates model and recordings, if that was asked.
    pub diagnosis: Option<Diagnosed>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// How long it took, s: the only thing that may differ from one time to the next.
    pub duration_s: f64,
}

/// What a diagnosis says, in short.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Diagnosed {
    /// The verdict's kind.
    pub verdict: String,
    /// The causes that it names.
    pub effects: Vec<String>,
    /// Whose model the recordings were held against: the reference campaign's name, a file's, or `itself`.
    #[serde(default)]
    pub against: String,
}
