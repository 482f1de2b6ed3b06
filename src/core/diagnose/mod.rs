//! Where the gap between model and recordings lies, which unmodelled effect causes it, and how far it shrinks once that is added.
//!
//! The noise floor first; then what does not repeat (contact events) is set aside; then every candidate is fitted along with the
//! base model inside its confidence and scored on held-out units; then the verdict.

mod account;
mod answer;
mod base;
mod bins;
mod bootstrap;
mod candidates;
mod cause;
mod choose;
mod compare;
mod contact_events;
mod criteria;
mod data;
mod encoder;
mod explain;
mod extent;
mod fit;
mod flexible;
mod floor;
mod folds;
mod gram;
mod locate;
mod mask;
mod measures;
mod motion;
mod next;
mod on_chain;
mod on_cycles;
mod opening;
mod oscillation;
mod pairs;
mod parameter_ref;
mod parameters;
mod perturbation;
mod policy;
mod probability;
mod progress;
mod record;
mod records;
mod repeats;
mod ripple;
mod rounds;
mod runners_up;
mod search;
mod settle;
mod spectrum;
mod stale;
mod turns;
mod verdict;
mod wider;

pub use answer::{Answer, Form, Kind};
pub use bootstrap::Shrink;
pub use candidates::Cause;
pub use criteria::Decision;
pub use floor::{Floor, FloorSource};
pub use locate::Place;
pub use motion::{Follows, MotionGap, MotionPlace, MotionTrial, beside};
pub use next::{BlindSpot, NextExperiment};
pub use parameters::{BELOW_ZERO, Fitted};
pub use policy::{ENTRIES, FORMAT as POLICY_FORMAT, Policy, Threshold};
pub use progress::{Listener, Phase, Progress};
pub use verdict::{Verdict, signature};

use crate::evaluate::fitted;
use crate::log::Campaign;
use crate::model::Model;
use crate::problem::{Problem, Result};
use account::Account;
use base::BaseModel;
use bootstrap::Resamples;
use data::DataSet;
use explain::Explanation;
use on_cycles::Ceiling;
use opening::Opening;
use oscillation::Oscillation;

/// All that is found.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    /// The model as delivered.
    pub before: Model,
    /// The model with the causes added, and its base where the fit left it within its confidence.
    pub after: Model,
    /// How large the gap is.
    pub gap: Gap,
    /// What the gap is made of.
    pub budget: Budget,
    /// Where it lies, most first.
    pub places: Vec<Place>,
    /// Where what the causes leave lies, most first.
    pub remainder: Vec<Place>,
    /// Every candidate, best first.
    pub candidates: Vec<Candidate>,
    /// The answer.
    pub verdict: Verdict,
    /// Stretches of contact.
    pub contacts: Vec<Contact>,
    /// Every trial, thinned.
    pub views: Vec<View>,
    /// What was held out in turn: "trials" or "motion cycles".
    pub held_out: &'static str,
    /// What is resampled as a whole: "trials" or "motion cycles".
    pub resampled: &'static str,
    /// What separates the recordings in motion from a simulator's log of the same commands, where there is one.
    pub motion: Option<MotionGap>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// What to record next, if that would say more.
    pub next: Option<NextExperiment>,
    /// Effects that these recordings cannot show.
    pub blind_spots: Vec<BlindSpot>,
    /// The thresholds by which it was decided.
    pub policy: Policy,
}

/// The gap over all samples that are judged, low-passed, N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gap {
    /// RMSE of the model as delivered.
    pub rmse_nm: f64,
    /// What no model could explain.
    pub floor: Floor,
    /// sqrt(rmse^2 - floor^2).
    pub explainable_nm: f64,
    /// What a flexible fit recovers on held-out units: the ceiling for any named cause.
    pub recoverable_nm: f64,
}

/// What the mean square of the residual is made of, (N m)^2; the folds add up to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Budget {
    /// The floor.
    pub floor: f64,
    /// What moving the base within its confidence explains.
    pub within_confidence: f64,
    /// What each cause explains.
    pub causes: Vec<(Cause, f64)>,
    /// What is left.
    pub unexplained: f64,
}

