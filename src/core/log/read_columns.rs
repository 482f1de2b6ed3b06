//! `[columns]` being read: every fault of it at once.

use super::columns::{
    Column, Columns, FromCurrent, OtherColumn, ReferenceColumn, TorqueFrom, Wanted, other_position_key,
};
use super::controller::Controller;
use crate::document::Section;
use crate::dynamics::JointKind;
use crate::units::{Quantity, Unit};
use std::cell::RefCell;

/// What sections other than `[columns]` say of the columns.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Given {
    /// How the joint moves, which decides its units.
    pub kind: JointKind,
    /// Whether the torque of a prismatic joint is a motor's, in N m.
    pub turns_motor: bool,
    /// Sample rate where no column holds time, Hz.
    pub rate_hz: Option<f64>,
    /// Torque of the motor per ampere, N m/A.
    pub torque_constant_nm_a: Option<f64>,
    /// Turns of the motor for one of the winch.
    pub gear_ratio: f64,
    /// The position controller, where one is declared.
    pub controller: Option<Controller>,
}

impl Given {
    /// The kind of joint that decides the units of `quantity`.
    fn kind_for(&self, quantity: Quantity) -> JointKind {
        let is_of_motor = quantity == Quantity::Torque && self.turns_motor;
        if is_of_motor { JointKind::Revolute } else { self.kind }
    }
}

impl Columns {
    /// Reads `[columns]`; besides, whatever else is wrong, every column whose name is given.
    pub(super) fn read(section: &Section<'_>, given: Given) -> (Option<Self>, Vec<Wanted>) {
        let reader = Reader { section, given, named: RefCell::default() };
        let time = reader.time();
        let position = reader.needed(Quantity::Position, "deg");
        let optional = |quantity: Quantity| reader.column(quantity.name(), quantity);
        let current = optional(Quantity::Current);
        let velocity = optional(Quantity::Velocity);
        let (temperature, load_torque) = (optional(Quantity::Temperature), optional(Quantity::LoadTorque));
        let command = optional(Quantity::Command);
        let (torque, torque_from) = reader.torque(current.as_ref(), command.as_ref());
        let (reference_torque, other_position) = (reader.reference(), reader.other_positions());
        let mut named = reader.named.into_inner();
        let are_distinct = report_shared_names(section, &named);
        let order = |wanted: &Wanted| match wanted.quantity {
            Quantity::Time => 0,
            Quantity::Position => 1,
            Quantity::Torque => 2,
            _ => 3,
        };
        named.sort_by_key(order);
        let columns = || {
            Some(Self {
                time: time?,
                rate_hz: given.rate_hz,
                position: position?,
                torque: torque?,
                torque_from,
                velocity,
                current,
                temperature,
                load_torque,
                reference_torque,
                other_position,
                command,
            })
        };
        (columns().filter(|_| are_distinct), named)
    }
}

/// Two quantities from one column are a mistake: one of them would be wrong. Returns whether there are none.
fn report_shared_names(section: &Section<'_>, named: &[Wanted]) -> bool {
    let mut are_distinct = true;
    // What is counted or derived reads no column of its own.
    let named: Vec<&Wanted> = named.iter().filter(|wanted| wanted.is_in_file()).collect();
    for (index, wanted) in named.iter().enumerate() {
        if let Some(first) = named[..index].iter().find(|first| first.column.name == wanted.column.name) {
            let what = format!("reads column `{}`, as `{}` does", wanted.column.name, first.key);
            section.reject(&wanted.key, what, "name the column that holds this quantity alone");
            are_distinct = false;
        }
    }
    are_distinct
}

/// What a column that is missing is for.
fn means(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Time => {
            "the column's name in the logs, and its unit; where no column holds time, `rate_hz` in [files]"
        }
        Quantity::Torque => {
            "the column's name in the logs, and its unit; a joint whose torque is not measured needs its motor's `current`, with \
             torque_constant_nm_a in [joint], or the `command` of its position, with the stiffness of its [controller]"
        }
        _ => "the column's name in the logs, and its unit",
    }
}

/// `[columns]` being read.
struct Reader<'s, 'a> {
    section: &'s Section<'a>,
    given: Given,
    /// The columns whose name was given, those without a good unit in the first that their quantity may have.
    named: RefCell<Vec<Wanted>>,
}

impl Reader<'_, '_> {
    /// The time stamps: a column, or rows at a rate.
    fn time(&self) -> Option<Column> {
        let Some(rate_hz) = self.given.rate_hz else { return self.needed(Quantity::Time, "s") };
        if self.section.keys().any(|key| key == "time") {
            let what = "is given, and files.rate_hz too";
            self.section.reject("time", what, "delete rate_hz where the logs hold their time, or delete this column");
        }
        self.section.may("time").ignore();
        let rows = Column { scale: 1.0 / rate_hz, ..Column::new("row", Unit::Second) };
        let wanted = Wanted { rate_hz: Some(rate_hz), ..Wanted::new(Quantity::Time, &rows) };
        self.named.borrow_mut().push(wanted);
        Some(rows)
    }

