//! Ways in which a model may be changed: each a number that is 0 where the model stays as it is.
//!
//! Base parameters move in units of their confidence; groups of them move together, as a stale calibration would; effects move
//! by their strengths and shapes.

use super::parameter_ref::ParameterRef;
use crate::dynamics::Direction;
use crate::effects::{Added, Extent, Parameter, Role};
use crate::model::{Combination, Model, Term};
use crate::numerics::dual::Dual;
use crate::numerics::statistics::HALF_WIDTH;

/// Confidence of a parameter for which none is given, as a share of it: the 95 % interval reaches so far to either side.
const UNKNOWN_SHARE: f64 = 0.05;

/// How a parameter changes with the number of its perturbation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Mode {
    /// value + x step
    Add(f64),
    /// value exp(x)
    Scale,
}

/// One way to change a model: parameters that turn together.
#[derive(Debug, Clone, PartialEq)]
pub struct Perturbation {
    pub(super) turns: Vec<(ParameterRef, Mode)>,
    /// Standard deviation of the number before any data are seen; infinite where only data decide.
    pub prior: f64,
    /// The largest change of the number in one step.
    pub stride: f64,
    /// Limits of its parameters, beside their bounds.
    pub limits: (f64, f64),
    /// Whether the prediction is in proportion to it, or nearly so.
    pub is_linear: bool,
}

impl Perturbation {
    pub(super) fn of(turns: Vec<(ParameterRef, Mode)>, prior: f64) -> Self {
        Self { turns, prior, stride: f64::INFINITY, limits: (f64::NEG_INFINITY, f64::INFINITY), is_linear: true }
    }

    /// The same with a prior standard deviation of `deviation`.
    pub fn believed_within(self, deviation: f64) -> Self {
        Self { prior: deviation, ..self }
    }

    /// Changes `model` by `x`.
    pub fn apply(&self, model: &mut Model, x: f64) {
        for (parameter, turn) in &self.turns {
            let (low, high) = self.range(*parameter, model);
            if let Some(slot) = parameter.slot(model) {
                *slot = match turn {
                    Mode::Add(step) => *slot + x * step,
                    Mode::Scale => *slot * x.exp(),
                }
                .clamp(low, high.max(low));
            }
        }
    }

    /// Whether all that it turns is at its bound in `model` where `x` would lead beyond.
    pub fn is_stopped(&self, model: &Model, x: f64) -> bool {
        let mut moved = model.clone();
        self.apply(&mut moved, x);
        let is_still = |parameter: ParameterRef| parameter.value(&moved) == parameter.value(model);
        x != 0.0 && self.parameters().all(is_still)
    }

    /// `model` as a function of `ways`, at most [`crate::numerics::dual::VARIABLES`] of them: the variables of its numbers.
    pub fn varied(model: &Model, ways: &[Self]) -> Model<Dual> {
        let mut varied = model.over::<Dual>();
        for (variable, way) in ways.iter().enumerate() {
            for (parameter, turn) in &way.turns {
                if let Some(slot) = parameter.slot(&mut varied) {
                    slot.slopes[variable] += match turn {
                        Mode::Add(step) => *step,
                        Mode::Scale => slot.value,
                    };
                }
            }
        }
        varied
    }

    /// Within what it keeps `parameter`.
    pub fn range(&self, parameter: ParameterRef, model: &Model) -> (f64, f64) {
        let (low, high) = parameter.bounds(model);
        (low.max(self.limits.0), high.min(self.limits.1))
    }

    /// The parameters that it turns.
    pub fn parameters(&self) -> impl Iterator<Item = ParameterRef> {
        self.turns.iter().map(|(parameter, _)| *parameter)
    }

    /// Whether it turns the model's own parameters.
    pub fn is_own(&self) -> bool {
        self.parameters().all(|parameter| !matches!(parameter, ParameterRef::Effect(..)))
    }

    /// The number of the effect of which it turns a parameter, where all that the effect does is to add torque. Its columns are then those
    /// of that torque; other effects that act on the torque in turn (a delay, friction that grows with the load) are left out of them.
    pub fn only_adds(&self, model: &Model) -> Option<usize> {
        let [(ParameterRef::Effect(at, _), _)] = self.turns[..] else { return None };
        model.effects[at].effect.only_adds().then_some(at)
    }

    /// Whether it changes the friction of the branches.
    pub fn changes_branches(&self) -> bool {
        self.parameters().any(|parameter| matches!(parameter, ParameterRef::Friction(_, term) if term != Term::Load))
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

/// Every base parameter that `model` has, free within its confidence: one move each, in standard deviations.
pub fn within_confidence(model: &Model) -> Vec<Perturbation> {
    let friction = Direction::BOTH.into_iter().flat_map(|d| Term::ALL.map(|term| ParameterRef::Friction(d, term)));
    [ParameterRef::Gravity, ParameterRef::Inertia, ParameterRef::Backlash, ParameterRef::Curve]
        .into_iter()
        .chain(friction)
        .filter(|parameter| matters(model, *parameter))
        .filter_map(|parameter| {
            let sd = deviation(model, parameter);
            (sd > 0.0).then(|| Perturbation::of(vec![(parameter, Mode::Add(sd))], 1.0))
        })
        .collect()
}

/// Whether `parameter` is one that `model` has and that moves its prediction.
pub(super) fn matters(model: &Model, parameter: ParameterRef) -> bool {
    match parameter {
        ParameterRef::Gravity | ParameterRef::Inertia => model.chain.is_none() && parameter.value(model) != 0.0,
        ParameterRef::Backlash => model.combination != Combination::Sign && model.joint.backlash_m > 0.0,
        // A rate without its amplitude does nothing.
        ParameterRef::Friction(direction, term) if term.is_rate() => !model.friction.of(direction).lacks(term),
        _ => parameter.value(model) != 0.0,
    }
}

/// Standard deviation of a base parameter. Where only a combination with others is known, its own wide interval would leave it nearly free
/// while the others are held: the default for a parameter without an interval is used instead.
/// Terms of a branch may cancel each other, so none of them moves by more than that share of friction where the joint sets out.
fn deviation(model: &Model, parameter: ParameterRef) -> f64 {
    let size = match parameter {
        ParameterRef::Friction(direction, Term::Coulomb | Term::CableStribeck | Term::JointStribeck) => {
            let friction = model.friction.of(direction);
            parameter.value(model).abs().min((friction.a_j + friction.b_c + friction.b_j).abs())
        }
        _ => parameter.value(model).abs(),
    };
    let unknown = UNKNOWN_SHARE * size / HALF_WIDTH;
    match model.confidence.get(&parameter.name(model)) {
        Some(c) if c.low.is_finite() && c.high.is_finite() => {
            let own = (c.high - c.low) / (2.0 * HALF_WIDTH);
            if c.status == crate::model::Status::Pinned { own } else { own.min(unknown) }
        }
        _ => unknown,
    }
}

/// What may be fitted of effect number `at` of `model`: its strengths and shapes.
pub fn of_effect(model: &Model, at: usize, extent: &Extent) -> Vec<Perturbation> {
    let span = |(low, high): (f64, f64)| (high - low).abs().max(f64::MIN_POSITIVE);
    let one = |(index, parameter): (usize, &Parameter)| {
        let own = ParameterRef::Effect(at, index);
        let limits = model.effects[at].effect.limits(index, extent);
        let move_of = |turn, is_linear, stride| Perturbation {
            is_linear,
            limits,
            stride,
            ..Perturbation::of(vec![(own, turn)], f64::INFINITY)
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
