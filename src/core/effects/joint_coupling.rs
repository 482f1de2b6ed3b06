//! Torque that follows another joint: cables routed over it, its weight, its friction.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, RESTING_RAD_S, Region, Sample};
use crate::numerics::scalar::Scalar;

/// The number of the parameter that says where it acts.
const AT_JOINT: usize = 11;
/// The number of the parameter that says which terms it has.
const TERMS: usize = 12;

/// Parameters whose terms one cause has together: a cable, friction, rigid bodies.
const GROUPS: [&[usize]; 3] = [&[1, 7, 8], &[2, 3], &[4, 5, 6, 9, 10]];

static ABOUT: About = About {
    id: "joint_coupling",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "torque follows another joint",
    formula: "stiffness q2 + viscous v2 + coulomb tanh(v2/0.01) + inertia a2 + weight (sin(q + q2) - sin q) + inertia_cos (cos(q) a2 + sin(q) v2^2) + \
              centrifugal sin(q2) v2^2 + coriolis sin(q2) 2 v v2 + bending q2^2 + offset; at \
              the winch, or at the joint if at_joint, where the cable carries it and friction grows with it; if terms is 1, only those of a cable \
              over the other joint (stiffness, bending, offset), if 2, only friction (viscous, coulomb), if 3, only those of rigid bodies",
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
        Parameter::form("terms", 3.0),
    ],
    needs: &[Excitation::OtherJoint],
    by_hand: Some("hold the other joints fixed and repeat one trial"),
    ..About::PLAIN
};

/// The place of a `joint` that is counted from 1.
fn followed(joint: f64) -> Option<usize> {
    (joint as usize).checked_sub(1)
}

/// Whether it has the terms of group number `at`, for these `terms`.
fn has(terms: f64, at: usize) -> bool {
    let only = terms.round() as usize;
    only == 0 || only == at + 1
}

fn is_at_joint<S: Scalar>(p: &[S]) -> bool {
    p[AT_JOINT].value() > 0.5
}

#[derive(Debug)]
pub struct JointCoupling;

impl Effect for JointCoupling {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let of = |joint: usize, form: usize| {
            let mut start = vec![0.0; ABOUT.parameters.len()];
            (start[0], start[AT_JOINT], start[TERMS]) = (joint as f64, (form % 2) as f64, (form / 2) as f64);
            start
        };
        (1..=extent.others).flat_map(|joint| (0..2 * (1 + GROUPS.len())).map(move |form| of(joint, form))).collect()
    }

    fn uses(&self, p: &[f64], at: usize) -> bool {
        let of = GROUPS.iter().position(|group| group.contains(&at));
        of.is_none_or(|group| has(p[TERMS], group))
    }

    fn other_joint(&self, p: &[f64]) -> Option<usize> {
        followed(p[0])
    }
}

impl<S: Scalar> Hooks<S> for JointCoupling {
    fn joint_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        if is_at_joint(p) { coupled_nm(p, sample) } else { S::from(0.0) }
    }

    fn winch_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _asked_nm: S) -> S {
        if is_at_joint(p) { S::from(0.0) } else { coupled_nm(p, sample) }
    }
}

/// The torque that the other joint makes.
fn coupled_nm<S: Scalar>(p: &[S], sample: &Sample<'_, S::Given>) -> S {
    let Some(other) = followed(p[0].value()).and_then(|joint| sample.others.get(joint)) else {
        return S::from(0.0);
    };
    let (q, terms, mut sum_nm) = (sample.own.position, p[TERMS].value(), S::from(0.0));
    if has(terms, 0) {
        sum_nm += other.position * p[1] + other.position.squared() * p[7] + p[8];
    }
    if has(terms, 1) {
        sum_nm += other.velocity * p[2] + (other.velocity / RESTING_RAD_S).tanh() * p[3];
    }
    if has(terms, 2) {
        let squared = other.velocity.squared();
        sum_nm += other.acceleration * p[4]
            + ((q + other.position).sin() - q.sin()) * p[5]
            + (q.cos() * other.acceleration + q.sin() * squared) * p[6]
            + other.position.sin() * (squared * p[9] + sample.own.velocity * other.velocity * 2.0 * p[10]);
    }
    sum_nm
}
