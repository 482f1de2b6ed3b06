//! What effects see: one sample of the motion, what the cable carries there, and the range of a campaign.

use crate::dynamics::{Both, Motion, Payload};

/// What the joint does at one sample, as effects see it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<'a, S = f64> {
    /// Since the trial began, s.
    pub time_s: S,
    /// Since the campaign began, s: by the logs' own clock where no two of them overlap in it, else the lengths of the logs
    /// listed before added up.
    pub elapsed_s: S,
    /// The joint.
    pub own: Motion<S>,
    /// The other joints, in the order of the campaign's columns.
    pub others: &'a [Motion<S>],
}

/// What the cable carries at one sample, N m at the winch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Carried<S = f64> {
    /// (r1/r2) (G + I a + j): the joint's load.
    pub load_nm: S,
    /// The model's own friction on each branch, u and d.
    pub friction_nm: Both<S>,
}

/// Over what range a campaign moves, for an effect to know where its shape may lie.
#[derive(Debug, Clone, PartialEq)]
pub struct Extent {
    /// Lowest and highest position, rad.
    pub position_rad: (f64, f64),
    /// Travel that the encoder tells from none, rad.
    pub resolution_rad: f64,
    /// The longest way between two reversals in the trial where that is shortest, rad.
    pub stroke_rad: f64,
    /// Speeds that 5 % and all of the moving samples stay below, rad/s.
    pub speed_rad_s: (f64, f64),
    /// The lowest speed of which enough was recorded to show friction, in starting and turning at least, rad/s.
    pub slowest_rad_s: f64,
    /// The longest trial, s.
    pub trial_s: f64,
    /// The whole campaign, s.
    pub campaign_s: f64,
    /// Whether the trials are pieces of one recording: nothing starts anew with any of them.
    pub one_recording: bool,
    /// Lowest and highest reading of the torque, N m.
    pub torque_nm: (f64, f64),
    /// How many other joints are recorded moving.
    pub others: usize,
    /// Gravity of the model, N m at the joint: 0 where a chain says it.
    pub gravity_nm: f64,
    /// What the last link of a chain may well carry; nothing without a chain.
    pub payload: Option<Payload>,
    /// Whether of a payload the gravity shows more than the inertia.
    pub payload_weighs: bool,
    /// Whether the model has inertia, its own or a chain's.
    pub has_inertia: bool,
    /// Whether the model's friction changes over gradually, along a curve or a straight line.
    pub changes_gradually: bool,
    /// X_cl of the model, m on the cable.
    pub backlash_m: f64,
    /// r2, m.
    pub pulley_radius_m: f64,
    /// Whether the joint turns rather than slides.
    pub turns: bool,
}

impl Extent {
    /// Clocks on which a law of time may run, as its choice `restarts` (1 if it starts anew with every trial) and how long it runs, s.
    pub fn clocks(&self) -> impl Iterator<Item = (f64, f64)> {
        let of_trials = (!self.one_recording).then_some(1.0);
        of_trials.into_iter().chain([0.0]).map(|restarts| (restarts, self.horizon_s(restarts)))
    }

    /// How long such a clock runs, s.
    pub fn horizon_s(&self, restarts: f64) -> f64 {
        if restarts > 0.5 { self.trial_s } else { self.campaign_s }
    }
}
