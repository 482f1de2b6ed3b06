//! Friction that falls as grease and bearings warm up.

use super::{About, Effect, Extent, Family, Parameter, Region, Sample, clock_s, spaced};

static ABOUT: About = About {
    id: "warm_up",
    family: Family::Physics,
    means: "friction decays as the joint warms up",
    formula: "friction (1 + cold_share exp(-t/time_constant_s))",
    source: "Simoni, Beschi, Legnani and Visioli 2015",
    signature: Region::Time,
    trades_with: &["sensor_drift", "coulomb"],
    parameters: &[
        Parameter::choice("restarts", 0.0, 1.0),
        Parameter::strength("cold_share"),
        Parameter::shape("time_constant_s", 1e-2, 1e6),
    ],
};

#[derive(Debug)]
pub struct WarmUp;

impl Effect for WarmUp {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn needs_clock(&self, p: &[f64]) -> bool {
        p[0] <= 0.5
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let clocks = [(1.0, extent.trial_s), (0.0, extent.campaign_s)];
        let of = |(restarts, horizon_s): (f64, f64)| {
            spaced(horizon_s / 20.0, horizon_s * 1.5, 4).map(move |constant_s| vec![restarts, 0.0, constant_s])
        };
        clocks.into_iter().flat_map(of).collect()
    }

    fn friction_factor(&self, p: &[f64], sample: &Sample<'_>) -> f64 {
        1.0 + p[1] * (-clock_s(p[0], sample) / p[2]).exp()
    }
}
