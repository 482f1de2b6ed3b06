//! Torque of a magnet that holds the joint at one position.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Role, Sample, spaced};
use crate::numerics::scalar::Scalar;

/// Widths tried, as shares of the range moved through.
const WIDTHS: (f64, f64) = (0.02, 0.1);

static ABOUT: About = About {
    id: "magnetic_detent",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "a magnet holds the joint at one position",
    formula: "-peak_nm s exp((1 - s^2) / 2) with s = (q - position_rad) / width_rad",
    source: "the torque of a well of Gaussian shape",
    signature: Region::Position,
    trades_with: &["torque_ripple", "elastic_spring"],
    example: "peak_nm=0.05,position_rad=0.4,width_rad=0.08",
    parameters: &[
        Parameter::strength("peak_nm"),
        Parameter::placed("position_rad", Role::Position, 1e3),
        Parameter::shape("width_rad", 1e-4, 10.0),
    ],
    needs: &[Excitation::Range],
    ..About::PLAIN
};

#[derive(Debug)]
pub struct MagneticDetent;

impl Effect for MagneticDetent {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let (low, high) = extent.position_rad;
        let at = (1..8).map(|i| low + (high - low) * f64::from(i) / 8.0);
        at.flat_map(|at| spaced(WIDTHS.0 * (high - low), WIDTHS.1 * (high - low), 2).map(move |w| vec![0.0, at, w]))
            .collect()
    }

    /// What pushes away from its position is no detent.
    fn is_itself(&self, p: &[f64], _extent: &Extent) -> bool {
        p[0] >= 0.0
    }
}

impl<S: Scalar> Hooks<S> for MagneticDetent {
    fn winch_torque_nm(&self, p: &[S], sample: &Sample<'_, S>, _load_nm: S) -> S {
        let s = (sample.own.position - p[1]) / p[2];
        -p[0] * s * ((S::from(1.0) - s.squared()) / 2.0).exp()
    }
}
