//! `rig.toml`: which devices are on the bus, what their process data mean, what the joint may do.

mod process_data;
mod start;
mod write;

pub use process_data::{Entry, Kind, Place, ProcessData};
pub use start::starting_rig;

use super::drive::Mode;
use super::limits::Limits;
use crate::document::{Document, Section};
use crate::dynamics::Dynamics;
use crate::log::Signal;
use crate::model::Joint;
use crate::problem::Result;
use std::path::Path;

/// The format's name and version.
pub(super) const FORMAT: &str = "rig/1";
/// Roles of a drive's outputs; the first two are needed.
pub const DRIVE_OUTPUTS: [&str; 5] = ["control_word", "target_position", "target_velocity", "target_torque", "mode"];
/// Roles of a drive's inputs; the first two are needed.
pub const DRIVE_INPUTS: [&str; 6] = ["status_word", "position", "velocity", "torque", "mode", "error_code"];
/// Roles of a sensor's inputs: its torque is needed; `status` holds the four bits beside it, as EL3xxx terminals have them.
pub const SENSOR_INPUTS: [&str; 6] = ["torque", "status", "underrange", "overrange", "error", "toggle"];

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
}

/// The drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Who it is.
    pub identity: Identity,
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
    /// What is sent to it.
    pub outputs: ProcessData,
    /// What comes from it.
    pub inputs: ProcessData,
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

/// The torque sensor's terminal.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensor {
    /// Who it is.
    pub identity: Identity,
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
    /// Reads a rig.
    ///
    /// Errors: everything that is wrong with the file, by row.
    pub fn read(file: &Path) -> Result<Self> {
        Document::open(file)?.read(Self::from_section)
    }

    /// Reads a rig from `text`, which is called `file` in messages.
    pub fn parse(file: &Path, text: &str) -> Result<Self> {
        Document::from_toml(file, text)?.read(Self::from_section)
    }

    fn from_section(root: &Section<'_>) -> Option<Self> {
        root.need("format").choice(&[(FORMAT, ())]);
        let bus = root.need("bus").such_as("[bus]", "a section with the interface").section(read_bus);
        let drive = root.need("drive").such_as("[drive]", "a section on the drive").section(read_drive);
        let sensor = root.need("sensor").such_as("[sensor]", "a section on the sensor").section(read_sensor);
        let limits = root.need("limits").such_as("[limits]", "what the joint may do").section(Limits::read);
        let joint = root.need("joint").such_as("[joint]", "as in campaign.toml");
        let joint = joint.section(|section| Joint::read(section, Joint::read_kind(section)));
        let dynamics = root.need("dynamics").such_as("[dynamics]", "as in campaign.toml").section(read_dynamics);
        let signal = root.need("signal").such_as("[signal]", "as in campaign.toml").section(Signal::read);
        if let (Some(drive), Some(sensor)) = (&drive, &sensor)
            && drive.identity.place == sensor.identity.place
        {
            root.reject("sensor", "has the drive's place on the bus", "count the devices from 0: `tautline rig scan`");
        }
        Some(Self {
            bus: bus?,
            drive: drive?,
            sensor: sensor?,
            limits: limits?,
            joint: joint?,
            dynamics: dynamics?,
            signal: signal?,
        })
    }
}

fn read_dynamics(section: &Section<'_>) -> Option<Dynamics> {
    let gravity_nm = section.need("gravity_nm").such_as("0.7", "gravity torque about the joint at 90 deg, N m");
    let gravity_nm = gravity_nm.number();
    let inertia_kg_m2 = section.may("inertia_kg_m2").not_negative().unwrap_or(0.0);
    Some(Dynamics { gravity_nm: gravity_nm?, inertia_kg_m2 })
}

fn read_bus(section: &Section<'_>) -> Option<Bus> {
    let interface = section.need("interface").such_as("\"eth0\"", "the network interface").text();
    let cycle_us = section.may("cycle_us").whole(250, 20_000).unwrap_or(1000);
    let missed = section.may("missed_cycles_max").whole(0, 1000).unwrap_or(2);
    let clocks = section.may("clocks").flag().unwrap_or(true);
    Some(Bus {
        interface: interface?,
        cycle_us: u32::try_from(cycle_us).ok()?,
        missed_cycles_max: u32::try_from(missed).ok()?,
        clocks,
    })
}

fn read_identity(section: &Section<'_>) -> Option<Identity> {
    let number =
        |key: &str| section.need(key).such_as("0x00000002", "as `rig scan` shows it").whole(0, u32::MAX.into());
    let place = section.need("place").such_as("0", "its place on the bus, from 0").whole(0, 63);
    let name = section.need("name").such_as("\"drive\"", "any name").text();
    let (vendor, product) = (number("vendor"), number("product"));
    let revision = section.may("revision").whole(0, u32::MAX.into());
    Some(Identity {
        place: usize::try_from(place?).ok()?,
        name: name?,
        vendor: u32::try_from(vendor?).ok()?,
        product: u32::try_from(product?).ok()?,
        revision: revision.and_then(|revision| u32::try_from(revision).ok()),
    })
}

