//! A spring about the joint: sheath, cabling, passive tissue.

use super::{
    About, ActsOn, Added, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Role, Sample, SimulatorJoint,
    Starts,
};
use crate::numerics::scalar::Scalar;

/// A spring at rest farther beyond either end of the motion than the range of it and, on a joint that turns, than this pulls with a torque that is
/// all but constant: an offset with a slope.
const RESTS_BEYOND_RAD: f64 = std::f64::consts::FRAC_PI_2;

static ABOUT: About = About {
    id: "elastic_spring",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "a spring about the joint",
    formula: "stiffness_nm_rad q + preload_nm at the joint, which rests at -preload/stiffness; if it stiffens, + cubic_nm_rad3 (q - \
              centre_rad)^3",
    source: "sheath and cabling stiffness; passive tissue",
    signature: Region::Position,
    trades_with: &["gravity_phase", "cable_elasticity", "gravity"],
    example: "stiffness_nm_rad=0.3,preload_nm=-0.1,stiffens=1,cubic_nm_rad3=0.2,centre_rad=0.7",
    parameters: &[
        Parameter::strength("stiffness_nm_rad"),
        Parameter::strength("preload_nm"),
        Parameter::form("stiffens", 1.0),
        Parameter::strength("cubic_nm_rad3"),
        Parameter::placed("centre_rad", Role::Position, 1e3).or(0.0),
    ],
    needs: &[Excitation::Range],
    by_hand: Some("pull the joint with a spring balance through its range with the cables off"),
    starts: Starts::Forms,
    ..About::PLAIN
};

/// A spring without stiffness: a load of `torque_nm` at the joint everywhere.
pub fn constant_load(torque_nm: f64) -> Added {
    Added { effect: &ElasticSpring, parameters: vec![0.0, torque_nm, 0.0, 0.0, 0.0] }
}

/// A linear spring of `stiffness_nm_rad` at the joint that rests at `rest_rad`.
pub fn linear_spring(stiffness_nm_rad: f64, rest_rad: f64) -> Added {
    let preload_nm = -stiffness_nm_rad * rest_rad;
    Added { effect: &ElasticSpring, parameters: vec![stiffness_nm_rad, preload_nm, 0.0, 0.0, 0.0] }
}

#[derive(Debug)]
pub struct ElasticSpring;

impl Effect for ElasticSpring {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let (low, high) = extent.position_rad;
        let stiffening = [0.3, 0.7].map(|share| vec![0.0, 0.0, 1.0, 0.0, low + share * (high - low)]);
        [vec![vec![0.0; 5]], stiffening.to_vec()].concat()
    }

    fn uses(&self, p: &[f64], at: usize) -> bool {
        at < 3 || p[2] > 0.5
    }

    /// A spring that drives the motion, softens, or stiffens the wrong way is not this effect, nor is one that rests far away.
    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        let stiffens = p[2] > 0.5;
        let (low, high) = extent.position_rad;
        let beyond_rad = (high - low).max(if extent.turns { RESTS_BEYOND_RAD } else { 0.0 });
        // Stiffness times the distance of the rest from either limit: without stiffness it rests nowhere.
        let rests_near = p[1] + p[0] * (high + beyond_rad) >= 0.0 && p[1] + p[0] * (low - beyond_rad) <= 0.0;
        p[0] >= 0.0 && if stiffens { p[3] >= 0.0 } else { rests_near }
    }

    fn in_simulator(&self, p: &[f64]) -> Option<SimulatorJoint> {
        Some(SimulatorJoint { stiffness_nm_rad: p[0], preload_nm: p[1], ..SimulatorJoint::default() })
    }
}

impl<S: Scalar> Hooks<S> for ElasticSpring {
    fn joint_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        let beyond = sample.own.position - p[4];
        sample.own.position * p[0] + p[1] + p[3] * (beyond * beyond.squared())
    }
}
