//! A device's state machine (ETG.1000.6, 6.4): what a master may ask for, what is refused and why, and when a device falls.

use super::coe::{IN, OUT};
use super::device::Device;
use super::process;
use super::registers as at;

/// States as they stand in the registers.
const INIT: u8 = 1;
const PRE_OP: u8 = 2;
const BOOT: u8 = 3;
const SAFE_OP: u8 = 4;
const OP: u8 = 8;
/// The error flag in the status, and its acknowledgement in the control.
const ERROR: u8 = 0x10;

/// How long a change takes, ns.
const CHANGE_NS: u64 = 500_000;
/// How long a device waits in SAFE-OP for the outputs that let it into OP, ns.
const WAITS_FOR_OUTPUTS_NS: u64 = 5_000_000_000;

/// The object that holds when a device gives up because no outputs come (ETG.1020, sync error counter limit): each pulse of the clock
/// without them counts `MISSED`; 0 for never. Those of ETG.1020 take one off for a pulse with them. Here such a pulse takes all off: a
/// master that sleeps between its frames and is slower than the pulse by a third would be thrown out else, whose every frame comes.
pub const SYNC_ERROR_LIMIT: (u16, u8) = (0x10F1, 2);
const MISSED: u64 = 3;

/// Reasons for a refusal (ETG.1000.6, table 11).
mod code {
    pub const INVALID_CHANGE: u16 = 0x0011;
    pub const UNKNOWN_STATE: u16 = 0x0012;
    pub const NO_BOOTSTRAP: u16 = 0x0013;
    pub const MAILBOX: u16 = 0x0016;
    pub const WATCHDOG: u16 = 0x001B;
    pub const OUTPUTS: u16 = 0x001D;
    pub const INPUTS: u16 = 0x001E;
    pub const NO_SYNC: u16 = 0x002D;
    pub const CLOCK: u16 = 0x0030;
    pub const SYNCHRONISATION: u16 = 0x001A;
}

/// Where a device is, and where it was asked to go.
#[derive(Debug, Clone)]
pub struct States {
    now: u8,
    /// AL status code; an error while not 0.
    code: u16,
    asked: Option<Asked>,
}

#[derive(Debug, Clone, Copy)]
struct Asked {
    to: u8,
    since_ns: u64,
    due_ns: u64,
}

impl Default for States {
    fn default() -> Self {
        Self { now: INIT, code: 0, asked: None }
    }
}

impl States {
    /// The master asks for a state at `now_ns`.
    pub fn ask(&mut self, control: u16, now_ns: u64) {
        let (to, acknowledges) = (control as u8 & 0x0F, control as u8 & ERROR != 0);
        if acknowledges {
            self.code = 0;
        } else if self.code != 0 && to > self.now {
            return; // an error not acknowledged lets no device up
        }
        self.asked = Some(Asked { to, since_ns: now_ns, due_ns: now_ns + CHANGE_NS });
    }

    /// When a change is due.
    pub fn due_ns(&self) -> Option<u64> {
        self.asked.map(|asked| asked.due_ns)
    }

    /// Whether outputs count.
    pub fn is_operational(&self) -> bool {
        self.now == OP
    }

    /// Whether PDO mappings may be changed.
    pub fn is_pre_op(&self) -> bool {
        self.now == PRE_OP
    }

    /// Whether process data are exchanged.
    pub fn exchanges(&self) -> bool {
        self.now >= SAFE_OP
    }
}

impl Device {
    /// When the output watchdog expires.
    pub(super) fn watchdog_ns(&self) -> Option<u64> {
        let manager = self.memory.sync_manager(self.process_managers().0);
        if !self.states.is_operational() || self.outputs.is_empty() || !manager.feeds_watchdog() || self.is_unwatched {
            return None;
        }
        let tick_ns = (u64::from(self.memory.u16(at::WATCHDOG_DIVIDER)) + 2) * 40;
        let ticks = u64::from(self.memory.u16(at::WATCHDOG_OUTPUTS));
        self.fed_ns.filter(|_| ticks > 0).map(|fed_ns| fed_ns + ticks * tick_ns)
    }

    /// The output watchdog expired.
    pub(super) fn starve(&mut self) {
        let count = self.memory.u8(at::WATCHDOG_COUNT).saturating_add(1);
        self.memory.put(at::WATCHDOG_COUNT, &[count]);
        self.memory.put(at::WATCHDOG_STATUS, &[0]);
        self.fall(code::WATCHDOG);
    }

    /// A pulse of the clock came, for which outputs should have come: after too many without the device gives up, as drives do that work
    /// by their clock.
    pub(super) fn miss_outputs(&mut self) {
        let limit = self.dictionary.unsigned(SYNC_ERROR_LIMIT.0, SYNC_ERROR_LIMIT.1);
        if !self.states.is_operational() || self.outputs.is_empty() || limit == 0 {
            self.missed_outputs = 0;
            return;
        }
        let is_fed = self.fed_ns.is_some_and(|fed_ns| fed_ns >= self.worked_ns);
        self.missed_outputs = if is_fed { 0 } else { self.missed_outputs + MISSED };
        if self.missed_outputs >= limit {
            self.fall(code::SYNCHRONISATION);
        }
    }

