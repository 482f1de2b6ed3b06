//! tautline: the models of cable-driven robot joints, identified, judged and explained from recorded logs.
//!
//! What works on samples is the crate `tautline-core` (`src/core`), whose modules are shown here too. The modules stand in the
//! order in which data flow; a module may use those above it, never those below.

#[doc(inline)]
pub use tautline_core::{
    diagnose, document, dynamics, effects, evaluate, identify, import, interaction, limits, log, model, numerics,
    predict, prepare, problem, robots, simulate, trajectory, units,
};

/// Motions x the joint's limits -> what they ask of it, before anything moves.
pub mod excite;

/// Frames -> frames: a software EtherCAT bus, a drive and a torque sensor on a simulated joint, faults included.
pub mod bus;

/// A rig on the wire x a plan -> a campaign, recorded: the bus, the drive, its safety.
pub mod capture;

/// Files that no campaign describes yet -> a draft of campaign.toml, with what no data can tell as questions.
pub mod init;

/// Two `Model`s of one joint -> what changed, and what it does to the prediction.
pub mod compare;

/// A campaign x a stored baseline -> what moved, and whether it matters.
pub mod check;

/// Many campaigns -> a result each, kept as files -> a table; by joint, over time: what drifted.
pub mod batch;

/// Results -> terminal, JSON, tables, plots, one HTML file.
pub mod report;

/// `Model` -> code for a controller, a simulator's joint, tables.
pub mod export;

/// What may stand in files, as JSON Schemas.
pub mod schema;

/// Pages of the guide, as the documentation and `tautline guide` show them.
pub mod guide;

/// Arguments -> one pipeline per subcommand -> exit status.
pub mod cli;
