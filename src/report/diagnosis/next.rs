//! What to do next.

use super::names::{family, means, place};
use crate::diagnose::{Cause, Diagnosis, Kind};
use crate::effects::Family;

/// What to do next, a sentence each, the first thing first.
pub fn next_steps(found: &Diagnosis) -> Vec<String> {
    let mut steps = match found.verdict.kind {
        Kind::None => vec![
            "Keep the model. To look closer, lower the floor (more repeats, less noise) or record motions that these trials \
             do not hold."
                .to_string(),
        ],
        Kind::Ambiguous => ambiguous(found),
        Kind::Unknown => unknown(found),
        Kind::Stale | Kind::Effect | Kind::Several => found.verdict.effects.iter().map(|cause| mend(*cause)).collect(),
    };
    if !matches!(found.verdict.kind, Kind::None | Kind::Unknown) {
        steps.push("Judge the model.json written here on a campaign of its own before you rely on it.".to_string());
    }
    steps.dedup();
    steps
}

/// What to do about `cause`.
fn mend(cause: Cause) -> String {
    match (cause, family(cause)) {
        (Cause::Stale(_), _) => format!(
            "Take the refitted model.json, or identify anew; then ask what changed {}: cable tension, wear, temperature, load.",
            means(cause)
        ),
        (Cause::Effect(id), Some(Family::Fault)) => mend_measurement(id).to_string(),
        (_, Some(Family::Outside)) => {
            "Leave the stretches of contact out, or record again without anybody touching the joint; the model need not change."
                .to_string()
        }
        (Cause::Effect(id), _) => format!("Take the model.json written here, which has {id} added."),
    }
}

fn mend_measurement(id: &str) -> &'static str {
    match id {
        "sensor_bias" => "Tare the torque sensor, then record again; the model need not change.",
        "sensor_gain" => "Calibrate the torque sensor against a known load; the model need not change.",
        "sensor_drift" => "Let the torque sensor warm up and tare it before each trial; the model need not change.",
        "time_delay" => "Find where torque and position are stamped apart in the recorder; the model need not change.",
        "saturation" => "Record with a wider range of the torque sensor, or with less load.",
        _ => "Mend the measurement, then record again; the model need not change.",
    }
}

fn ambiguous(found: &Diagnosis) -> Vec<String> {
    let shows = |cause: &Cause| match cause {
        Cause::Effect(id) => crate::effects::find(id).map(|effect| {
            let about = effect.about();
            format!("{} shows {}", about.id, place(about.signature))
        }),
        Cause::Stale(_) => None,
    };
    let signs: Vec<String> = found.verdict.effects.iter().filter_map(shows).collect();
    let signs = if signs.is_empty() { String::new() } else { format!(": {}", signs.join(", ")) };
    vec![format!("Record a motion on which they differ{signs}. Until then either is a guess.")]
}

fn unknown(found: &Diagnosis) -> Vec<String> {
    let at = found.places.first().map_or("anywhere", |at| place(at.region));
    vec![
        format!("Look at the residual {at} (figures below): its shape there is the best hint of what is missing."),
        "Check that joint, sensor and campaign.toml belong together: sign, radii, low-pass, units.".to_string(),
    ]
}
