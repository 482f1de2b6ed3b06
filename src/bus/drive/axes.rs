//! A drive of two axes in one device: the objects of the second stand `AXIS_OBJECTS` further on (CiA 402-2, multi-axis devices).

use super::{Drive, PRODUCT, SERIAL, objects};
use crate::bus::application::{Application, Moment};
use crate::bus::clock::Clock;
use crate::bus::coe::{Access, Dictionary, Emergency};
use crate::bus::description::Description;
use crate::bus::device::Device;
use crate::bus::fault::Fault;
use crate::bus::terminal::VENDOR;
use crate::bus::world::World;
use std::ops::Range;

/// From an object of the first axis to the second's.
const AXIS_OBJECTS: u16 = 0x800;
/// The objects of one axis.
const OBJECTS: Range<u16> = 0x6000..0x6800;
/// From a PDO of the first axis to the second's.
const AXIS_PDOS: u16 = 0x10;

#[derive(Debug)]
struct TwoAxes {
    axes: [Drive; 2],
    /// The second axis' objects, as it sees them: at the places of a first one's.
    second: Dictionary,
}

/// The device, on the first two joints: PDOs 0x1600 and 0x1A00 of the first axis, 0x1610 and 0x1A10 of the second, all assigned.
pub fn two_axes(drift_ppb: i64) -> Device {
    let (mut dictionary, second) = (objects::dictionary(), objects::dictionary());
    for entry in second.entries().filter(|entry| OBJECTS.contains(&entry.at.0)) {
        let mut entry = entry.clone();
        entry.at.0 += AXIS_OBJECTS;
        dictionary.add(entry);
    }
    for (first, assignment) in [(0x1600, 0x1C12), (0x1A00, 0x1C13)] {
        let words = second.mapping(assignment);
        let moved: Vec<i64> = words
            .iter()
            .map(|(index, sub, bits)| {
                i64::from(u32::from(index + AXIS_OBJECTS) << 16 | u32::from(*sub) << 8 | u32::from(*bits))
            })
            .collect();
        dictionary.list(first + AXIS_PDOS, Access::Read, 4, &moved);
        dictionary.list(assignment, Access::WritePreOp, 2, &[first.into(), (first + AXIS_PDOS).into()]);
    }
    let description = Description {
        identity: [VENDOR, PRODUCT + 1, 1, SERIAL],
        names: ["TL7412", "Drive", "Winch drive of two axes, CiA 402"],
        dictionary,
        mailbox: true,
        clock: Some(Clock::new(1_234_567_890, drift_ppb)),
        feeds_watchdog: true,
    };
    Device::new(description, Box::new(TwoAxes { axes: [Drive::new(0), Drive::new(1)], second }))
}

impl Application for TwoAxes {
    fn work(&mut self, dictionary: &mut Dictionary, world: &mut World, moment: Moment) -> Option<Emergency> {
        let [first, second] = &mut self.axes;
        let warning = first.work(dictionary, world, moment);
        copy(dictionary, AXIS_OBJECTS, &mut self.second, 0);
        let other = second.work(&mut self.second, world, moment);
        copy(&self.second, 0, dictionary, AXIS_OBJECTS);
        warning.or(other)
    }

    fn fail(&mut self, fault: Fault) {
        self.axes[0].fail(fault);
    }
}

/// The values of an axis, whose objects stand `from_offset` further on in `from` and `to_offset` in `to`.
fn copy(from: &Dictionary, from_offset: u16, to: &mut Dictionary, to_offset: u16) {
    let range = OBJECTS.start + from_offset..OBJECTS.end + from_offset;
    for entry in from.entries().filter(|entry| range.contains(&entry.at.0)) {
        if let Some(value) = to.value_mut(entry.at.0 - from_offset + to_offset, entry.at.1) {
            value.clone_from(&entry.value);
        }
    }
}
