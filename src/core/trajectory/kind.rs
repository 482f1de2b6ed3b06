//! What a motion is for.

/// How the joint is moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Protocol {
    /// Sweeps back and forth at one speed.
    Uniform {
        /// The speed, rad/s (m/s for a prismatic joint); positive.
        speed_rad_s: f64,
    },
    /// Cascaded cosines.
    Cosine,
    /// A person or an obstacle acts on the joint.
    Interaction,
    /// Anything else.
    Free,
}

impl Protocol {
    /// The declared speed of a sweep, rad/s; `None` for other protocols.
    pub fn speed_rad_s(self) -> Option<f64> {
        match self {
            Self::Uniform { speed_rad_s } => Some(speed_rad_s),
            _ => None,
        }
    }

    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform { .. } => "uniform",
            Self::Cosine => "cosine",
            Self::Interaction => "interaction",
            Self::Free => "free",
        }
    }
}
