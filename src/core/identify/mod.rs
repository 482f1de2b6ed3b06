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
mod free_motion;
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
mod sweeps;
mod together;
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
use crate::model::{Both, Combination, Confidence, Direction, Friction, Functions, Model, Term};
use crate::problem::{Problem, Problems, Result};
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

impl Identification {
    /// RMSE over all samples of all trials, N m; NaN without any.
    pub fn rmse_nm(&self) -> f64 {
        let of_trials = self.residuals.iter().filter(|residual| !residual.residual_nm.is_empty());
        let of_trial = |residual: &Residual| {
            let samples = residual.residual_nm.len() as f64;
            (residual.rmse_nm.powi(2) * samples, samples)
        };
        whole::rmse_nm(&of_trials.map(of_trial).collect::<Vec<_>>())
    }
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
        sweeps::from_sweeps(campaign, readings, settings)?
    } else {
        free_motion::from_free_motion(campaign, readings, settings)?
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
        own_rmse_nm: None,
        failed_checks: Vec::new(),
    }
}

/// `model` with the zero of the position that was found, and what is known of it.
pub fn at_zero(mut model: Model, zero: &Zero) -> Model {
    model.dynamics.position_zero_rad = zero.rad;
    model.confidence.extend(zero.is_fitted().then(|| (zero::NAME.to_string(), zero.confidence())));
    model
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

/// What every route begins with.
struct Trials {
    /// Those in which nothing but the joint itself acts, thinned.
    prepared: Vec<Prepared>,
    /// Their entries.
    entries: Vec<TrialEntry>,
    /// Warnings.
    warnings: Vec<String>,
    /// Trials read.
    trials: usize,
    /// Rows read.
    rows: usize,
}

impl Trials {
    fn new(readings: Vec<Reading>) -> Self {
        let warnings = readings.iter().flat_map(|r| r.warnings.iter().map(Problem::to_string)).collect();
        let (rows, trials) = (readings.iter().map(|r| r.rows).sum(), readings.len());
        let (prepared, entries) = of_the_joint_alone(readings);
        Self { prepared, entries, warnings, trials, rows }
    }

    /// The half that each trial belongs to.
    fn folds(&self) -> Vec<usize> {
        folds(&self.entries.iter().map(|entry| entry.repeat).collect::<Vec<u32>>())
    }

    /// What every route ends with: `model`, found by `route`, and what it leaves of every trial.
    fn identified(self, model: Model, route: Route) -> Identification {
        Identification {
            residuals: residuals(&self.prepared, &self.entries, &model),
            model,
            route,
            legs: Vec::new(),
            combination: None,
            refinement: None,
            trace: None,
            warnings: self.warnings,
            checks: Vec::new(),
            rests_on: BTreeMap::new(),
            trials: self.trials,
            rows: self.rows,
        }
    }
}

/// The trials in which nothing but the joint itself acts, thinned, with their entries.
pub fn of_the_joint_alone(readings: Vec<Reading>) -> (Vec<Prepared>, Vec<TrialEntry>) {
    let alone = readings.into_iter().filter(|r| r.entry.protocol != Protocol::Interaction);
    alone.map(|r| (r.prepared, r.entry)).unzip()
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
