//! A simulated campaign's description: its joint, its columns, its trials.

use super::{Plan, PlannedTrial};
use crate::dynamics::{Dynamics, JointKind};
use crate::log::{
    Arm, Campaign, Column, Columns, Files, OtherColumn, Place, ReferenceColumn, Signal, TorqueFrom, Uncertainty,
};
use crate::model::{Drive, Model};
use crate::units::Unit;
use std::collections::BTreeMap;
use std::path::Path;

/// Names and units of position and torque in the logs.
pub(super) fn columns_of(kind: JointKind, drive: Drive) -> ((&'static str, Unit), (&'static str, Unit)) {
    match kind {
        JointKind::Revolute => (("position_deg", Unit::Degree), ("torque_nm", Unit::NewtonMetre)),
        JointKind::Prismatic if drive == Drive::Screw => {
            (("position_m", Unit::Metre), ("motor_torque_nm", Unit::NewtonMetre))
        }
        JointKind::Prismatic => (("position_m", Unit::Metre), ("force_n", Unit::Newton)),
    }
}

/// Name and unit of the column of a load cell times its moment arm, which measures what a person adds.
pub(super) fn reference_of(kind: JointKind) -> (&'static str, Unit) {
    match kind {
        JointKind::Revolute => ("interaction_nm", Unit::NewtonMetre),
        JointKind::Prismatic => ("interaction_n", Unit::Newton),
    }
}

impl Plan {
    /// The campaign's description for a joint like `model`, in `folder`.
    pub fn campaign(&self, model: &Model, folder: &Path, trials: &[PlannedTrial]) -> Campaign {
        let column = |(name, unit): (&str, Unit)| Column::new(name, unit);
        let (position, torque) = columns_of(model.joint.kind, model.joint.drive);
        let arm = self.arm.as_ref();
        let law = self.controller.as_ref().filter(|_| self.position_alone);
        let law = law.map(|controller| controller.law(model.joint.transmission()));
        let other = |(joint, kind): (String, JointKind)| {
            let (name, unit) = other_column(&joint, kind);
            // Only a chain has joints by name.
            OtherColumn { column: Column::new(name, unit), joint: arm.is_some().then_some(joint) }
        };
        let other_position: Vec<OtherColumn> = self.other_joints().into_iter().map(other).collect();
        let reference = (self.interactions > 0)
            .then(|| ReferenceColumn { column: column(reference_of(model.joint.kind)), arm_m: None });
        Campaign {
            folder: folder.to_path_buf(),
            file: folder.join("campaign.toml"),
            joint: model.joint.clone(),
            dynamics: if arm.is_some() {
                Dynamics::default()
            } else {
                Dynamics { position_zero_rad: 0.0, ..model.dynamics }
            },
            arm: arm.map(|arm| Arm {
                urdf: arm.urdf.clone(),
                others: (0..other_position.len()).map(Place::Column).collect(),
                chain: arm.chain.clone(),
                held_rad: BTreeMap::new(),
            }),
            uncertainty: Uncertainty::default(),
            signal: Signal {
                torque_sign: if self.position_alone { 1.0 } else { self.signal.torque_sign },
                ..self.signal
            },
            files: Files::default(),
            columns: Columns {
                time: column(("time_s", Unit::Second)),
                position: column(position),
                torque: column(if law.is_some() { command_of(model.joint.kind) } else { torque }),
                torque_from: law.map(TorqueFrom::Controller),
                command: law.map(|_| column(command_of(model.joint.kind))),
                rate_hz: None,
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
}

/// Name and unit of the column of another joint.
pub(super) fn other_column(joint: &str, kind: JointKind) -> (String, Unit) {
    match kind {
        JointKind::Revolute => (format!("{joint}_deg"), Unit::Degree),
        JointKind::Prismatic => (format!("{joint}_m"), Unit::Metre),
    }
}

/// Name and unit of the column of what was commanded.
pub(super) fn command_of(kind: JointKind) -> (&'static str, Unit) {
    match kind {
        JointKind::Revolute => ("command_deg", Unit::Degree),
        JointKind::Prismatic => ("command_m", Unit::Metre),
    }
}
