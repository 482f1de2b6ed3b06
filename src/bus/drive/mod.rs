//! A drive after CiA 402: its states, its modes, what it watches, and how it stops.

mod objects;
mod power;

pub use objects::{COUNTS_PER_REVOLUTION, RATED_TORQUE_MNM};

use super::application::{Application, Moment};
use super::clock::Clock;
use super::coe::{Dictionary, Emergency};
use super::description::Description;
use super::device::Device;
use super::fault::Fault;
use super::terminal::VENDOR;
use super::world::{Joint, Law, World};
use objects::{COUNTS_PER_RAD, CSP, CST, CSV, NM_PER_MILLE};
use power::Power;

/// Product code of the drive.
pub const PRODUCT: u32 = 0x0402;
/// Error codes (CiA 402-2, table 5; ETG.6010).
const FOLLOWING_ERROR: u16 = 0x8611;
const COMMUNICATION: u16 = 0x7500;
const POSITION_RANGE: u16 = 0x8600;
/// A speed below which the motor stands, rad/s.
const STANDS_RAD_S: f64 = 1e-3;
/// The motor runs no faster, rad/s at the joint.
const FASTEST_RAD_S: f64 = 50.0;
/// How long a command is good for beyond the period in which the next is due, ns: a pulse may come late.
const GRACE_NS: u64 = 1_000_000;
/// The most that a command of speed gets ahead of the motor, rad: the motor's limit is met before.
const AHEAD_RAD: f64 = 0.05;

/// What a drive does by itself without the optional objects 0x6072, 0x605A and 0x605E, 0x6084 and 0x6085: per mille of rated torque,
/// braking, counts/s^2 (20 rad/s^2).
const OWN_TORQUE: i64 = 1500;
const OWN_OPTION: i64 = 2;
const OWN_RAMP: i64 = (20.0 * COUNTS_PER_RAD) as i64;

/// The drive behind its bus interface.
#[derive(Debug)]
struct Drive {
    power: Power,
    mode: i64,
    control: u16,
    /// CiA 402 code, 0 without a fault.
    error: u16,
    /// What an injected fault asks for.
    injected: Option<Fault>,
    inhibited: bool,
    limit_shown: bool,
    /// Where a stop has got to: speed that is left, rad/s.
    stopping_rad_s: f64,
    /// Since when the following error is too large.
    strays_since_ns: Option<u64>,
    target: i64,
    /// Whether the last target stayed away.
    bridges: bool,
    was_operational: bool,
    worked_ns: u64,
    defects: Defects,
}

/// What is wrong with it for good.
#[derive(Debug, Clone, Copy)]
struct Defects {
    frozen_encoder: bool,
    ignores_control: bool,
    ignores_quick_stop: bool,
    /// How many times the speed that it is told it runs at.
    runaway: f64,
}

/// The device; its clock runs `drift_ppb` too fast.
pub fn device(drift_ppb: i64) -> Device {
    device_with(drift_ppb, true, &[])
}

/// The same, without the objects `without` (index of each), and whether its EEPROM has its outputs feed the watchdog.
pub fn device_with(drift_ppb: i64, feeds_watchdog: bool, without: &[u16]) -> Device {
    let mut dictionary = objects::dictionary();
    without.iter().for_each(|index| dictionary.remove(*index));
    let description = Description {
        identity: [VENDOR, PRODUCT, 1, 42],
        names: ["TL7402", "Drive", "Winch drive, CiA 402"],
        dictionary,
        mailbox: true,
        clock: Some(Clock::new(1_234_567_890, drift_ppb)),
        feeds_watchdog,
    };
    let drive = Drive {
        power: Power::SwitchOnDisabled,
        mode: CSP,
        control: 0,
        error: 0,
        injected: None,
        inhibited: false,
        limit_shown: false,
        stopping_rad_s: 0.0,
        strays_since_ns: None,
        target: 0,
        bridges: false,
        was_operational: false,
        worked_ns: 0,
        defects: Defects { frozen_encoder: false, ignores_control: false, ignores_quick_stop: false, runaway: 1.0 },
    };
    Device::new(description, Box::new(drive))
}

