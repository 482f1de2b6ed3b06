//! Unsolicited messages, withheld from the stack while it waits for an answer.
//!
//! A drive sends an emergency message whenever it has reason to: after a fault of the last session, often as soon as it is in PRE-OP. The
//! stack does not survive one where it expects the answer to its request for an object. So frames are looked at as they come in: an
//! emergency is noted, and while an answer is outstanding its frame is withheld, as if it had been lost. The stack then reads the mailbox
//! again, and as often as it is empty the frame is withheld too: an empty mailbox is no answer (ETG.1000.4: working counter 0).

/// What is read of a message: its header, 6 bytes, that of CoE, 2 bytes, and an emergency, 8 bytes.
pub(super) const HEAD: usize = 16;

/// Commands of datagrams: read and write of a station.
const FPRD: u8 = 4;
const FPWR: u8 = 5;
/// Where an Ethernet frame's first datagram begins, and its data. The stack sends requests for mailboxes alone in their frames.
const DATAGRAM: usize = 16;
const DATA: usize = DATAGRAM + 10;

/// What was heard, and what is waited for.
#[derive(Debug, Default)]
pub(super) struct Unasked {
    /// Emergency messages: the station's address and the code.
    pub heard: Vec<(u16, u16)>,
    /// The station that has been asked for something, and has not answered.
    asked: Option<u16>,
}

/// A datagram that is as long as a whole mailbox: longer than all registers that are read or written here.
struct Long<'f> {
    command: u8,
    station: u16,
    data: &'f [u8],
    working_counter: u16,
}

impl<'f> Long<'f> {
    fn of(frame: &'f [u8]) -> Option<Self> {
        let word = |at: usize| Some(u16::from_le_bytes([*frame.get(at)?, *frame.get(at + 1)?]));
        let end = DATA + usize::from(word(DATAGRAM + 6)? & 0x7FF);
        let data = frame.get(DATA..end).filter(|data| data.len() > HEAD)?;
        Some(Self { command: frame[DATAGRAM], station: word(DATAGRAM + 2)?, data, working_counter: word(end)? })
    }
}

impl Unasked {
    /// Nothing is waited for any more.
    pub fn forget(&mut self) {
        self.asked = None;
    }

    /// `frame` goes out.
    pub fn sends(&mut self, frame: &[u8]) {
        if let Some(request) = Long::of(frame).filter(|datagram| datagram.command == FPWR) {
            self.asked = Some(request.station);
        }
    }

    /// Whether `frame`, which came in, is to be withheld.
    pub fn withholds(&mut self, frame: &[u8]) -> bool {
        let Some(reply) = Long::of(frame).filter(|datagram| datagram.command == FPRD) else { return false };
        let is_waited_for = self.asked == Some(reply.station);
        if reply.working_counter == 0 {
            return is_waited_for;
        }
        if let Some(code) = reply.data.first_chunk().and_then(emergency) {
            // Code 0 says that an error is over.
            self.heard.extend((code != 0).then_some((reply.station, code)));
            return is_waited_for;
        }
        if is_waited_for {
            self.asked = None;
        }
        false
    }
}

/// The code of an emergency message: mailbox type 3 (CoE), service 1.
pub(super) fn emergency(head: &[u8; HEAD]) -> Option<u16> {
    let is_emergency = head[5] & 0x0F == 3 && head[7] >> 4 == 1;
    is_emergency.then(|| u16::from_le_bytes([head[8], head[9]]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame with one datagram of `data`.
    fn frame(command: u8, station: u16, data: &[u8], working_counter: u8) -> Vec<u8> {
        let [low, high] = station.to_le_bytes();
        let mut frame = vec![0; DATAGRAM];
        frame.extend([command, 0, low, high, 0, 0x10, data.len() as u8, 0, 0, 0]);
        frame.extend(data);
        frame.extend([working_counter, 0]);
        frame
    }

    fn message(service: u8) -> Vec<u8> {
        let mut message = vec![0; 64];
        (message[0], message[5], message[7], message[8], message[9]) = (10, 0x33, service << 4, 0x00, 0x75);
        message
    }

    #[test]
    fn an_emergency_does_not_come_between_request_and_answer() {
        let (emergency, answer, request) = (message(1), message(3), frame(FPWR, 0x1001, &[0; 64], 0));
        let mut unasked = Unasked::default();
        let comes =
            |unasked: &mut Unasked, data: &[u8], counter| unasked.withholds(&frame(FPRD, 0x1001, data, counter));
        // Nothing is waited for: the stack empties the mailbox.
        assert!(!comes(&mut unasked, &emergency, 1));
        unasked.sends(&request);
        assert!(comes(&mut unasked, &emergency, 1) && comes(&mut unasked, &[0; 64], 0));
        assert!(!unasked.withholds(&frame(FPRD, 0x1002, &emergency, 1)), "of another device");
        assert!(!comes(&mut unasked, &answer, 1) && !comes(&mut unasked, &emergency, 1));
        assert_eq!(unasked.heard, [(0x1001, 0x7500), (0x1001, 0x7500), (0x1002, 0x7500), (0x1001, 0x7500)]);
    }

    #[test]
    fn registers_and_stumps_pass() {
        let mut unasked = Unasked::default();
        unasked.sends(&frame(FPWR, 0x1001, &[0; 64], 0));
        assert!(!unasked.withholds(&frame(FPRD, 0x1001, &message(1)[..HEAD], 1)));
        let whole = frame(FPRD, 0x1001, &message(1), 1);
        for length in 0..whole.len() {
            assert!(!unasked.withholds(&whole[..length]));
        }
        assert!(unasked.heard.is_empty());
    }

    #[test]
    fn an_emergency_is_told_from_an_answer() {
        let mut head = [0; HEAD];
        (head[0], head[5], head[7], head[8], head[9]) = (10, 0x33, 0x10, 0x11, 0x86);
        assert_eq!(emergency(&head), Some(0x8611));
        assert_eq!(emergency(&[&head[..7], &[0x30], &head[8..]].concat().try_into().unwrap()), None);
        assert_eq!(emergency(&[&head[..5], &[0x32], &head[6..]].concat().try_into().unwrap()), None);
    }
}
