//! y less the prediction, sample by sample, with where it can be trusted.

use super::causal::Estimator;
use crate::evaluate::low_pass;
use crate::log::Campaign;
use crate::model::{Both, Model};
use crate::numerics::statistics::quantile;
use crate::predict::{forgotten, torque_nm};
use crate::prepare::Trial;
use crate::problem::Result;

/// Where the interaction torque is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Frame {
    /// At the winch, where the sensor is: y less the prediction, as (31) has it.
    #[default]
    Winch,
    /// At the joint: what there makes the winch see that, through transmission and load-dependent friction.
    Joint,
}

impl Frame {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Winch => "winch",
            Self::Joint => "joint",
        }
    }

    /// A torque at the winch times this is one in this frame, where friction stands at `k_tilde`.
    pub fn factor(self, model: &Model, k_tilde: f64) -> f64 {
        match self {
            Self::Winch => 1.0,
            Self::Joint => model.friction.loss(k_tilde) / model.joint.transmission(),
        }
    }
}

/// How torque and prediction are low-passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Filtering {
    /// Forwards and backwards: nothing is late.
    ZeroPhase,
    /// Forwards only, as on a stream.
    Causal {
        /// Travel back below which nothing counts as a reversal, rad.
        deadband_rad: f64,
    },
}

/// The interaction torque of one trial.
#[derive(Debug, Clone, Default)]
pub struct Extracted {
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// tau_E, low-passed, N m.
    pub torque_nm: Vec<f64>,
    /// The same measured independently, through the same low-pass, N m.
    pub reference_nm: Option<Vec<f64>>,
    /// Whether friction is changing over, or was within the low-pass' reach: the model is weak there.
    pub weak: Vec<bool>,
    /// Whether K_f is known and the sensor in range.
    pub known: Vec<bool>,
    /// How far off tau_E may be where K_f is not known: the whole change of friction, N m.
    pub change_nm: Vec<f64>,
    /// How late the torque is, s.
    pub filter_delay_s: f64,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Taken for free of contact in a trial that rests throughout, s.
const TARE_S: f64 = 0.5;

impl Extracted {
    /// Of `trial` by `model`. Errors: the log's rate does not carry the low-pass.
    pub fn new(campaign: &Campaign, model: &Model, frame: Frame, filtering: Filtering, trial: &Trial) -> Result<Self> {
        let mut extracted = match filtering {
            Filtering::ZeroPhase => Self::zero_phase(campaign, model, frame, trial),
            Filtering::Causal { deadband_rad } => Self::causal(campaign, model, frame, deadband_rad, trial)?,
        };
        extracted.spread_weakness(campaign.signal.lowpass_hz);
        Ok(extracted)
    }

    fn zero_phase(campaign: &Campaign, model: &Model, frame: Frame, trial: &Trial) -> Self {
        let (predicted_nm, states) = torque_nm(model, trial);
        let predicted_nm = low_pass(campaign, trial, predicted_nm);
        let n = trial.torque_nm.len();
        let factor = |i: usize| frame.factor(model, states.k_tilde[i]);
        let lowpass_hz = campaign.signal.lowpass_hz;
        let in_range = trial.in_range(lowpass_hz);
        let known_from = states.known_from + forgotten(trial.log.rate_hz, lowpass_hz);
        let mut made = Self {
            rate_hz: trial.log.rate_hz,
            time_s: trial.log.time_s.clone(),
            torque_nm: (0..n).map(|i| factor(i) * (trial.torque_nm[i] - predicted_nm[i])).collect(),
            reference_nm: trial.log.reference_torque_nm.as_ref().map(|r| low_pass(campaign, trial, r.clone())),
            weak: (0..n).map(|i| !states.is_stable(i)).collect(),
            known: (0..n).map(|i| i >= known_from && in_range[i]).collect(),
            change_nm: (0..n).map(|i| factor(i) * change_nm(model, trial.velocity_rad_s(i))).collect(),
            filter_delay_s: 0.0,
            warnings: trial.log.warnings.iter().map(ToString::to_string).collect(),
        };
        // A joint that moves through its clearance only at the very end is no joint that rests.
        if states.known_from >= n {
            made.tare(&trial.entry.file);
        }
        made
    }

