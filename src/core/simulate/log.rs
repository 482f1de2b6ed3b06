//! A trial as the bytes of its log.

use super::campaign::{columns_of, command_of, other_column, reference_of};
use super::{Made, Plan, PlannedTrial};
use crate::log::table::{Numbers, csv_bytes, parquet_bytes};
use crate::model::{Joint, Model};
use crate::problem::Result;
use crate::units::Unit;
use std::path::PathBuf;

/// One column to be written.
struct Written {
    name: String,
    values: Vec<f64>,
    decimals: usize,
}

impl Plan {
    /// The bytes of one trial's log.
    pub fn log_bytes(&self, model: &Model, trial: &PlannedTrial) -> Result<Vec<u8>> {
        let columns = self.columns(&model.joint, self.make(model, trial));
        let numbers: Vec<Numbers> =
            columns.iter().map(|c| Numbers { name: &c.name, values: &c.values, decimals: c.decimals }).collect();
        let file = PathBuf::from(&trial.entry.file);
        if self.parquet { parquet_bytes(&file, &numbers) } else { Ok(csv_bytes(&numbers)) }
    }

    fn columns(&self, joint: &Joint, made: Made) -> Vec<Written> {
        let kind = joint.kind;
        // Two digits below the noise, ten without any.
        let noise_nm = self.sensors.torque_noise_nm;
        let torque_decimals = if noise_nm > 0.0 { (3.0 - noise_nm.log10()).clamp(3.0, 10.0) as usize } else { 10 };
        let position_decimals = if self.sensors.encoder_counts > 0.0 { 6 } else { 10 };
        let position = |(name, unit): (&str, Unit), values: &[f64]| Written {
            name: name.to_string(),
            values: values.iter().map(|x| x / unit.factor()).collect(),
            decimals: position_decimals,
        };
        let (own, (torque_name, _)) = columns_of(kind, joint.drive);
        let torque = made.recording.torque_nm.iter().map(|y| y * self.signal.torque_sign).collect();
        let mut columns = vec![
            Written { name: "time_s".to_string(), values: made.recording.time_s, decimals: 5 },
            position(own, &made.recording.position_rad),
        ];
        if !self.position_alone {
            columns.push(Written { name: torque_name.to_string(), values: torque, decimals: torque_decimals });
        }
        for ((joint, kind), positions) in self.other_joints().iter().zip(&made.recording.others_rad) {
            let (name, unit) = other_column(joint, *kind);
            columns.push(position((&name, unit), positions));
        }
        if self.interactions > 0 {
            let name = reference_of(kind).0.to_string();
            columns.push(Written { name, values: made.reference_nm, decimals: 5 });
        }
        columns.extend(made.command_rad.map(|command| position(command_of(kind), &command)));
        columns
    }
}
