//! `interaction --json`: a result, which may gain keys.

use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;

/// The torque that a person adds.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Interaction {
    /// Always interaction/1.
    pub format: InteractionFormat,
    /// Where the torque is told: at the joint or at the sensor.
    pub frame: String,
    /// Whether only samples of the past were used.
    pub causal: bool,
    /// Delay of the filters, s.
    pub filter_delay_s: f64,
    /// Cut-off of the low-pass, Hz.
    pub lowpass_hz: f64,
    /// A contact is a torque above this, N m ...
    pub threshold_nm: Option<f64>,
    /// ... and after reversals above this, N m.
    pub threshold_at_reversals_nm: Option<f64>,
    /// 95 % half width of the torque, N m ...
    pub uncertainty_nm: Option<f64>,
    /// ... and after reversals, N m.
    pub uncertainty_at_reversals_nm: Option<f64>,
    /// Trials in which nobody acts, from which thresholds come.
    pub quiet: Quiet,
    /// Trial by trial.
    pub trials: Vec<InteractionTrial>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// For people: where it comes from.
    pub provenance: Option<Value>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum InteractionFormat {
    /// Version 1.
    #[serde(rename = "interaction/1")]
    V1,
}

/// Trials in which nobody acts.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Quiet {
    /// How many.
    pub trials: u64,
    /// How long, s.
    pub seconds: f64,
    /// RMSE of the model in them, N m.
    pub rmse_nm: Option<f64>,
    /// Contacts told in them.
    pub false_alarms: u64,
    /// The same per hour; null where there are none of them.
    pub false_alarm_rate_per_hour: Option<f64>,
    /// At most, with 95 % confidence.
    pub false_alarm_rate_at_most_per_hour: Option<f64>,
}

/// One trial; errors are those against a recorded reference torque, null where there is none.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct InteractionTrial {
    /// Its log.
    pub file: String,
    /// Root mean square error, N m.
    pub rmse_nm: Option<f64>,
    /// Mean absolute error, N m.
    pub mae_nm: Option<f64>,
    /// RMSE in percent of the reference's range.
    pub rmse_percent: Option<f64>,
    /// MAE in percent of the reference's range.
    pub mae_percent: Option<f64>,
    /// Largest error, N m.
    pub max_error_nm: Option<f64>,
    /// Error of the contacts' peaks, N m.
    pub peak_error_nm: Option<f64>,
    /// Delay against the reference, s.
    pub delay_s: Option<f64>,
    /// Delay of the contacts' onsets, s.
    pub onset_delay_s: Option<f64>,
    /// Slope of the torque over the reference.
    pub slope: Option<f64>,
    /// Contacts of the reference.
    pub reference_contacts: Option<u64>,
    /// Of those not told.
    pub missed: Option<u64>,
    /// Told that the reference does not have.
    pub spurious: Option<u64>,
    /// Samples at which the torque is known.
    pub samples: u64,
    /// A contact begins above this, N m.
    pub onset_threshold_nm: Option<f64>,
    /// False alarms per hour in quiet trials.
    pub false_alarm_rate_per_hour: Option<f64>,
    /// Contacts.
    pub contacts: Vec<Contact>,
}

/// One contact.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Contact {
    /// When it begins, s.
    pub onset_s: f64,
    /// When it ends, s.
    pub release_s: f64,
    /// Its largest torque, N m.
    pub peak_nm: f64,
    /// Whether it is after a reversal, where the torque is known less well.
    pub at_reversal: bool,
}
