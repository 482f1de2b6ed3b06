//! The torque that a person adds: tau_E = y - (M a + C v + G + f), equation (31).
//!
//! The threshold for contact follows from the model's residual on quiet trials, in which nobody touches the joint; around reversals, where
//! the model is weak, the threshold and the uncertainty are those of quiet reversals.

mod causal;
mod compare;
mod contacts;
mod extract;
mod quiet;
mod stream;

pub use compare::Comparison;
pub use contacts::{Contact, contacts};
pub use extract::{Extracted, Filtering, Frame};
pub use quiet::{Levels, Quiet};
pub use stream::{Plausible, Stream, StreamOutput};

use crate::evaluate::fitted;
use crate::log::{Campaign, Protocol, TrialEntry, read_trial, refuse_copies};
use crate::model::Model;
use crate::prepare::{Trial, prepare};
use crate::problem::{Problem, Problems, Result};
use rayon::prelude::*;

/// How the torque is extracted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settings {
    /// Where the torque is wanted.
    pub frame: Frame,
    /// Whether to filter forwards only, as on a stream.
    pub causal: bool,
    /// The threshold of a contact, N m, in place of the one that quiet trials give.
    pub threshold_nm: Option<f64>,
}

/// One trial's interaction.
#[derive(Debug, Clone)]
pub struct TrialInteraction {
    /// What the campaign says of it.
    pub entry: TrialEntry,
    /// The torque, sample by sample.
    pub extracted: Extracted,
    /// When somebody touched the joint.
    pub contacts: Vec<Contact>,
    /// Against the torque measured independently, if there is one.
    pub comparison: Option<Comparison>,
}

