//! The cable stretches: under load the joint is not where the winch's encoder says.

use super::{About, ActsOn, Effect, Excitation, Extent, Family, Hooks, Parameter, Region};
use crate::numerics::scalar::Scalar;

/// Loads by which a cable hardens that are tried, as shares of the reading's range.
const HARDENS: [f64; 3] = [0.04, 0.15, 0.6];

static ABOUT: About = About {
    id: "cable_elasticity",
    family: Family::Physics,
    acts_on: ActsOn::Load,
    means: "stretch of the cable takes the joint off the measured angle, the more the more it bears",
    formula: "q_joint = q - compliance_rad_nm tau; gravity is taken there; tau = the load, or y r2/r1 where with_friction; if it \
              hardens, its stiffness grows by itself with each hardens_nm: ln(1 + |tau|/hardens_nm) hardens_nm sgn(tau) instead of tau",
    source: "two-mass models; Spong 1987; stiffness that grows with the load: Feyrer, Wire Ropes, 2015",
    signature: Region::Load,
    trades_with: &["gravity_phase", "elastic_spring", "gravity"],
    example: "with_friction=1,compliance_rad_nm=0.03",
    parameters: &[
        Parameter::choice("with_friction", 0.0, 1.0),
        Parameter::strength("compliance_rad_nm"),
        Parameter::form("hardens", 1.0),
        Parameter::shape("hardens_nm", 1e-6, 1e6).or(1.0),
    ],
    needs: &[Excitation::Loads],
    by_hand: Some("lock the joint and pull: how far the winch turns for a torque is the cable's stretch"),
    ..About::PLAIN
};

#[derive(Debug)]
pub struct CableElasticity;

impl Effect for CableElasticity {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn only_adds(&self) -> bool {
        false
    }

    fn lags(&self) -> bool {
        true
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let span_nm = extent.torque_nm.1 - extent.torque_nm.0;
        let of = |with_friction: f64| {
            let hardens = HARDENS.into_iter().map(move |share| vec![with_friction, 0.0, 1.0, share * span_nm]);
            std::iter::once(vec![with_friction, 0.0, 0.0, 1.0]).chain(hardens)
        };
        of(0.0).chain(of(1.0)).collect()
    }

    fn uses(&self, p: &[f64], at: usize) -> bool {
        at < 3 || p[2] > 0.5
    }

    fn limits(&self, at: usize, extent: &Extent) -> (f64, f64) {
        let least_nm = HARDENS[0] / 4.0 * (extent.torque_nm.1 - extent.torque_nm.0);
        (if at == 3 { least_nm } else { f64::NEG_INFINITY }, f64::INFINITY)
    }

    /// A cable does not shorten under load.
    fn is_itself(&self, p: &[f64], _extent: &Extent) -> bool {
        p[1] >= 0.0
    }
}

impl<S: Scalar> Hooks<S> for CableElasticity {
    fn position_lag_rad(&self, p: &[S], load_nm: S, pull_nm: S) -> S {
        let tau_nm = if p[0].value() > 0.5 { pull_nm } else { load_nm };
        if p[2].value() <= 0.5 {
            return p[1] * tau_nm;
        }
        let stretch_rad = |tau_nm: S| p[1] * p[3] * (tau_nm / p[3] + 1.0).ln();
        tau_nm.if_positive(|| stretch_rad(tau_nm), || -stretch_rad(-tau_nm))
    }
}

#[cfg(test)]
mod tests {
    use super::{CableElasticity, Hooks};

    #[test]
    fn a_cable_that_hardens_is_as_soft_at_first_and_stretches_ever_less() {
        let lag_rad = |hardens: f64, load_nm: f64| {
            Hooks::<f64>::position_lag_rad(&CableElasticity, &[0.0, 0.03, hardens, 0.5], load_nm, 0.0)
        };
        assert!((lag_rad(1.0, 1e-6) / lag_rad(0.0, 1e-6) - 1.0).abs() < 1e-5);
        // At hardens_nm its stiffness has doubled.
        let slope = (lag_rad(1.0, 0.5 + 1e-6) - lag_rad(1.0, 0.5 - 1e-6)) / 2e-6;
        assert!((slope / 0.03 - 0.5).abs() < 1e-6);
        assert_eq!(lag_rad(1.0, -0.7), -lag_rad(1.0, 0.7));
    }
}