    /// The torque: a column, the motor's current, or the command of a position controller.
    fn torque(&self, current: Option<&Column>, command: Option<&Column>) -> (Option<Column>, Option<TorqueFrom>) {
        let is_there = self.section.keys().any(|key| key == "torque");
        let (column, from) = match (current, command) {
            _ if is_there => return (self.torque_itself(), None),
            (Some(current), _) => (current, self.of_current()),
            (None, Some(command)) => (command, self.of_command()),
            (None, None) => return (self.needed(Quantity::Torque, "N m"), None),
        };
        let wanted = Wanted { torque_from: Some(from), ..Wanted::new(Quantity::Torque, column) };
        self.named.borrow_mut().push(wanted);
        (Some(column.clone()), Some(from))
    }

    /// The torque's own column, before which all that it could follow from stands back.
    fn torque_itself(&self) -> Option<Column> {
        if self.given.torque_constant_nm_a.is_some() {
            let what = "holds the torque: joint.torque_constant_nm_a is not used";
            self.section.doubt("torque", what, "delete this column to take the torque from the current");
        }
        self.needed(Quantity::Torque, "N m")
    }

    fn of_current(&self) -> TorqueFrom {
        let Given { torque_constant_nm_a, gear_ratio, .. } = self.given;
        if torque_constant_nm_a.is_none() {
            let what = "torque comes from the current, and no torque constant is given: 1 A is taken as 1 N m. All torques are \
                        known up to one factor; mu_c cannot be identified, friction forces follow from their ratio to gravity";
            self.section.doubt("current", what, "give torque_constant_nm_a in [joint] if you know it");
        }
        TorqueFrom::Current(FromCurrent { torque_constant_nm_a, gear_ratio })
    }

    fn of_command(&self) -> TorqueFrom {
        let controller = self.given.controller.unwrap_or_default();
        if controller.stiffness_nm_rad.is_none() {
            let what = "torque comes from how far the joint is from its command, and the controller's stiffness is not given: 1 rad is \
                        taken as 1 N m. All torques are known up to one factor; mu_c cannot be identified, friction forces follow \
                        from their ratio to gravity, and what the controller damps counts as viscous friction";
            self.section.doubt("command", what, "give stiffness_nm_rad in [controller] if you know it");
        }
        TorqueFrom::Controller(controller)
    }

    /// A column that every log has; `unit` serves an example of what to write.
    fn needed(&self, quantity: Quantity, unit: &str) -> Option<Column> {
        let key = quantity.name();
        let example = format!("{{ name = \"{key}\", unit = \"{unit}\" }}");
        let field = self.section.need(key).such_as(&example, means(quantity));
        field.section(|at| self.one(at, key, quantity))
    }

    /// A column that may be absent.
    fn column(&self, key: &str, quantity: Quantity) -> Option<Column> {
        self.section.may(key).section(|at| self.one(at, key, quantity))
    }

    fn one(&self, at: &Section<'_>, key: &str, quantity: Quantity) -> Option<Column> {
        let kind = self.given.kind_for(quantity);
        let name = at.need("name").such_as("\"...\"", "the column's name in the header of the logs").text();
        let units = quantity.units(kind);
        let example = format!("\"{}\"", units[0].name());
        let unit = at.need("unit").such_as(&example, "the unit of the column").text();
        let unit = unit.and_then(|unit| {
            let parsed = quantity.parse_unit(kind, &unit);
            let of_motor = |what: String| match self.given.turns_motor && quantity == Quantity::Torque {
                true => format!("{what}: torque is the motor's, before the screw"),
                false => what,
            };
            parsed.map_err(|(what, cure)| at.reject("unit", of_motor(what), cure)).ok()
        });
        let scale = at.may("scale").number().unwrap_or(1.0);
        if scale == 0.0 || quantity == Quantity::Time && scale < 0.0 {
            let cure = "value in `unit` = scale * reading + offset; 1 where readings are values";
            at.reject("scale", format!("is {scale}"), cure);
        }
        let offset = at.may("offset").number().unwrap_or(0.0);
        let name = name?.trim().to_string();
        let column = Column { name, unit: unit.unwrap_or(units[0]), scale, offset };
        self.named.borrow_mut().push(Wanted { key: key.to_string(), ..Wanted::new(quantity, &column) });
        Some(Column { unit: unit?, ..column })
    }

    fn reference(&self) -> Option<ReferenceColumn> {
        let key = Quantity::ReferenceTorque.name();
        self.section.may(key).section(|at| {
            let arm_m = at.may("arm_m").positive();
            let column = self.one(at, key, Quantity::ReferenceTorque)?;
            let is_force_on_an_arm =
                matches!(column.unit, Unit::Newton | Unit::Kilonewton) && self.given.kind == JointKind::Revolute;
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
