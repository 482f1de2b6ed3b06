//! How well a model predicts recorded motions, best ones that it was not identified from: the paper's section III B.
//!
//! Prediction and measurement pass through the same declared low-pass; the raw figures compare them with neither filtered.
//! Samples before K_f is known and samples near clipped readings are in no figure.

pub mod curves;
pub mod figures;
mod fits;
mod view;

pub use curves::{Rival, Source, rivals};
pub use figures::{Figures, Judged, Split, Spread, pooled};
pub use fits::fitted;
pub use view::View;

use crate::log::{Campaign, Fingerprint, Protocol, TrialEntry, read_trial, refuse_copies};
use crate::model::{Combination, Model, RecordedCurve};
use crate::numerics::filter::LowPass;
use crate::predict::{Prediction, forgotten, with_curve};
use crate::prepare::{Trial, prepare};
use crate::problem::{Problem, Problems, Result};
use rayon::prelude::*;

/// What is judged.
#[derive(Debug, Clone, Default)]
pub struct Settings {
    /// Whether uniform sweeps are judged too.
    pub sweeps: bool,
    /// Curves that the model's file lists beside its own.
    pub recorded_curves: Vec<RecordedCurve>,
}

/// One trial judged.
#[derive(Debug, Clone)]
pub struct TrialEvaluation {
    /// What the campaign says of it.
    pub entry: TrialEntry,
    /// Both sides low-passed.
    pub filtered: Split,
    /// Neither side filtered.
    pub raw: Split,
    /// Each rival's figures, low-passed, in the order of `Evaluation::rivals`.
    pub rivals: Vec<Split>,
    /// The trial, thinned for drawing.
    pub view: View,
}

/// Trials that are repeats of each other, or at least of one protocol.
#[derive(Debug, Clone)]
pub struct Group {
    /// Their protocol, speed included.
    pub protocol: Protocol,
    /// Their trajectory's name.
    pub trajectory: Option<String>,
    /// Whether they repeat one motion: free trials without a trajectory's name do not.
    pub repeats: bool,
    /// Places in `Evaluation::trials`.
    pub trials: Vec<usize>,
    /// RMSE, N m.
    pub rmse_nm: Spread,
    /// MAE, N m.
    pub mae_nm: Spread,
}

/// A model judged on a campaign.
#[derive(Debug, Clone)]
pub struct Evaluation {
    /// The model.
    pub model: Model,
    /// All trials judged, in the campaign's order.
    pub trials: Vec<TrialEvaluation>,
    /// The same by protocol and trajectory.
    pub groups: Vec<Group>,
    /// The curves compared.
    pub rivals: Vec<Rival>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Cut-off of the low-pass, Hz.
    pub lowpass_hz: f64,
}

impl Evaluation {
    /// Figures over all trials together, low-passed.
    pub fn overall(&self) -> Split {
        self.together(|t| &t.filtered)
    }

    /// Figures over all trials together of one of their splits.
    pub fn together<'a>(&'a self, of: impl Fn(&'a TrialEvaluation) -> &'a Split) -> Split {
        let part = |part: fn(&Split) -> Figures| pooled(&self.trials.iter().map(|t| part(of(t))).collect::<Vec<_>>());
        Split { all: part(|s| s.all), stable: part(|s| s.stable), transition: part(|s| s.transition) }
    }
}

/// Judges `model` on the trials of `campaign` in which nothing but the joint itself acts; `progress` hears of each.
///
/// Errors: the model is of another joint; no trial can be judged; all that is wrong with any trial.
pub fn run(
    campaign: &Campaign,
    model: &Model,
    settings: &Settings,
    progress: &(dyn Fn() + Sync),
) -> Result<Evaluation> {
    let (campaign, model, mut warnings) = fitted(campaign, model)?;
    let (campaign, model) = (campaign.as_ref(), &model);
    let chosen = chosen(campaign, settings.sweeps)?;
    let rivals = rivals(model, &settings.recorded_curves);
    let evaluate = |index: &usize| {
        let judged = judge(campaign, *index, model, &rivals);
        progress();
        judged
    };
    let (mut trials, mut prints) = (Vec::with_capacity(chosen.len()), Vec::with_capacity(chosen.len()));
    let mut problems = Vec::new();
    for (index, judged) in chosen.iter().zip(chosen.par_iter().with_max_len(1).map(evaluate).collect::<Vec<_>>()) {
        match judged {
            Ok((trial, found, print)) => {
                warnings.extend(found);
                trials.push(trial);
                prints.push((*index, print));
            }
            Err(Problems(found)) => problems.extend(found),
        }
    }
    if !problems.is_empty() {
        return Err(Problems(problems));
    }
    refuse_copies(campaign, &prints)?;
    if trials.iter().all(|t| t.filtered.all.samples == 0) {
        let what = "no sample can be evaluated: the joint never moves through its clearance";
        return Problem::error(&campaign.file, what, "record motion in both directions").alone();
    }
    warnings.extend(trials.iter().filter(|t| t.filtered.all.samples == 0).map(|t| {
        format!("{}: not evaluated, because the joint never moves through its clearance there", t.entry.file)
    }));
    let groups = groups(&trials);
    let lowpass_hz = campaign.signal.lowpass_hz;
    Ok(Evaluation { model: model.clone(), trials, groups, rivals, warnings, lowpass_hz })
}

