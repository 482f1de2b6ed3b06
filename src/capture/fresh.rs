//! Whether what the drive sends is new: a value that must change every cycle, such as a counter of the drive, or which of its three
//! buffers the bus interface filled last (bits 4 and 5 of the sync manager's status, register 0x0805).
//!
//! Not every device changes it every cycle. So it is looked at for a while before there is torque: only where it never stood for
//! more than `ALIVE` looks does a standstill count later. Where it cannot be used that is reported: then frozen inputs are noticed
//! only once the joint must move (see `follow`), and while it is held they cannot be known.

/// A signal that stood for more looks than this, one after the other, tells nothing.
const ALIVE: u32 = 2;
/// Standing for so many looks is a fault.
const STALE: u32 = 4;
/// Looks that make sure that the signal can be used.
const LOOKS: u32 = 100;

/// The signal, look by look.
#[derive(Debug, Clone, Default)]
pub struct Freshness {
    last: Option<u32>,
    looks: u32,
    stands: u32,
    longest: u32,
    is_usable: bool,
}

impl Freshness {
    /// The signal as it is now; `is_judged` once there is torque: until then it shows what it is worth. Gives for how many looks it
    /// has stood, where that is too many.
    pub fn look(&mut self, signal: u32, is_judged: bool) -> Option<u32> {
        self.stands = if self.last == Some(signal) { self.stands + 1 } else { 0 };
        self.last = Some(signal);
        if !is_judged {
            self.looks += 1;
            self.longest = self.longest.max(self.stands);
            self.is_usable = self.looks >= LOOKS && self.longest <= ALIVE;
        }
        (self.is_usable && self.stands >= STALE).then_some(self.stands)
    }

    /// Whether it changes often enough to be relied on, as seen so far.
    pub fn is_usable(&self) -> bool {
        self.is_usable
    }

    /// Whether it stands now.
    pub fn is_stale(&self) -> bool {
        self.is_usable && self.stands >= STALE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looked(signal: impl Fn(u32) -> u32) -> Freshness {
        let mut fresh = Freshness::default();
        (0..LOOKS).for_each(|i| assert_eq!(fresh.look(signal(i), false), None));
        fresh
    }

    #[test]
    fn a_signal_that_stops_is_stale_within_a_few_looks() {
        let mut fresh = looked(|i| i % 3);
        assert!(fresh.is_usable());
        let told: Vec<_> = (0..6).map(|_| fresh.look(7, true)).collect();
        assert_eq!(told, [None, None, None, None, Some(4), Some(5)]);
        assert!(fresh.is_stale());
        assert_eq!((fresh.look(1, true), fresh.is_stale()), (None, false));
    }

    #[test]
    fn a_signal_that_stands_by_itself_is_not_used() {
        for period in [4, 100] {
            let mut fresh = looked(|i| i / period);
            assert!(!fresh.is_usable());
            assert!((0..100).all(|_| fresh.look(0, true).is_none()));
        }
        assert!(looked(|i| i / 2).is_usable());
    }

    #[test]
    fn too_few_looks_tell_nothing() {
        let mut fresh = Freshness::default();
        (0..LOOKS - 1).for_each(|i| assert_eq!(fresh.look(i, false), None));
        assert!(!fresh.is_usable());
    }
}
