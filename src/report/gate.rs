//! A value that is not a number ends as an error: the gate through which every file and every printed result passes.
//!
//! Inside, NaN stands for "not known" and an infinite end of an interval for "open"; JSON has null for both, tables an empty cell,
//! texts a dash or a word. What overflowed is neither. It shows as `∞`, `inf` or `NaN` where a figure is written, and as null under
//! a key that always holds a number. Readings and parameters are checked where they are read; this is the second line.

use crate::model::Term;
use crate::problem::{Problem, Result};
use serde_json::Value;
use std::path::Path;

/// How values that are not finite numbers are written.
const WORDS: [&str; 3] = ["inf", "NaN", "∞"];

/// Keys under which a number stands, whatever the result; those of friction come from `Term::ALL`.
const FIGURES: [&str; 19] = [
    "winch_radius_m",
    "pulley_radius_m",
    "gravity_nm",
    "inertia_kg_m2",
    "k",
    "p",
    "n",
    "a_nm",
    "noise_floor_nm",
    "explainable_nm",
    "recoverable_nm",
    "gap_before_nm",
    "gap_after_nm",
    "friction_nm",
    "damping_nm_s_rad",
    "armature_kg_m2",
    "rms_change_nm",
    "left_nm",
    "whole_nm",
];

/// Errors of a figure over samples that are counted beside it, if there are any ...
const OVER_SAMPLES: [&str; 3] = ["rmse_nm", "mae_nm", "peak_nm"];
/// ... and something to compare them with: null where a person's torque was not measured otherwise.
const COMPARED_WITH: &str = "reference_contacts";

/// Errors: `text`, to be written to `file`, holds something that is no number where a figure is meant.
pub fn file(file: &Path, text: &str) -> Result<()> {
    if file.extension().is_some_and(|extension| extension == "json") {
        // What is no JSON was not made by `json_text`, and holds no figure.
        return serde_json::from_str(text).map_or(Ok(()), |value| json(file, &value));
    }
    shown(file, text)
}

/// Errors: a key of `value`, the content of `file`, lacks its number.
pub fn json(file: impl AsRef<Path>, value: &Value) -> Result<()> {
    match lacking(value, "") {
        Some(key) => refuse(file.as_ref(), "null", &key, CURE),
        None => Ok(()),
    }
}

/// Errors: `text`, to be shown as `file`, holds something that is no number where a figure is meant.
pub fn shown(file: impl AsRef<Path>, text: &str) -> Result<()> {
    for word in WORDS {
        let mut places = memchr::memmem::find_iter(text.as_bytes(), word);
        if let Some(at) = places.find(|at| is_figure(text, *at, word.len())) {
            let before = text[..at].char_indices().rev().nth(SHOWN_BEFORE).map_or(0, |(at, _)| at);
            let after = text[at..].char_indices().nth(SHOWN_AFTER).map_or(text.len(), |(length, _)| at + length);
            let around = text[before..after].split_whitespace().collect::<Vec<_>>().join(" ");
            return refuse(file.as_ref(), word, &around, &format!("{CURE}; rename what is called so, if it is a name"));
        }
    }
    Ok(())
}

/// Characters shown around what is no number.
const SHOWN_BEFORE: usize = 40;
const SHOWN_AFTER: usize = 20;

/// Whether the `length` bytes at `at` stand as a number does, and not as a part of a name, a word or a path.
fn is_figure(text: &str, at: usize, length: usize) -> bool {
    let (before, after) = (&text[..at], &text[at + length..]);
    let joins = |c: char| c.is_alphanumeric() || matches!(c, '_' | '`' | '/' | '\\');
    let mut left = before.chars().rev();
    let starts = match left.next() {
        Some('-' | '\u{2212}' | '.') => left.next().is_none_or(|c| !joins(c)),
        Some(c) => !joins(c),
        None => true,
    };
    let mut right = after.chars();
    let ends = match right.next() {
        Some('.' | '-') => right.next().is_none_or(|c| !joins(c)),
        Some(c) => !joins(c),
        None => true,
    };
    starts && ends
}

/// The path of the first key that lacks its number.
fn lacking(value: &Value, path: &str) -> Option<String> {
    let at = |key: &str| if path.is_empty() { key.to_string() } else { format!("{path}.{key}") };
    match value {
        Value::Object(object) => {
            let is_compared = object.get(COMPARED_WITH).is_none_or(|contacts| !contacts.is_null());
            let has_samples = object.get("samples").and_then(Value::as_u64).is_some_and(|samples| samples > 0);
            object.iter().find_map(|(key, value)| {
                let is_figure = FIGURES.contains(&key.as_str())
                    || Term::find(key).is_some()
                    || has_samples && is_compared && OVER_SAMPLES.contains(&key.as_str());
                if is_figure && value.is_null() { Some(at(key)) } else { lacking(value, &at(key)) }
            })
        }
        Value::Array(list) => list.iter().enumerate().find_map(|(i, value)| lacking(value, &at(&i.to_string()))),
        _ => None,
    }
}

/// What to look at.
const CURE: &str = "check the data with `tautline validate`, and the model's parameters for values that no joint has";

fn refuse(file: &Path, found: &str, place: &str, cure: &str) -> Result<()> {
    let what = format!("not written: `{found}` where a figure is meant (`{place}`), because of a numerical overflow");
    Problem::error(file, what, cure).alone()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn numbers_that_are_none_are_found_and_names_are_not() {
        for text in
            ["RMSE inf N m", "0.1,NaN,2", "it leaves ∞ N m RMSE", "x = (-inf);", "damping=\"inf\"", "inf", "is NaN."]
        {
            assert!(shown("a", text).is_err(), "{text}");
        }
        for text in [
            "information",
            "infinite",
            "\\infty",
            "/data/inf/x",
            "inf.csv",
            "joint_inf",
            "NaNo",
            "`NaN` in row 3",
            "-inf-1",
        ] {
            assert!(shown("a", text).is_ok(), "{text}");
        }
    }

    #[test]
    fn absent_is_not_overflowed() {
        let open = json!({ "low": null, "high": null, "samples": 0, "rmse_nm": null, "speed_rad_s": null });
        assert!(json("a", &open).is_ok());
        let alone = json!({ "samples": 3, "rmse_nm": null, "mae_nm": null, "reference_contacts": null });
        assert!(json("a", &alone).is_ok());
        for lacking in [
            json!({ "friction": { "up": { "mu_c": null } } }),
            json!({ "trials": [{ "samples": 3, "rmse_nm": f64::INFINITY }] }),
            json!({ "samples": 3, "rmse_nm": f64::INFINITY, "reference_contacts": 2 }),
            json!({ "joint": { "winch_radius_m": f64::NAN } }),
        ] {
            assert!(json("a", &lacking).is_err(), "{lacking}");
        }
    }
}
