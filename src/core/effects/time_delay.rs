//! The torque is recorded late, or early, against the position.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Starts};
use crate::numerics::scalar::Scalar;

static ABOUT: About = About {
    id: "time_delay",
    family: Family::Fault,
    acts_on: ActsOn::Sensor,
    means: "torque is recorded late or early against position",
    formula: "reading(t) = y(t - delay_s); if first_order: delay_s d(reading)/dt = y - reading",
    source: "transport on the bus, an analog filter",
    signature: Region::Acceleration,
    trades_with: &["reversal_transition", "viscous", "inertia"],
    example: "delay_s=0.02,first_order=0",
    parameters: &[
        Parameter { bounds: (-10.0, 10.0), ..Parameter::strength("delay_s") },
        Parameter::form("first_order", 1.0),
    ],
    needs: &[Excitation::TorqueRate],
    by_hand: Some("tap the winch and compare when encoder and torque sensor answer"),
    remedy: Some(
        "Find out why torque and position are not recorded at the same time; the model need not change for it.",
    ),
    starts: Starts::Forms,
    ..About::PLAIN
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
}

impl<S: Scalar> Hooks<S> for TimeDelay {
    /// A lag that would be early is no lag.
    fn delay_s(&self, p: &[S]) -> S {
        if p[1].value() > 0.5 && p[0].value() > 0.0 { S::from(0.0) } else { p[0] }
    }

    fn lag_s(&self, p: &[S]) -> S {
        if p[1].value() > 0.5 { p[0].max(S::from(0.0)) } else { S::from(0.0) }
    }
}
