//! `rig.toml`.

use super::campaign::{Dynamics, Joint, Signal};
use schemars::JsonSchema;
use serde::Deserialize;

/// A joint on an EtherCAT bus: its devices, what their process data mean, what the joint may do.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rig {
    /// Always rig/1.
    pub format: RigFormat,
    /// The network interface and how the bus is run.
    pub bus: Bus,
    /// The drive of the joint's winch.
    pub drive: Drive,
    /// Where the torque comes from.
    pub sensor: Sensor,
    /// What the joint may do.
    pub limits: Limits,
    /// The joint, as in campaign.toml.
    pub joint: Joint,
    /// Gravity and inertia, as in campaign.toml.
    pub dynamics: Dynamics,
    /// Sign and low-pass of the torque, as in campaign.toml.
    pub signal: Signal,
    /// Further drives, which hold a tension or a position while the joint moves.
    #[serde(default)]
    pub axes: Vec<Axis>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum RigFormat {
    /// Version 1.
    #[serde(rename = "rig/1")]
    V1,
}

/// How the bus is run.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bus {
    /// The network interface.
    pub interface: String,
    /// Length of a cycle, us: 250 to 20,000; 1000 where absent.
    pub cycle_us: Option<u32>,
    /// More missed cycles than this, one after the other, stop the joint; 2 where absent.
    pub missed_cycles_max: Option<u32>,
    /// Whether distributed clocks are used; true where absent.
    pub clocks: Option<bool>,
    /// Time of the output watchdogs, ms; where absent twice the gap that may pass, 20 at least and 100 at most.
    pub watchdog_ms: Option<u32>,
    /// Places of devices with outputs that are not the rig's.
    pub others: Option<Vec<u32>>,
}

/// The drive of a winch.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Its place on the bus, from 0.
    pub place: u32,
    /// Any name.
    pub name: String,
    /// Vendor number.
    pub vendor: u32,
    /// Product code.
    pub product: u32,
    /// Revision, where it matters.
    pub revision: Option<u32>,
    /// Serial number, where it matters.
    pub serial: Option<u32>,
    /// Station alias, where it matters.
    pub alias: Option<u16>,
    /// Objects written in PRE-OP and read back.
    pub startup: Option<Vec<Startup>>,
    /// Pulses of its distributed clock, where they are not to come with every cycle.
    pub clock: Option<Clock>,
    /// Which of its axes, 0 to 7; 0 where absent.
    pub axis: Option<u16>,
    /// Objects that it does not have: what they would set is unknown.
    pub without: Option<Vec<u16>>,
    /// What it is told to follow; csp where absent.
    pub mode: Option<Mode>,
    /// Counts of the position for a rad of the joint.
    pub counts_per_rad: f64,
    /// Counts where the joint is at 0 rad.
    pub zero_counts: f64,
    /// 1, or -1 where counts grow as the joint goes down.
    pub sign: f64,
    /// Torque at the winch that the drive calls 1000, N m.
    pub rated_torque_nm: f64,
    /// The most that the drive may give, N m at the winch.
    pub torque_max_nm: f64,
    /// The drive's following-error window, rad.
    pub following_error_rad: f64,
    /// The drive's following-error time, s; 0.01 where absent.
    pub following_error_s: Option<f64>,
    /// How the position is closed in csv and cst.
    pub gains: Option<Gains>,
    /// A brake that is let go by this program.
    pub brake: Option<Brake>,
    /// What is sent to it.
    pub outputs: ProcessData,
    /// What comes from it.
    pub inputs: ProcessData,
}

/// A further axis: the keys of a drive, its own limits, and what it holds.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// What it holds from the moment it has torque.
    pub holds: Holds,
    /// The tension at its winch, N m, with the sign of its position.
    pub tension_nm: Option<f64>,
    /// What it may do.
    pub limits: Limits,
    /// Its drive.
    #[serde(flatten)]
    pub drive: Drive,
}

/// What an axis holds.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Holds {
    /// A torque at its winch.
    Tension,
    /// The position at which it got torque.
    Position,
}

/// What a drive is told to follow.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// Positions.
    Csp,
    /// Speeds; the position loop runs on this computer.
    Csv,
    /// Torques; the position loop runs on this computer.
    Cst,
}

/// How a position error becomes a speed or a torque.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gains {
    /// Speed for a position error, 1/s (csv).
    pub position_per_s: Option<f64>,
    /// Torque at the winch for a position error, N m/rad (cst).
    pub stiffness_nm_rad: Option<f64>,
    /// Torque at the winch for a speed error, N m s/rad (cst).
    pub damping_nm_s_rad: Option<f64>,
}

/// A brake that stands closed without power.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Brake {
    /// The bit of its output that lets it go; 0 where absent.
    pub bit: Option<u32>,
    /// From letting it go until the joint may move, s.
    pub release_s: f64,
    /// From closing it until it holds, s.
    pub engage_s: f64,
    /// The device whose output lets it go, where that is not the drive.
    pub device: Option<BrakeDevice>,
}

/// A digital output terminal with a brake.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BrakeDevice {
    /// Its place on the bus, from 0.
    pub place: u32,
    /// Any name.
    pub name: String,
    /// Vendor number.
    pub vendor: u32,
    /// Product code.
    pub product: u32,
    /// Revision, where it matters.
    pub revision: Option<u32>,
    /// Serial number, where it matters.
    pub serial: Option<u32>,
    /// Station alias, where it matters.
    pub alias: Option<u16>,
    /// Objects written in PRE-OP and read back.
    pub startup: Option<Vec<Startup>>,
    /// Pulses of its distributed clock.
    pub clock: Option<Clock>,
    /// What is sent to it: one entry with `as = "brake"`.
    pub outputs: ProcessData,
}