/// A cause that was tried.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// Which.
    pub cause: Cause,
    /// In which way, where a group of parameters can move in several.
    pub how: &'static str,
    /// RMSE on held-out units with it (and the other causes found) added, N m.
    pub held_out_rmse_nm: f64,
    /// How far the gap shrinks.
    pub shrink: Shrink,
    /// What was fitted.
    pub parameters: Vec<Fitted>,
    /// Causes that do as well.
    pub trades_with: Vec<Cause>,
    /// Whether the verdict rests on it.
    pub taken: bool,
    /// Whether it was tried only in addition to all causes on which the verdict rests, not in the place of one.
    pub beside: bool,
    /// Whether the fit settled; if not, a longer search might do better.
    pub settled: bool,
}

/// A stretch of contact.
#[derive(Debug, Clone, PartialEq)]
pub struct Contact {
    /// The trial's log.
    pub file: String,
    /// From, s since the trial began.
    pub from_s: f64,
    /// To, s.
    pub to_s: f64,
    /// Its largest torque, N m.
    pub peak_nm: f64,
}

/// One trial, thinned to a few rows per period of the low-pass.
#[derive(Debug, Clone)]
pub struct View {
    /// Its log.
    pub file: String,
    /// Since it began, s.
    pub time_s: Vec<f64>,
    /// rad.
    pub position_rad: Vec<f64>,
    /// rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// y, low-passed, N m.
    pub measured_nm: Vec<f64>,
    /// Predicted by the model as delivered, N m.
    pub before_nm: Vec<f64>,
    /// Predicted with the causes added, N m.
    pub after_nm: Vec<f64>,
    /// Whether the row is judged.
    pub judged: Vec<bool>,
    /// Whether the sensor clips there or beside it.
    pub clipped: Vec<bool>,
}

/// Warning where the motion of a trial cannot be read again by the simulated encoder.
const ENCODER_UNKNOWN: &str = "what the encoder alone leaves of a perfect model is not known: its smoothed motion cannot be prepared as the \
                               recorded one; a coarse encoder may be taken for a gap";

/// Warning where the floor is the whole residual.
const UNFORESEEN: &str = "what is left exceeds the torque's noise beyond the low-pass, or the rate is too low to record any there, but no fit \
                          finds it again on held-out data: it counts as noise; whether it comes again with the motion, only repeats of one \
                          motion would tell";

/// Warning where `model` was not found to describe the recordings that it was identified from.
fn failed(model: &Model) -> Option<String> {
    (!model.failed_checks.is_empty()).then(|| {
        format!(
            "the model failed checks of its identification ({}; its report tells more): what the gap shows there may be as old as the model, and no \
             change of the joint",
            model.failed_checks.join(", ")
        )
    })
}

/// Warning where the residual oscillates.
fn oscillates(oscillations: &[Oscillation]) -> Option<String> {
    let share: f64 = oscillations.iter().map(|oscillation| oscillation.share).sum();
    let frequencies: Vec<String> = oscillations.iter().map(|o| format!("{:.2} Hz", o.frequency_hz)).collect();
    (share >= locate::SHARE_MIN).then(|| {
        format!(
            "the residual oscillates at {} ({:.0} % of its mean square), which is neither noise nor an effect of the library: mains hum folded into \
             the band, a resonance, a base that sways; record the joint at rest: what oscillates there too is not its friction or its load",
            frequencies.join(" and "),
            100.0 * share
        )
    })
}

/// Looks for what separates `model` from the recordings of `campaign`; `listener` hears what it is at.
///
/// Errors: the model is of another joint; all that is wrong with any trial; no sample can be scored.
pub fn run(campaign: &Campaign, model: &Model, listener: Listener<'_>) -> Result<Diagnosis> {
    run_by(campaign, model, &Policy::default(), listener)
}

