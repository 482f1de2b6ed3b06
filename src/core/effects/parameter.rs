//! Parameters of effects: how each enters, within which range.

/// How a parameter enters the prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// In proportion, or nearly so; at 0 the effect is absent.
    Strength,
    /// Above 0, it decides how the effect acts: searched in its logarithm.
    Shape,
    /// A position at which the effect acts: searched along the joint's range.
    Position,
    /// A torque at which the effect acts: searched along the reading's range.
    Level,
    /// It selects, and is neither fitted nor has it an interval: which joint, which clock.
    Choice,
    /// It selects a form of the effect, like a choice; 0 is the default.
    Form,
}

/// One parameter of an effect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Its name in files; the unit stands in it.
    pub name: &'static str,
    /// How it enters.
    pub role: Role,
    /// The range beyond which it makes no sense.
    pub bounds: (f64, f64),
    /// Prior scale, as a share of the torque's range; infinite where there is none.
    pub share: f64,
    /// Its default; `None` where it must be given.
    pub default: Option<f64>,
    /// Whether the effect would be another one where it is negative.
    pub is_positive: bool,
}

impl Parameter {
    /// Whether it may be `value`.
    pub fn allows(&self, value: f64) -> bool {
        (self.bounds.0..=self.bounds.1).contains(&value)
    }

    pub(super) const fn strength(name: &'static str) -> Self {
        Self { role: Role::Strength, default: Some(0.0), ..Self::choice(name, -1e9, 1e9) }
    }

    /// A strength that makes another effect where it is negative.
    pub(super) const fn positive_strength(name: &'static str) -> Self {
        Self { is_positive: true, ..Self::strength(name) }
    }

    /// One of many strengths that together describe a curve.
    pub(super) const fn wave(name: &'static str, share: f64) -> Self {
        Self { share, ..Self::strength(name) }
    }

    pub(super) const fn shape(name: &'static str, low: f64, high: f64) -> Self {
        Self { role: Role::Shape, ..Self::choice(name, low, high) }
    }

    pub(super) const fn placed(name: &'static str, role: Role, limit: f64) -> Self {
        Self { role, ..Self::choice(name, -limit, limit) }
    }

    pub(super) const fn form(name: &'static str, high: f64) -> Self {
        Self { role: Role::Form, default: Some(0.0), ..Self::choice(name, 0.0, high) }
    }

    pub(super) const fn choice(name: &'static str, low: f64, high: f64) -> Self {
        Self { name, role: Role::Choice, bounds: (low, high), share: f64::INFINITY, default: None, is_positive: false }
    }

    pub(super) const fn or(self, default: f64) -> Self {
        Self { default: Some(default), ..self }
    }
}
