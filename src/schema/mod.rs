//! What may stand in files, as JSON Schemas: `tautline schema NAME`.
//!
//! The types here say it once, with a sentence for each key; the schemas are made from them. Readers report faults by row and column
//! and stand where the data go; the tests hold these types against what they read and against every bundled file. Inputs refuse
//! unknown keys; results may gain some.

mod campaign;
mod comparison;
mod evaluation;
mod fleet;
mod interaction;
mod list;
mod model;
mod policy;
mod rig;
mod trajectory;

pub use campaign::Campaign;
pub use comparison::{Check, Comparison};
pub use evaluation::{Diagnosis, Evaluation};
pub use fleet::{Fleet, Repeatability};
pub use interaction::Interaction;
pub use list::Batch;
pub use model::Model;
pub use rig::Rig;
pub use trajectory::Trajectory;

use schemars::{Schema, schema_for};

/// One kind of file.
pub struct File {
    /// What it is called by `tautline schema`.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Its schema.
    pub schema: fn() -> Schema,
}

/// All kinds.
pub const FILES: [File; 13] = [
    File { name: "campaign", about: "campaign.toml: a joint and its logs", schema: || schema_for!(Campaign) },
    File { name: "model", about: "model.json: a joint's friction", schema: || schema_for!(Model) },
    File { name: "trajectory", about: "a motion to record or to simulate", schema: || schema_for!(Trajectory) },
    File { name: "rig", about: "rig.toml: a joint on an EtherCAT bus", schema: || schema_for!(Rig) },
    File { name: "batch", about: "a list of campaigns for batch and repeatability", schema: || schema_for!(Batch) },
    File { name: "evaluation", about: "evaluation.json", schema: || schema_for!(Evaluation) },
    File { name: "diagnosis", about: "diagnosis.json", schema: || schema_for!(Diagnosis) },
    File { name: "policy", about: "thresholds for diagnose --policy", schema: policy::schema },
    File { name: "interaction", about: "interaction --json", schema: || schema_for!(Interaction) },
    File { name: "comparison", about: "compare --json", schema: || schema_for!(Comparison) },
    File { name: "check", about: "check --json", schema: || schema_for!(Check) },
    File { name: "fleet", about: "batch --json", schema: || schema_for!(Fleet) },
    File { name: "repeatability", about: "repeatability --json", schema: || schema_for!(Repeatability) },
];
