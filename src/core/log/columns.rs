//! `[columns]`: which column of a log holds which quantity, and in which unit.

use super::controller::Controller;
use crate::units::{Quantity, Unit};

/// One column of a log: a value in `unit` is `scale` times the reading plus `offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name in the log's header.
    pub name: String,
    /// The unit of its values.
    pub unit: Unit,
    /// Values per reading, in `unit`; 1 where readings are values. Not 0.
    pub scale: f64,
    /// The value of a reading of 0, in `unit`.
    pub offset: f64,
}

impl Column {
    /// A column whose readings are values in `unit`.
    pub fn new(name: impl Into<String>, unit: Unit) -> Self {
        Self { name: name.into(), unit, scale: 1.0, offset: 0.0 }
    }
}

/// How the torque follows from the motor's current, where no column holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FromCurrent {
    /// Torque of the motor per ampere, N m/A; unknown where there is none: all torques are then known up to one factor.
    pub torque_constant_nm_a: Option<f64>,
    /// Turns of the motor for one of the winch; 1 without a gear between them.
    pub gear_ratio: f64,
}

impl FromCurrent {
    /// Torque per ampere, N m/A; 1 A is taken as 1 N m of the motor where the constant is unknown.
    pub fn nm_a(&self) -> f64 {
        self.torque_constant_nm_a.unwrap_or(1.0) * self.gear_ratio
    }
}

/// Where the torque comes from, where no column holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TorqueFrom {
    /// The motor's current.
    Current(FromCurrent),
    /// A position controller, from the command and the position.
    Controller(Controller),
}

impl TorqueFrom {
    /// Whether it is known in N m, not only up to one factor.
    pub fn is_scaled(&self) -> bool {
        match self {
            Self::Current(from) => from.torque_constant_nm_a.is_some(),
            Self::Controller(controller) => controller.stiffness_nm_rad.is_some(),
        }
    }

    /// Torque per unit of the reading; 1 where it takes more than that.
    fn factor(&self) -> f64 {
        match self {
            Self::Current(from) => from.nm_a(),
            Self::Controller(_) => 1.0,
        }
    }
}

/// The column of a load cell or torque sensor that measures the interaction.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceColumn {
    /// Name and unit.
    pub column: Column,
    /// Moment arm that makes a torque of a force, m; only for a force (N) on a revolute joint.
    pub arm_m: Option<f64>,
}

/// The position of a coupled joint.
#[derive(Debug, Clone, PartialEq)]
pub struct OtherColumn {
    /// Name and unit.
    pub column: Column,
    /// The joint of the URDF that it is the position of.
    pub joint: Option<String>,
}

/// The columns of every log of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Time stamp; a name alone where `rate_hz` is given.
    pub time: Column,
    /// Sample rate where no column holds time, Hz.
    pub rate_hz: Option<f64>,
    /// Position of the joint.
    pub position: Column,
    /// Torque at the winch, as recorded: before `torque_sign`. The current or the command where `torque_from` says so.
    pub torque: Column,
    /// How torque follows from current or from command and position, where no column holds it.
    pub torque_from: Option<TorqueFrom>,
    /// Velocity of the joint.
    pub velocity: Option<Column>,
    /// Motor current.
    pub current: Option<Column>,
    /// Temperature.
    pub temperature: Option<Column>,
    /// Measured load at the joint.
    pub load_torque: Option<Column>,
    /// Interaction torque, measured independently.
    pub reference_torque: Option<ReferenceColumn>,
    /// Positions of coupled joints.
    pub other_position: Vec<OtherColumn>,
    /// Commanded position of the joint.
    pub command: Option<Column>,
}

/// One column to be read.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wanted {
    /// Its key under `[columns]`.
    pub key: String,
    pub quantity: Quantity,
    pub column: Column,
    pub arm_m: Option<f64>,
    pub joint: Option<String>,
    /// Where the torque comes from, if not from its own column.
    pub torque_from: Option<TorqueFrom>,
    /// Sample rate where the file holds no such column and rows are counted, Hz.
    pub rate_hz: Option<f64>,
}

impl Wanted {
    pub fn new(quantity: Quantity, column: &Column) -> Self {
        let (key, column) = (quantity.name().to_string(), column.clone());
        Self { key, quantity, column, arm_m: None, joint: None, torque_from: None, rate_hz: None }
    }

    /// Whether it has a column of its own: not counted, not derived.
    pub fn is_in_file(&self) -> bool {
        self.rate_hz.is_none() && self.torque_from.is_none()
    }

    /// The controller that makes the torque of it.
    pub fn controller(&self) -> Option<&Controller> {
        match &self.torque_from {
            Some(TorqueFrom::Controller(controller)) => Some(controller),
            _ => None,
        }
    }

    /// How much SI changes for a change of the reading by 1.
    pub fn factor(&self) -> f64 {
        self.column.scale * self.of_value()
    }

    /// The reading in SI.
    pub fn to_si(&self, reading: f64) -> f64 {
        reading * self.factor() + self.offset_si()
    }

    /// SI of a reading of 0.
    pub fn offset_si(&self) -> f64 {
        self.column.offset * self.of_value()
    }

    /// A value in the column's unit times this is SI.
    fn of_value(&self) -> f64 {
        self.column.unit.factor() * self.arm_m.unwrap_or(1.0) * self.torque_from.map_or(1.0, |from| from.factor())
    }
}

impl Columns {
    /// The names of all columns that the logs hold; time, position and torque come first, in this order.
    pub fn names(&self) -> Vec<String> {
        self.declared().into_iter().map(|wanted| wanted.column.name).collect()
    }

    /// Every column that `[columns]` names, each once.
    pub(super) fn declared(&self) -> Vec<Wanted> {
        self.wanted().into_iter().filter(Wanted::is_in_file).collect()
    }

    /// Every column there is; time, position and torque come first, in this order.
    pub(super) fn wanted(&self) -> Vec<Wanted> {
        let optional = [
            (Quantity::Velocity, &self.velocity),
            (Quantity::Current, &self.current),
            (Quantity::Temperature, &self.temperature),
            (Quantity::LoadTorque, &self.load_torque),
            (Quantity::Command, &self.command),
        ];
        let mut all = vec![
            Wanted { rate_hz: self.rate_hz, ..Wanted::new(Quantity::Time, &self.time) },
            Wanted::new(Quantity::Position, &self.position),
            Wanted { torque_from: self.torque_from, ..Wanted::new(Quantity::Torque, &self.torque) },
        ];
        all.extend(optional.iter().filter_map(|(quantity, column)| Some(Wanted::new(*quantity, column.as_ref()?))));
        let reference = self.reference_torque.as_ref();
        all.extend(
            reference.map(|at| Wanted { arm_m: at.arm_m, ..Wanted::new(Quantity::ReferenceTorque, &at.column) }),
        );
        let others = self.other_position.iter().enumerate();
        all.extend(others.map(|(index, other)| Wanted {
            key: other_position_key(index),
            joint: other.joint.clone(),
            ..Wanted::new(Quantity::OtherPosition, &other.column)
        }));
        all
    }
}

/// The key of the `index`th coupled joint's position: `other_position`, `other_position_2`, ...
pub(super) fn other_position_key(index: usize) -> String {
    let name = Quantity::OtherPosition.name();
    if index == 0 { name.to_string() } else { format!("{name}_{}", index + 1) }
}
