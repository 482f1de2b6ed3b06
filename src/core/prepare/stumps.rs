//! Trials whose recording broke off: those that some stage cannot use are left out, and told.
//!
//! A capture that ends in its ramp, before the first row or inside the clearance leaves a log that cannot be read or holds no leg.
//! It is marked as incomplete, and must not cost the trials that are whole. A trial that is not so marked is never left out.

use super::prepare;
use crate::log::{Campaign, TrialEntry, read_trial};
use crate::problem::{Problem, Problems, Result, Severity};
use std::path::Path;

/// Reads the campaign in `path` without the incomplete trials that cannot be used, each of them told among its warnings.
///
/// Errors: all that is wrong with `campaign.toml`; no trial is left.
pub fn read_campaign(path: &Path) -> Result<Campaign> {
    without_stumps(Campaign::read(path)?)
}

fn without_stumps(mut campaign: Campaign) -> Result<Campaign> {
    let fault = |index: usize| {
        let is_incomplete = campaign.trials[index].is_incomplete();
        is_incomplete.then(|| read_trial(&campaign, index).and_then(|log| prepare(&campaign, index, log)).err())?
    };
    let stumps: Vec<(usize, Problems)> =
        (0..campaign.trials.len()).filter_map(|index| Some((index, fault(index)?))).collect();
    let told: Vec<Problem> =
        stumps.iter().map(|(index, why)| left_out(&campaign, &campaign.trials[*index], &why.0)).collect();
    stumps.iter().rev().for_each(|(index, _)| drop(campaign.trials.remove(*index)));
    if campaign.trials.is_empty() {
        return Err(Problems(told.into_iter().map(|p| Problem { severity: Severity::Error, ..p }).collect()));
    }
    campaign.warnings.extend(told);
    Ok(campaign)
}

/// The warning that `entry` of `campaign` is left out because of `faults`.
pub fn left_out(campaign: &Campaign, entry: &TrialEntry, faults: &[Problem]) -> Problem {
    let why = entry.capture.as_ref().and_then(|capture| capture.incomplete.clone()).unwrap_or_default();
    let fault = faults.iter().find(|fault| fault.severity == Severity::Error).map_or("", |fault| &fault.what);
    let what = format!("`{}` broke off too early to be used ({why}): {fault}", entry.file);
    Problem::warning(&campaign.file, what, "it is left out")
}
