//! A log made ready: torque low-passed, motion differentiated, sweeps cut into legs.

mod encoder;
mod legs;
mod rest;
mod rigid;
mod series;
mod set_aside;
mod stumps;

pub use legs::{Leg, find_legs, sweep_speeds};
pub use rest::{REST_RAD, REST_S, before_turns, rests};
pub use rigid::along;
pub use series::Series;
pub use stumps::{left_out, read_campaign};

use crate::dynamics::{Direction, Dynamics, JointKind, Motion, RigidTorque};
use crate::effects::Sample;
use crate::log::{Campaign, Log, Protocol, TrialEntry};
use crate::model::{Asked, Joint, Turn, directions, turns};
use crate::numerics::difference::{acceleration_at, velocity_at};
use crate::numerics::filter::LowPass;
use crate::numerics::line::crossing;
use crate::problem::{Problem, Result};
use crate::trajectory::Trajectory;
use encoder::Position;
pub use encoder::changes_rad;
use legs::cut;
use std::ops::Range;

/// The motion is low-passed at this many times the torque's cut-off ...
const MOTION_BANDWIDTH: f64 = 4.0;
/// ... and at no less than this, Hz: at 5 or 10 Hz the corners of a sweep are smeared until a perfect model shows a gap.
const MOTION_BANDWIDTH_MIN_HZ: f64 = 20.0;
/// ... nor at more than this share of the sample rate, where the filter would no longer be one.
const MOTION_BANDWIDTH_MAX: f64 = 0.4;
/// Order of the motion's low-pass.
const MOTION_ORDER: usize = 4;

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
    /// Position after the motion's low-pass, rad; of a coarse encoder what its jumps tell, as smooth as its readings allow.
    pub position_rad: Vec<f64>,
    /// The recorded speed after the motion's low-pass, rad/s.
    recorded_velocity_rad_s: Option<Vec<f64>>,
    /// Measured load at the joint after the motion's low-pass, N m.
    pub load_torque_nm: Option<Vec<f64>>,
    /// The joint's row of M a + C v + G of the whole chain, where the campaign has one, and how its gravity changes with the
    /// joint's position, N m/rad.
    pub chain: Option<Vec<(RigidTorque, f64)>>,
    /// The other joints as recorded, after the motion's low-pass, in the order of their columns.
    pub others: Vec<Vec<Motion>>,
    /// When the trial began, s since the campaign did; 0 where the campaign's clock is not needed.
    pub began_s: f64,
    /// What an encoder's jumps tell of the position, rad; nothing where it is as recorded.
    between_jumps_rad: Option<Vec<f64>>,
    /// Travel back below which nothing counts as a reversal: noise, rad.
    pub deadband_rad: f64,
    /// The encoder's step where it matters, else 0, rad.
    pub step_rad: f64,
    /// Constant-speed legs of a sweep; none for other protocols.
    pub legs: Vec<Leg>,
}

impl Trial {
    /// Speed at sample `at`, rad/s: the recorded one, else that of the position. Derivatives are taken where they are asked for:
    /// of a log of 40 million rows each would take 320 MB.
    pub fn velocity_rad_s(&self, at: usize) -> f64 {
        match &self.recorded_velocity_rad_s {
            Some(recorded) => recorded[at],
            None => velocity_at(&self.position_rad, self.log.rate_hz, at),
        }
    }

    /// Acceleration at sample `at`, rad/s^2.
    pub fn acceleration_rad_s2(&self, at: usize) -> f64 {
        match &self.recorded_velocity_rad_s {
            Some(recorded) => velocity_at(recorded, self.log.rate_hz, at),
            None => acceleration_at(&self.position_rad, self.log.rate_hz, at),
        }
    }

    /// The joint's motion at sample `at`.
    pub fn motion(&self, at: usize) -> Motion {
        let (velocity, acceleration) = (self.velocity_rad_s(at), self.acceleration_rad_s2(at));
        Motion { position: self.position_rad[at], velocity, acceleration }
    }

