//! What an interval takes as right: an error of it would move the parameter, and no data of the campaign would show it.

use super::legs::Amplitude;
use super::zero::Zero;
use crate::model::{Both, Combination, Direction, Model, Term};
use std::collections::BTreeMap;

/// One thing that an interval rests on.
#[derive(Debug, Clone, PartialEq)]
pub struct RestsOn {
    /// What, by its name in campaign.toml or in words.
    pub on: &'static str,
    /// Whether it was fitted along with the parameter, its uncertainty in the interval, or taken as declared.
    pub fitted: bool,
    /// The change of it that is reported.
    pub change: &'static str,
    /// What that change moves the parameter by, in the parameter's unit.
    pub moves: f64,
}

/// 1 % of something that a parameter is in proportion to.
const PERCENT: f64 = 0.01;
/// 1 mN m.
const MILLI: f64 = 1e-3;

/// What each parameter of `model`, identified by sweeps with amplitudes `a` of a load of `load_nm`, rests on.
pub(super) fn of_sweeps(
    model: &Model,
    zero: &Zero,
    a: &Both<Amplitude>,
    load_nm: f64,
) -> BTreeMap<String, Vec<RestsOn>> {
    let mut all = BTreeMap::new();
    for direction in Direction::BOTH {
        let (friction, a) = (model.friction.of(direction), a.of(direction));
        let loss = friction.loss();
        let by_degree = if a.a_nm == 0.0 { 0.0 } else { (a.by_zero_nm_rad / a.a_nm).to_radians() };
        for term in Term::ALL {
            let value = friction[term];
            if value == 0.0 {
                continue;
            }
            let declared = |on, change, moves: f64| RestsOn { on, fitted: false, change, moves: moves.abs() };
            let of_zero =
                |moves: f64| RestsOn { on: "zero of the position", fitted: zero.is_fitted(), change: "1 deg", moves };
            let mut rests = Vec::new();
            match term {
                Term::Load if load_nm != 0.0 => {
                    rests.push(declared("gravity or measured load", "1 %", PERCENT * loss));
                    rests.push(declared("winch_radius_m", "1 %", PERCENT * loss));
                    rests.push(declared("pulley_radius_m", "1 %", PERCENT * loss));
                    rests.push(declared("scale of the torque", "1 %", PERCENT * loss));
                    rests.push(of_zero((loss * by_degree).abs()));
                }
                Term::Load | Term::JointDecay => {}
                Term::CableDecay => rests.push(declared("pulley_radius_m", "1 %", PERCENT * value)),
                _ => {
                    if load_nm != 0.0 {
                        rests.push(declared("gravity or measured load", "1 %", PERCENT * value));
                        rests.push(declared("pulley_radius_m", "1 %", PERCENT * value));
                        rests.push(of_zero((value * by_degree).abs()));
                    } else {
                        rests.push(declared("winch_radius_m", "1 %", PERCENT * value));
                        rests.push(declared("scale of the torque", "1 %", PERCENT * value));
                    }
                    if term == Term::Coulomb {
                        let moves = MILLI * loss / model.joint.winch_radius_m;
                        rests.push(declared("zero of the torque", "1 mN m", moves));
                    }
                }
            }
            all.insert(term.dotted(direction), rests);
        }
    }
    all.extend(of_curve(model));
    all
}

/// What each parameter of `model`, identified from free motion, rests on; by how much an error would move it is not computed.
pub(super) fn of_free_motion(model: &Model) -> BTreeMap<String, Vec<RestsOn>> {
    of_curve(model)
}

/// The curve's parameter is known in units of the clearance: p and n change with the one declared, about in proportion.
fn of_curve(model: &Model) -> BTreeMap<String, Vec<RestsOn>> {
    let declared = !model.confidence.contains_key("joint.backlash_m");
    let (name, value) = match model.combination {
        Combination::Arctan { p, .. } => ("combination.p", p),
        Combination::Power { n } => ("combination.n", n),
        Combination::Sign | Combination::Linear => return BTreeMap::new(),
    };
    let moves = PERCENT * value;
    BTreeMap::from([(name.to_string(), vec![RestsOn { on: "backlash_m", fitted: !declared, change: "1 %", moves }])])
}
