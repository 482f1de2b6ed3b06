//! What goes wrong on the wire itself: frames that come late, twice, damaged, or not at all.

use super::Reply;
use super::fault::Fault;

/// How long after the first a doubled frame comes, ns.
const DOUBLE_AFTER_NS: u64 = 10_000;

/// The faults of the wire that are left to strike.
#[derive(Debug, Default)]
pub struct Line {
    left: Vec<(Fault, u32)>,
    corrupted: u32,
}

/// Whether frames of a fault are counted, and how many there are.
fn frames(fault: Fault) -> Option<u32> {
    match fault {
        Fault::Late { frames, .. }
        | Fault::Lost { frames }
        | Fault::Unsent { frames }
        | Fault::Duplicated { frames }
        | Fault::Corrupted { frames }
        | Fault::WorkingCounterShort { frames, .. } => Some(frames),
        _ => None,
    }
}

impl Line {
    /// Takes `fault` if it is one of the wire.
    pub fn take(&mut self, fault: Fault) -> bool {
        if let Some(count) = frames(fault).filter(|count| *count > 0) {
            self.left.push((fault, count));
        }
        frames(fault).is_some()
    }

    /// The faults that strike the next frame of process data.
    pub fn strike(&mut self) -> Vec<Fault> {
        let struck = self.left.iter().map(|(fault, _)| *fault).collect();
        self.left.iter_mut().for_each(|(_, left)| *left -= 1);
        self.left.retain(|(_, left)| *left > 0);
        struck
    }

    /// The faults of them that no frame gets past meanwhile, process data or not.
    pub fn lasting(&self) -> Vec<Fault> {
        let stops = |fault: &Fault| matches!(fault, Fault::Lost { .. } | Fault::Unsent { .. });
        self.left.iter().map(|(fault, _)| *fault).filter(stops).collect()
    }

    /// What comes back of `reply` under `faults`, in order of arrival.
    pub fn replies(&mut self, reply: Reply, faults: &[Fault]) -> Vec<Reply> {
        let mut reply = reply;
        let mut twice = false;
        for fault in faults {
            match fault {
                Fault::Late { by_ns, .. } => reply.at_ns += by_ns,
                Fault::Lost { .. } | Fault::Unsent { .. } => return Vec::new(),
                Fault::Duplicated { .. } => twice = true,
                Fault::Corrupted { .. } => self.corrupt(&mut reply.frame),
                _ => {}
            }
        }
        let second = twice.then(|| Reply { at_ns: reply.at_ns + DOUBLE_AFTER_NS, frame: reply.frame.clone() });
        [Some(reply), second].into_iter().flatten().collect()
    }

    /// Damages what a checksum would have caught: in turn the first datagram's number, its length, a working counter, the end.
    fn corrupt(&mut self, frame: &mut Vec<u8>) {
        let last = frame.len() - 1;
        match self.corrupted % 4 {
            0 => frame[17] ^= 0xA5,
            1 => frame[22] ^= 0x7F,
            2 => frame[last] ^= 0x5A,
            _ => frame.truncate(last / 2),
        }
        self.corrupted += 1;
    }
}
