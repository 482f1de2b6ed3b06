//! A and B(v) with what the data know of them: what stays known where the parameters of (19) trade off.

use super::friction::FrictionFit;
use super::predicted::Prepared;
use super::whole::WholeFit;
use crate::model::{Both, BranchFunctions, Direction, Functions, Level, Model};
use crate::numerics::statistics::{HALF_WIDTH, quantile};

/// Speeds at which B of free motion is told, as quantiles of the speeds that occur: (19) is a line over most of them.
const QUANTILES: [f64; 2] = [0.25, 0.9];
/// Step of a derivative by difference, as a share of the parameter's standard error.
const STEP: f64 = 1e-3;

/// Of sweeps: the legs' own means, whatever form of (19) the model takes.
pub(super) fn of_sweeps(fits: &Both<FrictionFit>) -> Functions {
    Functions { branches: Both::make(|direction| Some(of_legs(fits.of(direction)))) }
}

fn of_legs(fit: &FrictionFit) -> BranchFunctions {
    let largest = fit.forms.iter().rev().find(|form| form.freedom() >= 1.0).unwrap_or(&fit.taken);
    BranchFunctions {
        a_nm: fit.a.a_nm,
        a_se_nm: if fit.a.fixed { f64::INFINITY } else { fit.a.half_width_nm / HALF_WIDTH },
        levels: fit.points.means(largest).collect(),
        common_se_nm: fit.b_common_se_nm,
    }
}

/// Of free motion: (18) and (19) of the fit, their errors to first order in those of its parameters.
pub(super) fn of_free_motion(fit: &WholeFit, trials: &[Prepared]) -> Functions {
    let branch = |direction: Direction| {
        let moving = |v: &&f64| **v * direction.sign() > 0.0;
        let speeds = trials.iter().flat_map(|trial| trial.series.velocity_rad_s.iter().filter(moving).map(|v| v.abs()));
        let mut speeds: Vec<f64> = speeds.collect();
        if speeds.is_empty() {
            return None;
        }
        let at = QUANTILES.map(|share| quantile(&mut speeds, share));
        let of_b = |speed_rad_s: f64| move |model: &Model| model.b_nm(direction, speed_rad_s);
        let [slow, fast] = at.map(|speed| gradient(fit, &of_b(speed)));
        let shared = covariance(fit, &slow, &fast).max(0.0).sqrt();
        let level = |speed_rad_s: f64, slopes: &[f64]| Level {
            speed_rad_s,
            b_nm: of_b(speed_rad_s)(&fit.model),
            se_nm: (covariance(fit, slopes, slopes) - shared * shared).max(0.0).sqrt(),
        };
        let of_a = |model: &Model| {
            model.joint.transmission() * model.dynamics.gravity_nm / (1.0 - model.friction.of(direction).mu_c)
        };
        let by_a = gradient(fit, &of_a);
        let a_se_nm = covariance(fit, &by_a, &by_a).sqrt();
        Some(BranchFunctions {
            a_nm: of_a(&fit.model),
            a_se_nm: if a_se_nm > 0.0 { a_se_nm } else { f64::INFINITY },
            levels: vec![level(at[0], &slow), level(at[1], &fast)],
            common_se_nm: shared,
        })
    };
    Functions { branches: Both::make(branch) }
}

/// Derivatives of `quantity` by the free parameters of `fit` as they move.
fn gradient(fit: &WholeFit, quantity: &dyn Fn(&Model) -> f64) -> Vec<f64> {
    let slope = |(i, free): (usize, &super::moving::Free)| {
        let at = free.read(&fit.model);
        let step = STEP * fit.covariance[(i, i)].sqrt().max(1e-6 * at.abs()).max(f64::MIN_POSITIVE);
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

/// Covariance of two quantities with these derivatives; infinite where one rests on what the data do not tell.
fn covariance(fit: &WholeFit, a: &[f64], b: &[f64]) -> f64 {
    let n = a.len();
    let term = |(i, j): (usize, usize)| match a[i] * b[j] {
        0.0 => 0.0,
        product => product * fit.covariance[(i, j)],
    };
    let sum: f64 = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(term).sum();
    if sum.is_nan() { f64::INFINITY } else { sum }
}
