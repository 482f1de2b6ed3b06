//! What a friction is worth to the prediction: how much of the series it leaves.

use super::combination::{Settings, fit_one};
use super::predicted::Prepared;
use super::whole::rmse_nm;
use crate::model::Model;
use rayon::prelude::*;

/// RMSE of `model` with a curve fitted to it, over all samples and after reversals, N m; NaN where there are none.
pub fn left_nm(trials: &[&Prepared], mut model: Model, lowpass_hz: f64, settings: Settings) -> [f64; 2] {
    let curve = fit_one(trials, &model, lowpass_hz, settings);
    if let Some(fit) = &curve {
        model.combination = fit.curve;
        model.joint.backlash_m = fit.backlash_m;
    }
    let square_sum = |trial: &&Prepared| {
        let (residual, known_from) = trial.residual_nm(&model);
        let used = residual.iter().zip(&trial.series.in_range).skip(known_from).filter(|(_, ok)| **ok);
        used.fold((0.0, 0.0), |(sum, count), (r, _)| (sum + r * r, count + 1.0))
    };
    let sums: Vec<(f64, f64)> = trials.par_iter().map(square_sum).collect();
    [rmse_nm(&sums), curve.map_or(f64::NAN, |fit| fit.rmse_nm)]
}
