//! Elastic displacement before sliding, without a clearance.

use super::{About, ActsOn, Curve, Effect, Excitation, Extent, Family, Hooks, Parameter, Presliding, Region, spaced};
use crate::numerics::scalar::Scalar;

/// Travels tried, as shares of the range moved through.
const TRAVELS: (f64, f64) = (0.002, 0.15);

/// Below this friction arrives at its branch as at the end of a clearance.
const EXPONENT_MIN: f64 = 0.65;
/// This near to it an exponent is at it.
const AT_BOUND: f64 = 0.01;

static ABOUT: About = About {
    id: "presliding",
    family: Family::Physics,
    acts_on: ActsOn::Friction,
    means: "elastic displacement before sliding",
    formula: "dk = sgn(K~ - k) |K~ - k|^exponent |dx| / travel_rad: friction k follows its branch over the travel; if in_place: K~ jumps as \
              without a clearance",
    source: "Dahl 1968; Canudas de Wit, Olsson, Astrom and Lischinsky 1995",
    signature: Region::AfterReversal,
    trades_with: &["reversal_transition", "backlash_width", "time_delay"],
    alike: &["reversal_transition"],
    example: "travel_rad=0.01,exponent=1.2",
    parameters: &[
        Parameter::shape("travel_rad", 1e-9, 10.0),
        Parameter::shape("exponent", EXPONENT_MIN, 4.0),
        Parameter::form("in_place", 1.0),
    ],
    needs: &[Excitation::Reversals],
    ..About::PLAIN
};

#[derive(Debug)]
pub struct Bristles;

impl Effect for Bristles {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let range_rad = extent.position_rad.1 - extent.position_rad.0;
        // In the place of the model's own transition, too, where it has one.
        let forms = if extent.changes_gradually { &[0.0, 1.0][..] } else { &[0.0] };
        let of_form = |in_place: &f64| {
            let in_place = *in_place;
            spaced(TRAVELS.0 * range_rad, TRAVELS.1 * range_rad, 7).map(move |travel| vec![travel, 1.0, in_place])
        };
        forms.iter().flat_map(of_form).collect()
    }

    /// Over a travel that the encoder does not show friction jumps: nine tenths of its change must lie in one that it shows. Friction that arrives
    /// as abruptly as at the end of a clearance tells of one, unless the joint's is known and the model does not pass over it.
    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        let tells_of_clearance = extent.changes_gradually || extent.backlash_m == 0.0;
        nine_tenths_rad(p) >= extent.resolution_rad && (!tells_of_clearance || p[1] > EXPONENT_MIN + AT_BOUND)
    }
}

/// Travel within which friction makes nine tenths of its change at a reversal, rad: the integral of z^-exponent over the share z that is left.
fn nine_tenths_rad(p: &[f64]) -> f64 {
    let (left, power) = (0.1_f64, 1.0 - p[1]);
    let travels = if power == 0.0 { -left.ln() } else { (1.0 - left.powf(power)) / power };
    p[0] * travels
}

impl<S: Scalar> Hooks<S> for Bristles {
    fn curve(&self, p: &[S]) -> Option<Curve<S>> {
        let [none, plain] = [0.0, 1.0].map(S::from);
        (p[2].value() > 0.5).then_some(Curve { backlash_m: none, p: plain, n: plain })
    }

    fn presliding(&self, p: &[S]) -> Option<Presliding<S>> {
        Some(Presliding { travel_rad: p[0], exponent: p[1] })
    }
}

#[cfg(test)]
mod tests {
    use super::nine_tenths_rad;

    #[test]
    fn friction_that_changes_more_and_more_slowly_takes_the_longer() {
        // Dahl's exponential at 1, the travel itself at 0, sqrt(0.1) of twice the travel left at 1/2.
        let of = |exponent: f64| nine_tenths_rad(&[2.0, exponent]);
        assert!((of(1.0) - 2.0 * 10f64.ln()).abs() < 1e-12 && (of(0.0) - 1.8).abs() < 1e-12);
        assert!((of(0.5) - 4.0 * (1.0 - 0.1f64.sqrt())).abs() < 1e-12);
        assert!((of(1.0 + 1e-9) - of(1.0)).abs() < 1e-6);
    }
}
