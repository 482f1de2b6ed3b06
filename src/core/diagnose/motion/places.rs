//! Where a position difference lies, and what of it never repeats.

use super::MotionTrial;
use crate::diagnose::Diagnosis;
use crate::diagnose::locate::{Quantity, SHARE_MIN, Survey};
use crate::diagnose::measures::Measures;
use crate::effects::Region;
use crate::numerics::difference::{acceleration, velocity};

/// Speeds below this share of the fastest are no direction of motion: the joint rests, or turns.
const SLOW: f64 = 0.01;

/// A region of the gap in motion.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionPlace {
    /// Which.
    pub region: Region,
    /// Its bounds, with units.
    pub detail: String,
    /// Share of the gap's square above the floor.
    pub share_of_gap: f64,
    /// Share of the samples within the bounds.
    pub share_of_samples: f64,
    /// RMS of the position difference within the bounds, rad.
    pub rmse_rad: f64,
}

/// RMS of what differs between repeats of one motion, as one of them has it, rad; nothing without repeats.
pub(super) fn floor_rad(trials: &[MotionTrial]) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0usize);
    for (at, first) in trials.iter().enumerate() {
        for second in trials[at + 1..].iter().filter(|second| second.motion == first.motion) {
            let begin = |trial: &MotionTrial| (trial.time_s[0] * trial.rate_hz).round() as usize;
            let from = begin(first).max(begin(second));
            let [a, b] =
                [first, second].map(|t| t.position_difference_rad()[(from - begin(t)).min(t.time_s.len())..].to_vec());
            sum += a.iter().zip(&b).map(|(a, b)| (a - b).powi(2) / 2.0).sum::<f64>();
            count += a.len().min(b.len());
        }
    }
    (count > 0).then(|| (sum / count as f64).sqrt())
}

/// The regions of the position difference, by share. `real` says what kind of joint it is.
pub(super) fn locate(real: &Diagnosis, trials: &[MotionTrial], floor_rad: f64, lowpass_hz: f64) -> Vec<MotionPlace> {
    let residual: Vec<f64> = trials.iter().flat_map(MotionTrial::position_difference_rad).collect();
    let floor_square = floor_rad * floor_rad;
    let whole = residual.iter().map(|r| r * r - floor_square).sum::<f64>().max(f64::MIN_POSITIVE);
    let speeds: Vec<f64> = over(trials, |trial| velocity(&trial.position_rad, trial.rate_hz));
    let slow = SLOW * speeds.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let sign: Vec<f64> = speeds.iter().map(|v| if v.abs() > slow { v.signum() } else { 0.0 }).collect();
    let rows_per_independent = trials.iter().map(|t| t.rate_hz / (2.0 * lowpass_hz)).fold(1.0, f64::max);
    let survey = Survey { rows_per_independent, residual: &residual, sign: &sign, whole, floor_square };
    let mut found: Vec<MotionPlace> = quantities(real, trials, speeds)
        .iter()
        .filter_map(|quantity| survey.place(quantity))
        .map(|place| MotionPlace {
            region: place.region,
            detail: place.detail,
            share_of_gap: place.share_of_gap,
            share_of_samples: place.share_of_samples,
            rmse_rad: place.rmse_nm,
        })
        .filter(|place| place.share_of_gap >= SHARE_MIN)
        .collect();
    found.sort_by(|a, b| b.share_of_gap.total_cmp(&a.share_of_gap));
    found
}

fn quantities(real: &Diagnosis, trials: &[MotionTrial], speeds: Vec<f64>) -> Vec<Quantity> {
    let Measures { position: angle, speed: rate, acceleration: per_s2, simulated_load: load, torque, .. } =
        Measures::of(&real.before.joint);
    let quantity =
        |region, values, what, (unit, per): (&'static str, f64)| Quantity { region, values, means: (what, unit, per) };
    let accelerations = over(trials, |trial| acceleration(&trial.position_rad, trial.rate_hz));
    vec![
        quantity(Region::Position, over(trials, |trial| trial.position_rad.clone()), "position", angle),
        quantity(Region::AfterReversal, over(trials, travel_rad), "travel since the reversal", angle),
        quantity(Region::LowSpeed, speeds.iter().map(|v| v.abs()).collect(), "speed", rate),
        quantity(Region::Acceleration, accelerations, "acceleration", per_s2),
        quantity(Region::Load, over(trials, |trial| trial.simulated_nm.clone()), load, torque),
        quantity(Region::Time, over(trials, |trial| trial.time_s.clone()), "time in the trial", ("s", 1.0)),
    ]
}

fn over(trials: &[MotionTrial], of: impl Fn(&MotionTrial) -> Vec<f64>) -> Vec<f64> {
    trials.iter().flat_map(of).collect()
}

/// Travel since the recorded motion last turned, rad.
fn travel_rad(trial: &MotionTrial) -> Vec<f64> {
    let (mut turned, mut before, mut going) = (trial.position_rad[0], trial.position_rad[0], 0.0);
    let step = |q: &f64| {
        let way = q - before;
        if way * going < 0.0 {
            turned = before;
        }
        if way != 0.0 {
            going = way;
        }
        before = *q;
        (q - turned).abs()
    };
    trial.position_rad.iter().map(step).collect()
}
