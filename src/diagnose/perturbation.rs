//! Ways in which a model may be changed: each a number that is 0 where the model stays as it is.
//!
//! Base parameters move in units of their confidence; groups of them move together, as a stale calibration would; effects move
//! by their strengths and shapes.

use crate::dynamics::Direction;
use crate::effects::{Added, Extent, Parameter, Role};
use crate::model::{Combination, Group, Model, Term, groups};

/// Confidence of a parameter for which none is given, as a share of it: the 95 % interval reaches so far to either side.
const UNKNOWN_SHARE: f64 = 0.05;
/// Half a 95 % interval in standard deviations.
const HALF_WIDTH: f64 = 1.96;

/// One number of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterRef {
    Gravity,
    Inertia,
    Backlash,
    Curve,
    Friction(Direction, Term),
    Effect(usize, usize),
}

impl ParameterRef {
    fn slot(self, model: &mut Model) -> Option<&mut f64> {
        match self {
            Self::Gravity => Some(&mut model.dynamics.gravity_nm),
            Self::Inertia => Some(&mut model.dynamics.inertia_kg_m2),
            Self::Backlash => Some(&mut model.joint.backlash_m),
            Self::Curve => match &mut model.combination {
                Combination::Arctan { p, .. } => Some(p),
                Combination::Power { n } => Some(n),
                Combination::Sign | Combination::Linear => None,
            },
            Self::Friction(direction, term) => Some(&mut model.friction.of_mut(direction)[term]),
            Self::Effect(effect, at) => model.effects.get_mut(effect)?.parameters.get_mut(at),
        }
    }

    /// Sets it in `model`.
    pub fn set(self, model: &mut Model, value: f64) {
        if let Some(slot) = self.slot(model) {
            *slot = value;
        }
    }

    /// Its value in `model`; 0 where it has none.
    pub fn value(self, model: &Model) -> f64 {
        self.slot(&mut model.clone()).map_or(0.0, |slot| *slot)
    }

    /// Its dotted name, as in a model's confidence.
    pub fn name(self, model: &Model) -> String {
        match self {
            Self::Gravity => "dynamics.gravity_nm".to_string(),
            Self::Inertia => "dynamics.inertia_kg_m2".to_string(),
            Self::Backlash => "joint.backlash_m".to_string(),
            Self::Curve if matches!(model.combination, Combination::Power { .. }) => "combination.n".to_string(),
            Self::Curve => "combination.p".to_string(),
            Self::Friction(direction, term) => term.dotted(direction),
            Self::Effect(effect, at) => {
                let added = &model.effects[effect];
                format!("effects.{}.{}", added.id(), added.effect.about().parameters[at].name)
            }
        }
    }
}

/// How a parameter turns with its move's number.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    /// value + x step
    Add(f64),
    /// value exp(x)
    Scale,
}

/// One way to change a model: parameters that turn together.
#[derive(Debug, Clone, PartialEq)]
pub struct Perturbation {
    turns: Vec<(ParameterRef, Mode)>,
    /// Standard deviation of the number before any data are seen; infinite where only data decide.
    pub prior: f64,
    /// The number's size for a difference quotient.
    pub probe: f64,
    /// The largest step of the number that is believed at once.
    pub stride: f64,
    /// The most that its parameters may come to.
    pub most: f64,
    /// Whether the prediction is in proportion to it, or nearly so.
    pub is_linear: bool,
}

impl Perturbation {
    fn of(turns: Vec<(ParameterRef, Mode)>, prior: f64, probe: f64) -> Self {
        Self { turns, prior, probe, stride: f64::INFINITY, most: f64::INFINITY, is_linear: true }
    }

    /// The same, its number known to be within about `deviation` before any data are seen.
    pub fn believed_within(self, deviation: f64) -> Self {
        Self { prior: deviation, ..self }
    }

    /// Changes `model` by `x`.
    pub fn apply(&self, model: &mut Model, x: f64) {
        for (parameter, turn) in &self.turns {
            let bounds = parameter.bounds(model);
            if let Some(slot) = parameter.slot(model) {
                *slot = match turn {
                    Mode::Add(step) => *slot + x * step,
                    Mode::Scale => *slot * x.exp(),
                }
                .clamp(bounds.0, bounds.1.min(self.most).max(bounds.0));
            }
        }
    }

    /// The parameters that it turns.
    pub fn parameters(&self) -> impl Iterator<Item = ParameterRef> {
        self.turns.iter().map(|(parameter, _)| *parameter)
    }

    /// Whether it turns the model's own parameters.
    pub fn is_own(&self) -> bool {
        self.parameters().all(|parameter| !matches!(parameter, ParameterRef::Effect(..)))
    }

