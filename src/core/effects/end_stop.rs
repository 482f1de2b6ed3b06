//! A stop engaged near one end of travel.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, RESTING_RAD_S, Region, Role, Sample};
use crate::numerics::scalar::Scalar;

/// Where a stop may begin, as shares of the range from its end.
const REACHES: [f64; 5] = [0.03, 0.07, 0.13, 0.22, 0.35];
/// What acts over more of the range is no stop.
const REACH_MAX: f64 = 0.5;

static ABOUT: About = About {
    id: "end_stop",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "a stop is engaged near the end of travel",
    formula: "(side stiffness_nm + or - loss_nm) (side (q - position_rad) / 1 rad)^exponent beyond position_rad, at the joint; the \
              sign goes by the direction",
    source: "contact of a stop; Hunt and Crossley 1975, the loss as in rubber: by direction, not by speed",
    signature: Region::Position,
    trades_with: &["elastic_spring", "saturation"],
    example: "side=1,stiffness_nm=4,position_rad=0.9,exponent=1.5,loss_nm=0.6",
    parameters: &[
        Parameter::choice("side", -1.0, 1.0),
        Parameter::strength("stiffness_nm"),
        Parameter::placed("position_rad", Role::Position, 1e3),
        Parameter::shape("exponent", 0.8, 3.0),
        Parameter::strength("loss_nm"),
    ],
    needs: &[Excitation::Range],
    by_hand: Some("move the joint by hand to its ends with the cables off: where does it meet resistance?"),
    ..About::PLAIN
};

#[derive(Debug)]
pub struct EndStop;

impl Effect for EndStop {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let (low, high) = extent.position_rad;
        let at = |reach: f64| {
            let reach_rad = reach * (high - low);
            [(-1.0, low + reach_rad), (1.0, high - reach_rad)]
                .into_iter()
                .flat_map(|(side, position)| [1.0, 2.0].map(|exponent| vec![side, 0.0, position, exponent, 0.0]))
        };
        REACHES.into_iter().flat_map(at).collect()
    }

    /// It pushes back near one end, and gives back less than it took.
    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        let (low, high) = extent.position_rad;
        let reach_rad = if p[0] > 0.0 { high - p[2] } else { p[2] - low };
        p[1] >= p[4].abs() && reach_rad <= REACH_MAX * (high - low)
    }
}

impl<S: Scalar> Hooks<S> for EndStop {
    fn joint_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        let depth_rad = (sample.own.position - p[2]) * p[0];
        let pushed_nm = || {
            let direction = (sample.own.velocity / RESTING_RAD_S).tanh();
            (p[0] * p[1] + direction * p[4]) * depth_rad.powf(p[3])
        };
        depth_rad.if_positive(pushed_nm, || S::from(0.0))
    }
}
