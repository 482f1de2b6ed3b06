//! The torque sensor's zero moves with time.

use super::{About, Effect, Extent, Family, Parameter, Region, Sample, clock_s};
use std::f64::consts::PI;

static ABOUT: About = About {
    id: "sensor_drift",
    family: Family::Fault,
    means: "the torque sensor's offset moves with time",
    formula: "reading = y + line_nm t/horizon_s + settle_nm exp(-t/settle_s) + sum over k of wave_k_nm cos(pi k t/horizon_s)",
    source: "temperature drift of strain gauges; a smooth function of time",
    signature: Region::Time,
    trades_with: &["warm_up", "joint_coupling", "sensor_bias"],
    parameters: &[
        Parameter::choice("restarts", 0.0, 1.0),
        Parameter::choice("horizon_s", 1e-3, 1e9),
        Parameter::shape("settle_s", 1e-3, 1e7),
        Parameter::strength("settle_nm"),
        Parameter::strength("line_nm"),
        Parameter::strength("wave_1_nm"),
        Parameter::strength("wave_2_nm"),
        Parameter::strength("wave_3_nm"),
        Parameter::strength("wave_4_nm"),
    ],
};

#[derive(Debug)]
pub struct SensorDrift;

impl Effect for SensorDrift {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn needs_clock(&self, p: &[f64]) -> bool {
        p[0] <= 0.5
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let clocks = [(1.0, extent.trial_s), (0.0, extent.campaign_s)];
        clocks
            .map(|(restarts, horizon_s)| vec![restarts, horizon_s, horizon_s / 8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
            .to_vec()
    }

    fn reading_nm(&self, p: &[f64], sample: &Sample<'_>, torque_nm: f64) -> f64 {
        let share = clock_s(p[0], sample) / p[1];
        // cos(k x) from the two before: a smooth drift needs no more.
        let first = (PI * share).cos();
        let (mut before, mut now, mut sum) = (1.0, first, 0.0);
        for wave_nm in &p[5..] {
            sum += wave_nm * now;
            (before, now) = (now, 2.0 * first * now - before);
        }
        torque_nm + p[3] * (-clock_s(p[0], sample) / p[2]).exp() + p[4] * share + sum
    }
}
