//! What happens in a planned trial, and what is recorded of it.

use super::closed::{self, Followed};
use super::contacts::contacts_nm;
use super::course::Motions;
use super::wander::{error_rad, motion_rad};
use super::{Course, Plan, PlannedTrial, Recording, driven, recorded};
use crate::dynamics::JointKind;
use crate::log::Protocol;
use crate::model::Model;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};

/// A load cell's noise as a share of the torque sensor's: a load cell at the handle has no transmission to measure through.
const LOAD_CELL_NOISE: f64 = 0.1;
/// Contacts, the load cell's noise, errors of tracking and other joints have streams of their own beside the torque's noise.
const CONTACT_SEED: u64 = 0x434F_4E54;
const LOAD_CELL_SEED: u64 = 0x4345_4C4C;
const TRACKING_SEED: u64 = 0x5452_4143;
const OTHERS_SEED: u64 = 0x4F54_4852;

/// A trial as recorded, and what no campaign declares.
pub(super) struct Made {
    pub recording: Recording,
    /// What a load cell says of the contacts, N m.
    pub reference_nm: Vec<f64>,
    /// What a controller was told, rad; nothing where the motion is prescribed.
    pub command_rad: Option<Vec<f64>>,
}

impl Plan {
    /// The joints that are recorded beside the model's: a chain's by name, else as many as are asked for or move.
    pub fn other_joints(&self) -> Vec<(String, JointKind)> {
        match &self.arm {
            Some(arm) => arm.chain.others().map(|(name, kind)| (name.to_string(), kind)).collect(),
            None => {
                let moved = self.trajectories.iter().map(|trajectory| trajectory.others.len()).max().unwrap_or(0);
                (1..=moved.max(self.other_joints)).map(|i| (format!("other_{i}"), JointKind::Revolute)).collect()
            }
        }
    }

    /// Drives the joint through `trial` and records it.
    pub(super) fn make(&self, model: &Model, trial: &PlannedTrial) -> Made {
        let planned = self.course(trial);
        let chain = self.arm.as_ref().map(|arm| &arm.chain);
        let (course, torque_nm, command_rad) = match &self.controller {
            Some(controller) => {
                let Followed { course, torque_nm } = closed::follow(model, chain, controller, &planned, self.rate_hz);
                (course, torque_nm, Some(planned.position_rad))
            }
            None => {
                let torque_nm = driven::torque_nm(model, chain, &planned, &Motions::new(&planned, self.rate_hz));
                (planned, torque_nm, None)
            }
        };
        let reference_nm = reference_nm(&course, LOAD_CELL_NOISE * self.sensors.torque_noise_nm, trial.seed);
        let recording = recorded(model, &course, torque_nm, self.rate_hz, self.sensors, trial.seed);
        Made { recording, reference_nm, command_rad }
    }

    /// What is to happen in a trial.
    fn course(&self, trial: &PlannedTrial) -> Course {
        let mut position_rad = trial.trajectory.positions_rad(self.rate_hz);
        let samples = position_rad.len();
        if self.tracking_error_rad > 0.0 {
            let missed = error_rad(&position_rad, self.tracking_error_rad, trial.seed ^ TRACKING_SEED);
            position_rad.iter_mut().zip(missed).for_each(|(x, error)| *x += error);
        }
        let contact_nm = match trial.entry.protocol {
            Protocol::Interaction => contacts_nm(samples, self.rate_hz, trial.seed ^ CONTACT_SEED),
            _ => Vec::new(),
        };
        let others_rad = (0..self.other_joints().len()).map(|at| self.other_rad(at, trial, samples)).collect();
        Course { position_rad, others_rad, contact_nm, began_s: trial.began_s }
    }

    /// How the other joint `at` moves: as the trajectory has it, wandering, or at rest. Repeats of one motion share it.
    fn other_rad(&self, at: usize, trial: &PlannedTrial, samples: usize) -> Vec<f64> {
        let wanders = at < self.other_joints && matches!(trial.entry.protocol, Protocol::Free | Protocol::Cosine);
        match trial.trajectory.others.get(at) {
            Some(path) => {
                let mut positions_rad = path.positions_rad(self.rate_hz);
                positions_rad.resize(samples, path.end_rad());
                positions_rad
            }
            None if wanders => {
                motion_rad(samples, self.rate_hz, trial.motion_seed.wrapping_add(at as u64) ^ OTHERS_SEED)
            }
            None => vec![0.0; samples],
        }
    }
}

/// What a load cell with white noise of `noise_nm` says of the contacts, N m.
fn reference_nm(course: &Course, noise_nm: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ LOAD_CELL_SEED);
    let noise = Normal::new(0.0, noise_nm).ok();
    let contact = |i: usize| course.contact_nm.get(i).copied().unwrap_or(0.0);
    let samples = 0..course.position_rad.len();
    samples.map(|i| contact(i) + noise.map_or(0.0, |noise| noise.sample(&mut random))).collect()
}
