//! Levenberg-Marquardt within bounds, with covariance.
//!
//! The crate's algorithm (MINPACK's) knows no bounds: each bounded parameter x in [low, high] is searched as the angle u of
//! x = low + (high - low) (1 + sin u) / 2, which cannot leave them. At a bound the slope of x(u) vanishes, so a start is
//! moved a little inside; and the covariance is taken in x, where it means something.

use super::rank::Shown;
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt, TerminationReason};
use nalgebra::{DMatrix, DVector, Dyn, Owned};

/// A start is kept this share of the range away from its bounds.
const INSIDE: f64 = 1e-3;
/// A result within this share of the range from a bound counts as at it.
const AT_BOUND: f64 = 1e-4;

/// Residuals of a parameter vector and, when asked, their Jacobian (one column for each parameter).
pub trait Residuals {
    /// The residuals at `parameters`.
    fn residuals(&self, parameters: &[f64]) -> DVector<f64>;
    /// Their derivatives at `parameters`, rows residuals, columns parameters.
    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64>;
}

/// How a fit stopped.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stopped {
    /// Neither cost nor parameters would change further.
    Converged,
    /// The number of evaluations ran out.
    OutOfPatience,
    /// The residuals were not finite, or the algorithm gave up.
    Failed,
}

impl Stopped {
    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::OutOfPatience => "out_of_patience",
            Self::Failed => "failed",
        }
    }
}

/// A minimum found.
#[derive(Debug, Clone)]
pub struct Minimum {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// Sum of squared residuals there.
    pub residual_sum: f64,
    /// Number of residuals.
    pub residual_count: usize,
    /// (J' J)^-1 over the parameters that are not at a bound; NaN elsewhere and of those that J does not tell apart.
    pub unscaled_covariance: DMatrix<f64>,
    /// Which parameters ended at a bound.
    pub at_bound: Vec<bool>,
    /// How it stopped.
    pub stopped: Stopped,
    /// Residual evaluations used.
    pub evaluations: usize,
}

/// Searches from `start` within `bounds` (low, high, both finite, low < high); at most `patience` times the number of
/// parameters evaluations, to the relative tolerance `tolerance` in cost and parameters.
pub fn minimise(
    problem: &impl Residuals,
    start: &[f64],
    bounds: &[(f64, f64)],
    patience: usize,
    tolerance: f64,
) -> Minimum {
    let angles = DVector::from_iterator(start.len(), start.iter().zip(bounds).map(|(x, b)| angle(*x, *b)));
    let search = Search { problem, bounds, angles };
    let (search, report) =
        LevenbergMarquardt::new().with_patience(patience.max(1)).with_tol(tolerance).minimize(search);
    let stopped = match report.termination {
        TerminationReason::LostPatience => Stopped::OutOfPatience,
        reason if reason.was_successful() => Stopped::Converged,
        // The tolerance is finer than rounding allows: as converged as numbers permit.
        TerminationReason::NoImprovementPossible(_) => Stopped::Converged,
        _ => Stopped::Failed,
    };
    finish(problem, bounds, search.inside(), stopped, report.number_of_evaluations)
}

fn finish(
    problem: &impl Residuals,
    bounds: &[(f64, f64)],
    mut parameters: Vec<f64>,
    stopped: Stopped,
    evaluations: usize,
) -> Minimum {
    let mut at_bound = vec![false; parameters.len()];
    for ((x, (low, high)), at) in parameters.iter_mut().zip(bounds).zip(&mut at_bound) {
        let near = if *x - low < high - *x { *low } else { *high };
        *at = (*x - near).abs() <= AT_BOUND * (high - low);
        // The search only nears a bound; what it meant is the bound itself.
        *x = if *at { near } else { *x };
    }
    let residuals = problem.residuals(&parameters);
    let unscaled_covariance = unscaled_covariance(&problem.jacobian(&parameters), &at_bound);
    Minimum {
        residual_sum: residuals.norm_squared(),
        residual_count: residuals.len(),
        unscaled_covariance,
        parameters,
        at_bound,
        stopped,
        evaluations,
    }
}

/// (J' J)^-1 over the columns that are not `held` and that J shows, NaN in the others.
fn unscaled_covariance(jacobian: &DMatrix<f64>, held: &[bool]) -> DMatrix<f64> {
    let n = held.len();
    let mut out = DMatrix::from_element(n, n, f64::NAN);
    let free: Vec<usize> = (0..n).filter(|i| !held[*i]).collect();
    let shown = Shown::new(&jacobian.select_columns(&free));
    let shows = |i: usize| shown.shows_parameter(i);
    for (i, a) in free.iter().enumerate().filter(|(i, _)| shows(*i)) {
        for (j, b) in free.iter().enumerate().filter(|(j, _)| shows(*j)) {
            out[(*a, *b)] = shown.inverse()[(i, j)];
        }
    }
    out
}

fn angle(x: f64, (low, high): (f64, f64)) -> f64 {
    let share = ((x - low) / (high - low)).clamp(INSIDE, 1.0 - INSIDE);
    (2.0 * share - 1.0).asin()
}

struct Search<'a, P> {
    problem: &'a P,
    bounds: &'a [(f64, f64)],
    angles: DVector<f64>,
}

impl<P> Search<'_, P> {
    fn inside(&self) -> Vec<f64> {
        let at = |(u, (low, high)): (&f64, &(f64, f64))| low + (high - low) * (1.0 + u.sin()) / 2.0;
        self.angles.iter().zip(self.bounds).map(at).collect()
    }
}

impl<P: Residuals> LeastSquaresProblem<f64, Dyn, Dyn> for Search<'_, P> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, angles: &DVector<f64>) {
        self.angles.copy_from(angles);
    }

    fn params(&self) -> DVector<f64> {
        self.angles.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.problem.residuals(&self.inside()))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let mut jacobian = self.problem.jacobian(&self.inside());
        for ((mut column, u), (low, high)) in jacobian.column_iter_mut().zip(self.angles.iter()).zip(self.bounds) {
            column *= (high - low) / 2.0 * u.cos();
        }
        Some(jacobian)
    }
}
