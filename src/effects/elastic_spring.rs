//! A spring about the joint: sheath, cabling, passive tissue.

use super::{About, Effect, Extent, Family, Parameter, Region, Sample};

static ABOUT: About = About {
    id: "elastic_spring",
    family: Family::Physics,
    means: "a spring about the joint",
    formula: "stiffness_nm_rad q + preload_nm at the joint; it rests at -preload/stiffness",
    source: "sheath and cabling stiffness; passive tissue",
    signature: Region::Position,
    trades_with: &["gravity_phase", "cable_elasticity", "gravity"],
    parameters: &[Parameter::strength("stiffness_nm_rad"), Parameter::strength("preload_nm")],
};

#[derive(Debug)]
pub struct ElasticSpring;

impl Effect for ElasticSpring {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0]]
    }

    fn joint_torque_nm(&self, p: &[f64], sample: &Sample<'_>) -> f64 {
        p[0] * sample.own.position + p[1]
    }
}
