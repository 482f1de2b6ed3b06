//! `compare --json` and `check --json`: results, which may gain keys.

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

/// Two models of one joint compared.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Comparison {
    /// Always comparison/1.
    pub format: ComparisonFormat,
    /// The joint's name.
    pub joint: String,
    /// Whether A or B(v) changed beyond their intervals; null where a model does not hold them.
    pub changed: Option<bool>,
    /// Chance that unchanged A and B(v) would differ as much; null likewise.
    pub chance: Option<f64>,
    /// Causes of the change.
    pub what_changed: Vec<ChangeCause>,
    /// Every parameter of either model.
    pub parameters: Vec<ParameterChange>,
    /// What both models know with an interval.
    pub functions: Vec<FunctionChange>,
    /// A and B(v), by direction, of which one of the models knows nothing.
    pub not_known: Vec<NotKnown>,
    /// Friction at some speeds, as the parameters have it.
    pub friction: Vec<FrictionLevel>,
    /// Curve of the combination before and after.
    pub combination: Vec<String>,
    /// What the change does to the predicted torque.
    pub prediction: Prediction,
    /// For people: where it comes from.
    pub provenance: Option<Value>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum ComparisonFormat {
    /// Version 1.
    #[serde(rename = "comparison/1")]
    V1,
}

/// What changed, as A and B(v) tell it.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct ChangeCause {
    /// coulomb_friction, viscous_friction, stribeck_friction, friction_per_load, gain_or_load_coefficient, gravity_or_spring,
    /// torque_offset, change_over or position_zero.
    pub what: String,
    /// up or down; null of what concerns both.
    pub direction: Option<String>,
    /// Change of the torque, N m; null of what is no torque.
    pub change_nm: Option<f64>,
    /// Lower end of its 95 % interval, N m.
    pub low_nm: Option<f64>,
    /// Upper end, N m.
    pub high_nm: Option<f64>,
    /// Change of an angle, rad.
    pub change_rad: Option<f64>,
    /// Change as a share of what was before.
    pub relative: Option<f64>,
    /// Lower end of its 95 % interval.
    pub relative_low: Option<f64>,
    /// Upper end.
    pub relative_high: Option<f64>,
    /// Dotted names of the parameters that stand for it.
    pub parameters: Vec<String>,
    /// Causes that these data cannot tell it from.
    pub or: Vec<Rival>,
}

/// A cause that would explain as much.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Rival {
    /// Which.
    pub what: String,
    /// up or down; null of what concerns both.
    pub direction: Option<String>,
}

/// A parameter in both models.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct ParameterChange {
    /// Its dotted name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Before; null where that model lacks it.
    pub before: Option<f64>,
    /// After.
    pub after: Option<f64>,
    /// Their difference.
    pub change: Option<f64>,
    /// Lower end of the change's 95 % interval; open where null.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// changed, within_confidence, known_only_together or unknown.
    pub verdict: String,
}

/// A function in both models, with 95 % half widths.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct FunctionChange {
    /// a, b, hysteresis_width or change_over_travel.
    pub function: String,
    /// up or down; null of what concerns both.
    pub direction: Option<String>,
    /// At what speed, rad/s.
    pub speed_rad_s: Option<f64>,
    /// Its unit.
    pub unit: String,
    /// Before.
    pub before: f64,
    /// Half width of that.
    pub before_half_width: f64,
    /// After.
    pub after: f64,
    /// Half width of that.
    pub after_half_width: f64,
    /// Their difference.
    pub change: f64,
    /// Half width of the difference.
    pub half_width: f64,
}

/// A function that cannot be compared.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct NotKnown {
    /// a or b.
    pub function: String,
    /// up or down.
    pub direction: String,
}

/// Friction at one speed.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct FrictionLevel {
    /// up or down.
    pub direction: String,
    /// rad/s.
    pub speed_rad_s: f64,
    /// Before, N m.
    pub before_nm: f64,
    /// After, N m.
    pub after_nm: f64,
    /// Their difference, N m.
    pub change_nm: f64,
}

/// Change of the predicted torque along a motion.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Prediction {
    /// Which motion.
    pub motion: String,
    /// Whether gravity and inertia are left out, which a chain holds.
    pub friction_alone: bool,
    /// Root mean square, N m.
    pub rms_change_nm: f64,
    /// Mean, N m.
    pub mean_change_nm: f64,
    /// Largest, N m.
    pub peak_change_nm: f64,
    /// How much of it the intervals of A and B(v) explain, N m; null where one is open.
    pub explained_by_intervals_nm: Option<f64>,
}

/// A campaign beside its stored baseline.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Check {
    /// Always check/1.
    pub format: CheckFormat,
    /// The campaign.
    pub campaign: String,
    /// The baseline's file.
    pub baseline: String,
    /// Whether anything regressed; exit status 1.
    pub regressed: bool,
    /// How many findings have each outcome.
    pub counts: Counts,
    /// Everything compared.
    pub findings: Vec<Finding>,
    /// For people: where it comes from.
    pub provenance: Option<Value>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum CheckFormat {
    /// Version 1.
    #[serde(rename = "check/1")]
    V1,
}

/// Findings by outcome.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Counts {
    /// No difference beyond rounding.
    pub same: u64,
    /// Data that are the same but for rounding.
    pub rounded: u64,
    /// Data that changed.
    pub changed: u64,
    /// Figures that moved within their confidence.
    pub within_confidence: u64,
    /// Figures too loosely known to tell.
    pub too_loosely_known: u64,
    /// Errors that shrank beyond their confidence.
    pub better: u64,
    /// What matters.
    pub regressed: u64,
}

/// One thing compared.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Finding {
    /// setting, data, stage, choice or figure.
    pub part: String,
    /// Its name.
    pub name: String,
    /// The unit of numbers.
    pub unit: String,
    /// In the baseline; null where it was not there.
    pub before: Option<Held>,
    /// Now.
    pub now: Option<Held>,
    /// What a number moved by.
    pub moved: Option<f64>,
    /// What it may move by; open where null.
    pub allowed: Option<f64>,
    /// moved over allowed.
    pub tolerances: Option<f64>,
    /// same, rounded, changed, within_confidence, too_loosely_known, better or regressed.
    pub outcome: String,
    /// What there is to say of it.
    pub note: String,
}

/// A number or a text.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Held {
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
}
