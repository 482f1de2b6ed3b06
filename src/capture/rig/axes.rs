//! Further axes on the same bus, which hold while the joint moves: the second cable of an antagonistic joint, a neighbouring joint.

use super::read_drive::read_drive;
use super::read_sensor::sensor_in_drive;
use super::{Drive, Rig, Setup, Target};
use crate::capture::limits::Limits;
use crate::document::Section;
use crate::dynamics::Dynamics;

/// An axis that holds.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldAxis {
    /// Its drive.
    pub drive: Drive,
    /// What it may do; its torque is the drive's own (0x6077).
    pub limits: Limits,
    /// What it holds.
    pub holds: Holds,
}

/// What an axis holds from the moment it has torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Holds {
    /// The position at which it got torque.
    Position,
    /// A torque at its winch, N m, with the sign of its position.
    Tension(f64),
}

/// What it may hold, as files name it: whether that is a tension.
const HOLDS: [(&str, bool); 2] = [("position", false), ("tension", true)];

impl HeldAxis {
    /// Reads one of `[[axes]]`: the keys of `[drive]`, its own `limits`, and what it holds.
    pub(super) fn read(section: &Section<'_>) -> Option<Self> {
        let example = "\"tension\"";
        let means = "a torque at its winch (`tension_nm`), or \"position\"";
        let is_tension = section.need("holds").such_as(example, means).choice(&HOLDS);
        let tension_nm = match is_tension {
            Some(true) => section.need("tension_nm").such_as("0.2", "at its winch, N m").number(),
            _ => None,
        };
        let target = if is_tension == Some(true) { Target::Tension } else { Target::Path };
        let drive = read_drive(section, target);
        let limits = section.need("limits").such_as("[axes.limits]", "what it may do").section(Limits::read);
        let (drive, limits) = (drive?, limits?);
        if drive.inputs.place("torque").is_none() {
            let cure = "map object 0x6077 in its inputs, with `as = \"torque\"`";
            section.reject("inputs", "lack the drive's torque, by which this axis is watched", cure);
        }
        if let Some(tension_nm) = tension_nm
            && tension_nm.abs() > drive.torque_max_nm.min(limits.torque_nm)
        {
            let what = format!("is {tension_nm}, above torque_max_nm or its limits' torque_nm");
            section.reject("tension_nm", what, "hold less, or allow more");
        }
        let holds = match is_tension? {
            true => Holds::Tension(tension_nm?),
            false => Holds::Position,
        };
        Some(Self { drive, limits, holds })
    }

    /// What is wrong with it, the axis `index` of `rig`, beside the joint's own drive and the axes before it.
    pub(super) fn check(&self, root: &Section<'_>, rig: &Rig, index: usize) {
        let place = self.drive.identity.place;
        let name = &self.drive.identity.name;
        if !rig.sensor.is_in_drive && place == rig.sensor.identity.place {
            root.reject("axes", format!("`{name}` has the sensor's place on the bus"), "`tautline rig scan` shows it");
        }
        for other in rig.drives().take(index + 1).filter(|other| other.identity.place == place) {
            // Two axes of one device exchange the same bytes, of which each reads and writes its own.
            let is_same = self.drive.outputs.is_alike(&other.outputs) && self.drive.inputs.is_alike(&other.inputs);
            if self.drive.axis == other.axis || !is_same || self.drive.setup != Setup::default() {
                let cure = "two axes of one device differ by `axis`, list the same PDOs with all entries (each with its own \
                            roles), and have startup and clock in the first of them only";
                root.reject("axes", format!("`{name}` and `{}` have one place on the bus", other.identity.name), cure);
            }
        }
    }
}

impl Rig {
    /// The joint's own axis and those that hold, each as a rig of its own on the same bus.
    pub fn each_axis(&self) -> Vec<Self> {
        let own = Self { axes: Vec::new(), ..self.clone() };
        let held = self.axes.iter().map(|axis| Self {
            drive: axis.drive.clone(),
            sensor: sensor_in_drive(&axis.drive),
            limits: axis.limits,
            // Its load is not the joint's.
            dynamics: Dynamics::default(),
            ..own.clone()
        });
        std::iter::once(own.clone()).chain(held).collect()
    }
}
