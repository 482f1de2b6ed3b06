//! The centre of mass lies off the line that the model assumes.

use super::{About, Effect, Extent, Family, Parameter, Region, Sample};

static ABOUT: About = About {
    id: "gravity_phase",
    family: Family::Physics,
    means: "the centre of mass lies off the assumed line",
    formula: "cos_nm cos(q) at the joint",
    source: "(17) with a second coordinate of the centre of mass",
    signature: Region::Position,
    trades_with: &["elastic_spring", "cable_elasticity", "gravity"],
    parameters: &[Parameter::strength("cos_nm")],
};

#[derive(Debug)]
pub struct GravityPhase;

impl Effect for GravityPhase {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        if extent.turns { vec![vec![0.0]] } else { Vec::new() }
    }

    fn joint_torque_nm(&self, p: &[f64], sample: &Sample<'_>) -> f64 {
        p[0] * sample.own.position.cos()
    }
}
