//! One direction's points B(v) with all the forms that they can hold, before one is taken.

use super::legs::Amplitude;
use super::scale::Scale;
use super::stribeck::{ExponentialFit, Points};
use crate::model::{Direction, Friction};

/// One direction with all its forms, none taken yet.
pub struct Branch {
    /// The direction.
    pub direction: Direction,
    /// Its amplitude A.
    pub a: Amplitude,
    /// What makes parameters of a form.
    pub scale: Scale,
    /// Of B(v).
    pub points: Points,
    /// All that the speeds can hold, the smallest first; never empty.
    pub forms: Vec<ExponentialFit>,
    /// How many exponentials the data support.
    pub supported: usize,
    /// How many exponentials are asked for.
    pub wanted: usize,
}

impl Branch {
    /// The parameters of `form`.
    pub fn friction(&self, form: &ExponentialFit) -> Friction {
        self.scale.friction(form)
    }
}
