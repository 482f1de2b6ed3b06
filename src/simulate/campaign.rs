//! A whole campaign from a model: the protocol's sweeps and cosine trials, other joints moving, a person touching it.

use super::contacts::contacts_nm;
use super::{Course, Plan, PlannedTrial, record};
use crate::dynamics::{Dynamics, JointKind};
use crate::log::table::{Numbers, csv_bytes, parquet_bytes};
use crate::log::{Arm, Campaign, Column, Columns, OtherColumn, Place, Protocol, ReferenceColumn};
use crate::model::Model;
use crate::problem::Result;
use crate::units::Unit;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Period of the other joint's motion, s.
const SWING_PERIOD_S: f64 = 40.0;
/// Its noise as a share of the torque sensor's: a load cell at the handle has no transmission to measure through.
const LOAD_CELL_NOISE: f64 = 0.1;
/// Contacts and the load cell's noise have streams of their own beside the torque's noise.
const CONTACT_SEED: u64 = 0x434F_4E54;
const LOAD_CELL_SEED: u64 = 0x4345_4C4C;

/// Names and units of position and torque in the logs.
fn columns_of(kind: JointKind) -> ((&'static str, Unit), (&'static str, Unit)) {
    match kind {
        JointKind::Revolute => (("position_deg", Unit::Degree), ("torque_nm", Unit::NewtonMetre)),
        JointKind::Prismatic => (("position_m", Unit::Metre), ("force_n", Unit::Newton)),
    }
}

/// Name and unit of the column of a load cell times its moment arm, which measures what a person adds.
fn reference_of(kind: JointKind) -> (&'static str, Unit) {
    match kind {
        JointKind::Revolute => ("interaction_nm", Unit::NewtonMetre),
        JointKind::Prismatic => ("interaction_n", Unit::Newton),
    }
}

impl Plan {
    /// The campaign's description for a joint like `model`, in `folder`.
    pub fn campaign(&self, model: &Model, folder: &Path, trials: &[PlannedTrial]) -> Campaign {
        let column = |(name, unit): (&str, Unit)| Column { name: name.to_string(), unit };
        let (position, torque) = columns_of(model.joint.kind);
        let arm = self.arm.as_ref();
        let other_position = arm.map_or(Vec::new(), |arm| {
            let other = |(joint, kind)| {
                let (name, unit) = other_column(joint, kind);
                OtherColumn { column: Column { name, unit }, joint: Some(joint.to_string()) }
            };
            arm.chain.others().map(other).collect()
        });
        let reference = (self.interactions > 0)
            .then(|| ReferenceColumn { column: column(reference_of(model.joint.kind)), arm_m: None });
        Campaign {
            folder: folder.to_path_buf(),
            file: folder.join("campaign.toml"),
            joint: model.joint.clone(),
            dynamics: if arm.is_some() { Dynamics { gravity_nm: 0.0, inertia_kg_m2: 0.0 } } else { model.dynamics },
            arm: arm.map(|arm| Arm {
                urdf: arm.urdf.clone(),
                others: (0..other_position.len()).map(Place::Column).collect(),
                chain: arm.chain.clone(),
                held_rad: BTreeMap::new(),
            }),
            signal: self.signal,
            columns: Columns {
                time: column(("time_s", Unit::Second)),
                position: column(position),
                torque: column(torque),
                velocity: None,
                current: None,
                temperature: None,
                load_torque: None,
                reference_torque: reference,
                other_position,
            },
            trials: trials.iter().map(|trial| trial.entry.clone()).collect(),
            warnings: Vec::new(),
            clock_s: Vec::new(),
        }
    }

