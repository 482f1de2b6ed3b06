//! What a column's name says: quantity, unit, joint. `elbow_position_deg`, `Drehmoment [Nm]`, `q1 (rad)`, `elbow.effort`.

use super::vocabulary::{COUNTER, GENERIC, QUANTITIES, SUFFIXES};
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
    /// Whether it is called x and nothing else: a position, or what a plot has below.
    pub is_axis: bool,
}

/// What a column called `name` holds, with what a row of units says of it.
pub(super) fn label(name: &str, unit_row: &str) -> Label {
    let (base, in_name) = split_unit(name);
    let of_row = Unit::written(unit_row.trim().trim_matches(['[', ']', '(', ')']));
    let mut unit = of_row.or(in_name);
    let mut words = words(&base);
    if unit.is_none() {
        (words, unit) = suffix(&base, words);
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
    let is_axis = unit.is_none() && words.iter().all(|word| word == "x" || is_one_of(&GENERIC, word));
    Label { quantity, unit, joint, is_counter, is_axis }
}

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

/// The letter that a Latin one is written with: names are `posicion` as often as `posici\u{f3}n`.
fn without_accent(sign: char) -> char {
    match sign {
        '\u{e0}'..='\u{e5}' => 'a',
        '\u{e7}' => 'c',
        '\u{e8}'..='\u{eb}' => 'e',
        '\u{ec}'..='\u{ef}' => 'i',
        '\u{f1}' => 'n',
        '\u{f2}'..='\u{f6}' => 'o',
        '\u{f9}'..='\u{fc}' => 'u',
        other => other,
    }
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
            word.extend(sign.to_lowercase().map(without_accent));
        }
        last = sign;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The unit that ends `name`, whose words are `words`, and the words before it, at least one.
///
/// Two words tell more than one (`deg_s`), and signs as they were written more than small letters: `torque_mNm` is not in N m.
fn suffix(name: &str, words: Vec<String>) -> (Vec<String>, Option<Unit>) {
    let in_small_letters = |count: usize| {
        let (before, end) = words.split_at_checked(words.len().checked_sub(count)?)?;
        let unit = SUFFIXES.iter().find(|(suffix, _)| *suffix == end.join(" ")).map(|(_, unit)| *unit)?;
        (!before.is_empty()).then(|| (before.to_vec(), Some(unit)))
    };
    let as_written = |count: usize| {
        let (at, _) = name.rmatch_indices(['_', ' ', '.', '-']).nth(count - 1)?;
        let before = self::words(&name[..at]);
        let unit = Unit::written(&name[at + 1..])?;
        (!before.is_empty()).then_some((before, Some(unit)))
    };
    in_small_letters(2)
        .or_else(|| as_written(2))
        .or_else(|| as_written(1))
        .or_else(|| in_small_letters(1))
        .unwrap_or((words, None))
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
            ("motor current [mA]", "", Current, Some(Unit::Milliampere), ""),
            ("q_cmd", "", Command, None, ""),
            ("M [Nm]", "", Torque, Some(Unit::NewtonMetre), ""),
            ("timestamp", "", Time, None, ""),
            ("slide_pos_mm", "", Position, Some(Unit::Millimetre), "slide"),
            ("torque_mNm", "", Torque, Some(Unit::MillinewtonMetre), ""),
            ("motor_current_mA", "", Current, Some(Unit::Milliampere), ""),
            ("torque_kgfcm", "", Torque, Some(Unit::KilogramForceCentimetre), ""),
            ("torque_lbf_in", "", Torque, Some(Unit::PoundForceInch), ""),
            ("torque_n_m", "", Torque, Some(Unit::NewtonMetre), ""),
            ("v_mm_s", "", Velocity, Some(Unit::MillimetrePerSecond), ""),
            ("Geschw_deg_s", "", Velocity, Some(Unit::DegreePerSecond), ""),
            ("Posici\u{f3}n (grados)", "", Position, Some(Unit::Degree), ""),
            ("Vitesse", "rad/s", Velocity, Some(Unit::RadianPerSecond), ""),
            ("present_position", "", Position, None, ""),
        ] {
            let found = label(name, row);
            assert_eq!((found.quantity, found.unit, found.joint.as_str()), (Some(quantity), unit, joint), "{name}");
        }
        assert!(label("sample", "").is_counter);
    }
}
