//! The torque sensor's zero is off.

use super::{About, Effect, Extent, Family, Parameter, Region, Sample};

static ABOUT: About = About {
    id: "sensor_bias",
    family: Family::Fault,
    means: "the torque sensor has a constant offset",
    formula: "reading = y + bias_nm",
    source: "tare error",
    signature: Region::Everywhere,
    trades_with: &["coulomb"],
    parameters: &[Parameter::strength("bias_nm")],
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

    fn reading_nm(&self, p: &[f64], _sample: &Sample<'_>, torque_nm: f64) -> f64 {
        torque_nm + p[0]
    }
}
