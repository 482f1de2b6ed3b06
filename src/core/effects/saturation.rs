//! The torque sensor clips at the ends of its range.

use super::{About, ActsOn, Effect, Extent, Family, Hooks, Parameter, Region, Role, Sample, Starts};
use crate::numerics::scalar::Scalar;

/// Shares of the reading's range at which it is tried to clip.
const LEVELS: [f64; 3] = [0.0, 0.03, 0.08];
/// Readings pass the end of the range by no more than this share of theirs: what a low-pass overshoots, up to 9 % of a step (Gibbs) at each of two
/// edges close together, and noise.
const PASSED_MAX: f64 = 0.2;

static ABOUT: About = About {
    id: "saturation",
    family: Family::Fault,
    acts_on: ActsOn::Sensor,
    means: "the torque sensor clips",
    formula: "reading = y kept between low_nm and high_nm",
    source: "end of the amplifier's or converter's range",
    signature: Region::Clipped,
    trades_with: &["end_stop"],
    example: "low_nm=-0.05,high_nm=0.9",
    parameters: &[Parameter::placed("low_nm", Role::Level, 1e9), Parameter::placed("high_nm", Role::Level, 1e9)],
    by_hand: Some("pull with a torque near the sensor's range and see where the reading stops"),
    remedy: Some("Record with a wider range of the torque sensor, or with less load."),
    starts: Starts::ClipLevels,
    ..About::PLAIN
};

#[derive(Debug)]
pub struct Saturation;

impl Effect for Saturation {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn only_adds(&self) -> bool {
        false
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let (low, high) = extent.torque_nm;
        let at = |share: f64| share * (high - low);
        LEVELS.iter().flat_map(|a| LEVELS.map(|b| vec![low + at(*a), high - at(b)])).collect()
    }

    fn clips(&self) -> bool {
        true
    }

    /// A range that readings lie outside of is not the sensor's.
    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        let (low, high) = extent.torque_nm;
        let passed_nm = (p[0] - low).max(high - p[1]);
        passed_nm <= PASSED_MAX * (high - low)
    }
}

impl<S: Scalar> Hooks<S> for Saturation {
    fn reading_nm(&self, p: &[S], _sample: &Sample<'_, S::Given>, torque_nm: S) -> S {
        torque_nm.min(p[1]).max(p[0])
    }
}
