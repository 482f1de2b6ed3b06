//! Friction in proportion to the load that the joint carries.

use super::{About, Effect, Extent, Family, Parameter, Region, Sample};
use crate::dynamics::Both;

static ABOUT: About = About {
    id: "load_dependent_friction",
    family: Family::Physics,
    means: "friction grows with the load carried",
    formula: "up |load| moving up, -down |load| moving down; load = (r1/r2) (G + I a + measured load)",
    source: "Bittencourt and Gunnarsson 2012; BAM models M3 to M6",
    signature: Region::Load,
    trades_with: &["load_coefficient", "coulomb", "sensor_gain"],
    parameters: &[Parameter::strength("up"), Parameter::strength("down")],
};

#[derive(Debug)]
pub struct LoadDependentFriction;

impl Effect for LoadDependentFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0]]
    }

    fn friction_nm(&self, p: &[f64], _sample: &Sample<'_>, load_nm: f64) -> Both<f64> {
        Both { up: p[0] * load_nm.abs(), down: -p[1] * load_nm.abs() }
    }
}
