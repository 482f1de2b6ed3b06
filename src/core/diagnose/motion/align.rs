//! A recorded trial and its simulated partner on one grid of time.
//!
//! Logs need not begin at the same moment of the command. The shift at which the positions agree best is found, but a joint
//! under a controller may lag for good reason (drag delays it, whatever the clocks): so the shift is taken for the clocks'
//! only if the torques then differ less from what the controller answers to the positions than without it.

use super::controller;
use super::pairs::Pair;
use crate::diagnose::record::SAMPLES_PER_PERIOD;
use crate::log::{Campaign, read_trial};
use crate::numerics::filter::LowPass;
use crate::numerics::resample::between;
use crate::numerics::statistics::root_mean_square;
use crate::prepare::{Trial, prepare};
use crate::problem::Result;

/// The largest shift looked for, s ...
const LAG_MAX_S: f64 = 5.0;
/// ... and the largest as a share of the shorter log.
const LAG_SHARE: f64 = 0.2;
/// Steps of the search, s: each about the best of the one before; no motion turns round within the first.
const STEPS_S: [f64; 4] = [0.05, 0.005, 5e-4, 5e-5];
/// Samples compared in a search.
const COMPARED: usize = 4000;
/// A shift is due to the clocks if with it the torques' residual is below this share of the controller's residual without it: the noise of
/// both torques is in each.
const CLEARER: f64 = 0.95;
/// Shifts below this are negligible, s: a sample at 1 kHz.
const LEAST_S: f64 = 1e-3;

/// A recorded trial and its simulated partner, resampled, as the command's time goes.
#[derive(Debug, Clone)]
pub struct MotionTrial {
    /// The recorded log.
    pub file: String,
    /// The simulated log.
    pub partner: String,
    /// What it repeats: trials of one protocol, speed and trajectory share it.
    pub motion: String,
    /// Samples a second.
    pub rate_hz: f64,
    /// By how much later the recorded positions agree best with the simulated ones, s.
    pub lag_s: f64,
    /// The part of it that was taken for the clocks' and shifted away, s.
    pub shifted_s: f64,
    /// Since the simulated log began, s.
    pub time_s: Vec<f64>,
    /// Recorded, rad.
    pub position_rad: Vec<f64>,
    /// Simulated, rad.
    pub simulated_rad: Vec<f64>,
    /// Recorded y, low-passed, N m.
    pub torque_nm: Vec<f64>,
    /// Simulated y, low-passed, N m.
    pub simulated_nm: Vec<f64>,
}

impl MotionTrial {
    /// Recorded less simulated, rad.
    pub fn position_difference_rad(&self) -> Vec<f64> {
        less(&self.position_rad, &self.simulated_rad)
    }

    /// Recorded less simulated, low-passed, N m.
    pub fn torque_difference_nm(&self) -> Vec<f64> {
        less(&self.torque_nm, &self.simulated_nm)
    }

    /// RMS of the position difference, rad.
    pub fn rmse_rad(&self) -> f64 {
        root_mean_square(&self.position_difference_rad())
    }

    /// The largest position difference, rad.
    pub fn peak_rad(&self) -> f64 {
        peak(&self.position_difference_rad())
    }

    /// RMS of the torque difference, N m.
    pub fn rmse_nm(&self) -> f64 {
        root_mean_square(&self.torque_difference_nm())
    }

    /// The largest torque difference, N m.
    pub fn peak_nm(&self) -> f64 {
        peak(&self.torque_difference_nm())
    }

    /// A shift that was found and not made, in words.
    pub(super) fn doubt(&self) -> Option<String> {
        (self.shifted_s == 0.0 && self.lag_s.abs() >= 20.0 * LEAST_S).then(|| {
            format!(
                "{} agrees best with its simulation {:.3} s later; taken for the controller's doing, not for the clocks'",
                self.file, self.lag_s
            )
        })
    }
}

