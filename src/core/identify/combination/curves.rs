//! The four curves, and what a fit of one says.

use crate::model::Combination;
use crate::numerics::scalar::Scalar;

/// Range of p searched: from nearly a straight line to nearly a step.
const P_RANGE: (f64, f64) = (0.02, 100.0);
/// Range of n searched, likewise.
const N_RANGE: (f64, f64) = (0.02, 10.0);

/// A curve without its parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveKind {
    /// (20).
    Sign,
    /// (25).
    Linear,
    /// (29).
    Arctan,
    /// (30).
    Power,
}

impl CurveKind {
    /// All, the simplest first.
    pub const ALL: [Self; 4] = [Self::Sign, Self::Linear, Self::Arctan, Self::Power];

    /// The name used in files.
    pub fn name(self) -> &'static str {
        self.with(1.0).name()
    }

    /// The kind of `curve`.
    pub fn of(curve: &Combination) -> Self {
        match curve {
            Combination::Sign => Self::Sign,
            Combination::Linear => Self::Linear,
            Combination::Arctan { .. } => Self::Arctan,
            Combination::Power { .. } => Self::Power,
        }
    }

    /// The curve with its parameter, p or n, if it has one.
    pub fn with<S: Scalar>(self, parameter: S) -> Combination<S> {
        match self {
            Self::Sign => Combination::Sign,
            Self::Linear => Combination::Linear,
            Self::Arctan => Combination::arctan(parameter),
            Self::Power => Combination::Power { n: parameter },
        }
    }

    /// The range of the parameter; `None` for a curve without.
    pub fn range(self) -> Option<(f64, f64)> {
        match self {
            Self::Sign | Self::Linear => None,
            Self::Arctan => Some(P_RANGE),
            Self::Power => Some(N_RANGE),
        }
    }
}

/// One curve's fit.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveFit {
    /// Which.
    pub kind: CurveKind,
    /// With its parameter.
    pub curve: Combination,
    /// X_cl it was fitted with, m.
    pub backlash_m: f64,
    /// Residual on the samples that `CombinationFit::judged_on` names, N m.
    pub rmse_nm: f64,
    /// Share of those samples' variance that is explained.
    pub r_squared: f64,
}