    fn causal(campaign: &Campaign, model: &Model, frame: Frame, deadband_rad: f64, trial: &Trial) -> Result<Self> {
        let mut estimator = Estimator::new(campaign, model, frame, trial.log.rate_hz, deadband_rad)?;
        let log = &trial.log;
        let mut made = Self {
            rate_hz: log.rate_hz,
            time_s: log.time_s.clone(),
            filter_delay_s: estimator.delay_s(),
            warnings: log.warnings.iter().map(ToString::to_string).collect(),
            ..Self::default()
        };
        let in_range = trial.in_range(campaign.signal.lowpass_hz);
        let mut others = vec![0.0; log.other_position_rad.len()];
        for i in 0..log.time_s.len() {
            others.iter_mut().zip(&log.other_position_rad).for_each(|(slot, column)| *slot = column[i]);
            let load_nm = log.load_torque_nm.as_ref().map_or(0.0, |load| load[i]);
            let step = estimator.step(log.position_rad[i], log.torque_nm[i], load_nm, &others);
            made.torque_nm.push(step.torque_nm);
            made.weak.push(step.weak);
            made.known.push(step.known && in_range[i]);
            made.change_nm.push(step.change_nm);
        }
        made.reference_nm = log.reference_torque_nm.as_ref().map(|reference| {
            let mut filter = estimator.like_the_torque();
            reference.iter().map(|r| filter.step(*r)).collect()
        });
        Ok(made)
    }

    /// The low-pass smears what happens in a transition by half a period to either side; forwards only, by a whole one.
    fn spread_weakness(&mut self, lowpass_hz: f64) {
        let period = (self.rate_hz / lowpass_hz) as usize;
        let (ahead, reach) = if self.filter_delay_s > 0.0 { (0, period) } else { (period / 2, period / 2) };
        let inside: Vec<usize> = (0..self.weak.len()).filter(|i| self.weak[*i]).collect();
        for run in inside.chunk_by(|a, b| a + 1 == *b) {
            let from = run[0].saturating_sub(ahead);
            let to = (run[run.len() - 1] + reach).min(self.weak.len() - 1);
            self.weak[from..=to].fill(true);
        }
    }

    /// A trial at rest throughout does not determine K_f: the friction at its beginning is then taken from the residual.
    fn tare(&mut self, file: &str) {
        let n = ((TARE_S * self.rate_hz) as usize).min(self.torque_nm.len());
        let level = quantile(&mut self.torque_nm[..n].to_vec(), 0.5);
        if level.is_finite() {
            self.torque_nm.iter_mut().for_each(|y| *y -= level);
            self.known.fill(true);
            self.weak.fill(true);
            self.warnings.push(format!(
                "{file}: the joint rests throughout, so the friction it holds is not known: what the sensor shows in the \
                 first {TARE_S} s, {level:.3} N m beyond the prediction, is taken for it"
            ));
        }
    }

    /// Its first and its second half.
    pub fn halves(&self) -> Vec<Self> {
        let middle = self.torque_nm.len() / 2;
        [0..middle, middle..self.torque_nm.len()]
            .map(|part| Self {
                rate_hz: self.rate_hz,
                time_s: self.time_s[part.clone()].to_vec(),
                torque_nm: self.torque_nm[part.clone()].to_vec(),
                weak: self.weak[part.clone()].to_vec(),
                known: self.known[part.clone()].to_vec(),
                change_nm: self.change_nm[part].to_vec(),
                ..Self::default()
            })
            .to_vec()
    }

    /// Of every `step`th sample.
    pub fn thinned(&self, step: usize) -> Self {
        let thin = |values: &[f64]| values.iter().step_by(step).copied().collect::<Vec<f64>>();
        let flags = |values: &[bool]| values.iter().step_by(step).copied().collect::<Vec<bool>>();
        Self {
            rate_hz: self.rate_hz / step as f64,
            time_s: thin(&self.time_s),
            torque_nm: thin(&self.torque_nm),
            reference_nm: self.reference_nm.as_deref().map(thin),
            weak: flags(&self.weak),
            known: flags(&self.known),
            change_nm: thin(&self.change_nm),
            filter_delay_s: self.filter_delay_s,
            warnings: Vec::new(),
        }
    }
}

/// Bu - Bd as the sensor sees it, N m: how far friction can be off where its branch is not known.
pub(super) fn change_nm(model: &Model, velocity_rad_s: f64) -> f64 {
    let Both { up, down } = model.branches_nm(velocity_rad_s);
    ((up - down) / model.friction.loss(0.5)).abs()
}
