//! `--refine`: all parameters together on the whole series, from the protocol's result, judged on trials it did not see.

use super::moving::{Free, Limits};
use super::predicted::Prepared;
use super::whole::{Part, WholeFit, fit_whole, rmse_nm, square_sums};
use crate::model::{Combination, Direction, Friction, Model};
use crate::numerics::statistics::{mean, standard_deviation};

/// What refining gained.
#[derive(Debug, Clone)]
pub struct Refinement {
    /// RMSE of the protocol's model over all trials, N m.
    pub before_nm: f64,
    /// RMSE of refined models, each on the trials that its fit did not see, N m.
    pub after_nm: f64,
    /// Whether the gain exceeds its own standard error over trials; else the protocol's result is kept.
    pub gained: bool,
    /// The fit on all trials.
    pub fit: WholeFit,
}

/// Refines `model` on `trials`; `fold` says which half each trial belongs to.
pub fn refine(trials: &[Prepared], folds: &[usize], model: &Model, lowpass_hz: f64) -> Refinement {
    let free = free_parameters(model);
    let parts: Vec<Part> =
        trials.iter().map(|trial| Part::new(trial, 0..trial.len(), model.joint.backlash_rad(), lowpass_hz)).collect();
    let limits = Limits::new(trials, model);
    let before = square_sums(&parts, model);
    let mut after = before.clone();
    for fold in 0..2 {
        let of = |wanted: bool| -> Vec<Part> {
            parts.iter().zip(folds).filter(|(_, f)| (**f == fold) == wanted).map(|(p, _)| p.clone()).collect()
        };
        let fit = fit_whole(&of(false), model, &free, &limits);
        let mut judged = square_sums(&of(true), &fit.model).into_iter();
        for (i, _) in folds.iter().enumerate().filter(|(_, f)| **f == fold) {
            after[i] = judged.next().unwrap_or(after[i]);
        }
    }
    let gains: Vec<f64> = before.iter().zip(&after).map(|(b, a)| b.0 - a.0).collect();
    let error = standard_deviation(&gains) / (gains.len() as f64).sqrt();
    Refinement {
        before_nm: rmse_nm(&before),
        after_nm: rmse_nm(&after),
        gained: mean(&gains) > error,
        fit: fit_whole(&parts, model, &free, &limits),
    }
}

/// All parameters that the model uses; X_cl stays, for it is measured or estimated by itself.
fn free_parameters(model: &Model) -> Vec<Free> {
    let mut free = Vec::new();
    for direction in Direction::BOTH {
        let friction: &Friction = model.friction.of(direction);
        free.extend([0, 1, 6].map(|i| Free::Friction(direction, i)));
        if friction.b_c != 0.0 {
            free.extend([2, 3].map(|i| Free::Friction(direction, i)));
        }
        if friction.b_j != 0.0 {
            free.extend([4, 5].map(|i| Free::Friction(direction, i)));
        }
    }
    if matches!(model.combination, Combination::Arctan { .. } | Combination::Power { .. }) {
        free.push(Free::Curve);
    }
    free
}
