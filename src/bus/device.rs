//! One device on the wire: registers, EEPROM, state machine, mailbox, clock, and what it is for.

use super::application::{Application, Moment};
use super::clock::Clock;
use super::coe::{Dictionary, Mailbox};
use super::eeprom::Eeprom;
use super::fault::Fault;
use super::memory::Memory;
use super::process::{self, Mapping};
use super::registers as at;
use super::states::States;
use super::world::World;

/// How often a device works that no pulse drives, ns.
const OWN_CYCLE_NS: u64 = 1_000_000;
/// A device on the wire.
#[derive(Debug)]
pub struct Device {
    pub(super) memory: Memory,
    pub(super) clock: Option<Clock>,
    pub(super) dictionary: Dictionary,
    pub(super) mailbox: Option<Mailbox>,
    pub(super) states: States,
    pub(super) inputs: Mapping,
    pub(super) outputs: Mapping,
    /// When outputs last came.
    pub(super) fed_ns: Option<u64>,
    pub(super) eeprom: Eeprom,
    pub(super) application: Box<dyn Application>,
    pub(super) worked_ns: u64,
    /// Whether what it sends stays as it is.
    pub(super) is_frozen: bool,
    /// Whether its output watchdog does nothing.
    pub(super) is_unwatched: bool,
    /// Pulses of the clock for which no outputs had come, as ETG.1020 counts them.
    pub(super) missed_outputs: u64,
    /// Whether its state has changed since the master read it.
    pub(super) has_news: bool,
}

impl Device {
    /// The sync managers of outputs and inputs.
    pub(super) fn process_managers(&self) -> (usize, usize) {
        if self.mailbox.is_some() { (2, 3) } else { (0, 1) }
    }

    /// Shows on which sides the device has a link.
    pub(super) fn link(&mut self, behind: bool) {
        // Bit 0 operational, 4 and 5 links of ports 0 and 1; per port from bit 8: loop closed, communication established.
        let status: u16 = 0x0001 | 0x0010 | 0x0200 | 0x5000 | if behind { 0x0020 | 0x0800 } else { 0x0400 };
        self.memory.put(at::DL_STATUS, &status.to_le_bytes());
    }

    /// When it has something to do by itself, as of `now_ns`.
    pub(super) fn due_ns(&self, now_ns: u64) -> u64 {
        let pulse_ns = self.clock.as_ref().and_then(|clock| clock.next_pulse_ns(&self.memory, now_ns));
        let mailbox_ns = self.mailbox.as_ref().and_then(Mailbox::due_ns);
        let works_ns = pulse_ns.unwrap_or(self.worked_ns + OWN_CYCLE_NS);
        let others = [mailbox_ns, self.states.due_ns(), self.watchdog_ns()];
        others.into_iter().flatten().fold(works_ns, u64::min)
    }

    /// Does what is due at `now_ns`.
    pub(super) fn act(&mut self, world: &mut World, now_ns: u64) {
        if self.watchdog_ns().is_some_and(|due_ns| due_ns <= now_ns) {
            self.starve();
        }
        self.change_state(now_ns);
        self.answer(now_ns);
        let pulse_ns = self.clock.as_ref().and_then(|clock| clock.next_pulse_ns(&self.memory, now_ns));
        match pulse_ns {
            Some(pulse_ns) if pulse_ns <= now_ns => {
                if let Some(clock) = &mut self.clock {
                    clock.pulse(&self.memory, now_ns);
                }
                self.miss_outputs();
                self.work(world, now_ns, true);
            }
            None if self.worked_ns + OWN_CYCLE_NS <= now_ns => self.work(world, now_ns, false),
            _ => {}
        }
    }

    /// Before a frame comes in: a device that no pulse drives samples for it, as process data pass or before they ever do.
    pub(super) fn expect(&mut self, world: &mut World, now_ns: u64, process_data: bool) {
        let pulsed = self.clock.as_ref().is_some_and(Clock::is_running);
        if !pulsed && (process_data || !self.states.exchanges()) {
            self.work(world, now_ns, true);
        }
    }

    /// Outputs to objects, the application, objects to inputs.
    fn work(&mut self, world: &mut World, now_ns: u64, samples: bool) {
        let fresh = self.fed_ns.is_some_and(|fed_ns| fed_ns >= self.worked_ns);
        self.worked_ns = now_ns;
        let operational = self.states.is_operational();
        let (out, into) = self.process_managers();
        if operational && !self.outputs.is_empty() {
            let start = self.memory.sync_manager(out).start;
            process::unpack(
                &self.outputs,
                self.memory.bytes(start, process::length(&self.outputs)),
                &mut self.dictionary,
            );
        }
        let warning =
            self.application.work(&mut self.dictionary, world, Moment { now_ns, operational, fresh, samples });
        if self.states.exchanges() && !self.is_frozen {
            let start = self.memory.sync_manager(into).start;
            let length = process::length(&self.inputs);
            process::pack(&self.inputs, &self.dictionary, self.memory.bytes_mut(start, length));
            self.memory.turn_buffer(into);
        }
        if let (Some(mailbox), Some(warning)) = (&mut self.mailbox, warning) {
            mailbox.warn(warning);
            self.answer(now_ns);
        }
    }

    /// Lets the mailbox work.
    pub(super) fn answer(&mut self, now_ns: u64) {
        let in_pre_op = self.states.is_pre_op();
        if let Some(mailbox) = &mut self.mailbox {
            mailbox.work(&mut self.memory, &mut self.dictionary, in_pre_op, now_ns);
        }
    }

    /// Something goes wrong in the device or in what it is for.
    pub(super) fn fail(&mut self, fault: Fault, now_ns: u64) {
        match fault {
            Fault::SafeOp { code, .. } => self.fall(code),
            Fault::Watchdog { .. } => self.starve(),
            Fault::SecondMaster => self.reset(),
            Fault::WatchdogOff { .. } => {
                self.is_unwatched = true;
                self.memory.put(at::WATCHDOG_OUTPUTS, &[0, 0]);
            }
            Fault::FrozenInputs { .. } => self.is_frozen = true,
            Fault::Emergency { code, .. } => {
                if let Some(mailbox) = &mut self.mailbox {
                    mailbox.warn(super::coe::Emergency { code, register: 1 });
                }
                self.answer(now_ns);
            }
            other => self.application.fail(other),
        }
    }

    /// An object's value, for tests.
    pub fn object(&self, index: u16, sub: u8) -> Option<&[u8]> {
        self.dictionary.entry(index, sub).ok().map(|entry| entry.value.as_slice())
    }

    /// The AL status: state, and bit 4 for an error.
    pub fn al_status(&self) -> u16 {
        self.memory.u16(at::AL_STATUS)
    }

    /// The AL status code: why the error flag is set.
    pub fn al_code(&self) -> u16 {
        self.memory.u16(at::AL_CODE)
    }

    /// Counts a frame that came in damaged at `port`.
    pub(super) fn count_damage(&mut self, port: u16) {
        self.count_up(at::PORT_ERRORS + 2 * port);
        self.count_up(at::PORT_ERRORS + 2 * port + 1);
    }

    /// Counts a link that was lost at `port`.
    pub(super) fn count_lost_link(&mut self, port: u16) {
        self.count_up(at::LOST_LINKS + port);
    }

    fn count_up(&mut self, register: u16) {
        let count = self.memory.u8(register).saturating_add(1);
        self.memory.put(register, &[count]);
    }
}