    /// The strength that it is per unit, where it is one of an effect that only adds torque: the effect's number, the parameter's and
    /// the unit.
    pub fn strength(&self, model: &Model) -> Option<(usize, usize, f64)> {
        let [(ParameterRef::Effect(at, index), Mode::Add(unit))] = self.turns[..] else { return None };
        (self.is_linear && model.effects[at].effect.only_adds()).then_some((at, index, unit))
    }

    /// Whether it changes where friction stands between its branches.
    pub fn changes_passage(&self, model: &Model) -> bool {
        self.parameters().any(|parameter| match parameter {
            ParameterRef::Backlash | ParameterRef::Curve => true,
            ParameterRef::Effect(at, _) => {
                let added = &model.effects[at];
                added.effect.curve(&added.parameters).is_some() || added.effect.presliding(&added.parameters).is_some()
            }
            _ => false,
        })
    }
}

impl ParameterRef {
    /// Its name where its owner is known: an effect's parameter by itself.
    pub fn own_name(self, model: &Model) -> String {
        match self {
            Self::Effect(effect, at) => model.effects[effect].effect.about().parameters[at].name.to_string(),
            _ => self.name(model),
        }
    }

    /// The range beyond which it makes no sense.
    pub fn bounds(self, model: &Model) -> (f64, f64) {
        match self {
            Self::Friction(_, Term::Load) => (-5.0, 0.95),
            Self::Backlash => (1e-9, 1e3),
            Self::Curve => (0.02, 100.0),
            Self::Effect(effect, at) => model.effects[effect].effect.about().parameters[at].bounds,
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }
}

/// Every base parameter that `model` has, free within its confidence: one move each, in standard deviations.
pub fn within_confidence(model: &Model) -> Vec<Perturbation> {
    let friction = Direction::BOTH.into_iter().flat_map(|d| Term::ALL.map(|term| ParameterRef::Friction(d, term)));
    [ParameterRef::Gravity, ParameterRef::Inertia, ParameterRef::Backlash, ParameterRef::Curve]
        .into_iter()
        .chain(friction)
        .filter(|parameter| matters(model, *parameter))
        .filter_map(|parameter| {
            let sd = deviation(model, parameter);
            (sd > 0.0).then(|| Perturbation::of(vec![(parameter, Mode::Add(sd))], 1.0, 0.1))
        })
        .collect()
}

/// Whether `parameter` is one that `model` has and that moves its prediction.
fn matters(model: &Model, parameter: ParameterRef) -> bool {
    match parameter {
        ParameterRef::Gravity | ParameterRef::Inertia => model.chain.is_none() && parameter.value(model) != 0.0,
        ParameterRef::Backlash => model.combination != Combination::Sign && model.joint.backlash_m > 0.0,
        // A rate without its amplitude does nothing.
        ParameterRef::Friction(direction, term) if term.is_rate() => !model.friction.of(direction).lacks(term),
        _ => parameter.value(model) != 0.0,
    }
}

/// Standard deviation of a base parameter. Where only a combination with others is known, its own wide interval would let it
/// wander with theirs held: it is then as if nobody had said.
fn deviation(model: &Model, parameter: ParameterRef) -> f64 {
    let unknown = UNKNOWN_SHARE * parameter.value(model).abs() / HALF_WIDTH;
    match model.confidence.get(&parameter.name(model)) {
        Some(c) if c.low.is_finite() && c.high.is_finite() => {
            let own = (c.high - c.low) / (2.0 * HALF_WIDTH);
            if c.status == crate::model::Status::Pinned { own } else { own.min(unknown) }
        }
        _ => unknown,
    }
}

/// The group that a base parameter goes stale with.
pub fn group_of(parameter: ParameterRef) -> Option<&'static Group> {
    match parameter {
        ParameterRef::Gravity => Some(&groups::GRAVITY),
        ParameterRef::Inertia => Some(&groups::INERTIA),
        ParameterRef::Backlash => Some(&groups::BACKLASH_WIDTH),
        ParameterRef::Friction(_, term) => Some(Group::of_term(term)),
        ParameterRef::Curve | ParameterRef::Effect(..) => None,
    }
}

/// How viscous friction moves where it takes Coulomb friction along: a line per direction.
pub const WHOLE_LINE: &str = "each direction by itself, with its coulomb";

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

