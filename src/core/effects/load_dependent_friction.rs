//! Friction in proportion to the load that the joint carries.

use super::{
    About, ActsOn, Added, Carried, Effect, Excitation, Extent, Family, Hooks, Parameter, Region, Sample,
    grows_both_ways,
};
use crate::dynamics::{Both, Direction};
use crate::numerics::scalar::Scalar;

/// Pretensions that are tried, as shares of the reading's range.
const PRETENSIONS: [f64; 6] = [0.0, 0.025, 0.05, 0.1, 0.2, 0.4];
/// Torques at which it levels off, as such shares.
const LEVELS: [f64; 4] = [0.12, 0.25, 0.5, 1.0];

const ID: &str = "load_dependent_friction";

static ABOUT: About = About {
    id: ID,
    family: Family::Physics,
    acts_on: ActsOn::Friction,
    means: "friction grows with the load carried",
    formula: "up |T| moving up, -down |T| moving down; T = (r1/r2) (G + I a + measured load), with the model's own friction in \
              the branch if of_tension: what a sheath or a capstan bears is the cable's whole tension; |T| is \
              sqrt(T^2 + pretension_nm^2), and |T| / (1 + |T| / levels_off_nm) where that is not 0",
    source: "Bittencourt and Gunnarsson 2012; BAM models M3 to M6; Euler-Eytelwein for the cable's tension",
    signature: Region::Load,
    trades_with: &["load_coefficient", "coulomb", "sensor_gain"],
    example: "up=0.2,down=0.15,of_tension=0,pretension_nm=0,levels_off_nm=0",
    parameters: &[
        Parameter::strength("up"),
        Parameter::strength("down"),
        Parameter::form("of_tension", 1.0),
        Parameter::form("pretension_nm", 1e6),
        Parameter::form("levels_off_nm", 1e6),
    ],
    needs: &[Excitation::Loads],
    by_hand: Some("repeat one sweep with a second, known load at the joint"),
    ..About::PLAIN
};

/// Friction that grows by `share` of the load's size, whichever way the load acts and the joint moves.
pub fn friction_of_load(share: f64) -> Added {
    Added { effect: &LoadDependentFriction, parameters: vec![share, share, 0.0, 0.0, 0.0] }
}

/// Where `effects` hold that share of one direction: which effect, and which of its parameters; `None` where none is this one.
pub fn place_of_share<S>(effects: &[Added<S>], direction: Direction) -> Option<(usize, usize)> {
    let at = effects.iter().position(|added| added.id() == ID)?;
    Some((at, usize::from(direction == Direction::Down)))
}

/// The dotted name of that share.
pub fn share_name(direction: Direction) -> String {
    format!("effects.{ID}.{}", direction.name())
}

#[derive(Debug)]
pub struct LoadDependentFriction;

impl Effect for LoadDependentFriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn starts(&self, extent: &Extent) -> Vec<Vec<f64>> {
        let span_nm = extent.torque_nm.1 - extent.torque_nm.0;
        let of = |of_tension: f64| {
            let before = PRETENSIONS.map(|share| vec![0.0, 0.0, of_tension, share * span_nm, 0.0]);
            let above = LEVELS.map(|share| vec![0.0, 0.0, of_tension, 0.0, share * span_nm]);
            before.into_iter().chain(above)
        };
        of(0.0).chain(of(1.0)).collect()
    }

    fn is_itself(&self, p: &[f64], _extent: &Extent) -> bool {
        grows_both_ways(p[0], p[1])
    }
}

impl<S: Scalar> Hooks<S> for LoadDependentFriction {
    fn friction_nm(&self, p: &[S], _sample: &Sample<'_, S::Given>, carried: Carried<S>) -> Both<S> {
        let Both { up, down } = carried.friction_nm;
        let borne_nm = |own_nm: S| {
            let tension_nm = (carried.load_nm + p[2] * own_nm).hypot(p[3]);
            if p[4].value() > 0.0 { tension_nm / (tension_nm / p[4] + 1.0) } else { tension_nm }
        };
        Both { up: p[0] * borne_nm(up), down: -p[1] * borne_nm(down) }
    }
}
