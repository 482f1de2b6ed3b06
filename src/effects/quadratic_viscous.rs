//! Drag beyond linear in speed.

use super::{About, Carried, Effect, Extent, Family, Parameter, Region, Sample};
use crate::dynamics::Both;

static ABOUT: About = About {
    id: "quadratic_viscous",
    family: Family::Physics,
    means: "drag grows with the square of speed",
    formula: "up_nm_s2_rad2 v^2 moving up, -down_nm_s2_rad2 v^2 moving down",
    source: "turbulent drag; churning of grease",
    signature: Region::HighSpeed,
    trades_with: &["viscous", "inertia", "time_delay"],
    parameters: &[Parameter::strength("up_nm_s2_rad2"), Parameter::strength("down_nm_s2_rad2")],
};

#[derive(Debug)]
pub struct QuadraticViscous;

impl Effect for QuadraticViscous {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0]]
    }

    fn friction_nm(&self, p: &[f64], sample: &Sample<'_>, _carried: Carried) -> Both<f64> {
        let square = sample.own.velocity * sample.own.velocity;
        Both { up: p[0] * square, down: -p[1] * square }
    }
}
