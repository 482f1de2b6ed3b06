//! `rig.toml`: which devices are on the bus, what their process data mean, what the joint may do.

mod axes;
pub mod preset;
mod process_data;
mod read;
mod read_drive;
mod read_sensor;
mod setup;
mod start;

pub use axes::{HeldAxis, Holds};
pub use process_data::{Entry, Kind, Pdo, Place, ProcessData};
pub use setup::{Pulses, Setup, Startup};
pub use start::starting_rig;

use super::drive::Mode;
use super::limits::Limits;
use crate::document::Document;
use crate::dynamics::Dynamics;
use crate::log::Signal;
use crate::model::Joint;
use crate::problem::Result;
use std::path::Path;

/// The format's name and version.
pub(super) const FORMAT: &str = "rig/1";
/// Roles of a drive's outputs; the control word and the target of its mode are needed. `brake` is an output that lets a brake go.
pub const DRIVE_OUTPUTS: [&str; 6] =
    ["control_word", "target_position", "target_velocity", "target_torque", "mode", "brake"];
/// Roles of a drive's inputs; the first two are needed. `counter` is anything that the drive changes every cycle, `sensor` and
/// `sensor_status` a torque sensor that is wired to the drive.
pub const DRIVE_INPUTS: [&str; 10] = [
    "status_word",
    "position",
    "velocity",
    "torque",
    "current",
    "mode",
    "error_code",
    "counter",
    "sensor",
    "sensor_status",
];
/// Roles of a sensor's inputs: its torque is needed; `status` holds the four bits beside it, as EL3xxx terminals have them.
pub const SENSOR_INPUTS: [&str; 6] = ["torque", "status", "underrange", "overrange", "error", "toggle"];

/// Objects of one axis after the other's, of a drive that has several (CiA 402-2, multi-axis devices).
pub const AXIS_OBJECTS: u16 = 0x800;

/// A joint on a bus.
#[derive(Debug, Clone, PartialEq)]
pub struct Rig {
    /// The wire.
    pub bus: Bus,
    /// The drive of the winch.
    pub drive: Drive,
    /// The torque sensor at the winch.
    pub sensor: Sensor,
    /// What the joint may do.
    pub limits: Limits,
    /// What campaigns say of the joint.
    pub joint: Joint,
    /// Its gravity and inertia.
    pub dynamics: Dynamics,
    /// What is to be done to the torque.
    pub signal: Signal,
    /// Further axes, which hold while the joint moves.
    pub axes: Vec<HeldAxis>,
}

/// How the bus is run.
#[derive(Debug, Clone, PartialEq)]
pub struct Bus {
    /// The network interface.
    pub interface: String,
    /// Length of a cycle, us.
    pub cycle_us: u32,
    /// More missed cycles than this, one after the other, end a motion.
    pub missed_cycles_max: u32,
    /// Whether distributed clocks are set up and held.
    pub clocks: bool,
    /// After how long without outputs a device must leave OP by itself, ms.
    pub watchdog_ms: u32,
    /// Places of devices with outputs that are not the rig's and may be brought to OP all the same.
    pub others: Vec<usize>,
}

impl Bus {
    /// Length of a cycle, s.
    pub fn period_s(&self) -> f64 {
        f64::from(self.cycle_us) * 1e-6
    }
}

/// What a device must report of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// Its place on the bus, from 0.
    pub place: usize,
    /// What we call it.
    pub name: String,
    /// Vendor.
    pub vendor: u32,
    /// Product code.
    pub product: u32,
    /// Revision, where it matters.
    pub revision: Option<u32>,
    /// Serial number, where it matters: of two like devices it tells which is which.
    pub serial: Option<u32>,
    /// Station alias, where it matters.
    pub alias: Option<u16>,
}

/// The drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Who it is.
    pub identity: Identity,
    /// How it is set up.
    pub setup: Setup,
    /// Which of its axes: their objects are `AXIS_OBJECTS` apart (CiA 402-2).
    pub axis: u16,
    /// Objects that it is known not to have: what they would set or tell is unknown.
    pub without: Vec<u16>,
    /// What it is told to follow.
    pub mode: Mode,
    /// Counts of the position (0x6064, 0x607A) for a rad of the joint.
    pub counts_per_rad: f64,
    /// Counts where the joint is at 0 rad.
    pub zero_counts: f64,
    /// 1 or -1: -1 where counts grow as the joint goes down.
    pub sign: f64,
    /// Torque at the winch that the drive calls 1000 (per mille of rated), N m.
    pub rated_torque_nm: f64,
    /// Largest torque that the drive may give (0x6072), N m at the winch.
    pub torque_max_nm: f64,
    /// Following-error window (0x6065), rad.
    pub following_error_rad: f64,
    /// Following-error time (0x6066), s.
    pub following_error_s: f64,
    /// In velocity and torque mode: how the position error is closed.
    pub gains: Gains,
    /// A brake that we let go, where the drive does not do that by itself.
    pub brake: Option<Brake>,
    /// What is sent to it.
    pub outputs: ProcessData,
    /// What comes from it.
    pub inputs: ProcessData,
}

