//! What a column's name says: quantity, unit, joint. `elbow_position_deg`, `Drehmoment [Nm]`, `q1 (rad)`, `elbow.effort`.

use crate::units::{Quantity, Unit};

/// What a name tells.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Label {
    /// What the column most likely holds.
    pub quantity: Option<Quantity>,
    /// The unit that the header names.
    pub unit: Option<Unit>,
    /// The words that are neither quantity nor unit, joined: the joint, where there are several.
    pub joint: String,
    /// Whether it counts samples.
    pub is_counter: bool,
}

const TIME: [&str; 9] = ["time", "t", "zeit", "timestamp", "stamp", "ts", "zeitstempel", "clock", "secs"];
const POSITION: [&str; 17] = [
    "position",
    "pos",
    "angle",
    "ang",
    "winkel",
    "theta",
    "q",
    "phi",
    "encoder",
    "enc",
    "lage",
    "weg",
    "hub",
    "stellung",
    "displacement",
    "travel",
    "x",
];
const VELOCITY: [&str; 14] = [
    "velocity",
    "vel",
    "speed",
    "omega",
    "qd",
    "dq",
    "qdot",
    "qp",
    "geschwindigkeit",
    "geschw",
    "drehzahl",
    "winkelgeschwindigkeit",
    "v",
    "dtheta",
];
const TORQUE: [&str; 13] =
    ["torque", "tau", "trq", "tq", "moment", "drehmoment", "effort", "force", "kraft", "mom", "m", "f", "load"];
const CURRENT: [&str; 8] = ["current", "curr", "i", "iq", "strom", "amps", "motorstrom", "cur"];
const TEMPERATURE: [&str; 3] = ["temperature", "temp", "temperatur"];
const COMMAND: [&str; 14] = [
    "command",
    "cmd",
    "target",
    "desired",
    "setpoint",
    "soll",
    "goal",
    "ref",
    "reference",
    "des",
    "sollwert",
    "commanded",
    "set",
    "sollposition",
];
const COUNTER: [&str; 9] = ["sample", "index", "counter", "count", "nr", "cycle", "row", "frame", "idx"];
/// Words that say nothing of which joint it is.
const GENERIC: [&str; 24] = [
    "actual", "ist", "act", "measured", "meas", "mess", "value", "wert", "joint", "raw", "filt", "filtered", "state",
    "states", "sensor", "signal", "channel", "kanal", "column", "of", "in", "the", "unnamed", "istwert",
];
/// Units as the end of a name: `torque_nm` is in N m, though `nm` alone would be no unit.
const SUFFIXES: [(&str, Unit); 22] = [
    ("s", Unit::Second),
    ("sec", Unit::Second),
    ("ms", Unit::Millisecond),
    ("us", Unit::Microsecond),
    ("ns", Unit::Nanosecond),
    ("deg", Unit::Degree),
    ("rad", Unit::Radian),
    ("nm", Unit::NewtonMetre),
    ("mnm", Unit::MillinewtonMetre),
    ("ncm", Unit::NewtonCentimetre),
    ("n", Unit::Newton),
    ("a", Unit::Ampere),
    ("ma", Unit::Milliampere),
    ("mm", Unit::Millimetre),
    ("m", Unit::Metre),
    ("rpm", Unit::Rpm),
    ("rads", Unit::RadianPerSecond),
    ("dps", Unit::DegreePerSecond),
    ("degc", Unit::Celsius),
    ("c", Unit::Celsius),
    ("rad s", Unit::RadianPerSecond),
    ("deg s", Unit::DegreePerSecond),
];

/// What a column called `name` holds, with what a row of units says of it.
pub(super) fn label(name: &str, unit_row: &str) -> Label {
    let (base, in_name) = split_unit(name);
    let of_row = Unit::written(unit_row.trim().trim_matches(['[', ']', '(', ')']));
    let mut words = words(&base);
    let mut unit = of_row.or(in_name);
    if unit.is_none() {
        unit = take_suffix(&mut words);
    }
    let is_one_of = |list: &[&str], word: &String| list.contains(&word.as_str());
    let told: Vec<Quantity> = QUANTITIES
        .iter()
        .filter(|(_, list)| words.iter().any(|word| is_one_of(list, word)))
        .map(|(quantity, _)| *quantity)
        .collect();
    // `current_position_deg` is a position: of what the words say, the unit decides.
    let fits = |quantity: &&Quantity| unit.is_none_or(|unit| could_be(**quantity, unit));
    let quantity = told.iter().find(fits).copied().or_else(|| unit.and_then(of_unit));
    let is_counter = words.iter().any(|word| is_one_of(&COUNTER, word)) && quantity != Some(Quantity::Time);
    let is_other =
        |word: &&String| !is_one_of(&GENERIC, word) && !QUANTITIES.iter().any(|(_, list)| is_one_of(list, word));
    let joint = words.iter().filter(is_other).cloned().collect::<Vec<_>>().join("_");
    Label { quantity, unit, joint, is_counter }
}

