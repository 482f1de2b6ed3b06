//! One number of a model: where it stands, what it is called, what it may be.

use crate::dynamics::{Direction, INERTIA, Payload};
use crate::model::{Combination, Model, Term};

/// One number of a model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterRef {
    Gravity,
    Inertia,
    /// A number of what a chain's last link carries.
    Payload(usize),
    Backlash,
    Curve,
    Friction(Direction, Term),
    Effect(usize, usize),
}

impl ParameterRef {
    /// Where it stands in `model`; nowhere where that has none.
    pub(super) fn slot<S>(self, model: &mut Model<S>) -> Option<&mut S> {
        match self {
            Self::Gravity => Some(&mut model.dynamics.gravity_nm),
            Self::Inertia => Some(&mut model.dynamics.inertia_kg_m2),
            Self::Payload(at) => model.dynamics.payload.number_mut(at),
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
            Self::Payload(at) => format!("dynamics.payload.{}", Payload::<f64>::NAMES[at]),
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
            Self::Inertia => (0.0, f64::INFINITY),
            // Only a link that the URDF has too heavy loses inertia.
            Self::Payload(INERTIA) if model.dynamics.payload.mass_kg >= 0.0 => (0.0, f64::INFINITY),
            Self::Backlash => (1e-9, 1e3),
            Self::Curve => (0.02, 100.0),
            Self::Effect(effect, at) => model.effects[effect].effect.about().parameters[at].bounds,
            _ => (f64::NEG_INFINITY, f64::INFINITY),
        }
    }
}
