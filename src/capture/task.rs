//! What a session is asked to do, and what is told of it while it runs.

use super::cycle::Counts;
use super::operator::Operator;
use super::plan::Plan;
use super::rig::Rig;
use std::sync::atomic::AtomicBool;

/// What is to be done.
#[derive(Debug, Clone, Copy)]
pub struct Task<'t> {
    /// By which joint.
    pub rig: &'t Rig,
    /// Which trials.
    pub plan: &'t Plan,
    /// Whether the drive may get torque; else it is only looked at.
    pub armed: bool,
    /// Ends it early, by a quick stop.
    pub interrupted: &'t AtomicBool,
    /// Whoever is asked before there is torque.
    pub operator: &'t dyn Operator,
}

/// What is happening, for whoever watches.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Live {
    /// The trial, and how many there are in all.
    pub trial: usize,
    /// In all.
    pub trials: usize,
    /// The name of its log.
    pub name: String,
    /// Of its samples: recorded, and all.
    pub samples: (usize, usize),
    /// The safety machine's state.
    pub state: &'static str,
    /// rad.
    pub position_rad: f64,
    /// N m; `None` where the sensor is not valid.
    pub torque_nm: Option<f64>,
    /// What is left to the nearest limit of position, rad, and of torque, N m.
    pub margins: (f64, f64),
    /// Cycles that were not as they should be, in this trial.
    pub counts: Counts,
}

/// The torque sensor, looked at for a while.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Looked {
    /// How often.
    pub samples: u32,
    /// Mean of its counts.
    pub mean_counts: f64,
    /// Their standard deviation.
    pub sd_counts: f64,
    /// Between the lowest and the highest position meanwhile, rad.
    pub spread_rad: f64,
}
