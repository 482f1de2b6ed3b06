//! Faults put in from outside: when they strike, and whom.

use super::device::Device;
use super::fault::{Fault, When};
use super::{BEHIND, Bus};
use crate::simulate::Load;

/// Whose fault it is, where there are two drives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Struck {
    First = 0,
    Second = 1,
}

impl Bus {
    /// Injects a fault at a time (ns) or at a cycle; a fault of a drive or its joint strikes the first drive.
    pub fn inject(&mut self, fault: Fault, when: impl Into<When>) {
        self.to_come.push((when.into(), Struck::First, fault));
    }

    /// The same in the second drive, or what it moves.
    pub fn inject_into_second(&mut self, fault: Fault, when: impl Into<When>) {
        self.to_come.push((when.into(), Struck::Second, fault));
    }

    /// Lets the faults happen whose time has come.
    pub(super) fn strike(&mut self, now: impl Fn(When) -> bool) {
        if self.to_come.is_empty() {
            return;
        }
        let (struck, to_come) = std::mem::take(&mut self.to_come).into_iter().partition(|(when, ..)| now(*when));
        self.to_come = to_come;
        let struck: Vec<(When, Struck, Fault)> = struck;
        for (_, of, fault) in struck {
            self.happen(of, fault);
        }
    }

    fn happen(&mut self, of: Struck, fault: Fault) {
        if self.line.take(fault) {
            return;
        }
        let now_ns = self.now_ns;
        match fault {
            Fault::Gone { device } => {
                self.reached = self.reached.min(device);
                if let Some(last) = self.devices[..self.reached].last_mut() {
                    last.count_lost_link(BEHIND);
                }
                self.link();
            }
            Fault::SafeOp { device, .. }
            | Fault::Emergency { device, .. }
            | Fault::Watchdog { device }
            | Fault::WatchdogOff { device }
            | Fault::FrozenInputs { device } => {
                if let Some(device) = self.devices.get_mut(device) {
                    device.fail(fault, now_ns);
                }
            }
            Fault::CableBreak => self.world.break_cable(of as usize),
            Fault::Blocked | Fault::EncoderJump { .. } => {
                if let Some(joint) = self.world.joints.get_mut(of as usize) {
                    match fault {
                        Fault::EncoderJump { by_rad } => joint.motor.encoder_off_rad += by_rad,
                        _ => joint.set_load(Load::Obstacle),
                    }
                }
            }
            Fault::SecondMaster => self.devices.iter_mut().for_each(|device| device.fail(fault, now_ns)),
            // Terminals leave alone what is of a drive, and the other way round.
            _ => {
                let is_drive = |device: &Device| device.object(0x6041, 0).is_some();
                let second = self.devices.iter().position(is_drive).map_or(usize::MAX, |first| {
                    let behind = self.devices[first + 1..].iter().position(is_drive);
                    behind.map_or(usize::MAX, |behind| first + 1 + behind)
                });
                let is_struck = |place: usize| (place == second) == (of == Struck::Second);
                let struck = self.devices.iter_mut().enumerate().filter(|(place, _)| is_struck(*place));
                struck.for_each(|(_, device)| device.fail(fault, now_ns));
            }
        }
    }
}
