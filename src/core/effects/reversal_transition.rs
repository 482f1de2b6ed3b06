//! Friction passes gradually from one branch to the other after a reversal: the clearance takes up first.

use super::{About, ActsOn, Curve, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, spaced};
use crate::numerics::scalar::Scalar;

/// Clearances tried, as shares of the range moved through.
const WIDTHS: (f64, f64) = (0.004, 0.4);
/// A clearance found within this share of the joint's own is that clearance; by chance one of many sizes is there seldom ...
const OWN: f64 = 0.15;
/// ... and counts as this many parameters fewer: the clearance need not be fitted, and no second one has to be assumed.
const OWN_COUNTS: usize = 2;
/// Below this exponent the curve rises with a vertical slope and most of it in the first part of the travel, as bristles bend; a clearance that is
/// taken up first has a flat part there.
const EXPONENT_OF_BRISTLES: f64 = 0.6;
/// Widest clearance, as a share of the stroke that crosses it.
const CROSSED: f64 = 0.8;

static ABOUT: About = About {
    id: "reversal_transition",
    family: Family::Physics,
    acts_on: ActsOn::Friction,
    means: "friction builds up gradually after a reversal",
    formula: "K~ = (atan(2 p u) / atan(2 p))^n, u = travel since the reversal over backlash_rad",
    source: "paper (21) to (30); Nordin, Galic and Gutman 1997",
    signature: Region::AfterReversal,
    trades_with: &["presliding", "time_delay", "backlash_width"],
    alike: &["presliding"],
    example: "backlash_m=0.003,p=1.1,n=1.4",
    parameters: &[
        Parameter::shape("backlash_m", 1e-7, 1.0),
        Parameter::shape("p", 0.05, 50.0),
        Parameter::shape("n", 0.05, 5.0),
    ],
    needs: &[Excitation::Reversals],
    ..About::PLAIN
};

#[derive(Debug)]
pub struct ReversalTransition;

impl Effect for ReversalTransition {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let range_m = (extent.position_rad.1 - extent.position_rad.0) * extent.pulley_radius_m;
        let own_m = (extent.backlash_m > 0.0).then_some(extent.backlash_m);
        spaced(WIDTHS.0 * range_m, WIDTHS.1 * range_m, 8)
            .chain(own_m)
            .filter(|width_m| *width_m <= widest_m(extent))
            .flat_map(|width_m| [(0.3, 0.2), (0.3, 1.0), (3.0, 1.0), (0.3, 2.0)].map(|(p, n)| vec![width_m, p, n]))
            .collect()
    }

    fn confirmed(&self, p: &[f64], extent: &Extent) -> usize {
        if (p[0] - extent.backlash_m).abs() <= OWN * extent.backlash_m { OWN_COUNTS } else { 0 }
    }

    /// Over a travel that the encoder does not show friction jumps.
    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        p[0] >= extent.resolution_rad * extent.pulley_radius_m
    }

    fn suits_its_like(&self, p: &[f64]) -> bool {
        p[2] < EXPONENT_OF_BRISTLES
    }

    fn limits(&self, at: usize, extent: &Extent) -> (f64, f64) {
        (f64::NEG_INFINITY, if at == 0 { widest_m(extent) } else { f64::INFINITY })
    }
}

/// A clearance that some trial never crosses would leave that trial without a state to begin from, m.
fn widest_m(extent: &Extent) -> f64 {
    CROSSED * extent.stroke_rad * extent.pulley_radius_m
}

impl<S: Scalar> Hooks<S> for ReversalTransition {
    fn curve(&self, p: &[S]) -> Option<Curve<S>> {
        Some(Curve { backlash_m: p[0], p: p[1], n: p[2] })
    }
}