    /// Position that K_f follows, rad: as recorded, or what an encoder's jumps say of it.
    pub fn followed_rad(&self) -> &[f64] {
        self.between_jumps_rad.as_deref().unwrap_or(&self.log.position_rad)
    }

    /// Where it turns; see [`turns`].
    pub fn turns(&self) -> Vec<Turn> {
        turns(self.followed_rad(), |at| self.velocity_rad_s(at), self.deadband_rad)
    }

    /// The direction of its motion at each sample, its `turns` known; see [`directions`].
    pub fn directions(&self, turns: &[Turn]) -> Vec<Direction> {
        directions(self.followed_rad(), turns, self.deadband_rad)
    }

    /// What mass asks of the joint at sample `at`, N m: by the chain where the campaign has one, else by `dynamics`.
    pub fn rigid(&self, at: usize, kind: JointKind, dynamics: &Dynamics) -> RigidTorque {
        match &self.chain {
            Some(chain) => {
                let (rigid, slope_nm_rad) = chain[at];
                RigidTorque { gravity_nm: dynamics.at_true_position(rigid.gravity_nm, slope_nm_rad).0, ..rigid }
            }
            None => RigidTorque {
                gravity_nm: dynamics.gravity_nm(kind, self.position_rad[at]),
                inertia_nm: dynamics.inertia_kg_m2 * self.acceleration_rad_s2(at),
                coriolis_nm: 0.0,
            },
        }
    }

    /// What the sample `at` asks of the joint: mass and measured load.
    pub fn asked(&self, at: usize, kind: JointKind, dynamics: &Dynamics) -> Asked {
        let slope_nm_rad = self.slope_nm_rad(at, kind, dynamics);
        Asked { torque_nm: self.rigid(at, kind, dynamics).total_nm() + self.load_nm(at), slope_nm_rad }
    }

    /// dG/dq at sample `at`, N m/rad.
    pub fn slope_nm_rad(&self, at: usize, kind: JointKind, dynamics: &Dynamics) -> f64 {
        match &self.chain {
            Some(chain) => dynamics.at_true_position(chain[at].0.gravity_nm, chain[at].1).1,
            None => dynamics.gravity_slope_nm_rad(kind, self.position_rad[at]),
        }
    }

    /// The sample `at` as effects see it; `others` is room for the other joints' motions.
    pub fn sample<'o>(&self, at: usize, others: &'o mut Vec<Motion>) -> Sample<'o> {
        others.clear();
        others.extend(self.others.iter().map(|other| other[at]));
        let time_s = self.log.time_s[at] - self.log.time_s[0];
        Sample { time_s, elapsed_s: self.began_s + time_s, own: self.motion(at), others }
    }

    /// Measured load at the joint at sample `at`, N m; 0 where none is recorded.
    pub fn load_nm(&self, at: usize) -> f64 {
        self.load_torque_nm.as_ref().map_or(0.0, |load| load[at])
    }

    /// Whether the low-passed torque at each sample is free of readings that were set aside; see [`Self::clear_of`].
    pub fn in_range(&self, lowpass_hz: f64) -> Vec<bool> {
        self.clear_of(&self.log.set_aside, lowpass_hz)
    }

    /// Whether the low-passed torque at each sample is free of the readings in `ranges`, which a low-pass at `lowpass_hz` carries
    /// into their surroundings.
    pub fn clear_of(&self, ranges: &[Range<usize>], lowpass_hz: f64) -> Vec<bool> {
        let mut clear = vec![true; self.torque_nm.len()];
        let reach = (self.log.rate_hz / lowpass_hz) as usize;
        for range in ranges {
            let last = (range.end + reach).min(clear.len());
            let first = range.start.saturating_sub(reach).min(last);
            clear[first..last].fill(false);
        }
        clear
    }
}

