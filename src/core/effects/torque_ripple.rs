//! Torque that varies periodically with position whatever the direction: cogging, an eccentric pulley.

use super::ripple::{NUMBERS, parameters, repeats, ripple_nm};
use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Sample, Starts};
use crate::numerics::scalar::Scalar;

/// The number of the parameter that says where it acts.
const AT_JOINT: usize = NUMBERS;
const PARAMETERS: [Parameter; NUMBERS + 1] = {
    let (wave, mut all) = (parameters("sin_of_load", "cos_of_load"), [Parameter::form("at_joint", 1.0); NUMBERS + 1]);
    let mut at = 0;
    while at < NUMBERS {
        all[at] = wave[at];
        at += 1;
    }
    all
};

static ABOUT: About = About {
    id: "torque_ripple",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "torque varies with position whatever the direction: cogging, an eccentric pulley",
    formula: "sum over h of sin_h_nm sin(2 pi h periods_per_rad q) + cos_h_nm cos(...), + (sin_of_load sin + cos_of_load cos) of one \
              period times the load; at the winch, where the load is all that it pulls, friction and all, or at the joint if at_joint, where \
              the cable carries it and friction grows with it, and the load is gravity, inertia and what was measured",
    source: "Tuttle and Seering 1996; cogging at 6 and 12 times the pole pairs",
    signature: Region::Position,
    trades_with: &["gravity_phase", "elastic_spring", "friction_ripple"],
    example: "periods_per_rad=5.1,sin_1_nm=0.06,cos_3_nm=0.02,sin_of_load=0.05",
    parameters: &PARAMETERS,
    needs: &[Excitation::Range],
    starts: Starts::PositionLines { by_direction: false },
    ..About::PLAIN
};

#[derive(Debug)]
pub struct TorqueRipple;

impl Effect for TorqueRipple {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        let at_winch = vec![0.0; PARAMETERS.len()];
        let mut at_joint = at_winch.clone();
        at_joint[AT_JOINT] = 1.0;
        vec![at_winch, at_joint]
    }

    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        repeats(p, extent)
    }
}

fn is_at_joint<S: Scalar>(p: &[S]) -> bool {
    p[AT_JOINT].value() > 0.5
}

/// The ripple under a load of `load_nm`.
fn of_load_nm<S: Scalar>(p: &[S], sample: &Sample<'_, S::Given>, load_nm: S) -> S {
    let (always_nm, by_load) = ripple_nm(p, sample);
    always_nm + by_load * load_nm
}

impl<S: Scalar> Hooks<S> for TorqueRipple {
    fn joint_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, asked_nm: S) -> S {
        if is_at_joint(p) { of_load_nm(p, sample, asked_nm) } else { S::from(0.0) }
    }

    fn winch_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, asked_nm: S) -> S {
        if is_at_joint(p) { S::from(0.0) } else { of_load_nm(p, sample, asked_nm) }
    }
}
