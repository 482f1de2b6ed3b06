//! Emergency messages of all devices, looked for beside the process data.

use super::Cycle;
use crate::capture::cause::Cause;
use crate::capture::mailbox;
use crate::capture::safety::State;
use crate::capture::wire::Wire;

/// What is taken out of the mailbox until then was there before.
const OLD_MAIL_CYCLES: u64 = 100;

impl<W: Wire, C> Cycle<'_, '_, W, C> {
    /// Whether a drive has sent an emergency message, or the next of the other devices. Of a drive it is a cause to stop. A message from
    /// before this session, or one that comes with the acknowledgement of a fault, belongs to the past: it is reported, and the status word
    /// shows the present state.
    pub(super) fn look_for_mail(&mut self, until_ns: u64) {
        for index in 0..=self.held.len() {
            let place = self.axis_at(index).place();
            let Some(code) = self.fetch(place, until_ns) else { continue };
            let cause = Cause::Emergency(code);
            let is_old = self.number <= OLD_MAIL_CYCLES;
            let driven = self.axis_at(index);
            let is_looking = driven.axis.state() == State::Watching && !is_old;
            if is_looking || driven.axis.drive().has_torque() {
                driven.axis.blame(cause);
            } else {
                let line = format!("cycle {}: {cause}, before there was torque", self.number);
                self.recorder.note(line);
            }
        }
        if let Some(place) = self.mailboxes.pop_front() {
            self.mailboxes.push_back(place);
            if let Some(code) = self.fetch(place, until_ns) {
                let code =
                    code.map_or("an unsolicited message".to_string(), |code| format!("emergency message {code:#06x}"));
                self.recorder.note(format!("cycle {}: {} sent {code}", self.number, self.name(place)));
            }
        }
    }

    /// A message out of the mailbox of the device at `place`, which is evidence in any case.
    fn fetch(&mut self, place: usize, until_ns: u64) -> Option<Option<u16>> {
        let device = self.exchange.group.subdevice(self.main, place).ok()?;
        let code = mailbox::fetch(self.line, &device, until_ns)?;
        self.evidence.heard(place, code);
        Some(code)
    }
}
