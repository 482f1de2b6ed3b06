//! `batch --json` and `repeatability --json`: results, which may gain keys.

use super::comparison::ChangeCause;
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

/// Many campaigns: what happened to each joint.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Fleet {
    /// Always fleet/1.
    pub format: FleetFormat,
    /// Campaigns in all.
    pub campaigns: u64,
    /// Those that could not be identified.
    pub failed: Vec<Failed>,
    /// Quantities in which a change was looked for.
    pub compared: u64,
    /// Joint by joint.
    pub joints: Vec<FleetJoint>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Campaigns unlike the fleet's others.
    pub outliers: Vec<Outlier>,
    /// For people: campaigns by where their results came from.
    pub work: Option<Value>,
    /// For people: where it comes from.
    pub provenance: Option<Value>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum FleetFormat {
    /// Version 1.
    #[serde(rename = "fleet/1")]
    V1,
}

/// A campaign that could not be identified.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Failed {
    /// Its name.
    pub campaign: String,
    /// Why.
    pub reason: Option<String>,
}

/// A joint over its campaigns.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct FleetJoint {
    /// Its name.
    pub joint: String,
    /// Its campaigns, in time.
    pub campaigns: Vec<String>,
    /// When it was last retensioned, as far as the list tells; null where never.
    pub retensioned: Option<Value>,
    /// The campaign that the last one is compared with: the named reference, or the first since retensioning.
    pub since: String,
    /// Whether anything changed since.
    pub changed: bool,
    /// What changed since.
    pub what_changed: Vec<ChangeCause>,
    /// What each retensioning did.
    pub retensionings: Vec<FleetEvent>,
    /// When else a level changed.
    pub events: Vec<FleetEvent>,
    /// Parameters and functions over the campaigns.
    pub quantities: Vec<FleetQuantity>,
    /// Limits, and when they will be reached.
    pub limits: Vec<Foreseen>,
    /// What differs since the reference beyond its interval.
    pub drifted: Vec<Difference>,
    /// RMS of the change of the predicted torque since, N m.
    pub prediction_rms_change_nm: Option<f64>,
    /// Why its campaigns cannot be compared, where they cannot.
    pub incomparable: Option<String>,
}

/// A retensioning, or another change of levels.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct FleetEvent {
    /// The date of the retensioning; null of another event.
    pub date: Option<String>,
    /// The last campaign before.
    pub before: String,
    /// The first after.
    pub after: String,
    /// The first of which it is no longer true, of an episode.
    pub until: Option<String>,
    /// The campaign after the retensioning before, which this one was to restore.
    pub as_after: String,
    /// What still differs from that campaign.
    pub differs: Vec<Difference>,
    /// What it changed.
    pub changes: Vec<FleetChange>,
    /// The same as causes.
    pub what_changed: Vec<ChangeCause>,
}

/// A quantity that changed.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct FleetChange {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// By how much.
    pub change: f64,
    /// Lower end of the change's 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A quantity in two campaigns.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Difference {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// Before.
    pub before: f64,
    /// After.
    pub after: f64,
    /// Their difference.
    pub change: f64,
    /// Lower end of the change's 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A parameter or function over the campaigns of a joint.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct FleetQuantity {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// How many campaigns show it.
    pub campaigns: u64,
    /// Scatter between campaigns beyond what they claim, a standard deviation.
    pub session_scatter: Option<f64>,
    /// What happened to it, in time.
    pub happened: Vec<FleetPart>,
    /// What would have been found had nobody recorded the temperature, where that is something else.
    pub without_temperature: Option<Vec<FleetPart>>,
}

/// One thing that happened to a quantity.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum FleetPart {
    /// Its level changed at a retensioning.
    Retensioning(FleetJump),
    /// Its level changed at any other time.
    Jump(FleetJump),
    /// It changed, and back again.
    Episode(FleetJump),
    /// It changes steadily.
    Drift {
        /// From this campaign on.
        since: String,
        /// Change per day.
        change_per_day: f64,
        /// Lower end of its 95 % interval.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// It follows the temperature.
    Temperature {
        /// Change per K.
        change_per_k: f64,
        /// Lower end of its 95 % interval.
        low: f64,
        /// Upper end.
        high: f64,
    },
}

/// A change of level.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct FleetJump {
    /// The last campaign before.
    pub before: String,
    /// The first after.
    pub after: String,
    /// The first with the old level again, of an episode.
    pub until: Option<String>,
    /// By how much.
    pub change: f64,
    /// Lower end of its 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// A limit, and when it will be reached.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Foreseen {
    /// What is limited.
    pub what: String,
    /// The quantity's name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// The limit, where it is an upper one.
    pub at_most: Option<f64>,
    /// The limit, where it is a lower one.
    pub at_least: Option<f64>,
    /// Whether it is reached already.
    pub reached: bool,
    /// When it will be.
    pub date: Option<String>,
    /// Beginning of the 95 % interval.
    pub low: Option<String>,
    /// Its end.
    pub high: Option<String>,
    /// Why that cannot be said, where it cannot.
    pub unknown: Option<String>,
}

/// A campaign unlike the others.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Outlier {
    /// Its name.
    pub campaign: String,
    /// Its joint.
    pub joint: String,
    /// What differs.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The fleet's median.
    pub median: f64,
    /// How far apart, in robust standard deviations.
    pub deviations: f64,
}

/// Several recordings of one joint: what comes out the same.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Repeatability {
    /// Always repeatability/1.
    pub format: RepeatabilityFormat,
    /// Joint by joint.
    pub joints: Vec<RepeatedJoint>,
    /// For people: where it comes from.
    pub provenance: Option<Value>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum RepeatabilityFormat {
    /// Version 1.
    #[serde(rename = "repeatability/1")]
    V1,
}

/// A joint over its runs.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RepeatedJoint {
    /// Its name.
    pub joint: String,
    /// Names of the runs.
    pub runs: Vec<String>,
    /// Each parameter and function.
    pub quantities: Vec<RepeatedQuantity>,
    /// Pairs of parameters that change together from run to run.
    pub absorbed: Vec<Absorbed>,
}

/// A parameter or function over the runs.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RepeatedQuantity {
    /// Its name.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// repeatable, scatters_more_than_claimed, depends_on_condition or not_identifiable.
    pub verdict: String,
    /// Weighted mean over the runs.
    pub mean: Option<f64>,
    /// Half width of one run's 95 % interval as identified.
    pub claimed_half_width: Option<f64>,
    /// The same as the scatter over the runs shows it.
    pub honest_half_width: Option<f64>,
    /// The condition that it depends on.
    pub condition: Option<String>,
    /// Change per unit of a condition in numbers.
    pub change_per_unit: Option<f64>,
    /// Half width of that.
    pub change_per_unit_half_width: Option<f64>,
    /// Run by run; null where one does not show it.
    pub runs: Vec<Option<RunValue>>,
}

/// What one run says.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct RunValue {
    /// The value.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
}

/// Two parameters that change together.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Absorbed {
    /// Both dotted names.
    pub parameters: Vec<String>,
    /// Their correlation over the runs.
    pub correlation: f64,
}
