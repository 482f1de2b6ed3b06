//! Drag beyond linear in speed.

use super::{
    About, ActsOn, Carried, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Sample, grows_both_ways,
};
use crate::dynamics::Both;
use crate::numerics::scalar::Scalar;

static ABOUT: About = About {
    id: "quadratic_viscous",
    family: Family::Physics,
    acts_on: ActsOn::Friction,
    means: "drag grows faster than speed, as with its square",
    formula: "up_nm_s2_rad2 |v|^exponent moving up, -down_nm_s2_rad2 |v|^exponent moving down, |v| over 1 rad/s; on \
              the branches of friction, or by_speed alone whatever the clearance does",
    source: "turbulent drag; churning of grease",
    signature: Region::HighSpeed,
    trades_with: &["viscous", "inertia", "time_delay"],
    example: "up_nm_s2_rad2=0.3,down_nm_s2_rad2=0.25,exponent=1.8",
    parameters: &[
        Parameter::strength("up_nm_s2_rad2"),
        Parameter::strength("down_nm_s2_rad2"),
        Parameter::shape("exponent", 1.7, 3.0).or(2.0),
        Parameter::form("by_speed", 1.0),
    ],
    needs: &[Excitation::Speeds],
    ..About::PLAIN
};

#[derive(Debug)]
pub struct QuadraticViscous;

impl Effect for QuadraticViscous {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0, 2.0, 0.0], vec![0.0, 0.0, 2.0, 1.0]]
    }

    /// Drag that levels off with speed is not this effect.
    fn is_itself(&self, p: &[f64], _extent: &Extent) -> bool {
        grows_both_ways(p[0], p[1])
    }
}

impl<S: Scalar> Hooks<S> for QuadraticViscous {
    fn friction_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _carried: Carried<S>) -> Both<S> {
        if p[3].value() > 0.5 {
            return Both { up: S::from(0.0), down: S::from(0.0) };
        }
        let speed: S = sample.own.velocity.abs().into();
        let power = speed.powf(p[2]);
        Both { up: p[0] * power, down: -p[1] * power }
    }

    fn winch_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        if p[3].value() <= 0.5 {
            return S::from(0.0);
        }
        let speed: S = sample.own.velocity.abs().into();
        let power = speed.powf(p[2]);
        let velocity: S = sample.own.velocity.into();
        velocity.if_positive(|| p[0] * power, || -p[1] * power)
    }
}
