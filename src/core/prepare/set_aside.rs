//! What a clipped or stuck sensor leaves of a leg.
//!
//! Near the end of the sensor's range noise decides which readings clip: those beside the clipped ones are a biased choice,
//! and the low-pass carries the clip into its surroundings. So the whole stretch from the first to the last clipped sample
//! is left out, with a period of the low-pass to either side.

use super::legs::{Leg, MIN_SAMPLES};
use crate::log::Log;
use crate::problem::Problem;

/// Left out on either side of the clipped stretch, in periods of the low-pass.
const MARGIN_PERIODS: f64 = 1.0;
/// A leg of which less than this share remains is left out: A of a short piece is poorly known, and counts as much as that
/// of a whole leg.
const MIN_KEPT: f64 = 0.5;

/// `legs` of `log` without what was set aside, and a word on each that is lost by it.
pub(super) fn leave_out(legs: Vec<Leg>, log: &Log, lowpass_hz: f64) -> (Vec<Leg>, Vec<Problem>) {
    let margin = (MARGIN_PERIODS / lowpass_hz * log.rate_hz).ceil() as usize;
    let (mut kept, mut warnings) = (Vec::with_capacity(legs.len()), Vec::new());
    for mut leg in legs {
        let within = |at: usize| at.clamp(leg.samples.start, leg.samples.end);
        let mut runs = log.set_aside.iter().map(|run| within(run.start)..within(run.end)).filter(|run| !run.is_empty());
        let set_aside: usize = runs.clone().map(|run| run.len()).sum();
        if let (Some(first), Some(last)) = (runs.clone().next(), runs.next_back()) {
            leg.left_out = within(first.start.saturating_sub(margin))..within(last.end + margin);
        }
        let (whole, left) = (leg.samples.len() as f64, leg.used().count());
        if left as f64 >= MIN_KEPT * whole && left >= MIN_SAMPLES {
            kept.push(leg);
        } else {
            warnings.push(lost(log, &leg, set_aside as f64 / whole, left as f64 / whole));
        }
    }
    (kept, warnings)
}

fn lost(log: &Log, leg: &Leg, set_aside: f64, left: f64) -> Problem {
    let is_clipped = log.clipped.iter().any(|run| run.start < leg.samples.end && leg.samples.start < run.end);
    let (why, cure) = if is_clipped {
        ("the sensor clips", "record with a wider range or less load")
    } else {
        ("a sensor is stuck", "check the sensor's channel and the recorder")
    };
    let what = format!(
        "the leg moving {} from {:.2} s to {:.2} s is left out: {why} in {:.1} % of it, and {:.0} % remain beside",
        leg.direction.name(),
        log.time_s[leg.samples.start],
        log.time_s[leg.samples.end - 1],
        100.0 * set_aside,
        100.0 * left
    );
    Problem::warning(&log.file, what, cure)
}