fn read_drive(section: &Section<'_>) -> Option<Drive> {
    let positive = |key, example, means| section.need(key).such_as(example, means).positive();
    let identity = read_identity(section);
    let mode = section.may("mode").choice(&Mode::NAMES).unwrap_or(Mode::Position);
    let counts_per_rad = positive("counts_per_rad", "83443.0", "counts of the position for a rad of the joint");
    let zero_counts = section.need("zero_counts").such_as("0", "counts where the joint is at 0 rad").number();
    let sign = read_sign(section, "1", "-1 where counts grow as the joint goes down");
    let rated_torque_nm = positive("rated_torque_nm", "2.0", "the torque at the winch that the drive calls 1000, N m");
    let torque_max_nm = positive("torque_max_nm", "2.0", "the most that the drive may give, N m at the winch");
    let following_error_rad = positive("following_error_rad", "0.05", "the drive's window, rad");
    let following_error_s = section.may("following_error_s").not_negative().unwrap_or(0.01);
    let gains = section.may("gains").section(read_gains).unwrap_or_default();
    let target = match mode {
        Mode::Position => "target_position",
        Mode::Velocity => "target_velocity",
        Mode::Torque => "target_torque",
    };
    let outputs = section.need("outputs").such_as("[drive.outputs]", "its RxPDO");
    let outputs = outputs.section(|s| ProcessData::read(s, &DRIVE_OUTPUTS, &["control_word", target]));
    let inputs = section.need("inputs").such_as("[drive.inputs]", "its TxPDO");
    let inputs = inputs.section(|s| ProcessData::read(s, &DRIVE_INPUTS, &["status_word", "position"]));
    let is_closed = match mode {
        Mode::Position => true,
        Mode::Velocity => gains.position_per_s > 0.0,
        Mode::Torque => gains.stiffness_nm_rad > 0.0 && gains.damping_nm_s_rad > 0.0,
    };
    if !is_closed {
        let what = "leave the position open in this mode";
        section.reject("gains", what, "csv needs position_per_s; cst stiffness_nm_rad and damping_nm_s_rad");
    }
    Some(Drive {
        identity: identity?,
        mode,
        counts_per_rad: counts_per_rad?,
        zero_counts: zero_counts?,
        sign: sign?,
        rated_torque_nm: rated_torque_nm?,
        torque_max_nm: torque_max_nm?,
        following_error_rad: following_error_rad?,
        following_error_s,
        gains,
        outputs: outputs?,
        inputs: inputs?,
    })
}

fn read_gains(section: &Section<'_>) -> Option<Gains> {
    let gain = |key| section.may(key).not_negative().unwrap_or(0.0);
    Some(Gains {
        position_per_s: gain("position_per_s"),
        stiffness_nm_rad: gain("stiffness_nm_rad"),
        damping_nm_s_rad: gain("damping_nm_s_rad"),
    })
}

fn read_sensor(section: &Section<'_>) -> Option<Sensor> {
    let identity = read_identity(section);
    let nm_per_count = section.need("nm_per_count").such_as("0.0001526", "torque for a count, N m").number();
    let zero_counts = section.need("zero_counts").such_as("0", "counts without torque: `tautline rig tare`").number();
    let saturated_counts = section.may("saturated_counts").positive().unwrap_or(32_767.0);
    let stale_by = section.may("stale_by").choice(&StaleBy::NAMES).unwrap_or(StaleBy::Toggle);
    let stale_cycles = section.may("stale_cycles").whole(1, 10_000).unwrap_or(3);
    if nm_per_count == Some(0.0) {
        section.reject("nm_per_count", "is 0", "expected the torque for a count, N m");
    }
    let inputs = section.need("inputs").such_as("[sensor.inputs]", "its TxPDO");
    let inputs = inputs.section(|s| ProcessData::read(s, &SENSOR_INPUTS, &["torque"]));
    let has_toggle = |data: &ProcessData| ["toggle", "status"].iter().any(|role| data.place(role).is_some());
    if stale_by == StaleBy::Toggle && inputs.as_ref().is_some_and(|data: &ProcessData| !has_toggle(data)) {
        let cure =
            "set it to \"value\", with as many stale_cycles as the value never stands still for, or to \"nothing\"";
        section.reject("stale_by", "is by a toggle bit, and the inputs have neither `status` nor `toggle`", cure);
    }
    Some(Sensor {
        identity: identity?,
        nm_per_count: nm_per_count?,
        zero_counts: zero_counts?,
        saturated_counts,
        stale_by,
        stale_cycles: u32::try_from(stale_cycles).ok()?,
        inputs: inputs?,
    })
}

fn read_sign(section: &Section<'_>, example: &str, means: &str) -> Option<f64> {
    let sign = section.need("sign").such_as(example, means).number()?;
    if sign.abs() != 1.0 {
        section.reject("sign", format!("is {sign}"), "expected 1 or -1");
    }
    Some(sign)
}