fn less(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn peak(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// The trials of `pair` side by side.
///
/// Errors: all that is wrong with either log.
pub(super) fn trial(real: &Campaign, simulated: &Campaign, pair: Pair) -> Result<MotionTrial> {
    let read = |campaign: &Campaign, at: usize| read_trial(campaign, at).and_then(|log| prepare(campaign, at, log));
    let (ours, theirs) = (read(real, pair.0)?, read(simulated, pair.1)?);
    let most_hz = SAMPLES_PER_PERIOD * real.signal.lowpass_hz;
    let rate_hz = most_hz.min(ours.log.rate_hz).min(theirs.log.rate_hz);
    let lag_s = lag_s(&ours, &theirs);
    let as_logged = side_by_side(&ours, &theirs, rate_hz, 0.0);
    let shifted = MotionTrial { lag_s, ..side_by_side(&ours, &theirs, rate_hz, lag_s) };
    let lowpass = LowPass::new(real.signal.lowpass_order, real.signal.lowpass_hz, rate_hz);
    let left = |trial: &MotionTrial| controller::left_square(trial, lowpass.as_ref());
    let is_clocks = lag_s.abs() >= LEAST_S && left(&shifted) < CLEARER * left(&as_logged);
    Ok(if is_clocks { shifted } else { MotionTrial { lag_s, ..as_logged } })
}

/// By how much later `ours` agrees best with `theirs` in position, s: coarse to fine.
fn lag_s(ours: &Trial, theirs: &Trial) -> f64 {
    let duration_s = |trial: &Trial| trial.position_rad.len() as f64 / trial.log.rate_hz;
    let shorter_s = duration_s(ours).min(duration_s(theirs));
    let most_s = LAG_MAX_S.min(LAG_SHARE * shorter_s);
    let compared_hz = (COMPARED as f64 / shorter_s).min(ours.log.rate_hz);
    let (mut best_s, mut reach_s) = (0.0, most_s);
    for step_s in STEPS_S {
        let count = (reach_s / step_s).round() as i32;
        let middle_s = best_s;
        // From the middle outwards: of lags that do as well the smaller one is taken.
        let mut outwards: Vec<i32> = (-count..=count).collect();
        outwards.sort_by_key(|n| n.abs());
        let lags = outwards.into_iter().map(|n| middle_s + step_s * f64::from(n)).filter(|lag_s| lag_s.abs() <= most_s);
        let apart = |lag_s: f64| side_by_side(ours, theirs, compared_hz, lag_s).rmse_rad();
        let (mut least, mut at_s) = (apart(middle_s), middle_s);
        for lag_s in lags {
            let now = apart(lag_s);
            if now < least {
                (least, at_s) = (now, lag_s);
            }
        }
        (best_s, reach_s) = (at_s, 2.0 * step_s);
    }
    best_s
}

/// Both at `rate_hz`, `ours` read `lag_s` later than `theirs`.
fn side_by_side(ours: &Trial, theirs: &Trial, rate_hz: f64, lag_s: f64) -> MotionTrial {
    let last_s = |trial: &Trial| (trial.position_rad.len().max(1) - 1) as f64 / trial.log.rate_hz;
    let first = ((-lag_s).max(0.0) * rate_hz).ceil() as usize;
    let until = (last_s(theirs).min(last_s(ours) - lag_s) * rate_hz).max(0.0) as usize;
    let time_s: Vec<f64> = (first..=until.max(first)).map(|i| i as f64 / rate_hz).collect();
    let read = |values: &[f64], trial: &Trial, later_s: f64| -> Vec<f64> {
        time_s.iter().map(|t| between(values, (t + later_s) * trial.log.rate_hz)).collect()
    };
    MotionTrial {
        file: ours.entry.file.clone(),
        partner: theirs.entry.file.clone(),
        motion: format!("{:?} {:?}", ours.entry.protocol, ours.entry.trajectory),
        rate_hz,
        lag_s,
        shifted_s: lag_s,
        position_rad: read(&ours.position_rad, ours, lag_s),
        simulated_rad: read(&theirs.position_rad, theirs, 0.0),
        torque_nm: read(&ours.torque_nm, ours, lag_s),
        simulated_nm: read(&theirs.torque_nm, theirs, 0.0),
        time_s,
    }
}
