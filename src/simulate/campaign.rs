//! A whole campaign from a model: the protocol's sweeps and cosine trials.

use super::{Recording, Sensors, record};
use crate::dynamics::JointKind;
use crate::log::table::{Numbers, csv_bytes, parquet_bytes};
use crate::log::{Campaign, Column, Columns, Protocol, Signal, TrialEntry};
use crate::model::Model;
use crate::problem::Result;
use crate::trajectory::Trajectory;
use crate::units::Unit;
use std::path::{Path, PathBuf};

/// What is recorded, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Number of sweep speeds.
    pub speeds: usize,
    /// The slowest, rad/s.
    pub slowest_rad_s: f64,
    /// The fastest, rad/s; those between are spaced evenly in their logarithm.
    pub fastest_rad_s: f64,
    /// Sweeps at each speed.
    pub repeats: u32,
    /// Trials of the cosine cascade.
    pub cosines: u32,
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

/// Names and units of position and torque in the logs.
fn columns_of(kind: JointKind) -> ((&'static str, Unit), (&'static str, Unit)) {
    match kind {
        JointKind::Revolute => (("position_deg", Unit::Degree), ("torque_nm", Unit::NewtonMetre)),
        JointKind::Prismatic => (("position_m", Unit::Metre), ("force_n", Unit::Newton)),
    }
}

/// One trial to be recorded.
#[derive(Debug, Clone)]
pub struct PlannedTrial {
    /// Its place in the campaign's list.
    pub entry: TrialEntry,
    trajectory: Trajectory,
    seed: u64,
}

impl Plan {
    /// The speeds of the sweeps, rad/s, to a tenth of a mrad/s: the file's name and the declared speed then say the same.
    pub fn speeds_rad_s(&self) -> Vec<f64> {
        let ratio = self.fastest_rad_s / self.slowest_rad_s;
        let speed = |i: usize| self.slowest_rad_s * ratio.powf(i as f64 / (self.speeds.max(2) - 1) as f64);
        (0..self.speeds).map(|i| (speed(i) * 1e4).round() / 1e4).collect()
    }

    /// The trials in order: sweeps by speed and repeat, then cosines.
    pub fn trials(&self) -> Vec<PlannedTrial> {
        let ending = if self.parquet { "parquet" } else { "csv" };
        let speeds = self.speeds_rad_s();
        let each = speeds.iter().flat_map(|speed_rad_s| (1..=self.repeats).map(move |repeat| (*speed_rad_s, repeat)));
        let sweeps = each.map(|(speed_rad_s, repeat)| {
            let file = format!("sweep_{speed_rad_s:.4}_{repeat}.{ending}");
            (file, Protocol::Uniform { speed_rad_s }, repeat, Trajectory::sweep(speed_rad_s))
        });
        let cosines = (1..=self.cosines)
            .map(|repeat| (format!("cosine_{repeat}.{ending}"), Protocol::Cosine, repeat, Trajectory::cascade()));
        let planned = |(i, (file, protocol, repeat, trajectory)): (usize, (String, Protocol, u32, Trajectory))| {
            // Every trial its own stream of noise, whatever the order in which they are made.
            let seed = self.seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(i as u64);
            PlannedTrial { entry: TrialEntry { file, protocol, repeat, trajectory: None }, trajectory, seed }
        };
        sweeps.chain(cosines).enumerate().map(planned).collect()
    }

    /// The campaign's description for a joint like `model`, in `folder`.
    pub fn campaign(&self, model: &Model, folder: &Path, trials: &[PlannedTrial]) -> Campaign {
        let column = |(name, unit): (&str, Unit)| Column { name: name.to_string(), unit };
        let (position, torque) = columns_of(model.joint.kind);
        Campaign {
            folder: folder.to_path_buf(),
            file: folder.join("campaign.toml"),
            joint: model.joint.clone(),
            dynamics: model.dynamics,
            arm: None,
            signal: self.signal,
            columns: Columns {
                time: column(("time_s", Unit::Second)),
                position: column(position),
                torque: column(torque),
                velocity: None,
                current: None,
                temperature: None,
                load_torque: None,
                reference_torque: None,
                other_position: Vec::new(),
            },
            trials: trials.iter().map(|trial| trial.entry.clone()).collect(),
            warnings: Vec::new(),
        }
    }

    /// The bytes of one trial's log.
    pub fn log_bytes(&self, model: &Model, trial: &PlannedTrial) -> Result<Vec<u8>> {
        let positions_rad = trial.trajectory.positions_rad(self.rate_hz);
        let Recording { time_s, position_rad, torque_nm } =
            record(model, &positions_rad, self.rate_hz, self.sensors, trial.seed);
        let (position, torque_column) = columns_of(model.joint.kind);
        let written: Vec<f64> = position_rad.iter().map(|x| x / position.1.factor()).collect();
        let torque: Vec<f64> = torque_nm.iter().map(|y| y * self.signal.torque_sign).collect();
        // Two digits below the noise, ten without any.
        let noise_nm = self.sensors.torque_noise_nm;
        let torque_decimals = if noise_nm > 0.0 { (3.0 - noise_nm.log10()).clamp(3.0, 10.0) as usize } else { 10 };
        let columns = [
            Numbers { name: "time_s", values: &time_s, decimals: 5 },
            Numbers {
                name: position.0,
                values: &written,
                decimals: if self.sensors.encoder_counts > 0.0 { 6 } else { 10 },
            },
            Numbers { name: torque_column.0, values: &torque, decimals: torque_decimals },
        ];
        let file = PathBuf::from(&trial.entry.file);
        if self.parquet { parquet_bytes(&file, &columns) } else { Ok(csv_bytes(&columns)) }
    }
}
