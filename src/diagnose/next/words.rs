//! What a person does about causes: the words in one place.

use super::motions::{Beyond, Motion};
use crate::effects::Extent;

/// How a cause shows by itself, without the joint's motion: the only way out where no motion tells rivals apart.
fn check(cause: &str) -> Option<&'static str> {
    Some(match cause {
        "sensor_bias" => "take the cable off the winch and read the torque sensor at rest: what it reads is the bias",
        "sensor_gain" => {
            "hang a known weight on the winch without the joint: the reading over its torque is the sensor's gain"
        }
        "sensor_drift" => "leave the joint at rest without load for as long as the campaign took and log the sensor",
        "time_delay" => "tap the winch and compare when encoder and torque sensor answer",
        "gravity" | "gravity_phase" => "weigh the moving part, and find where it hangs at rest with the cables off",
        "inertia" => "let the joint swing freely with the cables off: its period gives the inertia",
        "elastic_spring" => "pull the joint with a spring balance through its range with the cables off",
        "end_stop" => "move the joint by hand to its ends with the cables off: where does it meet resistance?",
        "cable_elasticity" => "lock the joint and pull: how far the winch turns for a torque is the cable's stretch",
        "backlash_width" => {
            "hold the joint and turn the winch by hand from one side to the other: that is the clearance"
        }
        "load_dependent_friction" | "load_coefficient" => "repeat one sweep with a second, known load at the joint",
        "warm_up" => "repeat the first trial cold and again after ten minutes of motion",
        "joint_coupling" => "hold the other joints fixed and repeat one trial",
        "saturation" => "pull with a torque near the sensor's range and see where the reading stops",
        "contact" => "repeat one trial with nobody near the joint",
        _ => return None,
    })
}

/// Pairs that look alike along every motion and under every load, and what tells them apart.
const TIES: [(&str, &str, &str); 4] = [
    (
        "sensor_bias",
        "coulomb",
        "take the cable off the winch and read the torque sensor at rest: a reading is the sensor's bias, none means that Coulomb \
         friction changed",
    ),
    (
        "sensor_gain",
        "load_coefficient",
        "hang a known weight on the winch without the joint: a wrong reading is the sensor's gain, a right one means that \
         load-dependent friction changed",
    ),
    (
        "sensor_gain",
        "gravity",
        "hang a known weight on the winch without the joint: a wrong reading is the sensor's gain, a right one means that the weight \
         changed",
    ),
    (
        "load_coefficient",
        "gravity",
        "weigh the moving part: if its weight is what the model has, load-dependent friction changed",
    ),
];

/// What tells `causes` apart where motion does not: what is known of each pair, else how each shows by itself.
pub fn checks(causes: &[&'static str]) -> String {
    let is_of = |a: &str, b: &str| causes.contains(&a) && causes.contains(&b);
    let pairs = TIES.iter().filter(|(a, b, _)| is_of(a, b));
    let of_pairs: Vec<String> = pairs.clone().map(|(_, _, check)| (*check).to_string()).collect();
    let others = causes.iter().filter(|cause| pairs.clone().all(|(a, b, _)| a != *cause && b != *cause));
    let alone = others.filter_map(|cause| Some(format!("{cause}: {}", check(cause)?)));
    let known: Vec<String> = of_pairs.into_iter().chain(alone).collect();
    match known.is_empty() {
        true => "No motion of this joint alone tells them apart; measure one of them by itself".to_string(),
        false => format!("By hand: {}", known.join("; ")),
    }
}

/// How to record a motion.
pub fn record(motion: &Motion, repeats: u32, extent: &Extent) -> String {
    let trajectory = &motion.trajectory;
    let minutes = trajectory.own.duration_s() / 60.0;
    let times = if repeats == 1 { "once".to_string() } else { format!("{repeats} times") };
    let caution = match motion.beyond {
        Beyond::Nothing => String::new(),
        Beyond::Speed => {
            format!(
                ". This is faster than the {:.2} {} recorded: make sure that the joint may",
                extent.speed_rad_s.1,
                speed(extent)
            )
        }
        Beyond::Range => format!(
            ". This goes beyond the {} recorded: make sure that the joint can, or shorten it in the file",
            range(extent, extent.position_rad)
        ),
    };
    format!("Record {} {times} ({minutes:.1} min each): {}{caution}", trajectory.name, motion.means)
}

/// A range of positions in the unit that people read.
pub fn range(extent: &Extent, (low, high): (f64, f64)) -> String {
    match extent.turns {
        true => format!("{:.0} to {:.0} deg", low.to_degrees(), high.to_degrees()),
        false => format!("{:.0} to {:.0} mm", 1e3 * low, 1e3 * high),
    }
}

/// The unit of speeds.
pub fn speed(extent: &Extent) -> &'static str {
    if extent.turns { "rad/s" } else { "m/s" }
}

/// "a, b and c".
pub fn listed(names: &[&str]) -> String {
    match names {
        [] => String::new(),
        [one] => (*one).to_string(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
