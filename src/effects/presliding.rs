//! Elastic displacement before sliding, without a clearance.

use super::{About, Effect, Extent, Family, Parameter, Region, spaced};

/// Travels tried, as shares of the range moved through.
const TRAVELS: (f64, f64) = (0.002, 0.15);

static ABOUT: About = About {
    id: "presliding",
    family: Family::Physics,
    means: "elastic displacement before sliding",
    formula: "ds = (K - s) |dx| / travel_rad: friction follows its branch exponentially in the travel",
    source: "Dahl 1968; Canudas de Wit, Olsson, Astrom and Lischinsky 1995",
    signature: Region::AfterReversal,
    trades_with: &["reversal_transition", "backlash_width", "time_delay"],
    parameters: &[Parameter::shape("travel_rad", 1e-9, 10.0)],
};

#[derive(Debug)]
pub struct Presliding;

impl Effect for Presliding {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let range_rad = extent.position_rad.1 - extent.position_rad.0;
        spaced(TRAVELS.0 * range_rad, TRAVELS.1 * range_rad, 7).map(|travel| vec![travel]).collect()
    }

    fn presliding_rad(&self, p: &[f64]) -> f64 {
        p[0]
    }
}
