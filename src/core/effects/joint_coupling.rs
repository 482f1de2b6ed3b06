//! Torque that follows another joint: cables routed over it, its weight, its friction.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, RESTING_RAD_S, Region, Sample};
use crate::numerics::scalar::Scalar;

/// The number of the parameter that says where it acts.
const AT_JOINT: usize = 11;

static ABOUT: About = About {
    id: "joint_coupling",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "torque follows another joint",
    formula: "stiffness q2 + viscous v2 + coulomb tanh(v2/0.01) + inertia a2 + weight (sin(q + q2) - sin q) + inertia_cos (cos(q) a2 + sin(q) v2^2) + \
              centrifugal sin(q2) v2^2 + coriolis sin(q2) 2 v v2 + bending q2^2 + offset; at \
              the winch, or at the joint if at_joint, where the cable carries it and friction grows with it",
    source: "rigid-body coupling (1); cables routed over a moving joint",
    signature: Region::OtherJoint,
    trades_with: &["sensor_drift", "warm_up"],
    example: "joint=1,stiffness_nm_rad=0.1,viscous_nm_s_rad=0.05,weight_nm=0.1,bending_nm_rad2=0.05,offset_nm=0.01",
    parameters: &[
        Parameter::choice("joint", 1.0, 64.0),
        Parameter::strength("stiffness_nm_rad"),
        Parameter::strength("viscous_nm_s_rad"),
        Parameter::strength("coulomb_nm"),
        Parameter::strength("inertia_kg_m2"),
        Parameter::strength("weight_nm"),
        Parameter::strength("inertia_cos_kg_m2"),
        Parameter::strength("bending_nm_rad2"),
        Parameter::strength("offset_nm"),
        Parameter::strength("centrifugal_kg_m2"),
        Parameter::strength("coriolis_kg_m2"),
        Parameter::form("at_joint", 1.0),
    ],
    needs: &[Excitation::OtherJoint],
    by_hand: Some("hold the other joints fixed and repeat one trial"),
    ..About::PLAIN
};

/// The place of a `joint` that is counted from 1.
fn followed(joint: f64) -> Option<usize> {
    (joint as usize).checked_sub(1)
}

#[derive(Debug)]
pub struct JointCoupling;

impl Effect for JointCoupling {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let of = |joint: usize, at_joint: f64| {
            let mut start = vec![0.0; AT_JOINT + 1];
            (start[0], start[AT_JOINT]) = (joint as f64, at_joint);
            start
        };
        (1..=extent.others).flat_map(|joint| [of(joint, 0.0), of(joint, 1.0)]).collect()
    }

    fn other_joint(&self, p: &[f64]) -> Option<usize> {
        followed(p[0])
    }
}

impl<S: Scalar> Hooks<S> for JointCoupling {
    fn joint_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _rigid_nm: S) -> S {
        if p[AT_JOINT].value() > 0.5 { coupled_nm(p, sample) } else { S::from(0.0) }
    }

    fn winch_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _load_nm: S) -> S {
        if p[AT_JOINT].value() > 0.5 { S::from(0.0) } else { coupled_nm(p, sample) }
    }
}

/// The torque that the other joint makes.
fn coupled_nm<S: Scalar>(p: &[S], sample: &Sample<'_, S::Given>) -> S {
    let Some(other) = followed(p[0].value()).and_then(|joint| sample.others.get(joint)) else {
        return S::from(0.0);
    };
    let q = sample.own.position;
    other.position * p[1]
        + other.velocity * p[2]
        + (other.velocity / RESTING_RAD_S).tanh() * p[3]
        + other.acceleration * p[4]
        + ((q + other.position).sin() - q.sin()) * p[5]
        + (q.cos() * other.acceleration + q.sin() * other.velocity.squared()) * p[6]
        + other.position.squared() * p[7]
        + p[8]
        + other.position.sin() * (other.velocity.squared() * p[9] + sample.own.velocity * other.velocity * 2.0 * p[10])
}
