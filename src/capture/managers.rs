//! A device's sync managers as its registers have them: what it takes and sends every cycle, and where that stands.

use super::line::Line;
use super::wire::Wire;
use ethercrab::{SubDevice, SubDeviceRef};
use std::ops::Deref;

/// How many sync managers a device has, one byte; each takes 8 bytes from there on.
const COUNT: u16 = 0x0005;
const FIRST: u16 = 0x0800;
const BYTES: u16 = 8;
/// Where of the 8 bytes its control, its status and its activation stand.
const CONTROL: u16 = 4;
const STATUS: u16 = 5;
const ACTIVATION: u16 = 6;
/// More than this no device has.
const MOST: u8 = 16;
/// Bit of the control byte by which outputs feed the watchdog.
pub(super) const FEEDS_WATCHDOG: u8 = 1 << 6;

/// One that is active.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Manager {
    at: u16,
    /// Where its bytes stand.
    pub start: u16,
    /// How many they are.
    pub length: u16,
    /// Bits 0-1: 0 for buffers, 2 for a mailbox; bits 2-3: 1 where the master writes; bit 6 feeds the watchdog.
    pub control: u8,
    /// As it was read.
    pub activation: u8,
}

impl Manager {
    /// Whether it holds what the device takes every cycle.
    pub fn is_outputs(&self) -> bool {
        self.control & 3 == 0 && self.control >> 2 & 3 == 1
    }

    /// Whether it holds what the device sends every cycle.
    pub fn is_inputs(&self) -> bool {
        self.control & 3 == 0 && self.control >> 2 & 3 == 0
    }

    /// Whether it is the mailbox that the device writes.
    pub fn is_mailbox_in(&self) -> bool {
        self.control & 3 == 2 && self.control >> 2 & 3 == 0
    }

    /// The register of its control.
    pub fn control_at(&self) -> u16 {
        self.at + CONTROL
    }

    /// The register of its status.
    pub fn status_at(&self) -> u16 {
        self.at + STATUS
    }

    /// The register of its activation.
    pub fn activation_at(&self) -> u16 {
        self.at + ACTIVATION
    }
}

/// Those of `device` that are active and not empty.
pub(super) fn managers<W: Wire, S: Deref<Target = SubDevice>>(
    line: &mut Line<'_, W>,
    device: &SubDeviceRef<'_, S>,
) -> Vec<Manager> {
    let count = line.run(device.register_read::<u8>(COUNT)).unwrap_or(0).min(MOST);
    let one = |index: u8| {
        let at = FIRST + BYTES * u16::from(index);
        let bytes = line.run(device.register_read::<[u8; BYTES as usize]>(at)).ok()?;
        let word = |i: usize| u16::from_le_bytes([bytes[i], bytes[i + 1]]);
        let activation = bytes[usize::from(ACTIVATION)];
        let is_used = activation & 1 != 0 && word(2) > 0;
        is_used.then_some(Manager { at, start: word(0), length: word(2), control: bytes[4], activation })
    };
    (0..count).filter_map(one).collect()
}
