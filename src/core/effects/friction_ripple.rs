//! Friction that varies periodically with position and changes sign with the direction.

use super::ripple::{NUMBERS, parameters, repeats, ripple_nm};
use super::{About, ActsOn, Carried, Effect, Excitation, Extent, Family, Hooks, Region, Sample, Starts};
use crate::dynamics::Both;
use crate::numerics::scalar::Scalar;

static ABOUT: About = About {
    id: "friction_ripple",
    family: Family::Physics,
    acts_on: ActsOn::Friction,
    means: "friction varies with position",
    formula: "+ or - sum over h of sin_h_nm sin(2 pi h periods_per_rad q) + cos_h_nm cos(...), by the direction; + (sin_of_friction \
              sin + cos_of_friction cos) of one period times friction",
    source: "Tuttle and Seering 1996",
    signature: Region::Position,
    trades_with: &["load_dependent_friction", "torque_ripple"],
    example: "periods_per_rad=7.3,sin_1_nm=0.08,cos_2_nm=0.03,cos_of_friction=0.1",
    parameters: &parameters("sin_of_friction", "cos_of_friction"),
    needs: &[Excitation::Range],
    starts: Starts::PositionLines { by_direction: true },
    ..About::PLAIN
};

#[derive(Debug)]
pub struct FrictionRipple;

impl Effect for FrictionRipple {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0; NUMBERS]]
    }

    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        repeats(p, extent)
    }
}

impl<S: Scalar> Hooks<S> for FrictionRipple {
    fn friction_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, carried: Carried<S>) -> Both<S> {
        let (always_nm, share) = ripple_nm(p, sample);
        Both { up: always_nm + share * carried.friction_nm.up, down: -always_nm + share * carried.friction_nm.down }
    }
}
