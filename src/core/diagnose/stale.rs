//! Groups of the model's own parameters that go stale together, in each of the ways in which that happens.

use super::parameter_ref::ParameterRef;
use super::perturbation::{Mode, Perturbation, matters};
use crate::dynamics::Direction;
use crate::model::{Group, Model, Term, groups};

/// How viscous friction moves where it takes Coulomb friction along: a line per direction.
pub const WHOLE_LINE: &str = "each direction separately, with its Coulomb term";

/// How Coulomb friction moves where one direction gains what the other loses: as by a bias of the sensor.
pub const SAME_TORQUE: &str = "up and down by the same torque";

/// How a parameter moves that moves in one direction alone.
pub const UP_ONLY: &str = "up only";
/// See [`UP_ONLY`].
pub const DOWN_ONLY: &str = "down only";

/// A group of the model's own parameters that may have gone stale, in one of the ways in which that happens.
#[derive(Debug, Clone, PartialEq)]
pub struct Stale {
    /// The group's name in a verdict.
    pub name: &'static str,
    /// How: "both directions alike", "up only" ...
    pub how: &'static str,
    /// What moves.
    pub moves: Vec<Perturbation>,
}

/// The terms that a Stribeck curve is in proportion to.
const AMPLITUDES: [Term; 2] = [Term::CableStribeck, Term::JointStribeck];

/// A parameter without prior; one step changes it by at most half of its size.
fn free(turns: Vec<(ParameterRef, Mode)>) -> Perturbation {
    Perturbation { stride: 0.5, ..Perturbation::of(turns, f64::INFINITY, 1e-3) }
}

/// `parameter` in proportion to what it is in `model`.
fn scaled(model: &Model, parameter: ParameterRef) -> (ParameterRef, Mode) {
    (parameter, Mode::Add(parameter.value(model)))
}

/// A term of friction moving up and down.
fn both(term: Term) -> [ParameterRef; 2] {
    Direction::BOTH.map(|d| ParameterRef::Friction(d, term))
}

/// Its mean size over both directions.
fn size(model: &Model, term: Term) -> f64 {
    both(term).iter().map(|parameter| parameter.value(model).abs()).sum::<f64>() / 2.0
}

/// The groups that `model` has.
pub fn stale(model: &Model) -> Vec<Stale> {
    let whole = |parameter: ParameterRef| free(vec![scaled(model, parameter)]);
    let curved = |parameter| Perturbation { is_linear: false, ..free(vec![(parameter, Mode::Scale)]) };
    let of_one = [
        (&groups::GRAVITY, ParameterRef::Gravity, whole(ParameterRef::Gravity)),
        (&groups::INERTIA, ParameterRef::Inertia, whole(ParameterRef::Inertia)),
        (&groups::BACKLASH_WIDTH, ParameterRef::Backlash, curved(ParameterRef::Backlash)),
    ];
    let of_one = of_one.into_iter().filter(|(_, parameter, _)| matters(model, *parameter));
    of_one
        .map(|(group, _, way)| Stale { name: group.name, how: "", moves: vec![way] })
        .chain([Term::Coulomb, Term::Viscous, Term::Load].into_iter().flat_map(|term| of_term(model, term)))
        .chain(whole_line(model))
        .chain(of_stribeck(model))
        .collect()
}

/// The ways in which `term` of both directions moves.
fn of_term(model: &Model, term: Term) -> Vec<Stale> {
    let mut found = Vec::new();
    let mut add = |how, moves| found.push(Stale { name: Group::of_term(term).name, how, moves });
    let [up, down] = both(term);
    let unit = if size(model, term) > 0.0 { size(model, term) } else { 0.1 };
    let present = |parameter: ParameterRef| parameter.value(model) != 0.0;
    if present(up) && present(down) {
        add("both directions alike", vec![free([up, down].map(|parameter| scaled(model, parameter)).to_vec())]);
    }
    for (parameter, how) in [(up, UP_ONLY), (down, DOWN_ONLY)] {
        if present(parameter) {
            add(how, vec![free(vec![scaled(model, parameter)])]);
        }
    }
    let by = |parameter: ParameterRef| (parameter, Mode::Add(unit));
    if term == Term::Coulomb && present(up) && present(down) {
        add(SAME_TORQUE, vec![free(vec![by(up), by(down)])]);
    }
    if (present(up) || present(down)) != (term == Term::Load) {
        add("each direction separately", [up, down].map(|parameter| free(vec![by(parameter)])).to_vec());
    }
    found
}

/// A model of Coulomb and viscous friction alone has a line per direction: its two numbers, fitted together, compensate for each
/// other, so that neither is right where the other is not.
fn whole_line(model: &Model) -> Option<Stale> {
    let is_line = |d: Direction| AMPLITUDES.iter().all(|term| model.friction.of(d).lacks(*term));
    let is_whole = size(model, Term::Coulomb) > 0.0 && size(model, Term::Viscous) > 0.0;
    let unit = |term: Term| both(term).map(|parameter| free(vec![(parameter, Mode::Add(size(model, term)))]));
    (Direction::BOTH.into_iter().all(is_line) && is_whole).then(|| Stale {
        name: groups::VISCOUS.name,
        how: WHOLE_LINE,
        moves: [unit(Term::Viscous), unit(Term::Coulomb)].concat(),
    })
}

/// The ways in which the size of the Stribeck terms moves.
fn of_stribeck(model: &Model) -> Vec<Stale> {
    let amplitudes = Direction::BOTH.map(|d| AMPLITUDES.map(|term| scaled(model, ParameterRef::Friction(d, term))));
    if amplitudes.iter().flatten().all(|(parameter, _)| parameter.value(model) == 0.0) {
        return Vec::new();
    }
    let of = |how, moves| Stale { name: groups::STRIBECK_LEVEL.name, how, moves };
    vec![
        of("both directions alike", vec![free(amplitudes.concat())]),
        of("each direction separately", amplitudes.map(|turns| free(turns.to_vec())).to_vec()),
    ]
}