impl Application for Drive {
    fn work(&mut self, objects: &mut Dictionary, world: &mut World, moment: Moment) -> Option<Emergency> {
        let joint = world.joint.as_mut()?;
        let warning = self.fault(objects, joint, moment);
        self.obey(objects, joint, moment);
        joint.motor.limit_nm = own(objects, 0x6072, OWN_TORQUE) as f64 * NM_PER_MILLE;
        self.steer(objects, joint, moment);
        self.tell(objects, joint, moment);
        self.worked_ns = moment.now_ns;
        self.was_operational = moment.operational;
        warning
    }

    fn fail(&mut self, fault: Fault) {
        match fault {
            Fault::Drive { .. } | Fault::QuickStop => self.injected = Some(fault),
            Fault::Inhibit => self.inhibited = true,
            Fault::InternalLimit => self.limit_shown = true,
            Fault::FrozenEncoder => self.defects.frozen_encoder = true,
            Fault::IgnoredControl => self.defects.ignores_control = true,
            Fault::IgnoredQuickStop => self.defects.ignores_quick_stop = true,
            Fault::Runaway { factor } => self.defects.runaway = factor,
            _ => {}
        }
    }
}

impl Drive {
    /// What it finds wrong by itself.
    fn fault(&mut self, objects: &Dictionary, joint: &mut Joint, moment: Moment) -> Option<Emergency> {
        let enabled = self.power == Power::Enabled;
        let lost =
            self.was_operational && !moment.operational && matches!(self.power, Power::Enabled | Power::QuickStop);
        let code = match self.injected.take() {
            Some(Fault::Drive { code }) => Some(code),
            Some(Fault::QuickStop) if enabled => {
                self.enter(Power::QuickStop, joint, moment);
                None
            }
            _ if lost => Some(COMMUNICATION),
            _ if enabled && self.strays(objects, joint, moment) => Some(FOLLOWING_ERROR),
            _ if enabled && self.leaves_range(objects, joint) => Some(POSITION_RANGE),
            _ => None,
        };
        if self.inhibited {
            self.enter(Power::SwitchOnDisabled, joint, moment);
        }
        let code = code.filter(|_| !matches!(self.power, Power::Fault | Power::FaultReaction))?;
        self.error = code;
        let moves = matches!(self.power, Power::Enabled | Power::QuickStop) && own(objects, 0x605E, OWN_OPTION) != 0;
        self.enter(if moves { Power::FaultReaction } else { Power::Fault }, joint, moment);
        Some(Emergency { code, register: if code == FOLLOWING_ERROR { 0x21 } else { 0x81 } })
    }

    /// Whether the motor is farther from its command than it may, for longer than it may.
    fn strays(&mut self, objects: &Dictionary, joint: &Joint, moment: Moment) -> bool {
        let window = objects.unsigned(0x6065, 0);
        let commanded = joint.motor.law.command(moment.now_ns).filter(|_| self.mode == CSP);
        let behind = commanded.map_or(0.0, |(position_rad, _)| (position_rad - joint.encoder_rad()) * COUNTS_PER_RAD);
        if window == u64::from(u32::MAX) || behind.abs() <= window as f64 {
            self.strays_since_ns = None;
            return false;
        }
        let since_ns = *self.strays_since_ns.get_or_insert(moment.now_ns);
        moment.now_ns - since_ns >= objects.unsigned(0x6066, 0) * 1_000_000
    }

    /// Whether the motor is beyond the drive's own limits of position (0x607D) and goes on outwards, in speed and torque mode, where
    /// no target can be held back.
    fn leaves_range(&self, objects: &Dictionary, joint: &Joint) -> bool {
        let position = (joint.encoder_rad() * COUNTS_PER_RAD).round() as i64;
        let (lowest, highest) = (objects.signed(0x607D, 1), objects.signed(0x607D, 2));
        let speed_rad_s = joint.velocity_rad_s();
        let goes_out = position < lowest && speed_rad_s < 0.0 || position > highest && speed_rad_s > 0.0;
        self.mode != CSP && !self.defects.frozen_encoder && lowest < highest && goes_out
    }

