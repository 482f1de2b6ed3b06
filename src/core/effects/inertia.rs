//! Inertia that the model has not.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Sample, SimulatorJoint};
use crate::numerics::scalar::Scalar;

static ABOUT: About = About {
    id: "inertia",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "inertia that the model lacks",
    formula: "inertia_kg_m2 a at the joint",
    source: "(4)",
    signature: Region::Acceleration,
    trades_with: &["time_delay", "quadratic_viscous"],
    example: "inertia_kg_m2=0.05",
    parameters: &[Parameter::strength("inertia_kg_m2")],
    needs: &[Excitation::Acceleration],
    by_hand: Some("let the joint swing freely with the cables off: its period gives the inertia"),
    ..About::PLAIN
};

#[derive(Debug)]
pub struct Inertia;

impl Effect for Inertia {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        if extent.has_inertia { Vec::new() } else { vec![vec![0.0]] }
    }

    fn in_simulator(&self, p: &[f64]) -> Option<SimulatorJoint> {
        Some(SimulatorJoint { inertia_kg_m2: p[0], ..SimulatorJoint::default() })
    }
}

impl<S: Scalar> Hooks<S> for Inertia {
    fn joint_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        sample.own.acceleration * p[0]
    }
}
