//! What a joint may do under a fault until its torque is off: the rig's limits and one braking ramp.
//!
//! **Speed**: the limit, with the share above it that is allowed to be measured. **Travel**: what passes at the limit of speed until the
//! fault is seen (`SEEN_CYCLES`), then one braking ramp, v^2 / 2a, at the limit of acceleration. **Range**: the rig's, the lag and one
//! braking ramp. A drive that only ignores commands does what it is told until it is told to stop: its travel counts from then.
//!
//! Some faults exceed that whatever this program does, because nothing that it sends acts before they have happened. Such cases are
//! bounded as well, and listed by name with their reason:
//!
//! - **driven**: an encoder that loses count, a drive that runs at another speed than it is told, a cable that breaks under load. All
//!   the torque that the rig lets the drive give acts on what it moves until a command can act, `ACTS_CYCLES` later; where the drive
//!   ignores the quick stop, until voltage is taken away. An encoder that loses count drives the joint no faster than sqrt(a d).
//! - **deaf**: a drive that ignores the quick stop follows its target to rest, for as long as it may take to obey (`OBEYING_S`).
//! - **coasts**: a winch without torque goes on, as little as friction takes, until the other drive has stopped the joint.
//! - **cut off**: no frame reaches the drive, which goes on until its watchdog expires.
//! - **unwatched**: the watchdog has failed as well, and only the drive's own limits of position are left.

use crate::bus::{Fault, MOTOR_INERTIA_KG_M2};
use crate::capture::axis::OBEYING_S;
use crate::capture::rig::Rig;
use std::ops::RangeInclusive;

/// By how much the true speed may be above the limit, as a share: what the rig allows a measurement.
const ROOM: f64 = 1.25;
/// Cycles until a command can act on a fault: sampled at the next pulse, decided and sent half a cycle later, acted on at the pulse
/// after that.
const ACTS_CYCLES: f64 = 2.0;
/// Cycles that may bring the evidence of a fault: a mailbox is looked at once in so many.
const SEEN_CYCLES: f64 = 10.0;

/// How long the other drive may take to bring the joint to rest and let go, s: its braking ramp, and what its status word takes.
const COASTS_S: f64 = 0.1;

/// What is allowed.
#[derive(Debug, Clone)]
pub(super) struct Allowed {
    pub within: Bound,
    /// What the fault does beyond that by itself, and why.
    pub beyond: Option<(&'static str, Bound)>,
    pub range_rad: RangeInclusive<f64>,
    /// Whether the way counts from the first command that is not to go on, and not from the fault.
    pub from_command: bool,
}

/// The largest speed, and travel since the fault; no bound of travel where only the range is left.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bound {
    pub speed_rad_s: f64,
    pub travel_rad: f64,
}

impl Bound {
    pub fn holds(&self, speed_rad_s: f64, travel_rad: f64) -> bool {
        speed_rad_s <= self.speed_rad_s && travel_rad <= self.travel_rad
    }
}

impl Allowed {
    /// Under `faults` that strike together; `is_winch` where what they strike is the second winch alone.
    pub fn of(rig: &Rig, faults: &[Fault], is_winch: bool) -> Self {
        let limits = &rig.limits;
        let ramp_rad = |speed_rad_s: f64| speed_rad_s.powi(2) / (2.0 * limits.acceleration_rad_s2);
        let seen_rad = SEEN_CYCLES * rig.bus.period_s() * limits.speed_rad_s;
        let within =
            Bound { speed_rad_s: ROOM * limits.speed_rad_s, travel_rad: seen_rad + ramp_rad(limits.speed_rad_s) };
        let is_deaf = |fault: &Fault| matches!(fault, Fault::IgnoredQuickStop | Fault::IgnoredControl);
        let has = |fault: Fault| faults.contains(&fault);
        let deaf_s = if faults.iter().any(is_deaf) { OBEYING_S } else { 0.0 };
        let watchdog_s = if has(Fault::Gone { device: 0 }) { f64::from(rig.bus.watchdog_ms) * 1e-3 } else { 0.0 };
        let driven_s = ACTS_CYCLES * rig.bus.period_s() + deaf_s + watchdog_s;
        let kick_rad_s = faults.iter().map(|fault| kick_rad_s(rig, *fault, driven_s)).fold(0.0, f64::max);
        let speed_rad_s = within.speed_rad_s + kick_rad_s;
        let coasts_s = if is_winch && has(Fault::Inhibit) { COASTS_S } else { 0.0 };
        let lasts_s = deaf_s + watchdog_s + coasts_s;
        let travel_rad = seen_rad + ramp_rad(limits.speed_rad_s + kick_rad_s) + lasts_s * speed_rad_s;
        let is_unwatched = has(Fault::WatchdogOff { device: 0 });
        let travel_rad = if is_unwatched { f64::INFINITY } else { travel_rad };
        let why = [
            (is_unwatched, "unwatched"),
            (watchdog_s > 0.0, "cut off"),
            (kick_rad_s > 0.0, "driven"),
            (deaf_s > 0.0, "deaf"),
            (coasts_s > 0.0, "coasts"),
        ];
        let why = why.into_iter().find_map(|(is_so, why)| is_so.then_some(why));
        let room_rad = limits.lag_rad + ramp_rad(within.speed_rad_s);
        Self {
            within,
            beyond: why.map(|why| (why, Bound { speed_rad_s, travel_rad })),
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
        // What is sent fades with the measured speed, whether the drive obeys its control word or not.
        Fault::Runaway { .. } => torque_nm / joint_kg_m2 * driven_s.min(2.0 * ACTS_CYCLES * rig.bus.period_s()),
        Fault::CableBreak => torque_nm / motor_kg_m2 * driven_s.min(2.0 * ACTS_CYCLES * rig.bus.period_s()),
        _ => 0.0,
    }
}
