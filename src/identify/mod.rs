//! The protocol: legs -> A, B(v) -> friction -> combination -> `Model` with its confidence.

mod branch;
mod check;
mod checks;
pub mod combination;
mod confidence;
mod covariance;
mod doubts;
pub mod drift;
mod forms;
pub mod free;
pub mod friction;
mod functions;
mod implausible;
mod judge;
pub mod legs;
mod moving;
pub mod predicted;
pub mod reading;
pub mod refine;
mod residuals;
mod rests_on;
mod scale;
pub mod stribeck;
pub mod strokes;
pub mod sums;
mod support;
mod understood;
pub mod whole;
mod windows;
pub mod zero;

pub use check::check;
pub use checks::Check;
pub use combination::{CombinationFit, CurveFit, CurveKind};
pub use covariance::Covariance;
pub use free::FreeFit;
pub use friction::{Form, FrictionFit};
pub use implausible::{Cause, Doubt, Evidence, evidence, implausible};
pub use legs::{Amplitude, LegFit, LegZero};
pub use reading::{Reading, Trace, examine_trials, read_trials};
pub use refine::Refinement;
pub use residuals::Residual;
pub use rests_on::RestsOn;
pub use sums::LegSums;
pub use understood::{Understood, UnderstoodTrial};
pub use windows::Crossing;
pub use zero::Zero;

use crate::dynamics::JointKind;
use crate::log::{Arm, Campaign, Protocol, TrialEntry};
use crate::model::{Both, Combination, Confidence, Direction, Friction, Functions, Model, Status, Term};
use crate::problem::{Problem, Problems, Result};
use drift::{Drift, LegTime};
use predicted::Prepared;
use residuals::residuals;
use std::collections::BTreeMap;

/// What a run of the protocol may choose.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settings {
    /// Which form of (19) the model takes.
    pub form: Form,
    /// How the combination is fitted.
    pub combination: combination::Settings,
    /// Whether to polish all parameters on the whole series.
    pub refine: bool,
    /// Whether the zero of the position is taken as declared, as in the paper, rather than fitted.
    pub zero_as_declared: bool,
}

impl Settings {
    /// How far the zero of the position of `campaign` may be off, rad; 0 where it is not fitted: a joint that slides, or whose
    /// gravity is 0, shows none.
    pub fn zero_within_rad(&self, campaign: &Campaign) -> f64 {
        let weighs = campaign.arm.is_some() || campaign.dynamics.gravity_nm != 0.0;
        let turns = campaign.joint.kind == JointKind::Revolute;
        if weighs && turns && !self.zero_as_declared { campaign.uncertainty.position_zero_rad } else { 0.0 }
    }
}

/// How the model was found.
#[derive(Debug, Clone)]
pub enum Route {
    /// By the five steps on constant-speed sweeps.
    Sweeps(Box<Both<FrictionFit>>),
    /// From free motion, where there are no sweeps.
    Free(Box<FreeFit>),
}

impl Route {
    /// The fits of the sweeps, if there were any.
    pub fn sweeps(&self) -> Option<&Both<FrictionFit>> {
        match self {
            Self::Sweeps(fits) => Some(fits),
            Self::Free(_) => None,
        }
    }
}

/// Everything that an identification found.
#[derive(Debug, Clone)]
pub struct Identification {
    /// The model, with the confidence of its parameters.
    pub model: Model,
    /// How it was found, with the fits.
    pub route: Route,
    /// Every leg's regression; none on the free route.
    pub legs: Vec<LegFit>,
    /// The curves side by side; `None` when no reversal could be used.
    pub combination: Option<CombinationFit>,
    /// What refining gained, if it was asked for.
    pub refinement: Option<Refinement>,
    /// Measured less predicted of every trial.
    pub residuals: Vec<Residual>,
    /// One sweep to look at.
    pub trace: Option<Trace>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Checks of the model on the same data; what fails takes `pinned` from the parameters that it concerns.
    pub checks: Vec<Check>,
    /// What each parameter's interval takes as right, by dotted name, with what an error of it moves the parameter by.
    pub rests_on: BTreeMap<String, Vec<RestsOn>>,
    /// Trials read.
    pub trials: usize,
    /// Rows read.
    pub rows: usize,
}

