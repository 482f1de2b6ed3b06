//! A drive after CiA 402: its states, its modes, what it watches, and how it stops.

mod axes;
mod motion;
mod objects;
mod power;

pub use axes::two_axes;
pub use objects::{COUNTS_PER_REVOLUTION, RATED_TORQUE_MNM};

use super::application::{Application, Moment};
use super::clock::Clock;
use super::coe::{Dictionary, Emergency};
use super::description::Description;
use super::device::Device;
use super::fault::Fault;
use super::motor::Law;
use super::terminal::VENDOR;
use super::world::{BrakeBy, Joint, World};
use objects::{COUNTS_PER_RAD, CSP, CST, NM_PER_MILLE};
use power::Power;

/// Product code of the drive.
pub const PRODUCT: u32 = 0x0402;
/// The bit of the digital outputs (0x60FE:01) that lets a brake go.
const BRAKE: u64 = 1;
/// Serial number of the first.
const SERIAL: u32 = 42;
/// Error codes (CiA 402-2, table 5; ETG.6010).
const FOLLOWING_ERROR: u16 = 0x8611;
const COMMUNICATION: u16 = 0x7500;
const POSITION_RANGE: u16 = 0x8600;
/// A speed below which the motor stands, rad/s.
const STANDS_RAD_S: f64 = 1e-3;

/// What a drive does by itself without the optional objects 0x6072, 0x607F, 0x605A and 0x605E, 0x6084 and 0x6085: per mille of rated
/// torque, counts/s (10 rad/s), braking, counts/s^2 (20 rad/s^2).
const OWN_TORQUE: i64 = 1500;
const OWN_SPEED: i64 = (10.0 * COUNTS_PER_RAD) as i64;
const OWN_OPTION: i64 = 2;
const OWN_RAMP: i64 = (20.0 * COUNTS_PER_RAD) as i64;

/// The drive behind its bus interface.
#[derive(Debug)]
struct Drive {
    /// Which of the joints it moves.
    joint: usize,
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
    /// Factor between the speed at which it runs and the commanded one.
    runaway: f64,
}

/// The device; its clock runs `drift_ppb` too fast.
pub fn device(drift_ppb: i64) -> Device {
    device_with(drift_ppb, true, &[])
}

/// The same, on another joint than the first.
pub(super) fn device_on(joint: usize, drift_ppb: i64) -> Device {
    made(joint, drift_ppb, true, &[])
}

/// The first, without the objects `without` (index of each), and whether its EEPROM has its outputs feed the watchdog.
pub fn device_with(drift_ppb: i64, feeds_watchdog: bool, without: &[u16]) -> Device {
    made(0, drift_ppb, feeds_watchdog, without)
}

fn made(joint: usize, drift_ppb: i64, feeds_watchdog: bool, without: &[u16]) -> Device {
    let mut dictionary = objects::dictionary();
    without.iter().for_each(|index| dictionary.remove(*index));
    let description = Description {
        identity: [VENDOR, PRODUCT, 1, SERIAL + joint as u32],
        names: ["TL7402", "Drive", "Winch drive, CiA 402"],
        dictionary,
        mailbox: true,
        clock: Some(Clock::new(1_234_567_890, drift_ppb)),
        feeds_watchdog,
    };
    Device::new(description, Box::new(Drive::new(joint)))
}

impl Application for Drive {
    fn work(&mut self, dictionary: &mut Dictionary, world: &mut World, moment: Moment) -> Option<Emergency> {
        let joint = world.joints.get_mut(self.joint)?;
        let warning = self.fault(dictionary, joint, moment);
        self.obey(dictionary, joint, moment);
        joint.motor.limit_nm = own(dictionary, 0x6072, OWN_TORQUE) as f64 * NM_PER_MILLE;
        joint.motor.fastest_rad_s = self.fastest_rad_s(dictionary);
        joint.brake(BrakeBy::Drive, !moment.operational || dictionary.unsigned(0x60FE, 1) & BRAKE == 0);
        self.steer(dictionary, joint, moment);
        self.tell(dictionary, joint, moment);
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
    /// One without torque, on the joint numbered `joint`.
    fn new(joint: usize) -> Self {
        Self {
            joint,
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
        }
    }

    /// Its limit of speed as it understands it: scaled where it misreads speeds, none where its encoder is frozen.
    fn fastest_rad_s(&self, dictionary: &Dictionary) -> f64 {
        let fastest_rad_s = own(dictionary, 0x607F, OWN_SPEED) as f64 / COUNTS_PER_RAD;
        if self.defects.frozen_encoder { f64::MAX } else { fastest_rad_s * self.defects.runaway.abs().max(1.0) }
    }

    /// What it finds wrong by itself.
    fn fault(&mut self, dictionary: &mut Dictionary, joint: &mut Joint, moment: Moment) -> Option<Emergency> {
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
            _ if enabled && self.strays(dictionary, joint, moment) => Some(FOLLOWING_ERROR),
            _ if enabled && self.leaves_range(dictionary, joint) => Some(POSITION_RANGE),
            _ => None,
        };
        if self.inhibited {
            self.enter(Power::SwitchOnDisabled, joint, moment);
        }
        let code = code.filter(|_| !matches!(self.power, Power::Fault | Power::FaultReaction))?;
        self.error = code;
        objects::remember(dictionary, code, moment.now_ns);
        let moves = matches!(self.power, Power::Enabled | Power::QuickStop) && own(dictionary, 0x605E, OWN_OPTION) != 0;
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

    /// Whether a limit of the drive keeps the motor from its command.
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
