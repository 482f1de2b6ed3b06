//! `campaign.toml`.

use schemars::JsonSchema;
use serde::Deserialize;
use std::collections::BTreeMap;

/// One joint, recorded: a folder with campaign.toml and a log for each trial.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Campaign {
    /// Always campaign/1.
    pub format: CampaignFormat,
    /// The joint and what drives it.
    pub joint: Joint,
    /// Gravity and inertia: of the joint alone, or of a chain from a URDF.
    pub dynamics: Dynamics,
    /// Sign and low-pass of the torque.
    pub signal: Signal,
    /// The position controller, where no column holds torque or current: torque follows from command and position.
    pub controller: Option<Controller>,
    /// How the CSV files are written; found out where it is absent.
    pub files: Option<Files>,
    /// Which column holds which quantity, by quantity: time, position, torque; optional velocity, current, temperature,
    /// load_torque, reference_torque, command, other_position, other_position_2, ...
    pub columns: BTreeMap<String, Column>,
    /// How far declared constants may be off: half widths of 95 % intervals.
    pub uncertainty: Option<Uncertainty>,
    /// The trials, one for each log.
    pub trials: Vec<Trial>,
}

/// The format's name.
#[derive(Debug, Deserialize, JsonSchema)]
pub enum CampaignFormat {
    /// Version 1.
    #[serde(rename = "campaign/1")]
    V1,
}

/// The joint and what drives it.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// How it moves; revolute where absent. Of a prismatic joint `_nm` holds N and `_rad` holds m.
    pub kind: Option<Kind>,
    /// What drives it; a cable where absent.
    pub drive: Option<Drive>,
    /// r1, m.
    pub winch_radius_m: Option<f64>,
    /// r2, m.
    pub pulley_radius_m: Option<f64>,
    /// X_cl, the clearance as travel of the cable, m.
    pub backlash_m: Option<f64>,
    /// The clearance at a joint without a cable, rad.
    pub backlash_rad: Option<f64>,
    /// Turns of the motor for one of the joint, of a gear.
    pub gear_ratio: Option<f64>,
    /// Travel of the slide for a turn of the screw, m.
    pub lead_m: Option<f64>,
    /// Torque of the motor for its current, N m/A, where current stands for torque.
    pub torque_constant_nm_a: Option<f64>,
}

/// How a joint moves.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// It turns.
    Revolute,
    /// It slides.
    Prismatic,
}

/// What drives a joint.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Drive {
    /// Two antagonistic cables from a winch.
    Cable,
    /// A gear.
    Gear,
    /// The motor itself.
    Direct,
    /// A screw.
    Screw,
}

/// Gravity and inertia.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Dynamics {
    /// The gravity torque about the joint at 90 deg, N m.
    pub gravity_nm: Option<f64>,
    /// Inertia about the joint, kg m^2; 0 where absent.
    pub inertia_kg_m2: Option<f64>,
    /// A chain of bodies instead: its URDF.
    pub urdf: Option<String>,
    /// The moving joint in the URDF.
    pub joint: Option<String>,
    /// Positions of joints that are held, rad, by name.
    pub held_rad: Option<BTreeMap<String, f64>>,
}

/// Sign and low-pass of the torque.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Signal {
    /// 1 or -1, so that y = torque_sign * recorded torque grows with gravity's torque when the joint moves up.
    pub torque_sign: f64,
    /// Cut-off of the zero-phase low-pass, Hz.
    pub lowpass_hz: f64,
    /// Its order, 1 to 12.
    pub lowpass_order: u8,
}

/// The law of a position controller at the joint, within its limit: stiffness (command - position) - damping velocity.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Controller {
    /// N m/rad; where absent, unknown: all torques are then known up to one factor.
    pub stiffness_nm_rad: Option<f64>,
    /// N m s/rad; 0 where absent.
    pub damping_nm_s_rad: Option<f64>,
    /// What is damped; the velocity where absent.
    pub damped: Option<Damped>,
    /// Time constant of the low-pass through which the controller has the velocity that it damps, s; 0 where absent.
    pub speed_filter_s: Option<f64>,
    /// The most that it gives, N m; no limit where absent.
    pub torque_limit_nm: Option<f64>,
}

/// What a controller damps.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Damped {
    /// The joint's velocity.
    Velocity,
    /// The velocity of the error: the joint's less the command's.
    Error,
}

/// How CSV files are written.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Files {
    /// What separates cells.
    pub delimiter: Option<String>,
    /// The decimal sign, `.` or `,`.
    pub decimal: Option<String>,
    /// The encoding's label, for instance windows-1252.
    pub encoding: Option<String>,
    /// Rows above the header.
    pub skip_rows: Option<u32>,
    /// Sampling rate where there is no time column, Hz.
    pub rate_hz: Option<f64>,
}

/// A column of the logs.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Column {
    /// Its name in the header.
    pub name: String,
    /// Its unit: s, ms, us; rad, deg, m, mm; rad/s, deg/s, rpm, m/s; N m, mN m, N, kN; A, mA; degC; ...
    pub unit: String,
    /// Multiplies the readings before the unit; 1 where absent.
    pub scale: Option<f64>,
    /// Is added after that, in the unit; 0 where absent.
    pub offset: Option<f64>,
    /// Of a force that stands for a torque: its arm, m.
    pub arm_m: Option<f64>,
    /// Of another joint's position: that joint's name in the URDF.
    pub joint: Option<String>,
}

/// Half widths of 95 % intervals; 0 takes the constant as exact.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Uncertainty {
    /// Of the position's zero, rad; 0.087 where absent.
    pub position_zero_rad: Option<f64>,
    /// Of the torque's zero, N m.
    pub torque_zero_nm: Option<f64>,
    /// Of the torque's scale, percent.
    pub torque_scale_percent: Option<f64>,
    /// Of gravity, percent.
    pub gravity_percent: Option<f64>,
    /// Of each radius, percent.
    pub radii_percent: Option<f64>,
}

/// A trial: one log.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Trial {
    /// Its log, CSV or Parquet.
    pub file: String,
    /// What was done.
    pub protocol: Protocol,
    /// Speed of a uniform sweep, rad/s.
    pub speed_rad_s: Option<f64>,
    /// Tells repeats apart: they share protocol, speed and trajectory; 1 where absent.
    pub repeat: Option<u32>,
    /// Name of the motion, where one protocol holds several.
    pub trajectory: Option<String>,
    /// First and last row that count, from 0, where a log holds more.
    pub rows: Option<Vec<u64>>,
    /// The controller in this trial, where it is not the campaign's.
    pub controller: Option<Controller>,
    /// Why the recording broke off, where it did.
    pub incomplete: Option<String>,
    /// Cycles that began late, of a capture.
    pub late_cycles: Option<u32>,
    /// Cycles without a sample, of a capture.
    pub missed_cycles: Option<u32>,
}

/// What was done in a trial.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Protocol {
    /// Back and forth at constant speed.
    Uniform,
    /// A cosine, or a cascade of them.
    Cosine,
    /// A person acts on the joint.
    Interaction,
    /// Any other motion.
    Free,
}
