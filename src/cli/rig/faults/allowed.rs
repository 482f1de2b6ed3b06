//! What a joint may do under a fault until its torque is off: the rig's limits and one braking ramp.
//!
//! **Speed**: the limit, with the share above it that is allowed to be measured. Some faults drive the joint by themselves, with all
//! the torque that the rig lets the drive give, before anybody can know: an encoder that loses count, a drive that runs at another speed
//! than it is told, a cable that breaks under load. No command can act earlier than three cycles after that (sampled, decided, acted
//! on), and a second one, where the drive ignores the first, no earlier than three more: by so much acceleration they may exceed it; an
//! encoder that loses count drives the joint no faster than it takes to make up for what it lost, sqrt(a d).
//!
//! **Way**: what it takes to see the fault (the way after which a joint must be seen to follow, twice, and ten cycles at the limit of
//! speed), then one stop (`stop_rad`: the braking ramp and the lag). Where no frame reaches the drive, what it goes on for until its
//! watchdog expires. A drive that only ignores commands does what it is told until it is told to stop: its way counts from then.
//!
//! **Range**: the rig's, the lag and one braking ramp. It is all that is left where no frame reaches the drive and its watchdog has
//! failed too: the drive's own limits of position.

use crate::bus::{Fault, MOTOR_INERTIA_KG_M2};
use crate::capture::rig::Rig;
use std::ops::RangeInclusive;

/// By how much the true speed may be above the limit, as a share: what the rig allows a measurement.
const ROOM: f64 = 1.25;
/// Cycles until a command can act on a fault: sampled, decided, acted on.
const ACTS_CYCLES: f64 = 3.0;
/// Cycles that may bring the evidence of a fault.
const SEEN_CYCLES: f64 = 10.0;

/// What is allowed.
#[derive(Debug, Clone)]
pub(super) struct Allowed {
    pub speed_rad_s: f64,
    /// Since the fault; nothing where only the range is left.
    pub travel_rad: Option<f64>,
    pub range_rad: RangeInclusive<f64>,
    /// Whether the way counts from the first command that is not to go on, and not from the fault.
    pub from_command: bool,
}

impl Allowed {
    /// Under `faults` that strike together.
    pub fn of(rig: &Rig, faults: &[Fault]) -> Self {
        let limits = &rig.limits;
        let (period_s, speed_rad_s) = (rig.bus.period_s(), ROOM * limits.speed_rad_s);
        let is_deaf = |fault: &Fault| matches!(fault, Fault::IgnoredQuickStop | Fault::IgnoredControl);
        let steps = if faults.iter().any(is_deaf) { 2.0 } else { 1.0 };
        let is_cut_off = faults.contains(&Fault::Gone { device: 0 });
        let watchdog_s = if is_cut_off { f64::from(rig.bus.watchdog_ms) * 1e-3 } else { 0.0 };
        let driven_s = steps * ACTS_CYCLES * period_s + watchdog_s;
        let kick_rad_s = faults.iter().map(|fault| kick_rad_s(rig, *fault, driven_s)).fold(0.0, f64::max);
        let seen_rad = 2.0 * limits.stuck_rad + SEEN_CYCLES * period_s * speed_rad_s;
        let is_unwatched = faults.contains(&Fault::WatchdogOff { device: 0 });
        let ramp_rad = speed_rad_s.powi(2) / (2.0 * limits.acceleration_rad_s2);
        let room_rad = limits.lag_rad + ramp_rad;
        Self {
            speed_rad_s: speed_rad_s + kick_rad_s,
            travel_rad: (!is_unwatched).then_some(seen_rad + watchdog_s * speed_rad_s + limits.stop_rad),
            range_rad: limits.low_rad - room_rad..=limits.high_rad + room_rad,
            from_command: faults.iter().all(is_deaf),
        }
    }
}

/// The speed that a fault gives to the joint by itself within `driven_s`, rad/s: all the torque the drive may give on what it moves. A
/// motor alone in torque mode is kept by the drive's own limit of speed (0x607F) where no frame reaches it.
fn kick_rad_s(rig: &Rig, fault: Fault, driven_s: f64) -> f64 {
    let transmission = rig.joint.transmission();
    let motor_kg_m2 = MOTOR_INERTIA_KG_M2 / transmission.powi(2);
    let joint_kg_m2 = motor_kg_m2 + rig.dynamics.inertia_kg_m2;
    let torque_nm = rig.drive.torque_max_nm / transmission;
    match fault {
        Fault::EncoderJump { by_rad } => {
            let driven_rad_s2 = torque_nm / joint_kg_m2;
            (driven_rad_s2 * driven_s).min((driven_rad_s2 * by_rad.abs()).sqrt())
        }
        Fault::Runaway { .. } => torque_nm / joint_kg_m2 * driven_s,
        Fault::CableBreak => torque_nm / motor_kg_m2 * driven_s.min(2.0 * ACTS_CYCLES * rig.bus.period_s()),
        _ => 0.0,
    }
}
