//! What a model leaves of the trials that it was fitted to: for figures, not for fits.

use super::predicted::Prepared;
use crate::log::{Protocol, TrialEntry};
use crate::model::Model;
use crate::numerics::statistics::root_mean_square;
use rayon::prelude::*;

/// What the model leaves of one trial, thinned, both sides low-passed.
#[derive(Debug, Clone)]
pub struct Residual {
    /// The trial's file.
    pub file: String,
    /// Its protocol.
    pub protocol: Protocol,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// Position, rad.
    pub position_rad: Vec<f64>,
    /// Speed, rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// Measured less predicted, N m; only samples whose K~ is known and whose sensor was in range.
    pub residual_nm: Vec<f64>,
    /// Its root mean square, N m.
    pub rmse_nm: f64,
}

/// What `model` leaves of each of `trials`.
pub(super) fn residuals(trials: &[Prepared], entries: &[TrialEntry], model: &Model) -> Vec<Residual> {
    let each = trials.par_iter().zip(entries);
    each.map(|(trial, entry)| residual(trial, &entry.file, entry.protocol, model)).collect()
}

fn residual(trial: &Prepared, file: &str, protocol: Protocol, model: &Model) -> Residual {
    let (residual, known_from) = trial.residual_nm(model);
    let used: Vec<usize> = (known_from..trial.len()).filter(|i| trial.series.in_range[*i]).collect();
    let take = |values: &[f64]| -> Vec<f64> { used.iter().map(|i| values[*i]).collect() };
    let residual_nm = take(&residual);
    Residual {
        file: file.to_string(),
        protocol,
        time_s: take(&trial.series.time_s),
        position_rad: take(&trial.series.position_rad),
        velocity_rad_s: take(&trial.series.velocity_rad_s),
        rmse_nm: root_mean_square(&residual_nm),
        residual_nm,
    }
}