/// Filters and differentiates `log`, trial `index` of `campaign`, and cuts a sweep into its legs.
///
/// Errors: the sample rate does not carry the declared low-pass; a sweep without a leg at its declared speed.
pub fn prepare(campaign: &Campaign, index: usize, mut log: Log) -> Result<Trial> {
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
    let recorded_velocity_rad_s = log.velocity_rad_s.as_ref().map(|recorded| motion.zero_phase(recorded));
    let load_torque_nm = log.load_torque_nm.as_ref().map(|load| motion.zero_phase(load));
    let others: Vec<Vec<Motion>> =
        log.other_position_rad.iter().map(|recorded| rigid::moving(recorded, &motion, rate_hz)).collect();
    let lowpass_hz = campaign.signal.lowpass_hz;
    let Position { between_jumps_rad, deadband_rad, step_rad } = Position::new(&log.position_rad, &position_rad);
    let smoothed = |between_rad: &Vec<f64>| {
        let low_passed = |cutoff_hz| Some(LowPass::new(MOTION_ORDER, cutoff_hz, rate_hz)?.zero_phase(between_rad));
        encoder::smoothed(&log.position_rad, step_rad, motion_cutoff_hz(lowpass_hz, rate_hz), low_passed)
    };
    let position_rad = between_jumps_rad.as_ref().and_then(smoothed).unwrap_or(position_rad);
    let legs = match entry.protocol {
        Protocol::Uniform { speed_rad_s } => find_legs(&log, &position_rad, speed_rad_s, &campaign.joint, lowpass_hz)?,
        _ => Vec::new(),
    };
    let (legs, warnings) = set_aside::leave_out(legs, &log, lowpass_hz);
    log.warnings.extend(warnings);
    let mut trial = Trial {
        index,
        entry,
        torque_nm,
        position_rad,
        recorded_velocity_rad_s,
        load_torque_nm,
        chain: None,
        others,
        began_s: campaign.began_s(index),
        between_jumps_rad,
        deadband_rad,
        step_rad,
        legs,
        log,
    };
    let all = 0..trial.position_rad.len();
    trial.chain = campaign.arm.as_ref().map(|arm| along(&arm.chain, &arm.others, &trial, all).collect());
    Ok(trial)
}

/// The fastest sweep, from `slowest_rad_s` to `fastest_rad_s`, that recorded at `rate_hz` has a leg to cut; `None` if not even
/// the slowest has.
pub fn fastest_sweep_rad_s(
    slowest_rad_s: f64,
    fastest_rad_s: f64,
    rate_hz: f64,
    joint: &Joint,
    lowpass_hz: f64,
) -> Option<f64> {
    /// Halvings of the range: to 1e-6 of it.
    const HALVINGS: usize = 20;
    let motion = motion_filter(lowpass_hz, rate_hz)?;
    let has_legs = |speed_rad_s: f64| {
        let positions_rad = motion.zero_phase(&Trajectory::sweep(speed_rad_s).positions_rad(rate_hz));
        !cut(&positions_rad, rate_hz, speed_rad_s, joint, lowpass_hz).legs.is_empty()
    };
    if has_legs(fastest_rad_s) {
        return Some(fastest_rad_s);
    }
    has_legs(slowest_rad_s).then(|| crossing(slowest_rad_s, fastest_rad_s, HALVINGS, has_legs))
}

/// The motion's low-pass, its -3 dB well above what the torque's low-pass lets through.
fn motion_filter(lowpass_hz: f64, rate_hz: f64) -> Option<LowPass> {
    LowPass::new(MOTION_ORDER, motion_cutoff_hz(lowpass_hz, rate_hz), rate_hz)
}

/// Cut-off of the motion's low-pass, Hz, for a torque low-passed at `lowpass_hz` and samples at `rate_hz`.
pub fn motion_cutoff_hz(lowpass_hz: f64, rate_hz: f64) -> f64 {
    (MOTION_BANDWIDTH * lowpass_hz).max(MOTION_BANDWIDTH_MIN_HZ).min(MOTION_BANDWIDTH_MAX * rate_hz)
}