    /// The master has switched the outputs' sync manager: without it there are no outputs.
    pub(super) fn check_outputs_manager(&mut self) {
        let manager = self.memory.sync_manager(self.process_managers().0);
        if self.states.is_operational() && !self.outputs.is_empty() && !manager.active {
            self.fall(code::OUTPUTS);
        }
    }

    /// Falls back to SAFE-OP, if it was beyond, with an error.
    pub(super) fn fall(&mut self, code: u16) {
        if self.states.exchanges() {
            self.states = States { now: SAFE_OP, code, asked: None };
            self.show_state();
        }
    }

    /// Another master has asked for INIT, and it is there at once.
    pub(super) fn reset(&mut self) {
        self.go(INIT);
        self.show_state();
    }

    /// Goes where it was asked to, if that is due and may be.
    pub(super) fn change_state(&mut self, now_ns: u64) {
        let Some(asked) = self.states.asked.take_if(|asked| asked.due_ns <= now_ns) else { return };
        match self.may_go(asked) {
            Ok(true) => self.go(asked.to),
            Ok(false) if now_ns < asked.since_ns + WAITS_FOR_OUTPUTS_NS => {
                self.states.asked = Some(Asked { due_ns: now_ns + CHANGE_NS, ..asked });
            }
            Ok(false) => self.states.code = code::WATCHDOG,
            Err(code) => self.states.code = code,
        }
        self.show_state();
    }

    /// Whether it may go there by now, or why it never will.
    fn may_go(&mut self, asked: Asked) -> Result<bool, u16> {
        match (self.states.now, asked.to) {
            (_, BOOT) => Err(code::NO_BOOTSTRAP),
            (INIT, PRE_OP) => self.check_mailbox().map(|()| true),
            (PRE_OP, SAFE_OP) => self.check_process_data().map(|()| true),
            (SAFE_OP, OP) => self.check_outputs(asked.since_ns),
            (now, to @ (INIT | PRE_OP | SAFE_OP | OP)) if to <= now => Ok(true),
            (_, INIT | PRE_OP | SAFE_OP | OP) => Err(code::INVALID_CHANGE),
            _ => Err(code::UNKNOWN_STATE),
        }
    }

    fn go(&mut self, to: u8) {
        self.states.now = to;
        self.states.code = 0;
        let (out, into) = self.process_managers();
        self.memory.shut(out, to < SAFE_OP);
        self.memory.shut(into, to < SAFE_OP);
        if let Some(mailbox) = self.mailbox.as_mut().filter(|_| to == INIT) {
            mailbox.clear();
            [IN, OUT].into_iter().for_each(|index| self.memory.set_full(index, false));
        }
        if to < OP {
            self.fed_ns = None;
        }
    }

    /// Mailboxes must stand where the EEPROM says.
    fn check_mailbox(&self) -> Result<(), u16> {
        let stands = |index: usize, written: bool| {
            let manager = self.memory.sync_manager(index);
            manager.active && manager.is_mailbox() && manager.is_written() == written && manager.length >= 24
        };
        let right = self.mailbox.is_none() || stands(0, true) && stands(1, false);
        if right { Ok(()) } else { Err(code::MAILBOX) }
    }

    /// The sync managers must be as long as what the objects map; a clock that is switched on must have a period.
    fn check_process_data(&mut self) -> Result<(), u16> {
        self.outputs = self.dictionary.mapping(0x1C12);
        self.inputs = self.dictionary.mapping(0x1C13);
        let (out, into) = self.process_managers();
        let fits = |index: usize, length: usize, written: bool| {
            let manager = self.memory.sync_manager(index);
            let empty = length == 0 && (!manager.active || manager.length == 0);
            let ram = usize::from(manager.start) >= 0x1000 && usize::from(manager.start) + length <= 0x3000;
            empty || manager.active && usize::from(manager.length) == length && manager.is_written() == written && ram
        };
        if !fits(out, process::length(&self.outputs), true) {
            return Err(code::OUTPUTS);
        }
        if !fits(into, process::length(&self.inputs), false) {
            return Err(code::INPUTS);
        }
        let activated = self.memory.u8(at::SYNC_ACTIVATION) & 1 != 0;
        let too_short = self.memory.u32(at::SYNC0_CYCLE) < super::clock::SHORTEST_CYCLE_NS;
        if activated && too_short { Err(code::CLOCK) } else { Ok(()) }
    }

    /// Outputs must have come since OP was asked for, and pulses if the clock is switched on.
    fn check_outputs(&self, since_ns: u64) -> Result<bool, u16> {
        let activated = self.memory.u8(at::SYNC_ACTIVATION) & 1 != 0;
        if activated && !self.clock.as_ref().is_some_and(super::clock::Clock::is_running) {
            return Err(code::NO_SYNC);
        }
        Ok(self.outputs.is_empty() || self.fed_ns.is_some_and(|fed_ns| fed_ns >= since_ns))
    }

    /// State and reason where the master reads them.
    pub(super) fn show_state(&mut self) {
        let flag = if self.states.code == 0 { 0 } else { ERROR };
        let shown = self.states.now | flag;
        self.has_news |= self.memory.u8(at::AL_STATUS) != shown;
        self.memory.put(at::AL_STATUS, &[shown, 0]);
        self.memory.put(at::AL_CODE, &self.states.code.to_le_bytes());
    }
}
