//! Friction that falls as the speed grows from rest.

use super::{
    About, ActsOn, Carried, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Sample, grows_both_ways,
    spaced,
};
use crate::dynamics::Both;
use crate::numerics::scalar::Scalar;

static ABOUT: About = About {
    id: "stribeck",
    family: Family::Physics,
    acts_on: ActsOn::Friction,
    means: "friction falls with speed at low speed",
    formula: "up_nm exp(-(|v| / speed_rad_s)^exponent) moving up, -down_nm exp(...) moving down",
    source: "Armstrong-Helouvry, Dupont and Canudas de Wit 1994",
    signature: Region::LowSpeed,
    trades_with: &["viscous", "stribeck_level", "presliding"],
    example: "up_nm=0.1,down_nm=0.13,speed_rad_s=0.1,exponent=1.3",
    parameters: &[
        Parameter::positive_strength("up_nm"),
        Parameter::positive_strength("down_nm"),
        Parameter::shape("speed_rad_s", 1e-5, 100.0),
        Parameter::shape("exponent", 0.5, 3.0),
    ],
    needs: &[Excitation::Speeds],
    ..About::PLAIN
};

#[derive(Debug)]
pub struct Stribeck;

impl Stribeck {
    /// The slowest speed that a search looks at, rad/s.
    fn slowest_rad_s(extent: &Extent) -> f64 {
        extent.slowest_rad_s.max(extent.speed_rad_s.1 / 200.0)
    }
}

impl Effect for Stribeck {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    /// Friction that falls with speed in one direction and rises in the other is not this effect (where it rises in both, the report says so).
    /// Nor is what changes far below the slowest motion only, at rest, where friction may be anything; friction that even the fastest motion
    /// hardly lowers is Coulomb friction.
    fn is_itself(&self, p: &[f64], extent: &Extent) -> bool {
        /// A curve that has fallen to less than this share at the slowest motion does not show in it.
        const SHOWN: f64 = 0.05;
        /// At the fastest motion it has fallen to this share at least.
        const FALLEN: f64 = 0.5;
        let share = |speed_rad_s: f64| (-(speed_rad_s / p[2]).powf(p[3])).exp();
        let is_one = grows_both_ways(p[0], p[1]) || grows_both_ways(-p[0], -p[1]);
        is_one && share(Self::slowest_rad_s(extent)) >= SHOWN && share(extent.speed_rad_s.1) <= FALLEN
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        spaced(Self::slowest_rad_s(extent), extent.speed_rad_s.1 / 3.0, 5)
            .flat_map(|speed| [1.0, 2.0].map(|exponent| vec![0.0, 0.0, speed, exponent]))
            .collect()
    }
}

impl<S: Scalar> Hooks<S> for Stribeck {
    fn friction_nm(&self, p: &[S], sample: &Sample<'_, S::Given>, _carried: Carried<S>) -> Both<S> {
        let decay = (-(sample.own.velocity.abs() / p[2]).powf(p[3])).exp();
        Both { up: p[0] * decay, down: -p[1] * decay }
    }
}