/// A campaign's interaction.
#[derive(Debug, Clone)]
pub struct Interaction {
    /// The model.
    pub model: Model,
    /// How it was extracted.
    pub settings: Settings,
    /// What counts as contact, and how often it would falsely.
    pub quiet: Quiet,
    /// All interaction trials, in the campaign's order.
    pub trials: Vec<TrialInteraction>,
    /// How late the torque is, s: 0 with zero-phase filters.
    pub filter_delay_s: f64,
    /// Cut-off of the low-pass, Hz.
    pub lowpass_hz: f64,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Extracts the interaction torque of all interaction trials of `campaign`; `progress` hears of each trial read.
///
/// Errors: the model is of another joint; there is no interaction trial; all that is wrong with any trial.
pub fn run(
    campaign: &Campaign,
    model: &Model,
    settings: Settings,
    progress: &(dyn Fn() + Sync),
) -> Result<Interaction> {
    let (campaign, model, mut warnings) = fitted(campaign, model)?;
    let campaign = campaign.as_ref();
    let touched = trials(campaign, true);
    if touched.is_empty() {
        let cure = "mark the trials in which somebody touches the joint with protocol = \"interaction\"";
        return Problem::error(&campaign.file, "holds no interaction trial", cure).alone();
    }
    let filtering = filtering(campaign, settings.causal)?;
    let (quiet_ones, mut found) = all(campaign, &model, settings.frame, filtering, &trials(campaign, false), progress)?;
    warnings.append(&mut found);
    let (trials, mut found) = all(campaign, &model, settings.frame, filtering, &touched, progress)?;
    warnings.append(&mut found);
    let quiet = Quiet::new(&quiet_ones, &trials, settings.threshold_nm, campaign.signal.lowpass_hz);
    warnings.extend(quiet.warnings.iter().cloned());
    let trials: Vec<TrialInteraction> = touched
        .iter()
        .zip(trials)
        .map(|(index, extracted)| touched_trial(campaign, *index, extracted, &quiet))
        .collect();
    warnings.extend(trials.iter().filter_map(unknown_warning));
    warnings.extend(trials.iter().filter_map(|trial| frame_warning(trial, &model, settings.frame)));
    warnings.dedup();
    let filter_delay_s = trials.first().map_or(0.0, |trial| trial.extracted.filter_delay_s);
    let lowpass_hz = campaign.signal.lowpass_hz;
    Ok(Interaction { model, settings, quiet, trials, filter_delay_s, lowpass_hz, warnings })
}

/// How `campaign`'s trials are filtered; forwards only, what counts as a reversal is the same in all and on a stream.
fn filtering(campaign: &Campaign, causal: bool) -> Result<Filtering> {
    Ok(if causal {
        Filtering::Causal { deadband_rad: first_trial(campaign)?.deadband_rad }
    } else {
        Filtering::ZeroPhase
    })
}

/// The trial that the encoder's noise is taken from, and the rate where none is given.
fn first_trial(campaign: &Campaign) -> Result<Trial> {
    read_trial(campaign, 0).and_then(|log| prepare(campaign, 0, log))
}

/// A stream of samples of `campaign`'s joint at `rate_hz` (by default that of its first trial); what counts as contact comes from its quiet
/// trials, filtered as the stream will be.
///
/// Errors: as `run`.
pub fn stream_of(
    campaign: &Campaign,
    model: &Model,
    settings: Settings,
    rate_hz: Option<f64>,
    progress: &(dyn Fn() + Sync),
) -> Result<Stream> {
    let first = first_trial(campaign)?;
    let filtering = Filtering::Causal { deadband_rad: first.deadband_rad };
    let (found, mut warnings) = all(campaign, model, settings.frame, filtering, &trials(campaign, false), progress)?;
    // Only without quiet trials do the others serve.
    let touched = match found.is_empty() {
        true => all(campaign, model, settings.frame, filtering, &trials(campaign, true), progress)?.0,
        false => Vec::new(),
    };
    let mut quiet = Quiet::new(&found, &touched, settings.threshold_nm, campaign.signal.lowpass_hz);
    quiet.warnings.append(&mut warnings);
    let plausible = Plausible::after(&first.log, campaign.joint.transmission());
    let noise = (first.deadband_rad, plausible);
    Stream::new(campaign, model, settings.frame, quiet, rate_hz.unwrap_or(first.log.rate_hz), noise)
}

/// The interaction trials, or the quiet ones.
fn trials(campaign: &Campaign, touched: bool) -> Vec<usize> {
    let is = |index: &usize| (campaign.trials[*index].protocol == Protocol::Interaction) == touched;
    (0..campaign.trials.len()).filter(is).collect()
}

fn touched_trial(campaign: &Campaign, index: usize, extracted: Extracted, quiet: &Quiet) -> TrialInteraction {
    let lowpass_hz = campaign.signal.lowpass_hz;
    let contacts = contacts(&extracted, &extracted.torque_nm, &quiet.levels, lowpass_hz);
    let comparison = Comparison::new(&extracted, &quiet.levels, lowpass_hz);
    TrialInteraction { entry: campaign.trials[index].clone(), extracted, contacts, comparison }
}

/// The torque of the trials `chosen`, with their warnings; of quiet ones thinned, because their single samples are not needed.
fn all(
    campaign: &Campaign,
    model: &Model,
    frame: Frame,
    filtering: Filtering,
    chosen: &[usize],
    progress: &(dyn Fn() + Sync),
) -> Result<(Vec<Extracted>, Vec<String>)> {
    let one = |index: &usize| {
        let is_quiet = campaign.trials[*index].protocol != Protocol::Interaction;
        let thinned = |extracted: Extracted| match is_quiet {
            true => Extracted {
                warnings: extracted.warnings.clone(),
                ..quiet::thinned(&extracted, campaign.signal.lowpass_hz)
            },
            false => extracted,
        };
        let extracted =
            read_trial(campaign, *index).and_then(|log| prepare(campaign, *index, log)).and_then(|mut trial| {
                let print = std::mem::take(&mut trial.log.fingerprint);
                Ok((thinned(Extracted::new(campaign, model, frame, filtering, &trial)?), (*index, print)))
            });
        progress();
        extracted
    };
    let (mut done, mut warnings, mut problems) = (Vec::with_capacity(chosen.len()), Vec::new(), Vec::new());
    let mut prints = Vec::with_capacity(chosen.len());
    for extracted in chosen.par_iter().with_max_len(1).map(one).collect::<Vec<_>>() {
        match extracted {
            Ok((mut extracted, print)) => {
                warnings.append(&mut extracted.warnings);
                done.push(extracted);
                prints.push(print);
            }
            Err(Problems(found)) => problems.extend(found),
        }
    }
    if !problems.is_empty() {
        return Err(Problems(problems));
    }
    refuse_copies(campaign, &prints)?;
    Ok((done, warnings))
}

/// A word on the part of a trial in which contacts may go unseen.
fn unknown_warning(trial: &TrialInteraction) -> Option<String> {
    /// A share that is not worth a word.
    const LITTLE: f64 = 0.05;
    let known = &trial.extracted.known;
    let unknown = known.iter().filter(|known| !**known).count();
    let share = unknown as f64 / known.len() as f64;
    (share > LITTLE).then(|| {
        format!(
            "{}: in {:.0} % of it ({:.1} s) K_f is not known yet or the sensor was at its limit: no figure and no contact \
             smaller than the whole change of friction can be extracted there",
            trial.entry.file,
            100.0 * share,
            unknown as f64 / trial.extracted.rate_hz
        )
    })
}

/// The reference measures at the joint what the winch sees through the transmission: a slope that fits says so.
fn frame_warning(trial: &TrialInteraction, model: &Model, frame: Frame) -> Option<String> {
    /// The slope meets the transmission's within this factor ...
    const NEAR: f64 = 1.25;
    /// ... and is off 1 by more than this one.
    const FAR: f64 = 1.5;
    let slope = trial.comparison.as_ref()?.slope;
    let seen = model.joint.transmission() / model.friction.loss(0.5);
    let expected = if frame == Frame::Winch { seen } else { 1.0 / seen };
    let off = |a: f64, b: f64| (a / b).max(b / a);
    let told = slope > 0.0 && off(slope, expected) < NEAR && off(slope, 1.0) > FAR;
    let other = if frame == Frame::Winch { Frame::Joint } else { Frame::Winch };
    told.then(|| {
        format!(
            "{}: the extracted torque is {slope:.2} times the reference, as the transmission would have it: the reference \
             seems to be at the {}; --at {} extracts it there",
            trial.entry.file,
            other.name(),
            other.name()
        )
    })
}