/// The trials to judge.
fn chosen(campaign: &Campaign, sweeps: bool) -> Result<Vec<usize>> {
    let judged = |entry: &TrialEntry| match entry.protocol {
        Protocol::Uniform { .. } => sweeps,
        Protocol::Interaction => false,
        Protocol::Cosine | Protocol::Free => true,
    };
    let chosen: Vec<usize> = (0..campaign.trials.len()).filter(|i| judged(&campaign.trials[*i])).collect();
    if chosen.is_empty() {
        let sweeps = campaign.trials.iter().any(|t| t.protocol.speed_rad_s().is_some());
        let cure = if sweeps { "judge the sweeps with --sweeps, or add such trials" } else { "add such trials" };
        return Problem::error(&campaign.file, "holds no cosine or free trial to judge a model on", cure).alone();
    }
    Ok(chosen)
}

/// The samples of `trial` that are judged under `prediction`: K_f known, and the low-pass past what it was before; in range.
pub fn judged(trial: &Trial, prediction: &Prediction, lowpass_hz: f64) -> Judged {
    let in_range = trial.in_range(lowpass_hz);
    let from = prediction.states.known_from + forgotten(trial.log.rate_hz, lowpass_hz);
    let samples: Vec<usize> = (from..trial.torque_nm.len()).filter(|at| in_range[*at]).collect();
    let stable = samples.iter().map(|at| prediction.states.is_stable(*at)).collect();
    Judged { samples, stable }
}

/// The campaign's low-pass for `trial`; `prepare` has made it before, so it can be made.
pub fn low_pass(campaign: &Campaign, trial: &Trial, mut signal: Vec<f64>) -> Vec<f64> {
    let filter = LowPass::new(campaign.signal.lowpass_order, campaign.signal.lowpass_hz, trial.log.rate_hz);
    if let Some(filter) = filter {
        filter.zero_phase_in_place(&mut signal);
    }
    signal
}

fn judge(
    campaign: &Campaign,
    index: usize,
    model: &Model,
    rivals: &[Rival],
) -> Result<(TrialEvaluation, Vec<String>, Fingerprint)> {
    let mut trial = read_trial(campaign, index).and_then(|log| prepare(campaign, index, log))?;
    let prediction = Prediction::new(model, &trial);
    let judged = judged(&trial, &prediction, campaign.signal.lowpass_hz);
    let filtered_nm = low_pass(campaign, &trial, prediction.torque_nm.clone());
    let mut warnings: Vec<String> = trial.log.warnings.iter().map(Problem::to_string).collect();
    warnings.extend(chatter_warning(&trial, model, &prediction));
    let mut view = View::new(&trial, &prediction, &filtered_nm, &judged);
    let filtered = judged.split(&trial.torque_nm, &filtered_nm);
    let raw = judged.split(&trial.log.torque_nm, &prediction.torque_nm);
    // What takes a column of a long log is let go as soon as its figures are taken.
    drop((prediction, filtered_nm));
    let of_rival = |rival: &Rival| match rival.source {
        Source::Model => (filtered, view.predicted_nm.clone()),
        _ => {
            let rival_nm = low_pass(campaign, &trial, with_curve(model, &rival.curve, rival.backlash_m, &trial));
            (judged.split(&trial.torque_nm, &rival_nm), View::thinned(&rival_nm))
        }
    };
    let (of_rivals, rivals_nm): (Vec<Split>, Vec<Vec<f64>>) = rivals.iter().map(of_rival).unzip();
    view.rivals_nm = rivals_nm;
    let entry = trial.entry.clone();
    let evaluation = TrialEvaluation { entry, filtered, raw, rivals: of_rivals, view };
    Ok((evaluation, warnings, std::mem::take(&mut trial.log.fingerprint)))
}

/// A word where the model follows the sign of a speed that is noise: (20) has no other way at rest.
fn chatter_warning(trial: &Trial, model: &Model, prediction: &Prediction) -> Option<String> {
    /// Changes of sign that are no chatter yet, beyond those of the motion.
    const FEW: usize = 10;
    let changes = |differ: &dyn Fn(usize) -> bool| (1..prediction.torque_nm.len()).filter(|i| differ(*i)).count();
    let states = &prediction.states;
    // An effect of the model may make the passage gradual: that is no change of sign.
    let of_speed = changes(&|i| (states.k_tilde[i] > 0.5) != (states.k_tilde[i - 1] > 0.5));
    let of_motion = changes(&|i| (states.k_f[i] > 0.0) != (states.k_f[i - 1] > 0.0));
    (model.combination == Combination::Sign && of_speed > of_motion + FEW).then(|| {
        format!(
            "{}: the speed changes its sign {of_speed} times where the motion turns {of_motion} times: at rest it is noise, and \
             the model's `sign` follows it",
            trial.entry.file
        )
    })
}

/// Trials by protocol, speed and trajectory, in the order of their first.
fn groups(trials: &[TrialEvaluation]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (at, trial) in trials.iter().enumerate() {
        let (protocol, trajectory) = (trial.entry.protocol, &trial.entry.trajectory);
        match groups.iter_mut().find(|g| g.protocol == protocol && g.trajectory == *trajectory) {
            Some(group) => group.trials.push(at),
            None => groups.push(Group {
                protocol,
                trajectory: trajectory.clone(),
                repeats: protocol != Protocol::Free || trajectory.is_some(),
                trials: vec![at],
                rmse_nm: Spread::of(std::iter::empty()),
                mae_nm: Spread::of(std::iter::empty()),
            }),
        }
    }
    for group in &mut groups {
        let all = || group.trials.iter().map(|at| trials[*at].filtered.all);
        (group.rmse_nm, group.mae_nm) = (Spread::of(all().map(|f| f.rmse_nm)), Spread::of(all().map(|f| f.mae_nm)));
    }
    groups
}