/// A brake that stands closed without power, and takes its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Brake {
    /// The bit of the output with the role `brake` that lets it go (0x60FE, or a bit of its own).
    pub bit: u32,
    /// From letting it go until the joint may move, s: torque is on before.
    pub release_s: f64,
    /// From closing it until it holds, s: torque stays on for so long.
    pub engage_s: f64,
    /// Whose output lets it go, where that is not the drive's own.
    pub device: Option<BrakeDevice>,
}

/// A device whose output lets a brake go: a digital output terminal.
#[derive(Debug, Clone, PartialEq)]
pub struct BrakeDevice {
    /// Who it is.
    pub identity: Identity,
    /// How it is set up.
    pub setup: Setup,
    /// What is sent to it.
    pub outputs: ProcessData,
}

/// What a drive is sent: targets along a path, or a torque that stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Target {
    Path,
    Tension,
}

/// How a position error becomes a velocity or a torque where the drive does not close that loop itself.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Gains {
    /// Velocity for a position error, 1/s (velocity mode).
    pub position_per_s: f64,
    /// Torque at the winch for a position error, N m/rad (torque mode).
    pub stiffness_nm_rad: f64,
    /// Torque at the winch for a velocity error, N m s/rad (torque mode).
    pub damping_nm_s_rad: f64,
}

/// Where the torque comes from: a terminal with a sensor, or the drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Who it is: the drive's own, where the torque comes from there.
    pub identity: Identity,
    /// Whether the torque comes from the drive: its own (0x6077), or that of a sensor wired to it.
    pub is_in_drive: bool,
    /// How it is set up.
    pub setup: Setup,
    /// Torque for a count, N m; negative where counts fall as the recorded torque grows.
    pub nm_per_count: f64,
    /// Counts without torque (`rig tare` sets it).
    pub zero_counts: f64,
    /// Counts, up or down, at which the range ends.
    pub saturated_counts: f64,
    /// What tells that a value is new.
    pub stale_by: StaleBy,
    /// Cycles without anything new after which the value is stale.
    pub stale_cycles: u32,
    /// What comes from it.
    pub inputs: ProcessData,
}

/// What tells a new value of a sensor from an old one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StaleBy {
    /// A bit that changes with every conversion: of the status word the highest, or one of its own.
    Toggle,
    /// The value itself: it has noise.
    Value,
    /// Nothing: a sensor that stops is not noticed.
    Nothing,
}

impl StaleBy {
    /// The names used in `rig.toml`.
    pub const NAMES: [(&'static str, Self); 3] =
        [("toggle", Self::Toggle), ("value", Self::Value), ("nothing", Self::Nothing)];
}

impl Drive {
    /// The index of its object that is `index` of a first axis.
    pub fn object(&self, index: u16) -> u16 {
        index + self.axis * AXIS_OBJECTS
    }

    /// The joint's position at `counts`, rad.
    pub fn position_rad(&self, counts: f64) -> f64 {
        self.sign * (counts - self.zero_counts) / self.counts_per_rad
    }

    /// Counts at which the joint is at `position_rad`.
    pub fn counts(&self, position_rad: f64) -> f64 {
        self.sign * position_rad * self.counts_per_rad + self.zero_counts
    }
}

impl Rig {
    /// The devices that the rig names, each once, with how they are set up.
    pub fn devices(&self) -> impl Iterator<Item = (&Identity, &Setup)> {
        let sensor = (!self.sensor.is_in_drive).then_some((&self.sensor.identity, &self.sensor.setup));
        let held = self.axes.iter().map(|axis| (&axis.drive.identity, &axis.drive.setup));
        let brakes = self.brake_devices().map(|device| (&device.identity, &device.setup));
        let all = std::iter::once((&self.drive.identity, &self.drive.setup)).chain(sensor).chain(held).chain(brakes);
        // A device with two axes, or on which two brakes hang, counts once, by the first of them.
        let mut seen = Vec::new();
        all.filter(move |(identity, _)| {
            let is_new = !seen.contains(&identity.place);
            seen.push(identity.place);
            is_new
        })
    }

    /// The devices whose outputs let brakes go, once for each brake.
    pub fn brake_devices(&self) -> impl Iterator<Item = &BrakeDevice> {
        self.drives().filter_map(|drive| drive.brake.as_ref()?.device.as_ref())
    }

    /// The joint's own drive, and those of the axes that hold.
    pub fn drives(&self) -> impl Iterator<Item = &Drive> {
        std::iter::once(&self.drive).chain(self.axes.iter().map(|axis| &axis.drive))
    }

    /// What the device at `place` is called, in quotes, if it is the rig's.
    pub fn name(&self, place: usize) -> Option<String> {
        let known = self.devices().map(|(identity, _)| identity).find(|identity| identity.place == place);
        known.map(|identity| format!("`{}`", identity.name))
    }

    /// Reads a rig.
    ///
    /// Errors: everything that is wrong with the file, by row.
    pub fn read(file: &Path) -> Result<Self> {
        Document::open(file)?.read(read::rig)
    }

    /// Reads a rig from `text`, which is called `file` in messages.
    pub fn parse(file: &Path, text: &str) -> Result<Self> {
        Document::from_toml(file, text)?.read(read::rig)
    }
}
