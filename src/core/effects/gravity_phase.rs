//! The centre of mass lies off the line that the model assumes.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Sample, Starts};
use crate::numerics::scalar::Scalar;

static ABOUT: About = About {
    id: "gravity_phase",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "the centre of mass lies off the assumed line",
    formula: "cos_nm cos(q) at the joint; of a weight of_nm that is turned, + (sqrt(of_nm^2 - cos_nm^2) - of_nm) sin(q)",
    source: "(17) with a second coordinate of the centre of mass",
    signature: Region::Position,
    trades_with: &["elastic_spring", "cable_elasticity", "gravity"],
    example: "cos_nm=0.2,of_nm=0.9",
    parameters: &[Parameter::strength("cos_nm"), Parameter::form("of_nm", 1e6)],
    needs: &[Excitation::Range],
    by_hand: Some("weigh the moving part, and find where it hangs at rest with the cables off"),
    starts: Starts::Forms,
    outnumbered_by: &["elastic_spring"],
    ..About::PLAIN
};

#[derive(Debug)]
pub struct GravityPhase;

impl Effect for GravityPhase {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        if extent.turns { vec![vec![0.0, 0.0], vec![0.0, extent.gravity_nm.abs()]] } else { Vec::new() }
    }

    fn only_adds(&self) -> bool {
        false
    }
}

impl<S: Scalar> Hooks<S> for GravityPhase {
    fn joint_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        let (sin, cos) = sample.own.position.sin_cos();
        cos * p[0] + sin * ((p[1] * p[1] - p[0] * p[0]).max(S::from(0.0)).sqrt() - p[1])
    }
}
