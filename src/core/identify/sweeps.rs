//! The route on constant-speed sweeps: legs -> A and B(v) -> friction -> combination.

use super::drift::{Drift, LegTime};
use super::legs::{Amplitude, LegFit};
use super::predicted::Prepared;
use super::{
    Check, CombinationFit, FrictionFit, Identification, LegSums, Reading, Refinement, Route, Settings, Trials, Zero,
    at_zero, blank_model, checks, combination, confidence, doubts, friction, judge, learn, legs, refine, rests_on,
    with_friction, zero,
};
use crate::log::{Campaign, TrialEntry};
use crate::model::{Both, Friction, Model};
use crate::problem::Result;

/// Identifies the joint of `campaign` from its sweeps; other trials tell the combination.
pub(super) fn from_sweeps(
    campaign: &Campaign,
    mut readings: Vec<Reading>,
    settings: Settings,
) -> Result<Identification> {
    let mut sums: Vec<LegSums> = readings.iter_mut().flat_map(|r| std::mem::take(&mut r.legs)).collect();
    let mut times: Vec<LegTime> = readings.iter_mut().flat_map(|r| std::mem::take(&mut r.times)).collect();
    let within_rad = settings.zero_within_rad(campaign);
    let (left_out, zero, mut legs) = legs::fit_telling(&mut sums, &mut times, within_rad);
    let load_nm = legs::load_of_a_nm(campaign);
    let drift = Drift::of(&legs.iter().collect::<Vec<_>>(), &times);
    let a = legs::amplitudes(&legs, load_nm, &campaign.file)?;
    legs::fix_a(&mut legs, &a);
    let trace = readings.iter_mut().find_map(|r| r.trace.take());
    let mut trials = Trials::new(readings);
    let fits = fit_friction(campaign, &trials, settings, &zero, &legs, &a)?;
    trials.warnings.splice(0..0, zero::warning(&zero));
    trials.warnings.extend((left_out > 0).then(|| untold(left_out)));
    trials.warnings.extend([&fits.up, &fits.down].into_iter().flat_map(friction::warnings));
    let mut model = with_friction(at_zero(blank_model(campaign), &zero), &fits);
    let combination = combine(campaign, &mut trials, settings, &legs, &mut model);
    let refinement = settings.refine.then(|| refined(campaign, &mut trials, &mut model, &fits, &zero));
    if let Some(drift) = drift {
        trials.warnings.push(drift.problem(&campaign.file).to_string());
        confidence::demote(model.confidence.values_mut());
    }
    let mut checks = checks::of_sweeps(&fits, &zero, &legs, &sums);
    trials.warnings.extend(checks.iter().filter_map(Check::warning));
    checks.extend(combination.iter().flat_map(|fit| fit.checks.iter().cloned()));
    checks.iter().for_each(|check| check.demote(&mut model));
    let rests_on = rests_on::of_sweeps(&model, &zero, &a, load_nm);
    let fastest_rad_s = fits.up.points.speed_range_rad_s().1;
    let mut found = trials.identified(model, Route::Sweeps(Box::new(fits)));
    found.warnings.extend(doubts::extrapolation_warning(&found.residuals, fastest_rad_s, settings.refine));
    Ok(Identification { legs, combination, refinement, trace, checks, rests_on, ..found })
}

/// A word on legs that were left out.
fn untold(legs: usize) -> String {
    let (noun, them) = if legs == 1 { ("leg", "it") } else { ("legs", "them") };
    format!(
        "left out {legs} {noun}: along {them} the load changes by less than 1 %, so A cannot be identified from {them}"
    )
}

/// The friction of both directions, in the form that the data support.
fn fit_friction(
    campaign: &Campaign,
    trials: &Trials,
    settings: Settings,
    zero: &Zero,
    legs: &[LegFit],
    a: &Both<Amplitude>,
) -> Result<Both<FrictionFit>> {
    let compared = first_repeats(&trials.prepared, &trials.entries);
    let judge = |friction: &Both<Friction>| {
        let model = Model { friction: *friction, ..at_zero(blank_model(campaign), zero) };
        judge::left_nm(&compared, model, campaign.signal.lowpass_hz, settings.combination)
    };
    let (uncertainty, load_nm) = (&campaign.uncertainty, legs::load_of_a_nm(campaign));
    let data = friction::Data { legs, a, joint: &campaign.joint, uncertainty, load_nm, campaign: &campaign.file };
    friction::fit_friction(&data, settings.form, Some(&judge))
}

/// Fits how friction changes over after a reversal, and gives `model` the curve.
fn combine(
    campaign: &Campaign,
    trials: &mut Trials,
    settings: Settings,
    legs: &[LegFit],
    model: &mut Model,
) -> Option<CombinationFit> {
    let (lowpass_hz, sliding_nm) = (campaign.signal.lowpass_hz, legs::sliding_nm(legs));
    let found = combination::fit_combination(&trials.prepared, model, lowpass_hz, settings.combination, sliding_nm);
    match &found {
        Some(fit) => {
            model.combination = fit.curve().curve;
            model.joint.backlash_m = fit.curve().backlash_m;
            model.confidence.extend(fit.confidence.iter().cloned());
            trials.warnings.extend(fit.warnings.iter().cloned());
        }
        None => trials.warnings.push("no reversal could be used: the combination stays `sign`".to_string()),
    }
    found
}

/// Polishes all parameters together on the whole series, and gives them to `model` if held-out trials gain by it.
fn refined(
    campaign: &Campaign,
    trials: &mut Trials,
    model: &mut Model,
    fits: &Both<FrictionFit>,
    zero: &Zero,
) -> Refinement {
    let (folds, lowpass_hz) = (trials.folds(), campaign.signal.lowpass_hz);
    let found = refine::refine(&trials.prepared, &folds, model, lowpass_hz, fits, zero.declared_rad);
    trials.warnings.extend(found.warnings.iter().cloned());
    if found.kept {
        *model = Model { confidence: std::mem::take(&mut model.confidence), ..found.fit.model.clone() };
        learn(model, &found.fit.confidence);
    }
    found
}

/// One repeat of each motion: enough to compare one friction with another.
fn first_repeats<'t>(trials: &'t [Prepared], entries: &[TrialEntry]) -> Vec<&'t Prepared> {
    let first = |entry: &TrialEntry| {
        let same = |other: &&TrialEntry| other.protocol == entry.protocol && other.trajectory == entry.trajectory;
        entries.iter().filter(same).all(|other| entry.repeat <= other.repeat)
    };
    trials.iter().zip(entries).filter(|(_, entry)| first(entry)).map(|(trial, _)| trial).collect()
}
