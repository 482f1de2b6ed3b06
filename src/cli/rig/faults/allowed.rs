//! What a joint may do under a fault until its torque is off: the rig's limits and one braking ramp.
//!
//! **Speed**: the limit, with the share above it that is allowed to be measured. **Travel**: what passes at the limit of speed until the
//! fault is seen (`SEEN_CYCLES`), then one braking ramp, v^2 / 2a, at the limit of acceleration; it begins at the speed that is allowed. **Range**: the rig's, the lag and one
//! braking ramp. A drive that only ignores commands does what it is told until it is told to stop: its travel counts from then.
//!
//! Some faults exceed these limits whatever this program does, because they are over before anything that it sends can act. Such cases are
//! bounded as well, and listed by name with their reason:
//!
//! - **driven**: a drive that runs at another speed than it is told. All the torque that the rig lets the drive give acts on what it
//!   moves until a command can act, `ACTS_CYCLES` later; where the drive ignores the quick stop, until voltage is taken away. The same
//!   bounds a winch whose cable has broken, on which no joint hangs any more.
//! - **deaf**: a drive that ignores the quick stop follows its target to rest, for as long as it may take to obey (`OBEYING_S`).
//! - **cut off**: no frame reaches the drive, which goes on until its watchdog expires, or, where that has failed, until it gives up by
//!   its clock's pulses a cycle later (0x10F1:02).
//!
//! An encoder that loses count is none of these: the drive's own limit of speed (0x607F) is written in every mode.

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

/// The largest speed, and travel since the fault.
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
    /// Under `faults` that strike together.
    pub fn of(rig: &Rig, faults: &[Fault]) -> Self {
        let limits = &rig.limits;
        let ramp_rad = |speed_rad_s: f64| speed_rad_s.powi(2) / (2.0 * limits.acceleration_rad_s2);
        let seen_rad = SEEN_CYCLES * rig.bus.period_s() * limits.speed_rad_s;
        let within = Bound {
            speed_rad_s: ROOM * limits.speed_rad_s,
            travel_rad: seen_rad + ramp_rad(ROOM * limits.speed_rad_s),
        };
        let is_deaf = |fault: &Fault| matches!(fault, Fault::IgnoredQuickStop | Fault::IgnoredControl);
        let has = |fault: Fault| faults.contains(&fault);
        let deaf_s = if faults.iter().any(is_deaf) { OBEYING_S } else { 0.0 };
        let unwatched_s = if has(Fault::WatchdogOff { device: 0 }) { rig.bus.period_s() } else { 0.0 };
        let watchdog_s =
            if has(Fault::Gone { device: 0 }) { f64::from(rig.bus.watchdog_ms) * 1e-3 + unwatched_s } else { 0.0 };
        let driven_s = ACTS_CYCLES * rig.bus.period_s() + deaf_s + watchdog_s;
        let kick_rad_s = faults.iter().map(|fault| kick_rad_s(rig, *fault, driven_s)).fold(0.0, f64::max);
        let speed_rad_s = within.speed_rad_s + kick_rad_s;
        let lasts_s = deaf_s + watchdog_s;
        let travel_rad = seen_rad + ramp_rad(speed_rad_s) + lasts_s * speed_rad_s;
        let why = [(watchdog_s > 0.0, "cut off"), (kick_rad_s > 0.0, "driven"), (deaf_s > 0.0, "deaf")];
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
        // What is sent fades with the measured speed, whether the drive obeys its control word or not.
        Fault::Runaway { .. } => torque_nm / joint_kg_m2 * driven_s.min(2.0 * ACTS_CYCLES * rig.bus.period_s()),
        Fault::CableBreak => torque_nm / motor_kg_m2 * driven_s.min(2.0 * ACTS_CYCLES * rig.bus.period_s()),
        _ => 0.0,
    }
}