/// An estimated clearance larger than the declared one by more than this share asks for legs that leave out more.
const RECUT: f64 = 1.05;

/// Reads all trials of `campaign` and identifies its joint; `progress` hears of each trial read.
///
/// Errors: all that is wrong with any trial; sweeps that contradict the campaign's geometry.
pub fn run(campaign: &Campaign, settings: Settings, progress: &(dyn Fn() + Sync)) -> Result<Identification> {
    let found = identify(campaign, read_trials(campaign, progress)?, settings)?;
    // Legs leave out the declared clearance after each reversal: with a larger one they would begin inside the transition.
    if found.legs.is_empty() || found.model.joint.backlash_m <= RECUT * campaign.joint.backlash_m {
        return Ok(found);
    }
    let mut recut = campaign.clone();
    recut.joint.backlash_m = found.model.joint.backlash_m;
    identify(&recut, read_trials(&recut, progress)?, settings)
}

/// Identifies the joint of `campaign` from its readings.
pub fn identify(campaign: &Campaign, readings: Vec<Reading>, settings: Settings) -> Result<Identification> {
    // First of all: a wrong unit or sign makes nonsense of whatever follows.
    let sweeps = readings.iter().any(|reading| reading.entry.protocol.speed_rad_s().is_some());
    // Where the zero is fitted, the fit reports it, with its interval.
    let is_fitted = sweeps && settings.zero_within_rad(campaign) > 0.0;
    let doubts = implausible(campaign, &readings).into_iter();
    let doubts = doubts.filter(|doubt| !is_fitted || doubt.causes.first() != Some(&Cause::Zero));
    let doubts: Vec<Problem> = doubts.map(|doubt| doubt.problem(campaign)).collect();
    Problems([doubts.clone(), check(campaign, &readings)].concat()).unless_errors(())?;
    let demotes = readings.iter().any(|reading| reading.demotes);
    let mut found = if sweeps {
        from_sweeps(campaign, readings, settings)?
    } else {
        from_free_motion(campaign, readings, settings)?
    };
    if demotes {
        confidence::demote(found.model.confidence.values_mut());
    }
    found.warnings.splice(0..0, doubts.iter().chain(&campaign.warnings).map(Problem::to_string));
    found.warnings.extend(doubts::doubts(&found.model, sweeps));
    Ok(found)
}

/// A model of `campaign`'s joint that knows no friction yet.
pub fn blank_model(campaign: &Campaign) -> Model {
    Model {
        joint: campaign.joint.clone(),
        dynamics: campaign.dynamics,
        chain: campaign.arm.as_ref().map(Arm::name),
        friction: Both { up: Friction::default(), down: Friction::default() },
        combination: Combination::Sign,
        effects: Vec::new(),
        confidence: BTreeMap::new(),
        functions: Functions::default(),
    }
}

/// `model` with the zero of the position that was found, and what is known of it.
pub fn at_zero(mut model: Model, zero: &Zero) -> Model {
    model.dynamics.position_zero_rad = zero.rad;
    model.confidence.extend(zero.is_fitted().then(|| (zero::NAME.to_string(), zero.confidence())));
    model
}

