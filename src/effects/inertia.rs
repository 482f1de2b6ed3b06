//! Inertia that the model has not.

use super::{About, Effect, Extent, Family, Parameter, Region, Sample};

static ABOUT: About = About {
    id: "inertia",
    family: Family::Physics,
    means: "inertia that the model lacks",
    formula: "inertia_kg_m2 a at the joint",
    source: "(4)",
    signature: Region::Acceleration,
    trades_with: &["time_delay", "quadratic_viscous"],
    parameters: &[Parameter::strength("inertia_kg_m2")],
};

#[derive(Debug)]
pub struct Inertia;

impl Effect for Inertia {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn joint_torque_nm(&self, p: &[f64], sample: &Sample<'_>) -> f64 {
        p[0] * sample.own.acceleration
    }
}
