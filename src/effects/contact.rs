//! External torque in a burst: a person, an obstacle.

use super::{About, ActsOn, Effect, Extent, Family, Parameter, Region, Sample, Starts};
use std::f64::consts::PI;

/// Its name in files.
pub(super) const ID: &str = "contact";

static ABOUT: About = About {
    id: ID,
    family: Family::Outside,
    acts_on: ActsOn::Outside,
    means: "external torque in bursts",
    formula: "peak_nm sin^2(pi (t - start_s)/length_s) within the burst, t since the campaign began",
    source: "the paper's interaction torque (31)",
    signature: Region::Bursts,
    trades_with: &[],
    parameters: &[
        Parameter::strength("peak_nm"),
        Parameter::shape("start_s", 0.0, 1e9),
        Parameter::shape("length_s", 1e-3, 1e6),
    ],
    by_hand: Some("repeat one trial with nobody near the joint"),
    starts: Starts::Events,
    of_time: true,
    ..About::PLAIN
};

#[derive(Debug)]
pub struct Contact;

impl Effect for Contact {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn needs_clock(&self, _p: &[f64]) -> bool {
        true
    }

    /// Bursts are found by their not being repeated, not by a search over shapes.
    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        Vec::new()
    }

    fn winch_torque_nm(&self, p: &[f64], sample: &Sample<'_>, _load_nm: f64) -> f64 {
        let share = (sample.elapsed_s - p[1]) / p[2];
        if (0.0..=1.0).contains(&share) { p[0] * (PI * share).sin().powi(2) } else { 0.0 }
    }
}
