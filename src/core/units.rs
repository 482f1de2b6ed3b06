//! Quantities of a log, the units they may be recorded in, and the factors to SI.
//!
//! Inside the program everything is in s, rad (or m), rad/s, N m (or N), A and degC; units live in files only.

use crate::dynamics::JointKind;
use std::f64::consts::PI;

/// m in an inch, exactly (international yard and pound agreement, 1959).
const INCH_M: f64 = 0.0254;
/// N that a kilogram weighs at standard gravity, exactly (ISO 80000-4).
const KILOGRAM_FORCE_N: f64 = 9.806_65;
/// N that a pound of 0.45359237 kg weighs at standard gravity.
const POUND_FORCE_N: f64 = 0.453_592_37 * KILOGRAM_FORCE_N;

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
    /// Commanded position of the joint.
    Command,
}

impl Quantity {
    /// Those that a log of a joint may be asked for.
    pub const ASKED: [Self; 6] =
        [Self::Time, Self::Position, Self::Velocity, Self::Torque, Self::Current, Self::Command];

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
            Self::Command => "command",
        }
    }

    /// The units it may be recorded in on a joint of this `kind`.
    pub fn units(self, kind: JointKind) -> &'static [Unit] {
        use JointKind::{Prismatic, Revolute};
        use Unit::*;
        match (self, kind) {
            (Self::Time, _) => &[Second, Millisecond, Microsecond, Nanosecond],
            (Self::Position | Self::Command, Revolute) => &[Radian, Degree, Turn],
            (Self::Position | Self::Command, Prismatic) => &[Metre, Millimetre, Centimetre, Micrometre, Inch],
            (Self::OtherPosition, _) => &[Radian, Degree, Turn, Metre, Millimetre, Centimetre, Micrometre, Inch],
            (Self::Velocity, Revolute) => &[RadianPerSecond, DegreePerSecond, Rpm, TurnPerSecond],
            (Self::Velocity, Prismatic) => &[MetrePerSecond, MillimetrePerSecond, CentimetrePerSecond],
            (Self::Torque | Self::LoadTorque, Revolute) => &Unit::TORQUES,
            (Self::ReferenceTorque, Revolute) => &Unit::TORQUES_OR_FORCES,
            (Self::Torque | Self::LoadTorque | Self::ReferenceTorque, Prismatic) => &Unit::FORCES,
            (Self::Current, _) => &[Ampere, Milliampere],
            (Self::Temperature, _) => &[Celsius],
        }
    }

    /// The unit called `name` in files, however it is written: `Nm`, `N.m` and `newton metre` are `N m`.
    ///
    /// Errors: no such unit, or none for this quantity on this `kind` of joint; says what was found, and the cure.
    pub fn parse_unit(self, kind: JointKind, name: &str) -> Result<Unit, (String, String)> {
        let accepted = self.units(kind);
        if let Some(unit) = accepted.iter().find(|unit| unit.is_written(name)) {
            return Ok(*unit);
        }
        let what = match Unit::written(name) {
            Some(_) => format!("`{name}` is no unit of {} on a {} joint", self.name(), kind.name()),
            None => format!("unknown unit `{name}`"),
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
    /// ns
    Nanosecond,
    /// rad
    Radian,
    /// deg
    Degree,
    /// A full turn.
    Turn,
    /// m
    Metre,
    /// mm
    Millimetre,
    /// cm
    Centimetre,
    /// um
    Micrometre,
    /// in
    Inch,
    /// rad/s
    RadianPerSecond,
    /// deg/s
    DegreePerSecond,
    /// Revolutions per minute.
    Rpm,
    /// turn/s
    TurnPerSecond,
    /// m/s
    MetrePerSecond,
    /// mm/s
    MillimetrePerSecond,
    /// cm/s
    CentimetrePerSecond,
    /// N m
    NewtonMetre,
    /// mN m
    MillinewtonMetre,
    /// N cm
    NewtonCentimetre,
    /// kgf cm
    KilogramForceCentimetre,
    /// kgf m
    KilogramForceMetre,
    /// lbf in
    PoundForceInch,
    /// lbf ft
    PoundForceFoot,
    /// ozf in
    OunceForceInch,
    /// N
    Newton,
    /// kN
    Kilonewton,
    /// kgf
    KilogramForce,
    /// lbf
    PoundForce,
    /// A
    Ampere,
    /// mA
    Milliampere,
    /// degC
    Celsius,
}

impl Unit {
    /// All of them.
    pub const ALL: [Self; 34] = [
        Self::Second,
        Self::Millisecond,
        Self::Microsecond,
        Self::Nanosecond,
        Self::Radian,
        Self::Degree,
        Self::Turn,
        Self::Metre,
        Self::Millimetre,
        Self::Centimetre,
        Self::Micrometre,
        Self::Inch,
        Self::RadianPerSecond,
        Self::DegreePerSecond,
        Self::Rpm,
        Self::TurnPerSecond,
        Self::MetrePerSecond,
        Self::MillimetrePerSecond,
        Self::CentimetrePerSecond,
        Self::NewtonMetre,
        Self::MillinewtonMetre,
        Self::NewtonCentimetre,
        Self::KilogramForceCentimetre,
        Self::KilogramForceMetre,
        Self::PoundForceInch,
        Self::PoundForceFoot,
        Self::OunceForceInch,
        Self::Newton,
        Self::Kilonewton,
        Self::KilogramForce,
        Self::PoundForce,
        Self::Ampere,
        Self::Milliampere,
        Self::Celsius,
    ];

    const FORCES: [Self; 4] = [Self::Newton, Self::Kilonewton, Self::KilogramForce, Self::PoundForce];

    const TORQUES: [Self; 8] = [
        Self::NewtonMetre,
        Self::MillinewtonMetre,
        Self::NewtonCentimetre,
        Self::KilogramForceCentimetre,
        Self::KilogramForceMetre,
        Self::PoundForceInch,
        Self::PoundForceFoot,
        Self::OunceForceInch,
    ];

    const TORQUES_OR_FORCES: [Self; 12] = {
        let [a, b, c, d, e, f, g, h] = Self::TORQUES;
        let [i, j, k, l] = Self::FORCES;
        [a, b, c, d, e, f, g, h, i, j, k, l]
    };

    /// The unit that `text` is a way to write, whatever it measures.
    pub fn written(text: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.is_written(text))
    }

    /// The name used in files.
    pub fn name(self) -> &'static str {
        self.name_and_factor().0
    }

    /// A reading in this unit times this is the reading in SI (rad for angles, degC for temperatures).
    pub fn factor(self) -> f64 {
        self.name_and_factor().1
    }

    /// Whether `text` is this unit, blanks and signs of multiplication aside. Capitals count in symbols (`mN m`, `MN m`), not in
    /// words (`Degrees`).
    fn is_written(self, text: &str) -> bool {
        let is_symbol = |known: &str| plain(known).eq(plain(text));
        let is_word = |known: &str| folded(known).eq(folded(text));
        plain(text).next().is_some()
            && (is_symbol(self.name())
                || self.other_names().iter().any(|known| is_symbol(known))
                || self.words().iter().any(|known| is_word(known)))
    }

    /// Whether `text` is this unit except for upper and lower case: not certain enough to be accepted. A capital M is mega.
    fn is_meant_by(self, text: &str) -> bool {
        let is_like = |known: &str| folded(known).eq(folded(text));
        !text.contains('M') && (is_like(self.name()) || self.other_names().iter().any(|known| is_like(known)))
    }

    /// How else its symbol is written.
    fn other_names(self) -> &'static [&'static str] {
        match self {
            Self::Second => &["sec"],
            Self::Millisecond => &["msec"],
            Self::Microsecond => &["usec", "\u{b5}s", "\u{3bc}s"],
            Self::Nanosecond => &["nsec"],
            Self::Radian => &[],
            Self::Degree => &["\u{b0}", "\u{ba}"],
            Self::Turn => &["rev", "U"],
            Self::Metre | Self::Millimetre | Self::Centimetre => &[],
            Self::Micrometre => &["\u{b5}m", "\u{3bc}m"],
            Self::Inch => &["in", "\""],
            Self::RadianPerSecond => &["rads", "rad/sec", "rads^-1", "rads-1", "rads**-1", "rads\u{207b}\u{b9}"],
            Self::DegreePerSecond => &[
                "dps",
                "deg/sec",
                "\u{b0}/s",
                "\u{ba}/s",
                "\u{b0}/sec",
                "degs^-1",
                "degs-1",
                "degs**-1",
                "degs\u{207b}\u{b9}",
            ],
            Self::Rpm => &["1/min", "r/min", "rev/min", "U/min", "tr/min", "min^-1", "min-1"],
            Self::TurnPerSecond => &["rev/s", "r/s", "rps", "U/s", "tr/s"],
            Self::MetrePerSecond => &["m/sec", "mps", "ms^-1", "ms**-1"],
            Self::MillimetrePerSecond => &["mm/sec", "mms^-1", "mms**-1"],
            Self::CentimetrePerSecond => &["cm/sec", "cms^-1", "cms**-1"],
            Self::MillinewtonMetre => &["Nmm"],
            Self::KilogramForceCentimetre => &["kgcm", "kpcm"],
            Self::KilogramForceMetre => &["kgm", "kpm"],
            Self::PoundForceInch => &["lbin", "inlb", "inlbf", "inlbs", "lbsin"],
            Self::PoundForceFoot => &["lbft", "ftlb", "ftlbf", "ftlbs", "lbsft"],
            Self::OunceForceInch => &["ozin", "inoz"],
            Self::KilogramForce => &["kp"],
            Self::PoundForce => &["lb", "lbs"],
            Self::NewtonMetre | Self::NewtonCentimetre | Self::Newton | Self::Kilonewton => &[],
            Self::Ampere => &["Amp", "Amps"],
            Self::Milliampere => &[],
            Self::Celsius => &["C", "\u{b0}C", "\u{ba}C"],
        }
    }

    /// Its name in words, whatever the capitals.
    fn words(self) -> &'static [&'static str] {
        match self {
            Self::Second => &["sec", "second", "seconds", "sekunden", "seg", "segundos", "secondes", "secondi"],
            Self::Millisecond => &["msec", "millis", "millisecond", "milliseconds"],
            Self::Microsecond => &["usec", "micros", "microsecond", "microseconds"],
            Self::Nanosecond => &["nsec", "nanos", "nanosecond", "nanoseconds"],
            Self::Radian => &["rad", "radian", "radians"],
            Self::Degree => {
                &["deg", "degs", "degree", "degrees", "grad", "grados", "gradi", "graus", "degr\u{e9}s", "degres"]
            }
            Self::Turn => &["turn", "turns", "rev", "revs", "revolution", "revolutions", "tours", "vueltas"],
            Self::Metre => &["metre", "metres", "meter", "meters"],
            Self::Millimetre => &["millimetre", "millimetres", "millimeter", "millimeters"],
            Self::Centimetre => &["centimetre", "centimetres", "centimeter", "centimeters"],
            Self::Micrometre => &["micron", "microns"],
            Self::Inch => &["inch", "inches"],
            Self::RadianPerSecond => &["rad/s", "rad/sec", "rad/seg", "radians/s", "radians/sec", "radians per second"],
            Self::DegreePerSecond => &["deg/s", "deg/sec", "degrees/s", "degrees/sec", "degrees per second"],
            Self::Rpm => &["rpm"],
            Self::TurnPerSecond => &["turns/s", "revs/s"],
            Self::MetrePerSecond => &["metres per second", "meters per second"],
            Self::MillimetrePerSecond | Self::CentimetrePerSecond => &[],
            Self::NewtonMetre => &["newtonmetre", "newtonmetres", "newtonmeter", "newtonmeters"],
            Self::MillinewtonMetre => &["millinewtonmetre", "millinewtonmeter"],
            Self::NewtonCentimetre
            | Self::KilogramForceCentimetre
            | Self::KilogramForceMetre
            | Self::PoundForceInch
            | Self::PoundForceFoot
            | Self::OunceForceInch
            | Self::KilogramForce
            | Self::PoundForce => &[],
            Self::Newton => &["newton", "newtons"],
            Self::Kilonewton => &["kilonewton", "kilonewtons"],
            Self::Ampere => &["amp", "amps", "ampere", "amperes"],
            Self::Milliampere => &["milliamp", "milliamps", "milliampere"],
            Self::Celsius => &["celsius", "degc"],
        }
    }

    fn name_and_factor(self) -> (&'static str, f64) {
        match self {
            Self::Second => ("s", 1.0),
            Self::Millisecond => ("ms", 1e-3),
            Self::Microsecond => ("us", 1e-6),
            Self::Nanosecond => ("ns", 1e-9),
            Self::Radian => ("rad", 1.0),
            Self::Degree => ("deg", PI / 180.0),
            Self::Turn => ("turn", 2.0 * PI),
            Self::Metre => ("m", 1.0),
            Self::Millimetre => ("mm", 1e-3),
            Self::Centimetre => ("cm", 1e-2),
            Self::Micrometre => ("um", 1e-6),
            Self::Inch => ("inch", INCH_M),
            Self::RadianPerSecond => ("rad/s", 1.0),
            Self::DegreePerSecond => ("deg/s", PI / 180.0),
            Self::Rpm => ("rpm", 2.0 * PI / 60.0),
            Self::TurnPerSecond => ("turn/s", 2.0 * PI),
            Self::MetrePerSecond => ("m/s", 1.0),
            Self::MillimetrePerSecond => ("mm/s", 1e-3),
            Self::CentimetrePerSecond => ("cm/s", 1e-2),
            Self::NewtonMetre => ("N m", 1.0),
            Self::MillinewtonMetre => ("mN m", 1e-3),
            Self::NewtonCentimetre => ("N cm", 1e-2),
            Self::KilogramForceCentimetre => ("kgf cm", KILOGRAM_FORCE_N * 1e-2),
            Self::KilogramForceMetre => ("kgf m", KILOGRAM_FORCE_N),
            Self::PoundForceInch => ("lbf in", POUND_FORCE_N * INCH_M),
            Self::PoundForceFoot => ("lbf ft", POUND_FORCE_N * 12.0 * INCH_M),
            Self::OunceForceInch => ("ozf in", POUND_FORCE_N / 16.0 * INCH_M),
            Self::Newton => ("N", 1.0),
            Self::Kilonewton => ("kN", 1e3),
            Self::KilogramForce => ("kgf", KILOGRAM_FORCE_N),
            Self::PoundForce => ("lbf", POUND_FORCE_N),
            Self::Ampere => ("A", 1.0),
            Self::Milliampere => ("mA", 1e-3),
            Self::Celsius => ("degC", 1.0),
        }
    }
}

