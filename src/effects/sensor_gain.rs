//! The torque sensor's scale is off.

use super::{About, Effect, Extent, Family, Parameter, Region, Sample};

static ABOUT: About = About {
    id: "sensor_gain",
    family: Family::Fault,
    means: "the torque sensor's scale is off",
    formula: "reading = (1 + error) y",
    source: "calibration error",
    signature: Region::Load,
    trades_with: &["load_coefficient", "gravity"],
    parameters: &[Parameter::strength("error")],
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

    fn reading_nm(&self, p: &[f64], _sample: &Sample<'_>, torque_nm: f64) -> f64 {
        (1.0 + p[0]) * torque_nm
    }
}
