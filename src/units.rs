//! Quantities of a log, the units they may be recorded in, and the factors to SI.
//!
//! Inside the program everything is in s, rad (or m), rad/s, N m (or N), A and degC; units live in files only.

use crate::dynamics::JointKind;
use std::f64::consts::PI;

/// What a column of a log holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Time stamp.
    Time,
    /// Position of the joint.
    Position,
    /// Velocity of the joint.
    Velocity,
    /// Torque at the winch (force, for a prismatic joint).
    Torque,
    /// Motor current.
    Current,
    /// Temperature.
    Temperature,
    /// Position of a coupled joint, which may be of the other kind.
    OtherPosition,
    /// Measured load at the joint.
    LoadTorque,
    /// Interaction torque, measured independently.
    ReferenceTorque,
}

impl Quantity {
    /// The key under `[columns]`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "time",
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Torque => "torque",
            Self::Current => "current",
            Self::Temperature => "temperature",
            Self::OtherPosition => "other_position",
            Self::LoadTorque => "load_torque",
            Self::ReferenceTorque => "reference_torque",
        }
    }

    /// The units it may be recorded in on a joint of this `kind`.
    pub fn units(self, kind: JointKind) -> &'static [Unit] {
        use JointKind::{Prismatic, Revolute};
        match (self, kind) {
            (Self::Time, _) => &[Unit::Second, Unit::Millisecond, Unit::Microsecond],
            (Self::Position, Revolute) => &[Unit::Radian, Unit::Degree],
            (Self::Position, Prismatic) => &[Unit::Metre, Unit::Millimetre],
            (Self::OtherPosition, _) => &[Unit::Radian, Unit::Degree, Unit::Metre, Unit::Millimetre],
            (Self::Velocity, Revolute) => &[Unit::RadianPerSecond, Unit::DegreePerSecond, Unit::Rpm],
            (Self::Velocity, Prismatic) => &[Unit::MetrePerSecond],
            (Self::Torque | Self::LoadTorque, Revolute) => &[Unit::NewtonMetre, Unit::MillinewtonMetre],
            (Self::ReferenceTorque, Revolute) => &[Unit::NewtonMetre, Unit::MillinewtonMetre, Unit::Newton],
            (Self::Torque | Self::LoadTorque | Self::ReferenceTorque, Prismatic) => &[Unit::Newton],
            (Self::Current, _) => &[Unit::Ampere],
            (Self::Temperature, _) => &[Unit::Celsius],
        }
    }

    /// The unit called `name` in files.
    ///
    /// Errors: no such unit, or none for this quantity on this `kind` of joint; says what was found, and the cure.
    pub fn parse_unit(self, kind: JointKind, name: &str) -> Result<Unit, (String, String)> {
        let accepted = self.units(kind);
        if let Some(unit) = accepted.iter().find(|unit| unit.name() == name) {
            return Ok(*unit);
        }
        let what = match Unit::ALL.iter().any(|unit| unit.name() == name) {
            true => format!("`{name}` is no unit of {} on a {} joint", self.name(), kind.name()),
            false => format!("unknown unit `{name}`"),
        };
        let all = accepted.iter().map(|unit| format!("`{}`", unit.name())).collect::<Vec<_>>().join(", ");
        let meant = accepted.iter().find(|unit| unit.is_meant_by(name));
        let hint = meant.map_or(String::new(), |unit| format!("; did you mean `{}`?", unit.name()));
        Err((what, format!("expected one of {all}{hint}")))
    }
}

/// A unit that a file may name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// s
    Second,
    /// ms
    Millisecond,
    /// us
    Microsecond,
    /// rad
    Radian,
    /// deg
    Degree,
    /// m
    Metre,
    /// mm
    Millimetre,
    /// rad/s
    RadianPerSecond,
    /// deg/s
    DegreePerSecond,
    /// Revolutions per minute.
    Rpm,
    /// m/s
    MetrePerSecond,
    /// N m
    NewtonMetre,
    /// mN m
    MillinewtonMetre,
    /// N
    Newton,
    /// A
    Ampere,
    /// degC
    Celsius,
}

