//! Trials read in parallel, each thinned to what the stages need before the next is opened.

use super::drift::{LegTime, leg_times};
use super::predicted::Prepared;
use super::sums::{LegSums, columns};
use crate::dynamics::JointKind;
use crate::log::{self, Campaign, Consequence, Fingerprint, TrialEntry, copies};
use crate::model::Direction;
use crate::numerics::statistics::root_mean_square;
use crate::prepare::{Series, Trial, prepare, sweep_speeds};
use crate::problem::{Problem, Problems, Result, Severity};
use rayon::prelude::*;
use std::borrow::Cow;

/// Samples kept of the sweep to look at.
const TRACE_SAMPLES: usize = 3000;

/// What stays of a trial.
#[derive(Debug, Clone)]
pub struct Reading {
    /// What the campaign says of it.
    pub entry: TrialEntry,
    /// Its legs, as sums.
    pub legs: Vec<LegSums>,
    /// The trial, thinned.
    pub prepared: Prepared,
    /// Rows of its log.
    pub rows: usize,
    /// Rows of its log per second, Hz.
    pub rate_hz: f64,
    /// How time goes with the regressor along each leg.
    pub times: Vec<LegTime>,
    /// What tells its recording from others.
    pub fingerprint: Fingerprint,
    /// Whether a finding in its signals takes the word `pinned` from what is identified.
    pub demotes: bool,
    /// Root mean square of what the low-pass takes from the torque, N m.
    pub noise_nm: f64,
    /// What to know of it.
    pub warnings: Vec<Problem>,
    /// The trial to look at, if it is this one.
    pub trace: Option<Trace>,
}

impl Reading {
    /// Speed at each sample of the thinned trial, rad/s; of a sweep as its legs are judged by.
    pub fn speeds_rad_s(&self) -> Cow<'_, [f64]> {
        let series = &self.prepared.series;
        match self.entry.protocol.speed_rad_s() {
            Some(speed_rad_s) => sweep_speeds(&series.position_rad, series.rate_hz, speed_rad_s).into(),
            None => (&series.velocity_rad_s).into(),
        }
    }
}

/// One sweep, to look at.
#[derive(Debug, Clone)]
pub struct Trace {
    /// Its file.
    pub file: String,
    /// Its declared speed, rad/s.
    pub speed_rad_s: f64,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// y as recorded, N m.
    pub raw_nm: Vec<f64>,
    /// y low-passed, N m.
    pub filtered_nm: Vec<f64>,
    /// Whether a measured load is part of what was fitted.
    pub with_load: bool,
    /// Fitted legs: direction, time (s) and A sin(theta + z) + B (N m) of the leg alone, with any measured load in it.
    pub legs: Vec<(Direction, Vec<(f64, f64)>)>,
}

/// Reads and prepares all trials of `campaign`, as many at once as there are threads; `progress` hears of each one done.
///
/// Errors: all that is wrong with any trial, in the campaign's order.
pub fn read_trials(campaign: &Campaign, progress: &(dyn Fn() + Sync)) -> Result<Vec<Reading>> {
    let (readings, problems): (Vec<_>, Vec<_>) = examine_trials(campaign, progress).into_iter().unzip();
    Problems(problems.concat()).unless_errors(readings.into_iter().flatten().collect())
}

/// The same, with everything that is wrong with each trial; those that cannot be used have no reading.
pub fn examine_trials(campaign: &Campaign, progress: &(dyn Fn() + Sync)) -> Vec<(Option<Reading>, Vec<Problem>)> {
    let shown = trial_to_show(campaign);
    let examine = |index: usize| {
        let examined = examine_trial(campaign, index, shown == Some(index));
        progress();
        (index, examined)
    };
    // The longest first: what is left at the end, when threads run out of work, is then short.
    let mut order: Vec<usize> = (0..campaign.trials.len()).collect();
    let size = |i: &usize| std::fs::metadata(campaign.folder.join(&campaign.trials[*i].file)).map_or(0, |m| m.len());
    order.sort_by_cached_key(|i| std::cmp::Reverse(size(i)));
    let mut examined: Vec<_> = order.into_par_iter().with_max_len(1).map(examine).collect();
    examined.sort_by_key(|(i, _)| *i);
    let mut examined: Vec<_> = examined.into_iter().map(|(_, examined)| examined).collect();
    refuse_copies(campaign, &mut examined);
    examined
}

