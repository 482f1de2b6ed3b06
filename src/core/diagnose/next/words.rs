//! What a person does about causes, in words.

use super::motions::{Beyond, Motion};
use crate::diagnose::cause::{by_hand, told_apart};
use crate::effects::Extent;

/// What tells `causes` apart where motion does not: what is known of each pair, else how each shows by itself.
pub fn checks(causes: &[&'static str]) -> String {
    let pairs = causes.iter().enumerate().flat_map(|(at, a)| causes[at + 1..].iter().map(move |b| (*a, *b)));
    let pairs: Vec<(&str, &str, &str)> = pairs.filter_map(|(a, b)| Some((a, b, told_apart(a, b)?))).collect();
    let of_pairs = pairs.iter().map(|(_, _, check)| (*check).to_string());
    let others = causes.iter().filter(|cause| pairs.iter().all(|(a, b, _)| a != *cause && b != *cause));
    let alone = others.filter_map(|cause| Some(format!("{cause}: {}", by_hand(cause)?)));
    let known: Vec<String> = of_pairs.chain(alone).collect();
    match known.is_empty() {
        true => "No motion of this joint alone distinguishes them; measure one of them separately".to_string(),
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