/// The same by other thresholds than the default.
///
/// Errors: those of [`run`].
pub fn run_by(campaign: &Campaign, model: &Model, policy: &Policy, listener: Listener<'_>) -> Result<Diagnosis> {
    let begins = |phase| listener(Progress::Begins(phase));
    begins(Phase::Reading);
    let (campaign, model, mut warnings) = fitted(campaign, model)?;
    let campaign = campaign.as_ref();
    let data = DataSet::read(campaign, &model, policy, listener)?;
    if !data.scored(&model).contains(&true) {
        let what = "no sample can be judged: the model's friction jumps at reversals, and the joint rests, or sticks at each turn";
        return Problem::error(&campaign.file, what, "record longer motion in each direction").alone();
    }
    warnings.extend(data.records.all.iter().flat_map(|record| record.warnings.iter().cloned()));
    warnings.extend(failed(&model));
    if data.again().is_none() {
        warnings.push(ENCODER_UNKNOWN.to_string());
    }
    let opening = Opening::of(&data, &model, listener);
    let ceiling = Ceiling::of(&opening);
    let mut found = explained(opening, (campaign, &model), listener);
    if found.verdict.kind == Kind::Unknown && found.verdict.tells_of_a_gap() {
        on_cycles::look_again(&mut found, &ceiling, &data, (campaign, &model), listener);
    }
    found.warnings.splice(..0, warnings);
    Ok(found)
}

/// What separates `model` from the recordings of `campaign`, beginning from `opening`, whose floor is known better once the causes are.
fn explained<'d>(
    mut opening: Opening<'d>,
    (campaign, model): (&Campaign, &Model),
    listener: Listener<'_>,
) -> Diagnosis {
    let begins = |phase| listener(Progress::Begins(phase));
    let of = |opening: &Opening<'d>| {
        let explanation = explain::explain(&opening.base, opening.events.clone(), &opening.rest_nm, listener);
        begins(Phase::Verdict);
        weighed(&opening.base, explanation, &opening.columns)
    };
    let (mut explanation, mut floor, mut resamples) = of(&opening);
    if explanation.ended_early(&floor) {
        let lower = opening.clone().above(floor.rms_nm);
        let again = of(&lower);
        if again.0.leaves_less(&explanation) {
            (opening, (explanation, floor, resamples)) = (lower, again);
        }
    }
    let Opening { base, flexible, .. } = opening;
    let (data, floor_nm) = (base.data(), base.mask.floor_nm);
    let mut warnings = Vec::new();
    if floor.source == FloorSource::Unforeseen {
        warnings.push(UNFORESEEN.to_string());
    }
    warnings.extend(oscillates(&explanation.oscillations));
    let account = Account::new(&base, &explanation, &resamples, &floor);
    let verdict = verdict::verdict(&explanation.choice, &account.evidence);
    begins(Phase::NextExperiment);
    let design = next::Design { campaign, base: &base, found: &explanation.choice.found, verdict: &verdict, floor_nm };
    let (next, blind_spots) = design.propose();
    Diagnosis {
        gap: account.gap(floor, &flexible),
        budget: account.budget(),
        places: account.places(&verdict),
        remainder: account.remainder(),
        candidates: account.candidates(),
        contacts: account.contacts(),
        views: account.views(),
        after: if verdict.tells_of_a_gap() { explanation.after.clone() } else { model.clone() },
        before: model.clone(),
        verdict,
        held_out: data.folds.held_out(),
        resampled: data.folds.resampled(),
        motion: None,
        warnings,
        next,
        blind_spots,
        policy: data.policy.clone(),
    }
}

/// `explanation`, without its causes where the gap is too weak for the share of resamples that agree; with the floor under its residual
/// (`columns` are those of the flexible fit), and how to resample.
fn weighed<'d>(
    base: &BaseModel<'d>,
    explanation: Explanation<'d>,
    columns: &[Vec<f64>],
) -> (Explanation<'d>, Floor, Resamples) {
    let under = |explanation: &Explanation<'d>| {
        let floor = explanation.floor(columns);
        (floor, Resamples::new(&base.data().folds, &floor))
    };
    let (floor, resamples) = under(&explanation);
    let agreement = {
        let evidence = Account::new(base, &explanation, &resamples, &floor).evidence;
        verdict::too_weak(&explanation.choice, &evidence)
    };
    let Some(agreement) = agreement else { return (explanation, floor, resamples) };
    let explanation = explanation.given_up(agreement);
    let (floor, resamples) = under(&explanation);
    (explanation, floor, resamples)
}
