//! External torque in a burst: a person, an obstacle.

use super::{About, ActsOn, Effect, Extent, Family, Hooks, Parameter, Region, Sample, Starts};
use crate::numerics::scalar::Scalar;
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
    example: "peak_nm=0.7,start_s=6.5,length_s=2",
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
}

impl<S: Scalar> Hooks<S> for Contact {
    fn winch_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        let share = (sample.elapsed_s - p[1]) / p[2];
        let within = share * (S::from(1.0) - share);
        within.if_positive(|| p[0] * (share * PI).sin().squared(), || S::from(0.0))
    }
}