fn from_sweeps(campaign: &Campaign, mut readings: Vec<Reading>, settings: Settings) -> Result<Identification> {
    let lowpass_hz = campaign.signal.lowpass_hz;
    let sums: Vec<LegSums> = readings.iter_mut().flat_map(|r| std::mem::take(&mut r.legs)).collect();
    let (zero, mut legs) = legs::fit_legs(&sums, settings.zero_within_rad(campaign));
    let load_nm = legs::load_of_a_nm(campaign);
    let times: Vec<LegTime> = readings.iter_mut().flat_map(|r| std::mem::take(&mut r.times)).collect();
    let drift = Drift::of(&legs.iter().collect::<Vec<_>>(), &times);
    let a = legs::amplitudes(&legs, load_nm, &campaign.file)?;
    legs::fix_a(&mut legs, &a);
    let sliding_nm = legs::sliding_nm(&legs);
    let mut warnings: Vec<String> = readings.iter().flat_map(|r| r.warnings.iter().map(Problem::to_string)).collect();
    let (rows, trials) = (readings.iter().map(|r| r.rows).sum(), readings.len());
    let trace = readings.iter_mut().find_map(|r| r.trace.take());
    let (prepared, entries) = of_the_joint_alone(readings);
    let compared = first_repeats(&prepared, &entries);
    let judge = |friction: &Both<Friction>| {
        let model = Model { friction: *friction, ..at_zero(blank_model(campaign), &zero) };
        judge::left_nm(&compared, model, lowpass_hz, settings.combination)
    };
    let uncertainty = &campaign.uncertainty;
    let data =
        friction::Data { legs: &legs, a: &a, joint: &campaign.joint, uncertainty, load_nm, campaign: &campaign.file };
    let fits = friction::fit_friction(&data, settings.form, Some(&judge))?;
    let mut model = with_friction(at_zero(blank_model(campaign), &zero), &fits);
    warnings.splice(0..0, zero::warning(&zero));
    warnings.extend([&fits.up, &fits.down].into_iter().flat_map(friction::warnings));
    let combination = combination::fit_combination(&prepared, &model, lowpass_hz, settings.combination, sliding_nm);
    match &combination {
        Some(fit) => {
            model.combination = fit.curve().curve;
            model.joint.backlash_m = fit.curve().backlash_m;
            model.confidence.extend(fit.confidence.iter().cloned());
            warnings.extend(fit.warnings.iter().cloned());
        }
        None => warnings.push("no reversal could be used: the combination stays `sign`".to_string()),
    }
    let refinement = settings.refine.then(|| {
        let folds: Vec<usize> = folds(&entries.iter().map(|e| e.repeat).collect::<Vec<u32>>());
        refine::refine(&prepared, &folds, &model, lowpass_hz, &fits, zero.declared_rad)
    });
    warnings.extend(refinement.iter().flat_map(|r| r.warnings.iter().cloned()));
    if let Some(refined) = refinement.as_ref().filter(|r| r.kept) {
        model = Model { confidence: model.confidence, ..refined.fit.model.clone() };
        learn(&mut model, &refined.fit.confidence);
    }
    if let Some(drift) = drift {
        warnings.push(drift.problem(&campaign.file).to_string());
        confidence::demote(model.confidence.values_mut());
    }
    let mut checks = checks::of_sweeps(&fits, &zero, &legs, &sums);
    warnings.extend(checks.iter().filter_map(Check::warning));
    checks.extend(combination.iter().flat_map(|fit| fit.checks.iter().cloned()));
    checks.iter().for_each(|check| check.demote(&mut model));
    let rests_on = rests_on::of_sweeps(&model, &zero, &a, load_nm);
    let residuals = residuals(&prepared, &entries, &model);
    warnings.extend(doubts::extrapolation_warning(&residuals, fits.up.points.speed_range_rad_s().1, settings.refine));
    let route = Route::Sweeps(Box::new(fits));
    Ok(Identification {
        model,
        route,
        legs,
        combination,
        refinement,
        residuals,
        trace,
        warnings,
        checks,
        rests_on,
        trials,
        rows,
    })
}

/// One repeat of each motion: enough to compare one friction with another.
fn first_repeats(trials: &[Prepared], entries: &[TrialEntry]) -> Vec<Prepared> {
    let first = |entry: &TrialEntry| {
        let same = |other: &&TrialEntry| other.protocol == entry.protocol && other.trajectory == entry.trajectory;
        entries.iter().filter(same).all(|other| entry.repeat <= other.repeat)
    };
    trials.iter().zip(entries).filter(|(_, entry)| first(entry)).map(|(trial, _)| trial.clone()).collect()
}

