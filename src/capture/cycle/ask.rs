//! What is asked of the drive alone, beside the process data.

use super::{Cycle, Failure};
use crate::capture::cause::Cause;
use crate::capture::mailbox;
use crate::capture::safety::State;
use crate::capture::wire::Wire;
use ethercrab::Command;

/// What is taken out of the mailbox until then was there before.
const OLD_MAIL_CYCLES: u64 = 100;

impl<W: Wire, C> Cycle<'_, '_, W, C> {
    /// Whether the drive has filled its buffer anew, where no counter of its own tells.
    pub(super) fn look_for_news(&mut self, until_ns: u64) {
        let Some(inputs) = self.drive_inputs.filter(|_| !self.axis.has_counter()) else { return };
        let Ok(drive) = self.exchange.group.subdevice(self.main, self.rig.drive.identity.place) else { return };
        let asked = self.line.run_until(until_ns, drive.register_read::<u8>(inputs.status_at()));
        match asked {
            Ok(status) => self.axis.freshen(u32::from(status >> 4 & 3)),
            Err(Failure::Panic(words)) => self.panicked(words),
            Err(_) => {}
        }
    }

    /// Asks the drive alone where it stands, by its memory, in a stop in which not all devices answer: out of OP, or with another
    /// device gone, it still tells.
    pub(super) fn ask_drive(&mut self, until_ns: u64) {
        let Some(inputs) = self.drive_inputs else { return };
        let Some(place) = self.rig.drive.inputs.place("status_word") else { return };
        let Ok(drive) = self.exchange.group.subdevice(self.main, self.rig.drive.identity.place) else { return };
        let memory = Command::fprd(drive.configured_address(), inputs.start);
        let asked = async { memory.receive_slice(self.main, inputs.length).await.map(|bytes| place.get(&bytes)) };
        if let Ok(status_word) = self.line.run_until(until_ns, asked) {
            self.axis.take_status(status_word as u16);
        }
    }

    /// Whether the drive has sent an emergency message. One that was there before we came, or that comes with a fault being
    /// acknowledged, is history: it is told, and the status word says how things stand now.
    pub(super) fn look_for_mail(&mut self, until_ns: u64) {
        let Ok(drive) = self.exchange.group.subdevice(self.main, self.rig.drive.identity.place) else { return };
        let Some(emergency) = mailbox::fetch(self.line, &drive, until_ns) else { return };
        self.evidence.heard(self.rig.drive.identity.place, emergency);
        let cause = Cause::Emergency(emergency);
        let is_looking = self.axis.state() == State::Watching && self.number > OLD_MAIL_CYCLES;
        match is_looking || self.axis.drive().has_torque() {
            true => self.axis.blame(cause),
            false => self.recorder.note(format!("cycle {}: {cause}, before there was torque", self.number)),
        }
    }
}
