//! An effect that a model has, with its parameters; effects by their names.

use super::{Along, Effect, Evaluated, LIBRARY, Parameter, Role, contact};

/// The effect called `id`.
pub fn find(id: &str) -> Option<&'static dyn Effect> {
    LIBRARY.into_iter().find(|effect| effect.about().id == id)
}

/// The effect of bursts from outside, which are found by their not being repeated.
pub const CONTACT: &str = contact::ID;

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
    pub fn hooks<'e>(&'e self) -> &'e (dyn Along<S> + 'e)
    where
        S: 'e,
    {
        S::hooks(self.effect)
    }
}

impl Added {
    /// Whether it does nothing yet: it has strengths, and all of them are 0.
    pub fn is_idle(&self) -> bool {
        let mut strengths = self.named().filter(|(parameter, _)| parameter.role == Role::Strength).peekable();
        strengths.peek().is_some() && strengths.all(|(_, x)| x == 0.0)
    }

    /// Parameters with their names.
    pub fn named(&self) -> impl Iterator<Item = (&'static Parameter, f64)> {
        self.effect.about().parameters.iter().zip(self.parameters.iter().copied())
    }
}