/// What each word may mean; the first that the unit allows counts.
const QUANTITIES: [(Quantity, &[&str]); 7] = [
    (Quantity::Command, &COMMAND),
    (Quantity::Time, &TIME),
    (Quantity::Temperature, &TEMPERATURE),
    (Quantity::Velocity, &VELOCITY),
    (Quantity::Position, &POSITION),
    (Quantity::Torque, &TORQUE),
    (Quantity::Current, &CURRENT),
];

fn could_be(quantity: Quantity, unit: Unit) -> bool {
    use crate::dynamics::JointKind::{Prismatic, Revolute};
    [Revolute, Prismatic].iter().any(|kind| quantity.units(*kind).contains(&unit))
}

/// The quantity that has this unit.
pub(super) fn of_unit(unit: Unit) -> Option<Quantity> {
    let all = [
        Quantity::Time,
        Quantity::Position,
        Quantity::Velocity,
        Quantity::Torque,
        Quantity::Current,
        Quantity::Temperature,
    ];
    all.into_iter().find(|quantity| could_be(*quantity, unit))
}

/// The name without the unit in brackets, behind a slash or behind ` in `, and that unit.
fn split_unit(name: &str) -> (String, Option<Unit>) {
    for (open, close) in [('[', ']'), ('(', ')'), ('<', '>')] {
        if let Some((before, rest)) = name.split_once(open) {
            let inside = rest.split(close).next().unwrap_or_default();
            return (before.to_string(), Unit::written(inside));
        }
    }
    for mark in [" in ", "/", ","] {
        if let Some((before, unit)) = name.split_once(mark).and_then(|(b, u)| Some((b, Unit::written(u)?))) {
            return (before.to_string(), Some(unit));
        }
    }
    (name.to_string(), None)
}

/// The words of a name in small letters: `actualPosition_1` is actual, position, 1.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut last = ' ';
    for sign in name.chars() {
        let is_break = !sign.is_alphanumeric()
            || sign.is_uppercase() && last.is_lowercase()
            || sign.is_numeric() != last.is_numeric() && last.is_alphanumeric();
        if is_break {
            words.push(String::new());
        }
        if sign.is_alphanumeric()
            && let Some(word) = words.last_mut()
        {
            word.extend(sign.to_lowercase());
        }
        last = sign;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Takes a unit off the end of `words`, at least one word being left.
fn take_suffix(words: &mut Vec<String>) -> Option<Unit> {
    for count in [2, 1] {
        if words.len() <= count {
            continue;
        }
        let end = words[words.len() - count..].join(" ");
        if let Some((_, unit)) = SUFFIXES.iter().find(|(suffix, _)| *suffix == end) {
            words.truncate(words.len() - count);
            return Some(*unit);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_as_labs_give_them() {
        use Quantity::*;
        for (name, row, quantity, unit, joint) in [
            ("torque [Nm]", "", Torque, Some(Unit::NewtonMetre), ""),
            ("pos (deg)", "", Position, Some(Unit::Degree), ""),
            ("Winkel/\u{b0}", "", Position, Some(Unit::Degree), ""),
            ("Drehmoment", "mNm", Torque, Some(Unit::MillinewtonMetre), ""),
            ("time_s", "", Time, Some(Unit::Second), ""),
            ("elbow_position_deg", "", Position, Some(Unit::Degree), "elbow"),
            ("elbow.effort", "", Torque, None, "elbow"),
            ("q1", "", Position, None, "1"),
            ("tau1", "", Torque, None, "1"),
            ("velocity_rad_s", "", Velocity, Some(Unit::RadianPerSecond), ""),
            ("current_position_deg", "", Position, Some(Unit::Degree), ""),
            ("motor current [mA]", "", Current, Some(Unit::Milliampere), "motor"),
            ("q_cmd", "", Command, None, ""),
            ("M [Nm]", "", Torque, Some(Unit::NewtonMetre), ""),
            ("timestamp", "", Time, None, ""),
            ("slide_pos_mm", "", Position, Some(Unit::Millimetre), "slide"),
        ] {
            let found = label(name, row);
            assert_eq!((found.quantity, found.unit, found.joint.as_str()), (Some(quantity), unit, joint), "{name}");
        }
        assert!(label("sample", "").is_counter);
    }
}