/// The groups that `model` has.
pub fn stale(model: &Model) -> Vec<Stale> {
    let mut found = Vec::new();
    let mut add = |name, how, moves: Vec<Perturbation>| found.push(Stale { name, how, moves });
    let free =
        |turns: Vec<(ParameterRef, Mode)>| Perturbation { stride: 0.5, ..Perturbation::of(turns, f64::INFINITY, 1e-3) };
    let curved = |parameter: ParameterRef| Perturbation { is_linear: false, ..free(vec![(parameter, Mode::Scale)]) };
    let scaled = |parameter: ParameterRef| free(vec![(parameter, Mode::Add(parameter.value(model)))]);
    if matters(model, ParameterRef::Gravity) {
        add(groups::GRAVITY.name, "", vec![scaled(ParameterRef::Gravity)]);
    }
    if matters(model, ParameterRef::Inertia) {
        add(groups::INERTIA.name, "", vec![scaled(ParameterRef::Inertia)]);
    }
    if matters(model, ParameterRef::Backlash) {
        add(groups::BACKLASH_WIDTH.name, "", vec![curved(ParameterRef::Backlash)]);
    }
    let both = |term: Term| Direction::BOTH.map(|d| ParameterRef::Friction(d, term));
    let size = |term: Term| both(term).iter().map(|parameter| parameter.value(model).abs()).sum::<f64>() / 2.0;
    for term in [Term::Coulomb, Term::Viscous, Term::Load] {
        let name = Group::of_term(term).name;
        let [up, down] = both(term);
        let unit = if size(term) > 0.0 { size(term) } else { 0.1 };
        let present = |parameter: ParameterRef| parameter.value(model) != 0.0;
        if present(up) && present(down) {
            let turn = |parameter: ParameterRef| (parameter, Mode::Add(parameter.value(model)));
            add(name, "both directions alike", vec![free(vec![turn(up), turn(down)])]);
        }
        for (parameter, how) in [(up, UP_ONLY), (down, DOWN_ONLY)] {
            if present(parameter) {
                add(name, how, vec![scaled(parameter)]);
            }
        }
        if term == Term::Coulomb && present(up) && present(down) {
            add(name, SAME_TORQUE, vec![free(vec![(up, Mode::Add(unit)), (down, Mode::Add(unit))])]);
        }
        if (present(up) || present(down)) != (term == Term::Load) {
            add(
                name,
                "each direction by itself",
                vec![free(vec![(up, Mode::Add(unit))]), free(vec![(down, Mode::Add(unit))])],
            );
        }
    }
    // A model of Coulomb and viscous friction alone has a line per direction: its two numbers, fitted together, make up for each
    // other, so that neither is right where the other is not.
    let is_line = |d: Direction| AMPLITUDES.iter().all(|term| model.friction.of(d).lacks(*term));
    if Direction::BOTH.into_iter().all(is_line) && size(Term::Coulomb) > 0.0 && size(Term::Viscous) > 0.0 {
        let unit = |term: Term| both(term).map(|parameter| free(vec![(parameter, Mode::Add(size(term)))]));
        add(groups::VISCOUS.name, WHOLE_LINE, [unit(Term::Viscous), unit(Term::Coulomb)].concat());
    }
    let amplitudes: Vec<Vec<(ParameterRef, Mode)>> = Direction::BOTH
        .map(|d| {
            AMPLITUDES
                .map(|term| ParameterRef::Friction(d, term))
                .into_iter()
                .map(|k| (k, Mode::Add(k.value(model))))
                .collect()
        })
        .to_vec();
    if amplitudes.iter().flatten().any(|(parameter, _)| parameter.value(model) != 0.0) {
        add(groups::STRIBECK_LEVEL.name, "both directions alike", vec![free(amplitudes.concat())]);
        add(groups::STRIBECK_LEVEL.name, "each direction by itself", amplitudes.into_iter().map(free).collect());
    }
    found
}

/// What may be fitted of effect number `at` of `model`: its strengths and shapes.
pub fn of_effect(model: &Model, at: usize, extent: &Extent) -> Vec<Perturbation> {
    let span = |(low, high): (f64, f64)| (high - low).abs().max(f64::MIN_POSITIVE);
    let one = |(index, parameter): (usize, &Parameter)| {
        let own = ParameterRef::Effect(at, index);
        let most = model.effects[at].effect.most(index, extent);
        let move_of = |turn, is_linear, stride| Perturbation {
            is_linear,
            most,
            stride,
            ..Perturbation::of(vec![(own, turn)], f64::INFINITY, if is_linear { 1e-3 } else { 1e-4 })
        };
        match parameter.role {
            Role::Choice | Role::Form => None,
            Role::Strength => Some(move_of(Mode::Add(1.0), true, parameter.share * span(extent.torque_nm))),
            Role::Shape => Some(move_of(Mode::Scale, false, 0.7)),
            Role::Position => Some(move_of(Mode::Add(span(extent.position_rad)), false, 0.1)),
            Role::Level => Some(move_of(Mode::Add(span(extent.torque_nm)), false, 0.1)),
        }
    };
    let Added { effect, parameters } = &model.effects[at];
    let used = |(index, _): &(usize, &Parameter)| effect.uses(parameters, *index);
    effect.about().parameters.iter().enumerate().filter(used).filter_map(one).collect()
}
