//! The torque sensor's scale is off.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Sample};
use crate::numerics::scalar::Scalar;

/// Largest factor by which a scale is off.
const OFF_BY: f64 = 3.0;

static ABOUT: About = About {
    id: "sensor_gain",
    family: Family::Fault,
    acts_on: ActsOn::Sensor,
    means: "the torque sensor's scale is off",
    formula: "reading = (1 + error) y",
    source: "calibration error",
    signature: Region::Load,
    trades_with: &["load_coefficient", "gravity"],
    example: "error=-0.1",
    parameters: &[Parameter::strength("error")],
    needs: &[Excitation::Loads],
    by_hand: Some(
        "hang a known weight on the winch without the joint: the reading over its torque is the sensor's gain",
    ),
    told_apart: &[
        (
            "load_coefficient",
            "hang a known weight on the winch without the joint: a wrong reading is the sensor's gain, a right one means \
             that load-dependent friction changed",
        ),
        (
            "gravity",
            "hang a known weight on the winch without the joint: a wrong reading is the sensor's gain, a right one means \
             that the weight changed",
        ),
    ],
    remedy: Some("Calibrate the torque sensor against a known load; the model need not change for it."),
    ..About::PLAIN
};

#[derive(Debug)]
pub struct SensorGain;

impl Effect for SensorGain {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn only_adds(&self) -> bool {
        false
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }

    /// A sensor that reads more than three times as much as there is, or less than a third, is not out of calibration but another one.
    fn is_itself(&self, p: &[f64], _extent: &Extent) -> bool {
        (1.0 / OFF_BY..=OFF_BY).contains(&(1.0 + p[0]))
    }
}

impl<S: Scalar> Hooks<S> for SensorGain {
    fn reading_nm(&self, p: &[S], _sample: &Sample<'_, S::Given>, torque_nm: S) -> S {
        (p[0] + 1.0) * torque_nm
    }
}
