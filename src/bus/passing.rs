//! What passing frames do to a device: they read and write its memory, and registers set things off.

use super::coe::{IN, OUT};
use super::device::Device;
use super::fmmu;
use super::frame::{Addressing, Datagram};
use super::memory::Touched;
use super::registers as at;

impl Device {
    /// A datagram passes. `times_ns`: when it comes in, and when it comes back from those behind.
    pub(super) fn pass(&mut self, datagram: &Datagram, frame: &mut [u8], times_ns: (u64, Option<u64>), logical: bool) {
        let command = datagram.command;
        let mut touched = Touched::default();
        let counted = match command.to {
            Addressing::Nobody => 0,
            Addressing::Logical if !logical => 0,
            Addressing::Logical => {
                let address = datagram.logical(frame);
                let data = &mut frame[datagram.data.clone()];
                let ways = (command.reads, command.writes);
                let (read, written) = fmmu::pass(&mut self.memory, (address, data), ways, &mut touched);
                count(command.writes && command.reads, read, written)
            }
            _ => self.physical(datagram, frame, times_ns, &mut touched),
        };
        if matches!(command.to, Addressing::Position | Addressing::Broadcast) {
            datagram.pass(frame);
        }
        datagram.count(frame, counted);
        datagram.signal(frame, self.events() & self.memory.u16(at::EVENT_MASK));
        self.notice(touched, times_ns.0);
    }

    fn physical(
        &mut self,
        datagram: &Datagram,
        frame: &mut [u8],
        times_ns: (u64, Option<u64>),
        touched: &mut Touched,
    ) -> u16 {
        let (command, device, offset) = (datagram.command, datagram.device(frame), datagram.offset(frame));
        let by_alias = self.memory.u8(at::DL_CONTROL + 3) & 1 != 0 && device == self.memory.u16(at::ALIAS);
        let meant = match command.to {
            Addressing::Position => device == 0,
            Addressing::Station => device == self.memory.u16(at::STATION) || by_alias,
            _ => true,
        };
        if !meant && !command.multiple {
            return 0;
        }
        let (reads, writes) = if command.multiple { (meant, !meant) } else { (command.reads, command.writes) };
        let data = &mut frame[datagram.data.clone()];
        let incoming = data.to_vec();
        let mut read = false;
        if reads {
            if let Some(clock) = self.clock.as_ref().filter(|_| overlaps(offset, data.len(), at::SYSTEM_TIME, 8)) {
                clock.show(&mut self.memory, times_ns.0);
            }
            let events = self.events();
            self.memory.put(at::EVENTS, &events.to_le_bytes());
            self.has_news &= !overlaps(offset, data.len(), at::AL_STATUS, 2);
            read = self.memory.read(offset, data, command.to == Addressing::Broadcast, touched);
        }
        let written = writes && self.write(offset, &incoming, times_ns, touched);
        count(reads && writes, read, written)
    }

    /// The master writes; registers may set things off.
    fn write(&mut self, offset: u16, data: &[u8], times_ns: (u64, Option<u64>), touched: &mut Touched) -> bool {
        let has = |register: u16, length: usize| overlaps(offset, data.len(), register, length);
        // What has no watchdog takes no time for it; an EEPROM that was left to the device's processor obeys it alone.
        let is_lent = self.memory.u8(at::EEPROM_OWNER) & 1 != 0;
        if is_lent && (at::EEPROM_CONTROL..at::FMMU).contains(&offset)
            || self.is_unwatched && has(at::WATCHDOG_OUTPUTS, 2)
            || self.clock.is_none() && (0x0900..0x0A00).contains(&offset)
            || !self.memory.write(offset, data, touched)
        {
            return false;
        }
        if has(at::SYNC_MANAGER + 8 * self.process_managers().0 as u16 + 6, 1) {
            self.check_outputs_manager();
        }
        if has(at::AL_CONTROL, 2) {
            self.states.ask(self.memory.u16(at::AL_CONTROL), times_ns.0);
        }
        if has(at::EEPROM_CONTROL + 1, 1) {
            self.eeprom.obey(&mut self.memory);
        }
        if let Some(mailbox) = self.mailbox.as_mut().filter(|_| has(at::SYNC_MANAGER + 8 * IN as u16 + 6, 1)) {
            mailbox.repeat_if_asked(&mut self.memory);
        }
        if let Some(clock) = &mut self.clock {
            if has(at::RECEIVE_TIMES, 1) {
                clock.latch(&mut self.memory, times_ns.0, times_ns.1);
            }
            if offset == at::SYSTEM_TIME {
                clock.follow(&mut self.memory, data, times_ns.0);
            }
            if has(at::SYNC_ACTIVATION, 1) {
                clock.activate(&self.memory, times_ns.0);
            }
        }
        true
    }

    /// What it has to tell the master: a change of its state, and a message in its mailbox.
    fn events(&self) -> u16 {
        let has_mail = self.mailbox.is_some() && self.memory.is_full(IN);
        u16::from(self.has_news) << 2 | u16::from(has_mail) << (4 + IN)
    }

    /// What followed from touching the process memory.
    fn notice(&mut self, touched: Touched, now_ns: u64) {
        if touched == Touched::default() {
            return;
        }
        let (out, _) = self.process_managers();
        if touched.written >> out & 1 != 0 && self.states.exchanges() {
            self.fed_ns = Some(now_ns);
            self.memory.put(at::WATCHDOG_STATUS, &[1]);
        }
        if let Some(mailbox) = &mut self.mailbox {
            if touched.written >> OUT & 1 != 0 {
                mailbox.take(&mut self.memory, now_ns);
            }
            if touched.read >> IN & 1 != 0 {
                self.answer(now_ns);
            }
        }
    }
}

/// What a device adds to the working counter: 1 for reading, 1 for writing, and where both are asked for 2 for writing.
fn count(both: bool, read: bool, written: bool) -> u16 {
    u16::from(read) + u16::from(written) * if both { 2 } else { 1 }
}

fn overlaps(offset: u16, length: usize, register: u16, of: usize) -> bool {
    usize::from(offset) < usize::from(register) + of && usize::from(register) < usize::from(offset) + length
}
