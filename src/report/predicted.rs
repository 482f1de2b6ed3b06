//! What `predict` writes: one table per trial, sample by sample.

use crate::evaluate::{judged, low_pass};
use crate::log::table::{Numbers, csv_bytes};
use crate::log::{Campaign, TrialEntry};
use crate::model::Model;
use crate::predict::Prediction;
use crate::prepare::Trial;
use crate::problem::{Problem, Result};
use std::collections::BTreeMap;
use std::path::Path;

/// Decimals of a torque: well below what any sensor resolves, so that the parts still add up.
const TORQUE_DECIMALS: usize = 9;

/// The names of the trials' tables: the stems of their logs, folders joined by an underscore.
///
/// Errors: two trials whose tables would have one name.
pub fn csv_names<'a>(campaign: &Campaign, trials: impl Iterator<Item = &'a TrialEntry>) -> Result<Vec<String>> {
    let mut seen: BTreeMap<String, &str> = BTreeMap::new();
    let mut names = Vec::new();
    for entry in trials {
        let name = Path::new(&entry.file).with_extension("csv").display().to_string().replace(['/', '\\'], "_");
        if let Some(other) = seen.insert(name.clone(), &entry.file) {
            let what = format!("`{other}` and `{}` would both become {name}", entry.file);
            return Problem::error(&campaign.file, what, "rename one of the logs").alone();
        }
        names.push(name);
    }
    Ok(names)
}

/// `trial` as predicted by `model`, N m at the winch.
pub fn trial_csv(campaign: &Campaign, model: &Model, trial: &Trial) -> Vec<u8> {
    let prediction = Prediction::new(model, trial);
    let filtered_nm = low_pass(campaign, trial, prediction.torque_nm.clone());
    let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
    let residual_nm = difference(&trial.log.torque_nm, &prediction.torque_nm);
    let residual_filtered_nm = difference(&trial.torque_nm, &filtered_nm);
    let mut counted = vec![0.0; filtered_nm.len()];
    judged(trial, &prediction, campaign.signal.lowpass_hz).samples.iter().for_each(|at| counted[*at] = 1.0);
    let torque = |name, values| Numbers { name, values, decimals: TORQUE_DECIMALS };
    csv_bytes(&[
        Numbers { name: "time_s", values: &trial.log.time_s, decimals: 6 },
        torque("torque_nm", &trial.log.torque_nm),
        torque("predicted_nm", &prediction.torque_nm),
        torque("gravity_nm", &prediction.gravity_nm),
        torque("inertia_nm", &prediction.inertia_nm),
        torque("friction_nm", &prediction.friction_nm),
        torque("residual_nm", &residual_nm),
        torque("coriolis_nm", &prediction.coriolis_nm),
        torque("load_nm", &prediction.load_nm),
        torque("torque_filtered_nm", &trial.torque_nm),
        torque("predicted_filtered_nm", &filtered_nm),
        torque("residual_filtered_nm", &residual_filtered_nm),
        Numbers { name: "k_f", values: &prediction.states.k_f, decimals: 6 },
        Numbers { name: "k_tilde", values: &prediction.states.k_tilde, decimals: 6 },
        Numbers { name: "judged", values: &counted, decimals: 0 },
    ])
}
