//! Friction in proportion to the load that the joint carries.

use super::{About, Carried, Effect, Extent, Family, Parameter, Region, Sample};
use crate::dynamics::Both;

/// Pretensions that are tried, as shares of the reading's range.
const PRETENSIONS: [f64; 4] = [0.0, 0.05, 0.1, 0.2];

static ABOUT: About = About {
    id: "load_dependent_friction",
    family: Family::Physics,
    means: "friction grows with the load carried",
    formula: "up |T| moving up, -down |T| moving down; T = (r1/r2) (G + I a + measured load), with the model's own friction in \
              the branch if of_tension: what a sheath or a capstan bears is the cable's whole tension; |T| is \
              sqrt(T^2 + pretension_nm^2)",
    source: "Bittencourt and Gunnarsson 2012; BAM models M3 to M6; Euler-Eytelwein for the cable's tension",
    signature: Region::Load,
    trades_with: &["load_coefficient", "coulomb", "sensor_gain"],
    parameters: &[
        Parameter::strength("up"),
        Parameter::strength("down"),
        Parameter::choice("of_tension", 0.0, 1.0),
        Parameter::choice("pretension_nm", 0.0, 1e6),
    ],
};

#[derive(Debug)]
pub struct LoadDependentFriction;

impl Effect for LoadDependentFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let span_nm = extent.torque_nm.1 - extent.torque_nm.0;
        let of = |of_tension: f64| PRETENSIONS.map(|share| vec![0.0, 0.0, of_tension, share * span_nm]);
        [of(0.0), of(1.0)].concat()
    }

    fn friction_nm(&self, p: &[f64], _sample: &Sample<'_>, carried: Carried) -> Both<f64> {
        let Both { up, down } = carried.friction_nm;
        let borne_nm = |own_nm: f64| (carried.load_nm + p[2] * own_nm).hypot(p[3]);
        Both { up: p[0] * borne_nm(up), down: -p[1] * borne_nm(down) }
    }
}