/// `text` without blanks and signs of multiplication; a hyphen before a letter is one too (`N-m`), before a digit a minus (`s-1`).
fn plain(text: &str) -> impl Iterator<Item = char> {
    let mut rest = text.chars();
    let next = move || loop {
        let sign = rest.next()?;
        let mut ahead = rest.clone();
        match (sign, ahead.next()) {
            ('*', Some('*')) => {
                rest = ahead;
                return Some('^');
            }
            ('-', Some(next)) if next.is_alphabetic() => {}
            (' ' | '.' | '*' | '_' | '\u{b7}' | '\u{22c5}' | '\u{30fb}' | '\u{a0}', _) => {}
            _ => return Some(sign),
        }
    };
    std::iter::from_fn(next)
}

/// The same in lower case.
fn folded(text: &str) -> impl Iterator<Item = char> {
    plain(text).map(|sign| sign.to_ascii_lowercase())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_as_labs_write_them() {
        for (text, unit) in [
            ("Nm", Unit::NewtonMetre),
            ("N.m", Unit::NewtonMetre),
            ("N\u{b7}m", Unit::NewtonMetre),
            ("mNm", Unit::MillinewtonMetre),
            ("mN*m", Unit::MillinewtonMetre),
            ("Ncm", Unit::NewtonCentimetre),
            ("N-m", Unit::NewtonMetre),
            ("kgf-cm", Unit::KilogramForceCentimetre),
            ("lb-in", Unit::PoundForceInch),
            ("in-lbf", Unit::PoundForceInch),
            ("oz-in", Unit::OunceForceInch),
            ("N\u{30fb}m", Unit::NewtonMetre),
            ("grados", Unit::Degree),
            ("rev/s", Unit::TurnPerSecond),
            ("ns", Unit::Nanosecond),
            ("\u{b5}s", Unit::Microsecond),
            ("rad s^-1", Unit::RadianPerSecond),
            ("rad s**-1", Unit::RadianPerSecond),
            ("rad*s^-1", Unit::RadianPerSecond),
            ("\u{b0}/s", Unit::DegreePerSecond),
            ("Degrees", Unit::Degree),
            ("RPM", Unit::Rpm),
            ("mA", Unit::Milliampere),
            ("\u{b0}C", Unit::Celsius),
        ] {
            assert_eq!(Unit::written(text), Some(unit), "{text}");
        }
        // Mega and mega-anything are not milli; what differs by capitals alone is not certain.
        for text in ["MNm", "nm", "Ms", "S", "a", "", " ", "x"] {
            assert_eq!(Unit::written(text), None, "{text}");
        }
        let (_, cure) = Quantity::Torque.parse_unit(JointKind::Revolute, "nm").unwrap_err();
        assert!(cure.contains("did you mean `N m`?"), "{cure}");
    }
}
