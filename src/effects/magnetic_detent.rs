//! A latch that holds the joint near one position: a magnet, a spring-loaded ball.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Role, Sample};
use crate::numerics::scalar::Scalar;

/// Where a latch may be, and how wide, as shares of the range.
const PLACES: [f64; 7] = [0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9];
const WIDTHS: [f64; 2] = [0.02, 0.06];
/// What acts over more of the range is no latch.
const WIDTH_MAX: f64 = 0.15;

static ABOUT: About = About {
    id: "magnetic_detent",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "a latch holds the joint near one position",
    formula: "peak_nm u exp((1 - u^2) / 2) at the joint, u = (q - position_rad) / width_rad",
    source: "force of a magnet or a ball catch over its displacement, by its first moment about the well",
    signature: Region::Position,
    trades_with: &["torque_ripple", "elastic_spring", "end_stop"],
    example: "peak_nm=0.2,position_rad=0.6,width_rad=0.05",
    parameters: &[
        Parameter::strength("peak_nm"),
        Parameter::placed("position_rad", Role::Position, 1e3),
        Parameter::shape("width_rad", 1e-4, 10.0),
    ],
    needs: &[Excitation::Range],
    by_hand: Some("move the joint slowly by hand with the cables off: where does it snap into place?"),
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
        let at = |place: f64| WIDTHS.map(|width| vec![0.0, low + place * (high - low), width * (high - low)]);
        PLACES.into_iter().flat_map(at).collect()
    }

    /// It holds the joint rather than drives it away, and near one place only.
    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        p[0] >= 0.0 && p[2] <= WIDTH_MAX * (extent.position_rad.1 - extent.position_rad.0)
    }
}

impl<S: Scalar> Hooks<S> for MagneticDetent {
    fn joint_torque_nm(&self, p: &[S], sample: &Sample<'_, S>) -> S {
        let u = (sample.own.position - p[1]) / p[2];
        p[0] * u * ((S::from(1.0) - u.squared()) / 2.0).exp()
    }
}