    /// What the control word asks for.
    fn obey(&mut self, objects: &mut Dictionary, joint: &mut Joint, moment: Moment) {
        let control = objects.unsigned(0x6040, 0) as u16;
        let is_quick_stop = control & 0x86 == 0x02;
        if self.defects.ignores_control || self.defects.ignores_quick_stop && is_quick_stop {
            return;
        }
        let reset = control & 0x80 != 0 && self.control & 0x80 == 0;
        self.control = control;
        if !moment.operational {
            return;
        }
        let option = objects.signed(0x605A, 0);
        let next = self.power.commanded(control, reset, option >= 5, option >= 0);
        if next != self.power && !self.inhibited {
            if self.power == Power::Fault {
                self.error = 0;
            }
            let next = if next == Power::QuickStop && option == 0 { Power::SwitchOnDisabled } else { next };
            self.enter(next, joint, moment);
        }
        let mode = objects.signed(0x6060, 0);
        if mode != self.mode && (CSP..=CST).contains(&mode) {
            self.mode = mode;
            if self.power == Power::Enabled {
                self.hold(joint, moment);
            }
        }
    }

    /// Into another state of the power stage.
    fn enter(&mut self, next: Power, joint: &mut Joint, moment: Moment) {
        match next {
            Power::Enabled => self.hold(joint, moment),
            Power::QuickStop | Power::FaultReaction => {
                self.stopping_rad_s = joint.velocity_rad_s();
                self.hold(joint, moment);
            }
            _ => joint.motor.law = Law::Off,
        }
        self.strays_since_ns = None;
        self.power = next;
    }

    /// Where the motor is, there it stays until told otherwise.
    fn hold(&mut self, joint: &mut Joint, moment: Moment) {
        self.target = (joint.encoder_rad() * COUNTS_PER_RAD).round() as i64;
        joint.motor.law = Law::Follow {
            position_rad: joint.encoder_rad(),
            velocity_rad_s: 0.0,
            from_ns: moment.now_ns,
            until_ns: moment.now_ns,
        };
    }

    /// What the motor does next.
    fn steer(&mut self, objects: &Dictionary, joint: &mut Joint, moment: Moment) {
        match self.power {
            Power::Enabled if self.mode == CSP => self.follow_position(objects, joint, moment),
            Power::Enabled if self.mode == CSV => {
                let speed_rad_s = self.defects.runaway * objects.signed(0x60FF, 0) as f64 / COUNTS_PER_RAD;
                self.run(joint, moment, speed_rad_s);
            }
            Power::Enabled => joint.motor.law = Law::Torque(self.torque_nm(objects, joint)),
            Power::QuickStop | Power::FaultReaction => self.stop(objects, joint, moment),
            _ => {}
        }
    }

    /// The target torque; none that drives a motor on beyond the drive's own limit of speed (0x607F).
    fn torque_nm(&self, objects: &Dictionary, joint: &Joint) -> f64 {
        let torque_nm = objects.signed(0x6071, 0) as f64 * NM_PER_MILLE;
        let speed_rad_s = if self.defects.frozen_encoder { 0.0 } else { joint.velocity_rad_s() };
        let fastest_rad_s = objects.unsigned(0x607F, 0) as f64 / COUNTS_PER_RAD;
        let drives_on = torque_nm * speed_rad_s > 0.0 && speed_rad_s.abs() > fastest_rad_s;
        if drives_on { 0.0 } else { torque_nm }
    }

    /// To the target, evenly over the period in which the next is due. One that stays away is bridged at the same speed; then
    /// the motor stands.
    fn follow_position(&mut self, objects: &Dictionary, joint: &mut Joint, moment: Moment) {
        let Law::Follow { velocity_rad_s: last_rad_s, from_ns, .. } = joint.motor.law else { return };
        let (lowest, highest) = (objects.signed(0x607D, 1), objects.signed(0x607D, 2));
        let target = objects.signed(0x607A, 0).clamp(lowest, highest.max(lowest));
        let exponent = objects.signed(0x60C2, 2).clamp(-6, 0) as i32;
        let period_s = objects.unsigned(0x60C2, 1).max(1) as f64 * 10f64.powi(exponent);
        let (now_ns, period_ns) = (moment.now_ns, (period_s * 1e9) as u64);
        // A pulse may come a little early.
        if target == self.target && now_ns < from_ns + period_ns * 9 / 10 {
            return;
        }
        let missing = !moment.fresh && target == self.target;
        let Some((position_rad, _)) = joint.motor.law.command(now_ns) else { return };
        let velocity_rad_s = match missing {
            false => (target as f64 / COUNTS_PER_RAD - position_rad) / period_s,
            // A jump of the target is no speed to go on at: command and motor would swing about it, and never be apart for long.
            true if self.bridges || last_rad_s.abs() > FASTEST_RAD_S => 0.0,
            true => last_rad_s,
        };
        (self.bridges, self.target) = (missing, target);
        let until_ns = now_ns + period_ns;
        joint.motor.law = Law::Follow { position_rad, velocity_rad_s, from_ns: now_ns, until_ns };
    }

