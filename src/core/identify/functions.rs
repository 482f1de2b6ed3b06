//! A and B(v) with what the data know of them: what stays known where the parameters of (19) trade off.

use super::friction::FrictionFit;
use super::predicted::Prepared;
use super::whole::WholeFit;
use crate::model::{Both, BranchFunctions, Direction, Functions, Level, Model, SharedError};
use crate::numerics::statistics::{HALF_WIDTH, quantile};
use nalgebra::DMatrix;

/// Speeds at which B of free motion is reported, as quantiles of the recorded speeds: (19) is a straight line over most of them.
const QUANTILES: [f64; 2] = [0.25, 0.9];
/// Step of a derivative by difference, as a share of the parameter's standard error.
const STEP: f64 = 1e-3;

/// Of sweeps: the legs' own means, whatever form of (19) the model takes.
pub(super) fn of_sweeps(fits: &Both<FrictionFit>) -> Functions {
    Functions { branches: Both::make(|direction| Some(of_legs(fits.of(direction)))) }
}

fn of_legs(fit: &FrictionFit) -> BranchFunctions {
    let largest = fit.forms.iter().rev().find(|form| form.freedom() >= 1.0).unwrap_or(&fit.taken);
    let a_se_nm = if fit.a.fixed { f64::INFINITY } else { fit.a.half_width_nm / HALF_WIDTH };
    // A has an error of its own in each direction, the zero one in both.
    let [own, zero] = fit.shared;
    let none = SharedError::default();
    let errors = match fit.direction {
        Direction::Up => vec![own, none, zero],
        Direction::Down => vec![none, own, zero],
    };
    BranchFunctions {
        a_nm: fit.a.a_nm,
        a_se_nm,
        levels: fit.points.means(largest).collect(),
        common_se_nm: own.b_nm.hypot(zero.b_nm),
        errors: of_size(errors, a_se_nm),
    }
}

/// `errors` with those of A together as large as `a_se_nm`, which may count in how few data told their size.
fn of_size(mut errors: Vec<SharedError>, a_se_nm: f64) -> Vec<SharedError> {
    let norm_nm = errors.iter().map(|error| error.a_nm.powi(2)).sum::<f64>().sqrt();
    let scale = if norm_nm > 0.0 && a_se_nm.is_finite() { a_se_nm / norm_nm } else { 1.0 };
    errors.iter_mut().for_each(|error| error.a_nm *= scale);
    errors
}

/// Of free motion: (18) and (19) of the fit, their errors to first order in those of its parameters.
pub(super) fn of_free_motion(fit: &WholeFit, trials: &[Prepared]) -> Functions {
    let branches = Both::make(|direction| Branch::new(fit, trials, direction));
    let slopes: Vec<&Vec<f64>> =
        Direction::BOTH.iter().filter_map(|d| branches.of(*d).as_ref()).flat_map(|of| [&of.by_a, &of.by_b]).collect();
    let covariance = DMatrix::from_fn(slopes.len(), slopes.len(), |i, j| fit.together.covariance(slopes[i], slopes[j]));
    let sources = sources(covariance);
    let mut rows = sources.row_iter();
    let functions = Both::make(|direction| {
        let of = branches.of(direction).as_ref()?;
        let (a, b) = (rows.next()?, rows.next()?);
        // The levels share less than what B in their middle does, whose size tells the sources apart.
        let norm_nm = b.norm();
        let share = if norm_nm > 0.0 { of.functions.common_se_nm / norm_nm } else { 0.0 };
        let error = |(a_nm, b_nm): (&f64, &f64)| SharedError { a_nm: *a_nm, b_nm: share * b_nm };
        let errors = a.iter().zip(b.iter()).map(error).collect();
        Some(BranchFunctions { errors, ..of.functions.clone() })
    });
    Functions { branches: functions }
}

/// Rows of independent sources, one column each, whose products are `covariance`; 0 of what is open.
fn sources(mut covariance: DMatrix<f64>) -> DMatrix<f64> {
    let n = covariance.nrows();
    for i in (0..n).filter(|i| !covariance[(*i, *i)].is_finite()).collect::<Vec<usize>>() {
        covariance.row_mut(i).fill(0.0);
        covariance.column_mut(i).fill(0.0);
    }
    let parts = covariance.symmetric_eigen();
    let size = parts.eigenvalues.map(|of| of.max(0.0).sqrt());
    parts.eigenvectors * DMatrix::from_diagonal(&size)
}

/// A and B of one direction of free motion, with the derivatives of A and of B in the middle of its levels.
struct Branch {
    functions: BranchFunctions,
    by_a: Vec<f64>,
    by_b: Vec<f64>,
}

impl Branch {
    /// `None` where nothing moves in `direction`.
    fn new(fit: &WholeFit, trials: &[Prepared], direction: Direction) -> Option<Self> {
        let moving = |v: &&f64| **v * direction.sign() > 0.0;
        let speeds = trials.iter().flat_map(|trial| trial.series.velocity_rad_s.iter().filter(moving).map(|v| v.abs()));
        let mut speeds: Vec<f64> = speeds.collect();
        if speeds.is_empty() {
            return None;
        }
        let at = QUANTILES.map(|share| quantile(&mut speeds, share));
        let of_b = |speed_rad_s: f64| move |model: &Model| model.b_nm(direction, speed_rad_s);
        let [slow, fast] = at.map(|speed| gradient(fit, &of_b(speed)));
        let variance = |of: &[f64]| fit.together.covariance(of, of);
        // What they share is no more than either has.
        let shared = fit.together.covariance(&slow, &fast).min(variance(&slow)).min(variance(&fast)).max(0.0);
        let level = |speed_rad_s: f64, slopes: &[f64]| Level {
            speed_rad_s,
            b_nm: of_b(speed_rad_s)(&fit.model),
            se_nm: if shared.is_finite() { (variance(slopes) - shared).max(0.0).sqrt() } else { f64::INFINITY },
        };
        let of_a = |model: &Model| {
            model.joint.transmission() * model.dynamics.gravity_nm / (1.0 - model.friction.of(direction).mu_c)
        };
        let by_a = gradient(fit, &of_a);
        let a_se_nm = variance(&by_a).sqrt();
        let functions = BranchFunctions {
            a_nm: of_a(&fit.model),
            a_se_nm: if a_se_nm > 0.0 { a_se_nm } else { f64::INFINITY },
            levels: vec![level(at[0], &slow), level(at[1], &fast)],
            common_se_nm: shared.sqrt(),
            errors: Vec::new(),
        };
        let by_b = slow.iter().zip(&fast).map(|(slow, fast)| (slow + fast) / 2.0).collect();
        Some(Self { functions, by_a, by_b })
    }
}

/// Derivatives of `quantity` by the free parameters of `fit` as they move.
fn gradient(fit: &WholeFit, quantity: &dyn Fn(&Model) -> f64) -> Vec<f64> {
    let slope = |(i, free): (usize, &super::moving::Free)| {
        let at = free.read(&fit.model);
        let step = STEP * fit.together.se(i).max(1e-6 * at.abs()).max(f64::MIN_POSITIVE);
        let moved = |by: f64| {
            let mut model = fit.model.clone();
            free.write(&mut model, at + by);
            quantity(&model)
        };
        let slope = (moved(step) - moved(-step)) / (2.0 * step);
        if slope.is_finite() { slope } else { 0.0 }
    };
    fit.free.iter().enumerate().map(slope).collect()
}
