//! The route on free motion, where no leg holds one speed: friction and combination together on whole series.

use super::confidence::merged;
use super::{Identification, Reading, Route, Settings, Trials, blank_model, free, functions, learn, rests_on, zero};
use crate::log::Campaign;
use crate::model::{Confidence, Direction, Model, Status, Term};
use crate::problem::Result;

/// Identifies the joint of `campaign` from free motion alone.
pub(super) fn from_free_motion(
    campaign: &Campaign,
    readings: Vec<Reading>,
    settings: Settings,
) -> Result<Identification> {
    let mut trials = Trials::new(readings);
    trials.warnings.push(
        "no uniform sweeps in this campaign: A(v) and B(v) cannot be identified; friction and combination are fitted to free \
         motion and validated on held-out strokes"
            .to_string(),
    );
    let (blank, folds, zero_rad) = (blank_model(campaign), trials.folds(), settings.zero_within_rad(campaign));
    let lowpass_hz = campaign.signal.lowpass_hz;
    let fit =
        free::fit_free(&trials.prepared, &folds, &blank, lowpass_hz, settings.combination, zero_rad, &campaign.file)?;
    let mut model = fit.fit.model.clone();
    let unseen = Confidence { low: f64::NEG_INFINITY, high: f64::INFINITY, cv: f64::INFINITY, status: Status::Flat };
    for direction in Direction::BOTH {
        for term in Term::ALL {
            model.confidence.insert(term.dotted(direction), unseen);
        }
    }
    learn(&mut model, &fit.fit.confidence);
    merge(&mut model);
    let checks = fit.combination.checks.clone();
    checks.iter().for_each(|check| check.demote(&mut model));
    if settings.refine {
        let what = "--refine changes nothing here: without sweeps all parameters are fitted together anyway";
        trials.warnings.push(what.to_string());
    }
    model.functions = functions::of_free_motion(&fit.of_functions, &trials.prepared);
    let rests_on = rests_on::of_free_motion(&model);
    trials.warnings.splice(0..0, zero::warning_of_fit(&model));
    trials.warnings.extend(fit.combination.warnings.iter().cloned());
    let combination = Some(fit.combination.clone());
    let found = trials.identified(model, Route::Free(Box::new(fit)));
    Ok(Identification { combination, checks, rests_on, ..found })
}

/// The one Stribeck term of free motion represents both of (15), and a_j and d represent the remainder, or everything where that term is
/// left out: none of them is the paper's parameter alone.
fn merge(model: &mut Model) {
    for direction in Direction::BOTH {
        let branch = *model.friction.of(direction);
        if branch.lacks(Term::CableStribeck) {
            for term in [Term::Coulomb, Term::JointStribeck, Term::JointDecay, Term::Viscous] {
                model.confidence.entry(term.dotted(direction)).and_modify(|known| *known = merged(*known));
            }
        }
    }
}