    /// At a speed.
    fn run(&mut self, joint: &mut Joint, moment: Moment, velocity_rad_s: f64) {
        let now_ns = moment.now_ns;
        let at_rad = joint.encoder_rad();
        let (position_rad, _) = joint.motor.law.command(now_ns).unwrap_or((at_rad, 0.0));
        let position_rad = position_rad.clamp(at_rad - AHEAD_RAD, at_rad + AHEAD_RAD);
        let until_ns = now_ns + GRACE_NS + now_ns.saturating_sub(self.worked_ns).min(GRACE_NS);
        joint.motor.law = Law::Follow { position_rad, velocity_rad_s, from_ns: now_ns, until_ns };
    }

    /// Down the ramp; then held, or without torque, as the options say.
    fn stop(&mut self, objects: &Dictionary, joint: &mut Joint, moment: Moment) {
        let by_fault = self.power == Power::FaultReaction;
        let option = own(objects, if by_fault { 0x605E } else { 0x605A }, OWN_OPTION);
        let ramp = if matches!(option, 1 | 5) { 0x6084 } else { 0x6085 };
        let deceleration_rad_s2 = own(objects, ramp, OWN_RAMP) as f64 / COUNTS_PER_RAD;
        let gone_s = moment.now_ns.saturating_sub(self.worked_ns) as f64 * 1e-9;
        let left = (self.stopping_rad_s.abs() - deceleration_rad_s2 * gone_s).max(0.0);
        self.stopping_rad_s = left.copysign(self.stopping_rad_s);
        self.run(joint, moment, self.stopping_rad_s);
        let stands = left == 0.0 && joint.velocity_rad_s().abs() < STANDS_RAD_S;
        if stands && by_fault {
            self.enter(Power::Fault, joint, moment);
        } else if stands && option < 5 && option > 0 {
            self.enter(Power::SwitchOnDisabled, joint, moment);
        }
    }

    /// What the master reads.
    fn tell(&self, objects: &mut Dictionary, joint: &Joint, moment: Moment) {
        let command = joint.motor.law.command(moment.now_ns);
        let behind_rad = command.map_or(0.0, |(position_rad, _)| position_rad - joint.encoder_rad());
        let mut status = self.power.status() | 1 << 9;
        if self.inhibited {
            status &= !(1 << 4);
        }
        if joint.velocity_rad_s().abs() < STANDS_RAD_S {
            status |= 1 << 10;
        }
        if self.limit_shown || self.power == Power::Enabled && self.is_limited(objects, joint) {
            status |= 1 << 11;
        }
        if self.power == Power::Enabled {
            status |= 1 << 12;
        }
        if self.strays_since_ns.is_some() || self.error == FOLLOWING_ERROR {
            status |= 1 << 13;
        }
        objects.set(0x6041, 0, i64::from(status));
        objects.set(0x603F, 0, i64::from(self.error));
        objects.set(0x1001, 0, i64::from(self.error != 0));
        objects.set(0x6061, 0, self.mode);
        let speed_rad_s = if self.defects.frozen_encoder { 0.0 } else { joint.velocity_rad_s() };
        if !self.defects.frozen_encoder {
            objects.set(0x6064, 0, (joint.encoder_rad() * COUNTS_PER_RAD).round() as i64);
        }
        objects.set(0x606C, 0, (speed_rad_s * COUNTS_PER_RAD).round() as i64);
        objects.set(0x6077, 0, (joint.motor.torque_nm / NM_PER_MILLE).round() as i64);
        objects.set(0x60F4, 0, (behind_rad * COUNTS_PER_RAD).round() as i64);
    }

    /// Whether a limit of its own keeps the motor from what it is told.
    fn is_limited(&self, objects: &Dictionary, joint: &Joint) -> bool {
        let target = objects.signed(0x607A, 0);
        let outside = target < objects.signed(0x607D, 1) || target > objects.signed(0x607D, 2);
        joint.motor.is_at_limit() || self.mode == CSP && outside
    }
}

/// What an optional object holds; `default` where the drive does not have it.
fn own(objects: &Dictionary, index: u16, default: i64) -> i64 {
    objects.entry(index, 0).map_or(default, |_| objects.signed(index, 0))
}