impl Unit {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Second,
        Self::Millisecond,
        Self::Microsecond,
        Self::Radian,
        Self::Degree,
        Self::Metre,
        Self::Millimetre,
        Self::RadianPerSecond,
        Self::DegreePerSecond,
        Self::Rpm,
        Self::MetrePerSecond,
        Self::NewtonMetre,
        Self::MillinewtonMetre,
        Self::Newton,
        Self::Ampere,
        Self::Celsius,
    ];

    /// The name used in files.
    pub fn name(self) -> &'static str {
        self.name_and_factor().0
    }

    /// A reading in this unit times this is the reading in SI (rad for angles, degC for temperatures).
    pub fn factor(self) -> f64 {
        self.name_and_factor().1
    }

    /// Whether `name` is another way to write this unit. Equal in meaning, not alike in letters: `Nmm` is a `mN m`.
    fn is_meant_by(self, name: &str) -> bool {
        let plain = |text: &str| text.replace([' ', '.', '*', '-', '_', '\u{b7}'], "");
        // A capital M is mega, and no unit here.
        !name.contains('M')
            && std::iter::once(&self.name())
                .chain(self.other_names())
                .any(|known| plain(known).eq_ignore_ascii_case(&plain(name)))
    }

    /// How else it is written, blanks, dots and capitals aside.
    fn other_names(self) -> &'static [&'static str] {
        match self {
            Self::Second => &["sec", "second", "seconds"],
            Self::Millisecond => &["msec", "millisecond", "milliseconds"],
            Self::Microsecond => &["usec", "\u{b5}s", "\u{3bc}s", "microsecond", "microseconds"],
            Self::Radian => &["radian", "radians"],
            Self::Degree => &["degree", "degrees", "\u{b0}"],
            Self::Metre => &["metre", "metres", "meter", "meters"],
            Self::Millimetre => &["millimetre", "millimetres", "millimeter", "millimeters"],
            Self::RadianPerSecond => &["rads", "rad/sec", "rads^-1", "radians/s"],
            Self::DegreePerSecond => &["dps", "deg/sec", "\u{b0}/s", "degrees/s"],
            Self::Rpm => &["1/min", "r/min", "rev/min", "min^-1"],
            Self::MetrePerSecond => &["m/sec", "mps", "ms^-1"],
            Self::NewtonMetre => &["newtonmetre", "newtonmeter"],
            Self::MillinewtonMetre => &["Nmm", "millinewtonmetre", "millinewtonmeter"],
            Self::Newton => &["newton", "newtons"],
            Self::Ampere => &["amp", "amps", "ampere", "amperes"],
            Self::Celsius => &["C", "\u{b0}C", "celsius"],
        }
    }

    fn name_and_factor(self) -> (&'static str, f64) {
        match self {
            Self::Second => ("s", 1.0),
            Self::Millisecond => ("ms", 1e-3),
            Self::Microsecond => ("us", 1e-6),
            Self::Radian => ("rad", 1.0),
            Self::Degree => ("deg", PI / 180.0),
            Self::Metre => ("m", 1.0),
            Self::Millimetre => ("mm", 1e-3),
            Self::RadianPerSecond => ("rad/s", 1.0),
            Self::DegreePerSecond => ("deg/s", PI / 180.0),
            Self::Rpm => ("rpm", 2.0 * PI / 60.0),
            Self::MetrePerSecond => ("m/s", 1.0),
            Self::NewtonMetre => ("N m", 1.0),
            Self::MillinewtonMetre => ("mN m", 1e-3),
            Self::Newton => ("N", 1.0),
            Self::Ampere => ("A", 1.0),
            Self::Celsius => ("degC", 1.0),
        }
    }
}
