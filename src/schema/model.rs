//! `model.json`.

use super::campaign::{Drive, Kind};
use schemars::JsonSchema;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;

/// A joint's model: the paper's formula with its parameters, and effects beyond it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Model {
    /// Always model/1.
    pub format: ModelFormat,
    /// The joint.
    pub joint: Joint,
    /// Gravity and inertia.
    pub dynamics: Dynamics,
    /// Friction of both directions.
    pub friction: Both<Friction>,
    /// How friction changes over after a reversal.
    pub combination: Combination,
    /// Effects beyond the formula (`tautline effects` lists them).
    #[serde(default)]
    pub effects: Vec<Effect>,
    /// How well parameters are known, by dotted name (friction.up.a_j).
    #[serde(default)]
    pub confidence: BTreeMap<String, Confidence>,
    /// A and B(v) as identified, with half widths.
    pub functions: Option<BTreeMap<String, Functions>>,
    /// Fit quality.
    pub fit: Option<Fit>,
    /// For people: the forms of B(v) that were compared.
    pub forms: Option<Value>,
    /// The curves of the combination that were compared.
    pub combinations: Option<Value>,
    /// For people: what refining gained.
    pub refinement: Option<Value>,
    /// For people: how free motion was fitted.
    pub free_motion: Option<Value>,
    /// For people: warnings.
    pub warnings: Option<Value>,
    /// For people: where it comes from.
    pub provenance: Option<Value>,
    /// For people: on which declared constants it rests.
    pub rests_on: Option<Value>,
    /// Checks of the data; `diagnose` tells of those that failed.
    pub checks: Option<Vec<Check>>,
}

/// A check of the data.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// Its name.
    pub check: String,
    /// Whether the model passes it.
    pub passes: bool,
    /// What was found, dimensionless.
    pub value: Option<f64>,
    /// The most that passes.
    pub limit: Option<f64>,
    /// How the dotted names begin of the parameters that rest on it.
    #[serde(default)]
    pub concerns: Vec<String>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum ModelFormat {
    /// Version 1.
    #[serde(rename = "model/1")]
    V1,
}

/// The joint.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// How it moves; revolute where absent.
    pub kind: Option<Kind>,
    /// What drives it; a cable where absent.
    pub drive: Option<Drive>,
    /// r1, m.
    pub winch_radius_m: f64,
    /// r2, m.
    pub pulley_radius_m: f64,
    /// X_cl, m of cable.
    pub backlash_m: f64,
}

/// Gravity and inertia.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dynamics {
    /// Gravity torque at 90 deg, N m.
    pub gravity_nm: f64,
    /// Inertia, kg m^2.
    pub inertia_kg_m2: f64,
    /// How far the declared zero of the position is off, rad.
    pub position_zero_rad: Option<f64>,
    /// URDF of a chain.
    pub urdf: Option<String>,
    /// The joint in it.
    pub joint: Option<String>,
    /// What the chain's last link carries beyond the URDF.
    pub payload: Option<Payload>,
}

/// A mass on the last link of a chain, in that link's frame.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    /// kg; negative where the URDF's link is too heavy.
    pub mass_kg: f64,
    /// The mass times the place of its centre along x, kg m.
    pub moment_x_kg_m: f64,
    /// Along y.
    pub moment_y_kg_m: f64,
    /// Along z.
    pub moment_z_kg_m: f64,
    /// Inertia about the frame's origin, alike about each axis, kg m^2.
    pub inertia_kg_m2: f64,
}

/// One of each direction.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Both<T> {
    /// Moving up.
    pub up: T,
    /// Moving down.
    pub down: T,
}

/// The seven parameters of a branch, equations 13 and 14 of the paper.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Loss of the cable's load, below 1.
    pub mu_c: f64,
    /// Coulomb friction of the joint, N.
    pub a_j: f64,
    /// Amplitude of the cable's Stribeck term, N.
    pub b_c: f64,
    /// Its rate, s/rad; its sign is the direction's.
    pub c_c: f64,
    /// Amplitude of the joint's Stribeck term, N.
    pub b_j: f64,
    /// Its rate, s/rad.
    pub c_j: f64,
    /// Viscous friction, N s/rad.
    pub d: f64,
}

/// The curve of the combination, after a reversal.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Combination {
    /// Which.
    pub kind: CombinationKind,
    /// Of arctan: its factor.
    pub k: Option<f64>,
    /// Of arctan: its steepness.
    pub p: Option<f64>,
    /// Of power: its exponent.
    pub n: Option<f64>,
}

/// Which curve.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum CombinationKind {
    /// At once (equation 20).
    Sign,
    /// In proportion to the travel (25).
    Linear,
    /// An arctangent (29).
    Arctan,
    /// A power (30).
    Power,
}

/// An effect beyond the formula.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Effect {
    /// Its name.
    pub id: String,
    /// Its parameters, units in their names.
    pub parameters: BTreeMap<String, f64>,
}

/// How well a parameter is known.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Confidence {
    /// Lower end of the 95 % interval; open where null.
    pub low: Option<f64>,
    /// Upper end.
    pub high: Option<f64>,
    /// Standard error over value.
    pub cv: Option<f64>,
    /// In a word.
    pub status: Status,
}

/// How well a parameter is known, in a word.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// Well determined.
    Pinned,
    /// Correlated with other parameters.
    TradeOff,
    /// Stands for several, in a smaller form.
    Merged,
    /// Not determined by the data.
    Flat,
    /// At the limit of what the data could show.
    AtBound,
}

/// How well the model fits the recordings that it was identified from. Other keys are for people.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Fit {
    /// For people: of moving up.
    pub up: Option<Value>,
    /// For people: of moving down.
    pub down: Option<Value>,
    /// Over whole recordings.
    pub whole: Option<Whole>,
}

/// What the model leaves of those recordings: `diagnose` compares with it what it leaves of others.
#[derive(Debug, Deserialize, JsonSchema)]
pub struct Whole {
    /// RMSE over all trials, N m.
    pub rmse_nm: Option<f64>,
    /// For people: by trial.
    pub trials: Option<Value>,
}

/// A and B(v) of a direction.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Functions {
    /// A, N m.
    pub a_nm: f64,
    /// Half width of its 95 % interval, N m.
    pub a_half_width_nm: Option<f64>,
    /// B by speed.
    pub b: Vec<Level>,
    /// Half width of what all of B have in common, N m.
    pub b_common_half_width_nm: Option<f64>,
    /// The errors that A and all of B share, with what each adds to them; those at one place in both directions are one.
    #[serde(default)]
    pub shared: Vec<SharedError>,
}

/// Half width of one error that A and all of B share, with the sign of what it adds.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SharedError {
    /// To A, N m.
    pub a_nm: f64,
    /// To B, N m.
    pub b_nm: f64,
}

/// B at one speed.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Level {
    /// rad/s.
    pub speed_rad_s: f64,
    /// N m.
    pub b_nm: f64,
    /// Half width of its 95 % interval, N m.
    pub half_width_nm: Option<f64>,
}
