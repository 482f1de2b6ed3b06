//! The torque is recorded late, or early, against the position.

use super::{About, Effect, Extent, Family, Parameter, Region};

static ABOUT: About = About {
    id: "time_delay",
    family: Family::Fault,
    means: "torque is recorded late against position",
    formula: "reading(t) = y(t - delay_s); if first_order: delay_s d(reading)/dt = y - reading",
    source: "transport on the bus, an analog filter",
    signature: Region::Acceleration,
    trades_with: &["reversal_transition", "viscous", "inertia"],
    parameters: &[
        Parameter { bounds: (-10.0, 10.0), ..Parameter::strength("delay_s") },
        Parameter::choice("first_order", 0.0, 1.0),
    ],
};

#[derive(Debug)]
pub struct TimeDelay;

impl Effect for TimeDelay {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn only_adds(&self) -> bool {
        false
    }

    fn starts(&self, _extent: &Extent) -> Vec<Vec<f64>> {
        vec![vec![0.0, 0.0], vec![0.0, 1.0]]
    }

    /// A lag that would be early is no lag.
    fn delay_s(&self, p: &[f64]) -> f64 {
        if p[1] > 0.5 && p[0] > 0.0 { 0.0 } else { p[0] }
    }

    fn lag_s(&self, p: &[f64]) -> f64 {
        if p[1] > 0.5 { p[0].max(0.0) } else { 0.0 }
    }
}
