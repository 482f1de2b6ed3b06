//! `[columns]`: which column of a log holds which quantity, and in which unit.

use crate::document::Section;
use crate::dynamics::JointKind;
use crate::units::{Quantity, Unit};

/// One column of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name in the log's header.
    pub name: String,
    /// The unit of its readings.
    pub unit: Unit,
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
    /// Time stamp.
    pub time: Column,
    /// Position of the joint.
    pub position: Column,
    /// Torque at the winch, as recorded: before `torque_sign`.
    pub torque: Column,
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
}

impl Wanted {
    /// A reading times this is SI.
    pub fn factor(&self) -> f64 {
        self.column.unit.factor() * self.arm_m.unwrap_or(1.0)
    }
}

impl Columns {
    /// Reads `[columns]` of a joint of this `kind`.
    pub(super) fn from_section(section: &Section<'_>, kind: JointKind) -> Option<Self> {
        let column = |quantity: Quantity| section.need(quantity.name()).section(|at| one(at, quantity, kind));
        let optional = |quantity: Quantity| section.may(quantity.name()).section(|at| one(at, quantity, kind));
        let (time, position, torque) = (column(Quantity::Time), column(Quantity::Position), column(Quantity::Torque));
        let (velocity, current) = (optional(Quantity::Velocity), optional(Quantity::Current));
        let (temperature, load_torque) = (optional(Quantity::Temperature), optional(Quantity::LoadTorque));
        let reference_torque = section.may(Quantity::ReferenceTorque.name()).section(|at| reference(at, kind));
        let other_position = other_positions(section, kind);
        let columns = Self {
            time: time?,
            position: position?,
            torque: torque?,
            velocity,
            current,
            temperature,
            load_torque,
            reference_torque,
            other_position,
        };
        columns.report_shared_names(section);
        Some(columns)
    }

    /// Every column there is; time, position and torque come first, in this order.
    pub(super) fn wanted(&self) -> Vec<Wanted> {
        let wanted = |quantity: Quantity, column: &Column, arm_m| Wanted {
            key: quantity.name().to_string(),
            quantity,
            column: column.clone(),
            arm_m,
            joint: None,
        };
        let optional = [
            (Quantity::Velocity, &self.velocity),
            (Quantity::Current, &self.current),
            (Quantity::Temperature, &self.temperature),
            (Quantity::LoadTorque, &self.load_torque),
        ];
        let mut all = vec![
            wanted(Quantity::Time, &self.time, None),
            wanted(Quantity::Position, &self.position, None),
            wanted(Quantity::Torque, &self.torque, None),
        ];
        all.extend(optional.iter().filter_map(|(quantity, column)| Some(wanted(*quantity, column.as_ref()?, None))));
        let reference = self.reference_torque.as_ref();
        all.extend(reference.map(|at| wanted(Quantity::ReferenceTorque, &at.column, at.arm_m)));
        let others = self.other_position.iter().enumerate();
        all.extend(others.map(|(index, other)| Wanted {
            key: other_position_key(index),
            joint: other.joint.clone(),
            ..wanted(Quantity::OtherPosition, &other.column, None)
        }));
        all
    }

    /// Two quantities in one column are a slip of the pen: one of them would be wrong.
    fn report_shared_names(&self, section: &Section<'_>) {
        let all = self.wanted();
        for (index, wanted) in all.iter().enumerate() {
            if let Some(first) = all[..index].iter().find(|first| first.column.name == wanted.column.name) {
                let what = format!("reads column `{}`, as `{}` does", wanted.column.name, first.key);
                section.reject(&wanted.key, what, "name the column that holds this quantity alone");
            }
        }
    }
}

/// The key of the `index`th coupled joint's position: `other_position`, `other_position_2`, ...
fn other_position_key(index: usize) -> String {
    let name = Quantity::OtherPosition.name();
    if index == 0 { name.to_string() } else { format!("{name}_{}", index + 1) }
}

fn one(section: &Section<'_>, quantity: Quantity, kind: JointKind) -> Option<Column> {
    let (name, unit) = (section.need("name").text(), section.need("unit").text());
    let unit = match quantity.parse_unit(kind, &unit?) {
        Ok(unit) => Some(unit),
        Err((what, cure)) => {
            section.reject("unit", what, cure);
            None
        }
    };
    Some(Column { name: name?.trim().to_string(), unit: unit? })
}

fn reference(section: &Section<'_>, kind: JointKind) -> Option<ReferenceColumn> {
    let arm_m = section.may("arm_m").positive();
    let column = one(section, Quantity::ReferenceTorque, kind)?;
    let is_force_on_an_arm = column.unit == Unit::Newton && kind == JointKind::Revolute;
    if is_force_on_an_arm && !section.keys().any(|key| key == "arm_m") {
        section.reject("unit", "a force (N) is no torque yet", "add `arm_m`, the moment arm about the joint in m");
    }
    if !is_force_on_an_arm && arm_m.is_some() {
        section.reject("arm_m", "goes only with a force (N) on a revolute joint", "delete it, or correct the unit");
    }
    Some(ReferenceColumn { column, arm_m })
}

fn other_positions(section: &Section<'_>, kind: JointKind) -> Vec<OtherColumn> {
    let mut found = Vec::new();
    for index in 0.. {
        let key = other_position_key(index);
        found.extend(section.may(&key).section(|at| {
            let joint = at.may("joint").text();
            Some(OtherColumn { column: one(at, Quantity::OtherPosition, kind)?, joint })
        }));
        if !section.keys().any(|present| present == key) {
            break;
        }
    }
    found
}
