//! An effect that a model has, with its parameters; effects by their names.

use super::{Effect, Evaluated, Hooks, LIBRARY, Parameter, contact, elastic_spring};

/// The effect called `id`.
pub fn find(id: &str) -> Option<&'static dyn Effect> {
    LIBRARY.into_iter().find(|effect| effect.about().id == id)
}

/// The effect of bursts from outside, which are found by their not being repeated.
pub const CONTACT: &str = contact::ID;

/// What adds `torque_nm` at the joint everywhere: a load that no column records.
pub fn constant_load(torque_nm: f64) -> Added {
    Added { effect: &elastic_spring::ElasticSpring, parameters: elastic_spring::preload(torque_nm) }
}

/// An effect that a model has, with its parameters in the order of its list.
#[derive(Debug, Clone)]
pub struct Added<S = f64> {
    /// Which one.
    pub effect: &'static dyn Effect,
    /// In SI.
    pub parameters: Vec<S>,
}

impl<S: PartialEq> PartialEq for Added<S> {
    fn eq(&self, other: &Self) -> bool {
        self.id() == other.id() && self.parameters == other.parameters
    }
}

impl<S> Added<S> {
    /// The effect's name in files.
    pub fn id(&self) -> &'static str {
        self.effect.about().id
    }
}

impl<S: Evaluated> Added<S> {
    /// Its physics, for this kind of number.
    pub fn hooks<'e>(&'e self) -> &'e (dyn Hooks<S> + 'e)
    where
        S: 'e,
    {
        S::hooks(self.effect)
    }
}

impl Added {
    /// Parameters with their names.
    pub fn named(&self) -> impl Iterator<Item = (&'static Parameter, f64)> {
        self.effect.about().parameters.iter().zip(self.parameters.iter().copied())
    }
}
