//! The cable stretches: under load the joint is not where the winch's encoder says.

use super::{About, Effect, Extent, Family, Parameter, Region};

static ABOUT: About = About {
    id: "cable_elasticity",
    family: Family::Physics,
    means: "the joint lags the measured angle in proportion to load",
    formula: "q_joint = q - compliance_rad_nm tau, tau = y r2/r1; gravity and springs are taken there",
    source: "two-mass models; Spong 1987",
    signature: Region::Load,
    trades_with: &["gravity_phase", "elastic_spring", "gravity"],
    parameters: &[Parameter::strength("compliance_rad_nm")],
};

#[derive(Debug)]
pub struct CableElasticity;

impl Effect for CableElasticity {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    fn position_lag_rad(&self, p: &[f64], torque_nm: f64) -> f64 {
        p[0] * torque_nm
    }
}
