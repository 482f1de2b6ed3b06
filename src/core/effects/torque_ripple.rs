//! Torque that varies periodically with position whatever the direction: cogging, an eccentric pulley.

use super::ripple::{parameters, repeats, ripple_nm, starts};
use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Region, Sample, Starts};
use crate::numerics::scalar::Scalar;

static ABOUT: About = About {
    id: "torque_ripple",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "torque varies with position whatever the direction: cogging, an eccentric pulley",
    formula: "sum over h of sin_h_nm sin(2 pi h periods_per_rad q) + cos_h_nm cos(...), + (sin_of_load sin + cos_of_load cos) of one period times the load",
    source: "Tuttle and Seering 1996; cogging at 6 and 12 times the pole pairs",
    signature: Region::Position,
    trades_with: &["gravity_phase", "elastic_spring", "friction_ripple"],
    example: "periods_per_rad=5.1,sin_1_nm=0.06,cos_3_nm=0.02,sin_of_load=0.05",
    parameters: &parameters("sin_of_load", "cos_of_load"),
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

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        starts(extent)
    }

    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        repeats(p, extent)
    }
}

impl<S: Scalar> Hooks<S> for TorqueRipple {
    fn winch_torque_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, load_nm: S) -> S {
        let (always_nm, by_load) = ripple_nm(p, sample);
        always_nm + by_load * load_nm
    }
}
