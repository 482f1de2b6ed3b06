//! What may be answered.

use super::candidates::Cause;

/// What kind of answer it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Nothing above the floor, beyond what the model's confidence allows.
    None,
    /// The model's own parameters, refitted, close the gap.
    Stale,
    /// One effect.
    Effect,
    /// Several causes.
    Several,
    /// Causes that these data cannot tell apart.
    Ambiguous,
    /// A gap that nothing in the library closes.
    Unknown,
}

impl Kind {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Stale => "stale_parameters",
            Self::Effect => "effect",
            Self::Several => "several",
            Self::Ambiguous => "ambiguous",
            Self::Unknown => "unknown",
        }
    }
}

/// Whether the formulas of the named causes fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// They leave nothing material of what can be explained.
    Fits,
    /// The causes are named rightly as far as can be told; their formulas leave a material part.
    Approximate,
}

impl Form {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fits => "fits",
            Self::Approximate => "approximate",
        }
    }
}

/// An answer that has a probability.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// These causes; none of them where nothing is missing.
    Causes(Vec<Cause>),
    /// Something outside the library.
    Outside,
    /// Anything else.
    Other,
}
