//! A log made ready: torque low-passed, motion differentiated, sweeps cut into legs.

mod encoder;
mod legs;
mod series;

pub use legs::{Leg, find_legs};
pub use series::Series;

use crate::dynamics::JointKind;
use crate::log::{Campaign, Log, Protocol, TrialEntry};
use crate::numerics::difference::{acceleration, velocity};
use crate::numerics::filter::LowPass;
use crate::problem::{Problem, Result};
use encoder::Position;

/// The motion is low-passed at this many times the torque's cut-off ...
const MOTION_BANDWIDTH: f64 = 4.0;
/// ... and at no less than this, Hz: at 5 or 10 Hz the corners of a sweep are smeared until a perfect model shows a gap.
const MOTION_BANDWIDTH_MIN_HZ: f64 = 20.0;
/// ... nor at more than this share of the sample rate, where the filter would no longer be one.
const MOTION_BANDWIDTH_MAX: f64 = 0.4;

/// One trial, at the log's full rate, SI units.
#[derive(Debug, Clone)]
pub struct Trial {
    /// Position in the campaign's list.
    pub index: usize,
    /// What the campaign says of it.
    pub entry: TrialEntry,
    /// The log as read.
    pub log: Log,
    /// y after the campaign's zero-phase low-pass, N m.
    pub torque_nm: Vec<f64>,
    /// Position after the motion's low-pass, rad.
    pub position_rad: Vec<f64>,
    /// Speed, rad/s.
    pub velocity_rad_s: Vec<f64>,
    /// Acceleration, rad/s^2.
    pub acceleration_rad_s2: Vec<f64>,
    /// Measured load at the joint after the motion's low-pass, N m.
    pub load_torque_nm: Option<Vec<f64>>,
    /// Position that K_f follows, rad.
    pub followed_rad: Vec<f64>,
    /// Travel back below which nothing counts as a reversal: noise, rad.
    pub deadband_rad: f64,
    /// The encoder's step where it matters, else 0, rad.
    pub step_rad: f64,
    /// Constant-speed legs of a sweep; none for other protocols.
    pub legs: Vec<Leg>,
}

/// Filters and differentiates `log`, trial `index` of `campaign`, and cuts a sweep into its legs.
///
/// Errors: the sample rate does not carry the declared low-pass; a sweep without a leg at its declared speed.
pub fn prepare(campaign: &Campaign, index: usize, log: Log) -> Result<Trial> {
    let entry = campaign.trials[index].clone();
    let rate_hz = log.rate_hz;
    let too_slow = || {
        let what = format!("sampled at {rate_hz:.4} Hz, too slow for a low-pass at {} Hz", campaign.signal.lowpass_hz);
        Problem::error(&log.file, what, "lower lowpass_hz in campaign.toml below half the sample rate")
    };
    let lowpass =
        LowPass::new(campaign.signal.lowpass_order, campaign.signal.lowpass_hz, rate_hz).ok_or_else(too_slow)?;
    let motion = motion_filter(campaign.signal.lowpass_hz, rate_hz).ok_or_else(too_slow)?;
    let torque_nm = lowpass.zero_phase(&log.torque_nm);
    let position_rad = motion.zero_phase(&log.position_rad);
    let velocity_rad_s = match &log.velocity_rad_s {
        Some(recorded) => motion.zero_phase(recorded),
        None => velocity(&position_rad, rate_hz),
    };
    let acceleration_rad_s2 = match &log.velocity_rad_s {
        Some(_) => velocity(&velocity_rad_s, rate_hz),
        None => acceleration(&position_rad, rate_hz),
    };
    let load_torque_nm = log.load_torque_nm.as_ref().map(|load| motion.zero_phase(load));
    let Position { followed_rad, deadband_rad, step_rad } = Position::new(&log.position_rad, &position_rad);
    let legs = match entry.protocol {
        Protocol::Uniform { .. } if campaign.joint.kind == JointKind::Prismatic => {
            let what = "a uniform sweep of a prismatic joint: without an angle there is no y = A sin(theta) + B";
            return Problem::error(&log.file, what, "mark the trial `free`").alone();
        }
        Protocol::Uniform { speed_rad_s } => {
            find_legs(&log, &position_rad, speed_rad_s, campaign.joint.backlash_rad(), campaign.signal.lowpass_hz)?
        }
        _ => Vec::new(),
    };
    Ok(Trial {
        index,
        entry,
        torque_nm,
        position_rad,
        velocity_rad_s,
        acceleration_rad_s2,
        load_torque_nm,
        followed_rad,
        deadband_rad,
        step_rad,
        legs,
        log,
    })
}

/// The motion's low-pass: 4th order, its -3 dB well above what the torque's low-pass lets through.
fn motion_filter(lowpass_hz: f64, rate_hz: f64) -> Option<LowPass> {
    let cutoff_hz = (MOTION_BANDWIDTH * lowpass_hz).max(MOTION_BANDWIDTH_MIN_HZ).min(MOTION_BANDWIDTH_MAX * rate_hz);
    LowPass::new(4, cutoff_hz, rate_hz)
}
