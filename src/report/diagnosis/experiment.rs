//! The next experiment, and what the recordings hide: as a file, as JSON, in words.

use crate::diagnose::{BlindSpot, Diagnosis};
use serde_json::{Value, json};

/// The file with the proposed motion.
pub const FILE: &str = "next_experiment.toml";

/// The proposed motion as a file that `simulate` takes, where there is one.
pub fn next_toml(found: &Diagnosis) -> Option<String> {
    Some(found.next.as_ref()?.trajectory.as_ref()?.to_toml())
}

/// `next_experiment` in `diagnosis.json`.
pub(super) fn next_json(found: &Diagnosis) -> Value {
    let Some(next) = &found.next else { return Value::Null };
    json!({
        "reason": next.reason,
        "trajectory_file": next.trajectory.as_ref().map(|_| FILE),
        "separates": next.separates,
        "difference_nm": next.difference_nm,
        "difference_over_floor": next.difference_over_floor,
        "instruction": next.instruction,
    })
}

/// `blind_spots` in `diagnosis.json`.
pub(super) fn blind_json(found: &Diagnosis) -> Value {
    let one = |spot: &BlindSpot| json!({ "what": spot.what, "hides": spot.hides, "advice": spot.advice });
    found.blind_spots.iter().map(one).collect()
}

/// The same as sentences, none repeated; empty where there is nothing to report.
pub fn sentences(found: &Diagnosis) -> Vec<String> {
    let mut said = Vec::new();
    if let Some(next) = &found.next {
        said.extend([sentence(&next.reason), sentence(&next.instruction)]);
        if next.trajectory.is_some() {
            said.push(format!(
                "{FILE} holds the motion: `excite next` checks it against limits, `simulate --trajectory` rehearses it."
            ));
        }
    }
    let told = |spot: &&BlindSpot| found.next.as_ref().is_some_and(|next| next.reason.contains(&spot.what));
    said.extend(found.blind_spots.iter().filter(|spot| !told(spot)).map(|spot| sentence(&spot.what)));
    said
}

/// `text` with a capital and a full stop.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
    format!("{first}{}{}", letters.as_str(), if text.ends_with('.') { "" } else { "." })
}