/// Says of each trial that holds the same recording as an earlier one that it does.
fn refuse_copies(campaign: &Campaign, examined: &mut [(Option<Reading>, Vec<Problem>)]) {
    let prints: Vec<(usize, &Fingerprint)> = examined
        .iter()
        .enumerate()
        .filter_map(|(trial, (reading, _))| Some((trial, &reading.as_ref()?.fingerprint)))
        .collect();
    let found = copies(campaign, &prints);
    for (trial, problem) in found {
        examined[trial].1.push(problem);
    }
}

fn examine_trial(campaign: &Campaign, index: usize, show: bool) -> (Option<Reading>, Vec<Problem>) {
    let (log, mut problems) = log::examine_trial(campaign, index);
    let trial = log.and_then(|log| match prepare(campaign, index, log) {
        Ok(trial) => Some(trial),
        Err(Problems(found)) => {
            problems.extend(found);
            None
        }
    });
    problems.extend(trial.iter().flat_map(|trial| trial.log.warnings.clone()));
    let is_usable = problems.iter().all(|problem| problem.severity == Severity::Warning);
    (trial.filter(|_| is_usable).map(|trial| reading(campaign, trial, show)), problems)
}

/// The sweep of middle speed: neither the longest nor the shortest to look at.
fn trial_to_show(campaign: &Campaign) -> Option<usize> {
    let trials = campaign.trials.iter().enumerate();
    let mut sweeps: Vec<(usize, f64)> = trials.filter_map(|(i, t)| Some((i, t.protocol.speed_rad_s()?))).collect();
    sweeps.sort_by(|a, b| a.1.total_cmp(&b.1));
    sweeps.get(sweeps.len() / 2).map(|(i, _)| *i)
}

fn reading(campaign: &Campaign, mut trial: Trial, show: bool) -> Reading {
    let gravity_nm = campaign.dynamics.gravity_nm;
    let kind = campaign.joint.kind;
    let legs: Vec<LegSums> = trial.legs.iter().map(|leg| LegSums::new(&trial, leg, gravity_nm, kind)).collect();
    let series = Series::new(&trial, campaign.signal.lowpass_hz, kind, &campaign.dynamics);
    Reading {
        trace: show.then(|| trace(&trial, &legs, gravity_nm, kind)),
        noise_nm: noise_nm(&trial),
        prepared: Prepared::new(series, campaign.signal.lowpass_order, campaign.signal.lowpass_hz),
        rows: trial.log.time_s.len(),
        rate_hz: trial.log.rate_hz,
        times: leg_times(&trial, gravity_nm, kind),
        fingerprint: std::mem::take(&mut trial.log.fingerprint),
        demotes: trial.log.findings.iter().any(|finding| finding.consequence == Consequence::Demote),
        warnings: std::mem::take(&mut trial.log.warnings),
        entry: trial.entry,
        legs,
    }
}

/// Root mean square of what the low-pass takes from the torque, N m.
fn noise_nm(trial: &Trial) -> f64 {
    let taken = trial.log.torque_nm.iter().zip(&trial.torque_nm).map(|(raw, passed)| raw - passed);
    root_mean_square(&taken.collect::<Vec<f64>>())
}

fn trace(trial: &Trial, legs: &[LegSums], gravity_nm: f64, kind: JointKind) -> Trace {
    let step = trial.torque_nm.len().div_ceil(TRACE_SAMPLES);
    let thin = |values: &[f64]| values.iter().step_by(step).copied().collect();
    let line = |(leg, sums): (&crate::prepare::Leg, &LegSums)| {
        let (zero_rad, fit) = sums.alone();
        let (sin, cos) = zero_rad.sin_cos();
        let at = |i: usize| {
            let [gravity, slope, rest] = columns(trial, gravity_nm, kind, i);
            (trial.log.time_s[i], fit.a_nm * (cos * gravity + sin * slope + rest) + fit.b_nm)
        };
        (leg.direction, leg.used().step_by(step).map(at).collect())
    };
    Trace {
        file: trial.entry.file.clone(),
        with_load: trial.load_torque_nm.is_some(),
        speed_rad_s: trial.entry.protocol.speed_rad_s().unwrap_or(f64::NAN),
        time_s: thin(&trial.log.time_s),
        raw_nm: thin(&trial.log.torque_nm),
        filtered_nm: thin(&trial.torque_nm),
        legs: trial.legs.iter().zip(legs).map(line).collect(),
    }
}
