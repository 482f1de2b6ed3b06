//! Which trials a campaign has: the protocol's sweeps and cosines, any other trajectories, a person touching the joint.

use super::{Controller, Sensors};
use crate::dynamics::{Chain, JointKind};
use crate::log::{Protocol, Signal, TrialEntry};
use crate::trajectory::Trajectory;

/// The trajectory's name, and the beginning of the files' names, of cosines with another joint moving.
const MULTI_JOINT: &str = "multi_joint";

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
    /// Joints that are recorded beside the model's where there is no arm: they wander in cosines and further motions.
    pub other_joints: usize,
    /// How far the joint is off its trajectory, rad, root mean square; different in each trial.
    pub tracking_error_rad: f64,
    /// What drives the joint along its trajectory; a joint without it moves as prescribed.
    pub controller: Option<Controller>,
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
    /// Whether the chain's first other joint swings along.
    pub(super) swings: bool,
    pub(super) seed: u64,
    /// The same for repeats of one motion.
    pub(super) motion_seed: u64,
    /// When it begins, s since the campaign did.
    pub(super) began_s: f64,
}

impl Plan {
    /// The speeds of the sweeps, rad/s, to a tenth of a mrad/s: the file's name and the declared speed then say the same.
    pub fn speeds_rad_s(&self) -> Vec<f64> {
        let ratio = self.fastest_rad_s / self.slowest_rad_s;
        let speed = |i: usize| self.slowest_rad_s * ratio.powf(i as f64 / (self.speeds.max(2) - 1) as f64);
        (0..self.speeds).map(|i| (speed(i) * 1e4).round() / 1e4).collect()
    }

    /// The trials of a joint of this `kind`, in order: sweeps by speed and repeat, cosines, cosines with other joints moving,
    /// touched ones, further trajectories.
    pub fn trials(&self, kind: JointKind) -> Vec<PlannedTrial> {
        let mut list = List { plan: self, trials: Vec::new(), now_s: 0.0 };
        for speed_rad_s in self.speeds_rad_s() {
            for repeat in 1..=self.repeats {
                let (name, protocol) = (format!("sweep_{speed_rad_s:.4}"), Protocol::Uniform { speed_rad_s });
                list.add(&name, protocol, repeat, Trajectory::sweep(speed_rad_s).on(kind), None);
            }
        }
        for repeat in 1..=self.cosines {
            list.add("cosine", Protocol::Cosine, repeat, Trajectory::cascade().on(kind), None);
        }
        for repeat in 1..=self.arm.as_ref().map_or(0, |arm| arm.multi_joint) {
            let wide = Trajectory::wide_cascade().on(kind);
            list.add(MULTI_JOINT, Protocol::Cosine, repeat, wide, Some(MULTI_JOINT));
        }
        for repeat in 1..=self.interactions {
            for (name, trajectory) in [("held", Trajectory::held()), ("moving", Trajectory::touched())] {
                let file = format!("touched_{name}");
                list.add(&file, Protocol::Interaction, repeat, trajectory.on(kind), Some(name));
            }
        }
        for trajectory in &self.trajectories {
            for repeat in 1..=trajectory.repeats.unwrap_or(self.repeats) {
                let name = &trajectory.name;
                list.add(name, Protocol::Free, repeat, trajectory.clone(), Some(name));
            }
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
    fn add(&mut self, stem: &str, protocol: Protocol, repeat: u32, trajectory: Trajectory, name: Option<&str>) {
        let ending = if self.plan.parquet { "parquet" } else { "csv" };
        let file = format!("{stem}_{repeat}.{ending}");
        // Every trial its own stream of noise, whatever the order in which they are made.
        let seed = self.plan.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(self.trials.len() as u64);
        let motion_seed = self.plan.seed ^ hash(stem);
        let entry = TrialEntry { file, protocol, repeat, trajectory: name.map(str::to_string), capture: None };
        let (swings, began_s) = (protocol == Protocol::Cosine && name == Some(MULTI_JOINT), self.now_s);
        // From the first stamp to the last: so the clock of a campaign is read back from its logs.
        let samples = trajectory.samples(self.plan.rate_hz);
        self.now_s += samples.saturating_sub(1) as f64 / self.plan.rate_hz;
        self.trials.push(PlannedTrial { entry, trajectory, swings, seed, motion_seed, began_s, samples });
    }
}

/// FNV-1a: the same on every machine and in every version, as a seed must be.
fn hash(text: &str) -> u64 {
    text.bytes().fold(0xCBF2_9CE4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3))
}
