//! `evaluation.json` and `diagnosis.json`: results, which may gain keys.

use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A model evaluated on motions. Errors are of torques with both sides low-passed; those called raw are not.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Evaluation {
    /// Always evaluation/1.
    pub format: EvaluationFormat,
    /// Trial by trial.
    pub trials: Vec<Trial>,
    /// Mean and SD over trials of one motion.
    pub groups: Vec<Group>,
    /// All trials together.
    pub overall: Figures,
    /// By curve of the combination.
    pub combinations: BTreeMap<String, Figures>,
    /// Cut-off of the low-pass, Hz.
    pub lowpass_hz: f64,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum EvaluationFormat {
    /// Version 1.
    #[serde(rename = "evaluation/1")]
    V1,
}

/// One trial.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Trial {
    /// Its log.
    pub file: String,
    /// uniform, cosine or free.
    pub protocol: String,
    /// Which repeat.
    pub repeat: u32,
    /// Its errors.
    #[serde(flatten)]
    pub figures: Figures,
}

/// Errors over samples; null where there is none.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Figures {
    /// Root mean square, N m.
    pub rmse_nm: Option<f64>,
    /// Mean absolute, N m.
    pub mae_nm: Option<f64>,
    /// Largest, N m.
    pub peak_nm: Option<f64>,
    /// RMSE in percent of the measured range.
    pub rmse_percent: Option<f64>,
    /// MAE in percent of the measured range.
    pub mae_percent: Option<f64>,
    /// How many samples.
    pub samples: u64,
    /// The same with neither side filtered.
    pub raw_rmse_nm: Option<f64>,
    /// Of samples with |K_f| = 1.
    pub stable: Option<Box<Figures>>,
    /// Of samples with |K_f| < 1.
    pub transition: Option<Box<Figures>>,
}

/// Trials of one motion.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Group {
    /// uniform, cosine or free.
    pub protocol: String,
    /// How many.
    pub trials: u32,
    /// N m.
    pub rmse_nm_mean: Option<f64>,
    /// N m.
    pub rmse_nm_sd: Option<f64>,
    /// N m.
    pub mae_nm_mean: Option<f64>,
    /// N m.
    pub mae_nm_sd: Option<f64>,
}

/// Where model and recordings differ, and what causes it.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Diagnosis {
    /// Always diagnosis/1.
    pub format: DiagnosisFormat,
    /// How large the gap is.
    pub gap: Gap,
    /// Where it lies, the largest share first.
    #[serde(rename = "where")]
    pub places: Vec<Place>,
    /// The candidate causes, ranked.
    pub causes: Vec<Cause>,
    /// The answer.
    pub verdict: Verdict,
    /// Every rule that decided, for causes named and refused.
    pub decisions: Vec<Decision>,
    /// Thresholds that differ from the default, by name; absent where none does.
    pub policy: Option<BTreeMap<String, f64>>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum DiagnosisFormat {
    /// Version 1.
    #[serde(rename = "diagnosis/1")]
    V1,
}

/// The gap over held-out data, N m.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Gap {
    /// RMSE of the model as delivered.
    pub rmse_nm: f64,
    /// What no model could explain.
    pub noise_floor_nm: f64,
    /// Of the floor, what the encoder's steps and noise alone leave of a perfect model.
    pub encoder_nm: f64,
    /// sqrt(rmse^2 - floor^2).
    pub explainable_nm: f64,
    /// What a flexible fit recovers on held-out data.
    pub recoverable_nm: f64,
}

/// A region that holds a share of the gap.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Place {
    /// after_reversal, rest, low_speed, high_speed, up, down, position, load, time, acceleration, other_joint, frequency, clipped,
    /// bursts or everywhere.
    pub region: String,
    /// Its bounds with units.
    pub detail: String,
    /// Of the gap's energy above the floor.
    pub share_of_gap: f64,
    /// Of the samples.
    pub share_of_samples: f64,
    /// Within it, N m.
    pub rmse_nm: f64,
}

/// A candidate cause.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Cause {
    /// An effect's id, or what of the model is out of date.
    pub effect: String,
    /// RMSE on held-out data with it, N m.
    pub held_out_rmse_nm: Option<f64>,
    /// 1 - gap after / gap before.
    pub shrink: Option<f64>,
    /// Lower end of its 95 % interval.
    pub shrink_low: Option<f64>,
    /// Upper end.
    pub shrink_high: Option<f64>,
    /// Causes that these data cannot tell it from.
    pub trades_with: Vec<String>,
    /// Whether it was tried only in addition to all named causes, not in the place of one.
    #[serde(default)]
    pub in_addition: bool,
}

/// The answer.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Verdict {
    /// none, stale_parameters, effect, several, ambiguous or unknown.
    pub kind: String,
    /// The causes.
    pub effects: Vec<String>,
    /// Probability that it is right: the share of blind simulated verdicts of its kind that were right, lower where the resamples disagree.
    pub confidence: f64,
    /// Share of the bootstrap resamples that agree.
    pub agreement: f64,
    /// Gap above the floor as delivered, N m.
    pub gap_before_nm: f64,
    /// The same with the causes added, N m.
    pub gap_after_nm: f64,
    /// The answers with their probabilities, which add up to 1.
    pub probabilities: Vec<Probability>,
    /// Of named causes whether their formulas fit: fits or approximate.
    pub form: Option<String>,
    /// What is left outside the named causes.
    pub remainder: Remainder,
}

/// An answer.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Probability {
    /// Its causes; none where nothing is missing; unknown for a cause outside the library; other for anything else.
    pub causes: Vec<String>,
    /// How probable.
    pub probability: f64,
}

/// What is left.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Remainder {
    /// RMS above the floor, N m.
    pub rms_nm: f64,
    /// Of the gap's energy.
    pub share_of_gap: f64,
    /// Where it lies, most first.
    pub r#where: Vec<Place>,
}

/// A rule that decided.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Decision {
    /// What is asked.
    pub rule: String,
    /// Of which cause, or of what is left.
    pub subject: String,
    /// What was found.
    pub value: f64,
    /// What it was compared with.
    pub limit: f64,
    /// What followed.
    pub outcome: String,
}