    /// What happens in one trial.
    fn course(&self, trial: &PlannedTrial) -> Course {
        let position_rad = trial.trajectory.positions_rad(self.rate_hz);
        let samples = position_rad.len();
        let contact_nm = match trial.entry.protocol {
            Protocol::Interaction => contacts_nm(samples, self.rate_hz, trial.seed ^ CONTACT_SEED),
            _ => Vec::new(),
        };
        let others = self.arm.as_ref().map_or(0, |arm| arm.chain.others().count());
        let other = |at: usize| match trial.swings && at == 0 {
            true => (0..samples).map(|i| swing_rad(i as f64 / self.rate_hz)).collect(),
            false => vec![0.0; samples],
        };
        Course { position_rad, others_rad: (0..others).map(other).collect(), contact_nm, began_s: trial.began_s }
    }

    /// The bytes of one trial's log.
    pub fn log_bytes(&self, model: &Model, trial: &PlannedTrial) -> Result<Vec<u8>> {
        let course = self.course(trial);
        let chain = self.arm.as_ref().map(|arm| &arm.chain);
        let recording = record(model, chain, &course, self.rate_hz, self.sensors, trial.seed);
        let (position, torque_column) = columns_of(model.joint.kind);
        let in_unit = |values: &[f64], unit: Unit| values.iter().map(|x| x / unit.factor()).collect::<Vec<f64>>();
        let written = in_unit(&recording.position_rad, position.1);
        let torque: Vec<f64> = recording.torque_nm.iter().map(|y| y * self.signal.torque_sign).collect();
        let named =
            chain.map_or(Vec::new(), |chain| chain.others().map(|(joint, kind)| other_column(joint, kind)).collect());
        let others: Vec<Vec<f64>> =
            recording.others_rad.iter().zip(&named).map(|(other, (_, unit))| in_unit(other, *unit)).collect();
        let reference = reference_nm(&course, LOAD_CELL_NOISE * self.sensors.torque_noise_nm, trial.seed);
        // Two digits below the noise, ten without any.
        let noise_nm = self.sensors.torque_noise_nm;
        let torque_decimals = if noise_nm > 0.0 { (3.0 - noise_nm.log10()).clamp(3.0, 10.0) as usize } else { 10 };
        let position_decimals = if self.sensors.encoder_counts > 0.0 { 6 } else { 10 };
        let mut columns = vec![
            Numbers { name: "time_s", values: &recording.time_s, decimals: 5 },
            Numbers { name: position.0, values: &written, decimals: position_decimals },
            Numbers { name: torque_column.0, values: &torque, decimals: torque_decimals },
        ];
        columns.extend(named.iter().zip(&others).map(|((name, _), values)| Numbers {
            name,
            values,
            decimals: position_decimals,
        }));
        if self.interactions > 0 {
            columns.push(Numbers { name: reference_of(model.joint.kind).0, values: &reference, decimals: 5 });
        }
        let file = PathBuf::from(&trial.entry.file);
        if self.parquet { parquet_bytes(&file, &columns) } else { Ok(csv_bytes(&columns)) }
    }
}

/// Name and unit of the column of another joint.
fn other_column(joint: &str, kind: JointKind) -> (String, Unit) {
    match kind {
        JointKind::Revolute => (format!("{joint}_deg"), Unit::Degree),
        JointKind::Prismatic => (format!("{joint}_m"), Unit::Metre),
    }
}

/// The motion of the first other joint: 0 to 40 deg and back, slow against the joint's own.
fn swing_rad(time_s: f64) -> f64 {
    20f64.to_radians() * (1.0 - (TAU * time_s / SWING_PERIOD_S).cos())
}

/// What a load cell with white noise of `noise_nm` says of the contacts, N m.
fn reference_nm(course: &Course, noise_nm: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed ^ LOAD_CELL_SEED);
    let noise = Normal::new(0.0, noise_nm).ok();
    let contact = |i: usize| course.contact_nm.get(i).copied().unwrap_or(0.0);
    let samples = 0..course.position_rad.len();
    samples.map(|i| contact(i) + noise.map_or(0.0, |noise| noise.sample(&mut random))).collect()
}
