//! `[columns]`: which column of a log holds which quantity, and in which unit.

use crate::document::Section;
use crate::dynamics::JointKind;
use crate::units::{Quantity, Unit};
use std::cell::RefCell;

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
    /// Reads `[columns]` of a joint of this `kind`; besides, whatever else is wrong, every column whose name is given.
    pub(super) fn read(section: &Section<'_>, kind: JointKind) -> (Option<Self>, Vec<Wanted>) {
        let reader = Reader { section, kind, named: RefCell::default() };
        let [time, position, torque] = [(Quantity::Time, "s"), (Quantity::Position, "deg"), (Quantity::Torque, "N m")]
            .map(|(quantity, unit)| reader.needed(quantity, unit));
        let optional = |quantity: Quantity| reader.column(quantity.name(), quantity);
        let (velocity, current) = (optional(Quantity::Velocity), optional(Quantity::Current));
        let (temperature, load_torque) = (optional(Quantity::Temperature), optional(Quantity::LoadTorque));
        let (reference_torque, other_position) = (reader.reference(), reader.other_positions());
        let named = reader.named.into_inner();
        let are_distinct = report_shared_names(section, &named);
        let columns = || {
            Some(Self {
                time: time?,
                position: position?,
                torque: torque?,
                velocity,
                current,
                temperature,
                load_torque,
                reference_torque,
                other_position,
            })
        };
        (columns().filter(|_| are_distinct), named)
    }

    /// The names of all columns; time, position and torque come first, in this order.
    pub fn names(&self) -> Vec<String> {
        self.wanted().into_iter().map(|wanted| wanted.column.name).collect()
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
}

/// Two quantities in one column are a slip of the pen: one of them would be wrong. Gives whether there are none.
fn report_shared_names(section: &Section<'_>, named: &[Wanted]) -> bool {
    let mut are_distinct = true;
    for (index, wanted) in named.iter().enumerate() {
        if let Some(first) = named[..index].iter().find(|first| first.column.name == wanted.column.name) {
            let what = format!("reads column `{}`, as `{}` does", wanted.column.name, first.key);
            section.reject(&wanted.key, what, "name the column that holds this quantity alone");
            are_distinct = false;
        }
    }
    are_distinct
}

/// The key of the `index`th coupled joint's position: `other_position`, `other_position_2`, ...
fn other_position_key(index: usize) -> String {
    let name = Quantity::OtherPosition.name();
    if index == 0 { name.to_string() } else { format!("{name}_{}", index + 1) }
}

/// `[columns]` being read.
struct Reader<'s, 'a> {
    section: &'s Section<'a>,
    kind: JointKind,
    /// The columns whose name was given, those without a good unit in the first that their quantity may have.
    named: RefCell<Vec<Wanted>>,
}

impl Reader<'_, '_> {
    /// A column that every log has; `unit` serves an example of what to write.
    fn needed(&self, quantity: Quantity, unit: &str) -> Option<Column> {
        let key = quantity.name();
        let example = format!("{{ name = \"{key}\", unit = \"{unit}\" }}");
        let field = self.section.need(key).such_as(&example, "the column's name in the logs, and its unit");
        field.section(|at| self.one(at, key, quantity))
    }

    /// A column that may be absent.
    fn column(&self, key: &str, quantity: Quantity) -> Option<Column> {
        self.section.may(key).section(|at| self.one(at, key, quantity))
    }

    fn one(&self, at: &Section<'_>, key: &str, quantity: Quantity) -> Option<Column> {
        let name = at.need("name").such_as("\"...\"", "the column's name in the header of the logs").text();
        let units = quantity.units(self.kind);
        let example = format!("\"{}\"", units[0].name());
        let unit = at.need("unit").such_as(&example, "the unit of the column").text();
        let unit = unit.and_then(|unit| {
            let parsed = quantity.parse_unit(self.kind, &unit);
            parsed.map_err(|(what, cure)| at.reject("unit", what, cure)).ok()
        });
        let name = name?.trim().to_string();
        let column = Column { name: name.clone(), unit: unit.unwrap_or(units[0]) };
        self.named.borrow_mut().push(Wanted { key: key.to_string(), quantity, column, arm_m: None, joint: None });
        Some(Column { name, unit: unit? })
    }

    fn reference(&self) -> Option<ReferenceColumn> {
        let key = Quantity::ReferenceTorque.name();
        self.section.may(key).section(|at| {
            let arm_m = at.may("arm_m").positive();
            let column = self.one(at, key, Quantity::ReferenceTorque)?;
            let is_force_on_an_arm = column.unit == Unit::Newton && self.kind == JointKind::Revolute;
            if is_force_on_an_arm && !at.keys().any(|key| key == "arm_m") {
                at.reject("unit", "a force (N) is no torque yet", "add `arm_m`, the moment arm about the joint in m");
            }
            if !is_force_on_an_arm && arm_m.is_some() {
                let what = "goes only with a force (N) on a revolute joint";
                at.reject("arm_m", what, "delete it, or correct the unit");
            }
            Some(ReferenceColumn { column, arm_m })
        })
    }

    fn other_positions(&self) -> Vec<OtherColumn> {
        let mut found = Vec::new();
        for index in 0.. {
            let key = other_position_key(index);
            found.extend(self.section.may(&key).section(|at| {
                let joint = at.may("joint").text();
                Some(OtherColumn { column: self.one(at, &key, Quantity::OtherPosition)?, joint })
            }));
            if !self.section.keys().any(|present| present == key) {
                break;
            }
        }
        found
    }
}