/// `model` with the friction that `fits` found and its confidence, and with A and B(v).
pub fn with_friction(mut model: Model, fits: &Both<FrictionFit>) -> Model {
    model.functions = functions::of_sweeps(fits);
    for direction in Direction::BOTH {
        let fit = fits.of(direction);
        *model.friction.of_mut(direction) = fit.friction;
        for (term, confidence) in Term::ALL.iter().zip(fit.confidence) {
            model.confidence.insert(term.dotted(direction), confidence);
        }
    }
    model
}

/// The trials in which nothing but the joint itself acts, thinned, with their entries.
pub fn of_the_joint_alone(readings: Vec<Reading>) -> (Vec<Prepared>, Vec<TrialEntry>) {
    let alone = readings.into_iter().filter(|r| r.entry.protocol != Protocol::Interaction);
    alone.map(|r| (r.prepared, r.entry)).unzip()
}

fn from_free_motion(campaign: &Campaign, readings: Vec<Reading>, settings: Settings) -> Result<Identification> {
    let lowpass_hz = campaign.signal.lowpass_hz;
    let mut warnings: Vec<String> = readings.iter().flat_map(|r| r.warnings.iter().map(Problem::to_string)).collect();
    warnings.push(
        "no uniform sweeps in this campaign: A(v) and B(v) cannot be identified; friction and combination are fitted to free \
         motion and validated on held-out strokes"
            .to_string(),
    );
    let (rows, trials) = (readings.iter().map(|r| r.rows).sum(), readings.len());
    let (prepared, entries) = of_the_joint_alone(readings);
    let blank = blank_model(campaign);
    let folds = folds(&entries.iter().map(|e| e.repeat).collect::<Vec<u32>>());
    let zero_rad = settings.zero_within_rad(campaign);
    let fit = free::fit_free(&prepared, &folds, &blank, lowpass_hz, settings.combination, zero_rad, &campaign.file)?;
    let mut model = fit.fit.model.clone();
    let unseen = Confidence { low: f64::NEG_INFINITY, high: f64::INFINITY, cv: f64::INFINITY, status: Status::Flat };
    for direction in Direction::BOTH {
        for term in Term::ALL {
            model.confidence.insert(term.dotted(direction), unseen);
        }
    }
    learn(&mut model, &fit.fit.confidence);
    let checks = fit.combination.checks.clone();
    checks.iter().for_each(|check| check.demote(&mut model));
    if settings.refine {
        warnings.push("--refine changes nothing here: without sweeps all parameters are fitted together anyway".into());
    }
    model.functions = functions::of_free_motion(&fit.of_functions, &prepared);
    let rests_on = rests_on::of_free_motion(&model);
    let residuals = residuals(&prepared, &entries, &model);
    warnings.splice(0..0, zero::warning_of_fit(&model));
    warnings.extend(fit.combination.warnings.iter().cloned());
    let combination = Some(fit.combination.clone());
    let route = Route::Free(Box::new(fit));
    let (legs, refinement, trace) = (Vec::new(), None, None);
    Ok(Identification {
        model,
        route,
        legs,
        combination,
        refinement,
        residuals,
        trace,
        warnings,
        checks,
        rests_on,
        trials,
        rows,
    })
}

/// Takes over what a fit knows of its parameters, and of k what it knows of p.
fn learn(model: &mut Model, known: &[(String, Confidence)]) {
    model.confidence.extend(known.iter().cloned());
    if let Some(of_p) = model.confidence.get("combination.p") {
        let of_k = confidence::of_k(*of_p);
        model.confidence.insert("combination.k".to_string(), of_k);
    }
}

/// The half that each trial belongs to: by its repeat number where that differs; else in the order a, b, b, a, which shares
/// out whatever rises, falls or alternates along the campaign.
fn folds(repeats: &[u32]) -> Vec<usize> {
    let by_repeat: Vec<usize> = repeats.iter().map(|r| *r as usize % 2).collect();
    let differ = by_repeat.windows(2).any(|pair| pair[0] != pair[1]);
    if differ { by_repeat } else { (0..repeats.len()).map(|i| i.div_ceil(2) % 2).collect() }
}
