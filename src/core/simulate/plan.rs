//! Which trials a campaign has: the protocol's sweeps and cosines, any other trajectories, a person touching the joint.

use super::{Controller, Sensors};
use crate::dynamics::{Chain, JointKind};
use crate::log::{Signal, TrialEntry};
use crate::trajectory::{Trajectory, Uniform};

/// What is recorded, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Number of sweep speeds.
    pub speeds: usize,
    /// The slowest, rad/s.
    pub slowest_rad_s: f64,
    /// The fastest, rad/s; those between are spaced evenly in their logarithm.
    pub fastest_rad_s: f64,
    /// Sweeps at each speed, and trials of each trajectory that does not say.
    pub repeats: u32,
    /// Trials of the cosine cascade.
    pub cosines: u32,
    /// Times that a person touches the joint, at rest and in motion: two trials each.
    pub interactions: u32,
    /// Further motions, as they stand: those of a prismatic joint in m.
    pub trajectories: Vec<Trajectory>,
    /// The whole arm, in place of the model's own gravity and inertia.
    pub arm: Option<SimulatedArm>,
    /// Joints that are recorded beside the model's where there is no arm: they vary slowly in cosines and further motions.
    pub other_joints: usize,
    /// How far the joint is off its trajectory, rad, root mean square; different in each trial.
    pub tracking_error_rad: f64,
    /// What drives the joint along its trajectory; a joint without it moves as prescribed.
    pub controller: Option<Controller>,
    /// Whether logs hold command and position in place of the torque.
    pub position_alone: bool,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Sensors.
    pub sensors: Sensors,
    /// Seed of all noise.
    pub seed: u64,
    /// How the torque is recorded and to be filtered.
    pub signal: Signal,
    /// Whether logs are Parquet rather than CSV.
    pub parquet: bool,
}

/// The chain that the joint is part of.
#[derive(Debug, Clone, PartialEq)]
pub struct SimulatedArm {
    /// Name of its URDF in the campaign's folder.
    pub urdf: String,
    /// The bodies that matter for the joint.
    pub chain: Chain,
    /// Trials of the cosine cascade with the chain's first other joint moving.
    pub multi_joint: u32,
}

/// One trial to be recorded.
#[derive(Debug, Clone)]
pub struct PlannedTrial {
    /// Its place in the campaign's list.
    pub entry: TrialEntry,
    /// How long its log is.
    pub samples: usize,
    pub(super) trajectory: Trajectory,
    pub(super) seed: u64,
    /// The same for repeats of one motion.
    pub(super) motion_seed: u64,
    /// When it begins, s since the campaign did.
    pub(super) began_s: f64,
}

impl Plan {
    /// The protocol's sweeps.
    pub fn sweeps(&self) -> Uniform {
        let Self { speeds, slowest_rad_s, fastest_rad_s, .. } = *self;
        Uniform { speeds, slowest_rad_s, fastest_rad_s, ..Uniform::default() }
    }

    /// The trials of a joint of this `kind`, in order: sweeps by speed and repeat, cosines, cosines with other joints moving,
    /// touched ones, further trajectories.
    pub fn trials(&self, kind: JointKind) -> Vec<PlannedTrial> {
        let mut list = List { plan: self, trials: Vec::new(), now_s: 0.0 };
        let multi_joint = self.arm.as_ref().map_or(0, |arm| arm.multi_joint);
        let sweeps = self.sweeps().trajectories().into_iter().map(|sweep| (sweep, self.repeats));
        let cosines = [(Trajectory::cascade(), self.cosines), (Trajectory::wide_cascade(), multi_joint)];
        for (trajectory, repeats) in sweeps.chain(cosines) {
            (1..=repeats).for_each(|repeat| list.add(&trajectory.on(kind), repeat));
        }
        for repeat in 1..=self.interactions {
            [Trajectory::held(), Trajectory::touched()].iter().for_each(|t| list.add(&t.on(kind), repeat));
        }
        for trajectory in &self.trajectories {
            (1..=trajectory.repeats.unwrap_or(self.repeats)).for_each(|repeat| list.add(trajectory, repeat));
        }
        list.trials
    }
}

/// Trials as they are added, one right after the other.
struct List<'p> {
    plan: &'p Plan,
    trials: Vec<PlannedTrial>,
    now_s: f64,
}

impl List<'_> {
    fn add(&mut self, trajectory: &Trajectory, repeat: u32) {
        let ending = if self.plan.parquet { "parquet" } else { "csv" };
        let file = format!("{}_{repeat}.{ending}", trajectory.name);
        // Every trial its own stream of noise, whatever the order in which they are made.
        let seed = self.plan.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(self.trials.len() as u64);
        let motion_seed = self.plan.seed ^ hash(&trajectory.name);
        let entry = TrialEntry {
            file,
            part: None,
            protocol: trajectory.protocol,
            repeat,
            trajectory: trajectory.name_in_a_campaign(),
            capture: None,
            controller: None,
        };
        // From the first stamp to the last: so the clock of a campaign is read back from its logs.
        let (samples, began_s) = (trajectory.samples(self.plan.rate_hz), self.now_s);
        self.now_s += samples.saturating_sub(1) as f64 / self.plan.rate_hz;
        self.trials.push(PlannedTrial { entry, trajectory: trajectory.clone(), seed, motion_seed, began_s, samples });
    }
}

/// FNV-1a: the same on every machine and in every version, as a seed must be.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}
