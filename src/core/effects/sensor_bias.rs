//! The torque sensor's zero is off.

use super::{About, ActsOn, Effect, Extent, Family, Hooks, Parameter, Region, Sample};
use crate::numerics::scalar::Scalar;

static ABOUT: About = About {
    id: "sensor_bias",
    family: Family::Fault,
    acts_on: ActsOn::Sensor,
    means: "the torque sensor has a constant offset",
    formula: "reading = y + bias_nm",
    source: "tare error",
    signature: Region::Everywhere,
    trades_with: &["coulomb"],
    example: "bias_nm=0.04",
    parameters: &[Parameter::strength("bias_nm")],
    by_hand: Some("take the cable off the winch and read the torque sensor at rest: what it reads is the bias"),
    told_apart: &[(
        "coulomb",
        "take the cable off the winch and read the torque sensor at rest: a reading is the sensor's bias, none means that \
         Coulomb friction changed",
    )],
    remedy: Some("Tare the torque sensor, then record again; the model need not change for it."),
    ..About::PLAIN
};

#[derive(Debug)]
pub struct SensorBias;

impl Effect for SensorBias {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0]]
    }
}

impl<S: Scalar> Hooks<S> for SensorBias {
    fn reading_nm(&self, p: &[S], _sample: &Sample<'_, S::Given>, torque_nm: S) -> S {
        torque_nm + p[0]
    }
}