/// Where the torque comes from: a terminal, or (`from`) the drive.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// The drive's own torque, or a sensor wired to the drive; absent for a device of its own.
    pub from: Option<From>,
    /// Its place on the bus, from 0.
    pub place: Option<u32>,
    /// Any name.
    pub name: Option<String>,
    /// Vendor number.
    pub vendor: Option<u32>,
    /// Product code.
    pub product: Option<u32>,
    /// Revision, where it matters.
    pub revision: Option<u32>,
    /// Serial number, where it matters.
    pub serial: Option<u32>,
    /// Station alias, where it matters.
    pub alias: Option<u16>,
    /// Objects written in PRE-OP and read back.
    pub startup: Option<Vec<Startup>>,
    /// Pulses of its distributed clock.
    pub clock: Option<Clock>,
    /// Torque for a count, N m; needed but for the drive's own torque.
    pub nm_per_count: Option<f64>,
    /// Counts without torque (`rig tare` sets it).
    pub zero_counts: Option<f64>,
    /// Counts, up or down, at which its range ends; 32,767 where absent.
    pub saturated_counts: Option<f64>,
    /// What tells that a value is new; toggle where absent.
    pub stale_by: Option<StaleBy>,
    /// Cycles without anything new after which a value is stale; 3 where absent.
    pub stale_cycles: Option<u32>,
    /// What comes from it.
    pub inputs: Option<ProcessData>,
}

/// Which torque of the drive.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum From {
    /// Its own torque (0x6077).
    DriveTorque,
    /// A sensor wired to it.
    DriveSensor,
}

/// What tells a new value of a sensor from an old one.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum StaleBy {
    /// A bit that changes with every conversion.
    Toggle,
    /// The value itself.
    Value,
    /// Nothing: a sensor that stops is not noticed.
    Nothing,
}

/// What one direction of a device carries: one PDO (`pdo`, `entries`), or several (`pdos`).
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProcessData {
    /// Index of the PDO.
    pub pdo: Option<u16>,
    /// Its entries, in their order.
    pub entries: Option<Vec<Entry>>,
    /// Several PDOs, in the order of their assignment.
    pub pdos: Option<Vec<Pdo>>,
}

/// A PDO.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pdo {
    /// Its index.
    pub pdo: u16,
    /// Its entries, in their order.
    pub entries: Vec<Entry>,
}

/// An object in the process data.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// What it is: of a drive's outputs control_word, target_position, target_velocity, target_torque, mode, brake; of its inputs
    /// status_word, position, velocity, torque, current, mode, error_code, counter, sensor, sensor_status; of a sensor's torque,
    /// status, underrange, overrange, error, toggle. Absent where it is left alone.
    #[serde(rename = "as")]
    pub role: Option<String>,
    /// Index in the object dictionary; 0 fills a gap.
    pub index: u16,
    /// Subindex; 0 where absent.
    pub sub: Option<u8>,
    /// How it is written.
    #[serde(rename = "type")]
    pub kind: Option<EntryType>,
    /// In place of `type`: length of what is left alone, bits.
    pub bits: Option<u8>,
}

/// How a number is written, little end first.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum EntryType {
    /// Signed, 8 bits.
    I8,
    /// Signed, 16 bits.
    I16,
    /// Signed, 32 bits.
    I32,
    /// Unsigned, 8 bits.
    U8,
    /// Unsigned, 16 bits.
    U16,
    /// Unsigned, 32 bits.
    U32,
    /// IEEE 754, 32 bits.
    F32,
    /// One bit.
    Bit,
    /// Two bits.
    Bit2,
    /// Three bits.
    Bit3,
    /// Four bits.
    Bit4,
    /// Five bits.
    Bit5,
    /// Six bits.
    Bit6,
    /// Seven bits.
    Bit7,
}

/// An object written in PRE-OP.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Startup {
    /// Its index.
    pub index: u16,
    /// Subindex; 0 where absent.
    pub sub: Option<u8>,
    /// How it is written; not a bit.
    #[serde(rename = "type")]
    pub kind: EntryType,
    /// What it must hold.
    pub value: f64,
}

/// Pulses of a device's distributed clock, as an ESI file has them.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Clock {
    /// AssignActivate: 0x0300 for SYNC0, 0x0700 for both, 0 for none; 0x0300 where absent.
    pub assign_activate: Option<u16>,
    /// How much later than those of the others SYNC0 comes, us.
    pub sync0_shift_us: Option<f64>,
    /// From SYNC0 to SYNC1, us.
    pub sync1_us: Option<f64>,
}

/// What a joint may do; of a prismatic one `_rad` is m and `_nm` is N.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Lower end of its range, rad.
    pub low_rad: f64,
    /// Upper end, rad.
    pub high_rad: f64,
    /// rad/s.
    pub speed_rad_s: f64,
    /// Of commands, rad/s^2.
    pub acceleration_rad_s2: f64,
    /// At the sensor, N m.
    pub torque_nm: f64,
    /// Largest change of the torque from one sample to the next, N m.
    pub torque_step_nm: f64,
    /// Largest distance from the command, rad.
    pub lag_rad: f64,
    /// Speed of the moves between trials, rad/s; a quarter of speed_rad_s where absent.
    pub approach_rad_s: Option<f64>,
    /// Way that may be commanded before the joint must be seen to follow, rad; a tenth of lag_rad where absent.
    pub stuck_rad: Option<f64>,
    /// Way that a stop may take, rad.
    pub stop_rad: Option<f64>,
}
