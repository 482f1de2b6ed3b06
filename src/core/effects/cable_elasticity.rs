//! The cable stretches: under load the joint is not where the winch's encoder says.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region};
use crate::numerics::scalar::Scalar;

static ABOUT: About = About {
    id: "cable_elasticity",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "stretch of the cable takes the joint off the measured angle, in proportion to load",
    formula: "q_joint = q - compliance_rad_nm tau; gravity is taken there; tau = the load, or y r2/r1 where with_friction",
    source: "two-mass models; Spong 1987",
    signature: Region::Load,
    trades_with: &["gravity_phase", "elastic_spring", "gravity"],
    example: "with_friction=1,compliance_rad_nm=0.03",
    parameters: &[Parameter::choice("with_friction", 0.0, 1.0), Parameter::strength("compliance_rad_nm")],
    needs: &[Excitation::Loads],
    by_hand: Some("lock the joint and pull: how far the winch turns for a torque is the cable's stretch"),
    ..About::PLAIN
};

#[derive(Debug)]
pub struct CableElasticity;

impl Effect for CableElasticity {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn only_adds(&self) -> bool {
        false
    }

    fn lags(&self) -> bool {
        true
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0], vec![1.0, 0.0]]
    }

    /// A cable does not shorten under load.
    fn is_itself(&self, p: &[f64], _extent: &Extent) -> bool {
        p[1] >= 0.0
    }
}

impl<S: Scalar> Hooks<S> for CableElasticity {
    fn position_lag_rad(&self, p: &[S], load_nm: S, pull_nm: S) -> S {
        p[1] * if p[0].value() > 0.5 { pull_nm } else { load_nm }
    }
}
