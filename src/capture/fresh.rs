//! Whether what the drive sends is new: a value that must change every cycle, such as a counter of the drive, or which of its three
//! buffers the bus interface filled last (bits 4 and 5 of the sync manager's status, register 0x0805).
//!
//! Not every device changes it every cycle. So it is looked at for a while before there is torque: only where it never stood for
//! more than `ALIVE` looks does a standstill count later. Where it cannot be used that is reported: then frozen inputs are noticed
//! only once the joint must move (see `follow`), and while it is held they cannot be known.
//!
//! Only looks one cycle apart count, one after the other. After missed cycles the signal may have gone round: of three buffers the third filled since is the
//! same one again, and a computer that sleeps through two of three cycles sees the same buffer each time though all is well. A frame that
//! was not received is a missed cycle, not a stale input.

/// A signal that stayed the same for more consecutive checks than this cannot be used.
const ALIVE: u32 = 2;
/// A signal that stays the same for this many checks is a fault.
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
    /// The signal as it is now, `periods` after the last look; `is_judged` once there is torque: until then it only shows whether it can be
    /// used. Returns for how many checks it has stayed the same, where these are too many.
    pub fn look(&mut self, signal: u32, periods: u32, is_judged: bool) -> Option<u32> {
        let is_next = periods == 1;
        self.stands = if is_next && self.last == Some(signal) { self.stands + 1 } else { 0 };
        self.last = Some(signal);
        if !is_judged && is_next {
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
        (0..LOOKS).for_each(|i| assert_eq!(fresh.look(signal(i), 1, false), None));
        fresh
    }

    #[test]
    fn a_signal_that_stops_is_stale_within_a_few_looks() {
        let mut fresh = looked(|i| i % 3);
        assert!(fresh.is_usable());
        let told: Vec<_> = (0..6).map(|_| fresh.look(7, 1, true)).collect();
        assert_eq!(told, [None, None, None, None, Some(4), Some(5)]);
        assert!(fresh.is_stale());
        assert_eq!((fresh.look(1, 1, true), fresh.is_stale()), (None, false));
    }

    #[test]
    fn a_signal_that_stands_by_itself_is_not_used() {
        for period in [4, 100] {
            let mut fresh = looked(|i| i / period);
            assert!(!fresh.is_usable());
            assert!((0..100).all(|_| fresh.look(0, 1, true).is_none()));
        }
        assert!(looked(|i| i / 2).is_usable());
    }

    /// A computer that sleeps through two of three cycles: the same of three buffers each time.
    #[test]
    fn missed_cycles_are_no_standstill() {
        let mut fresh = looked(|i| i % 3);
        assert!((0..100).all(|_| fresh.look(0, 3, true).is_none() && !fresh.is_stale()));
        // One that sleeps through two of three cycles, wakes late, and is on time with the next, before the device's next pulse.
        assert!((0..100).all(|i| fresh.look(0, 1 + 2 * (i % 2), true).is_none() && !fresh.is_stale()));
        // What stands once it is awake still counts.
        let told: Vec<_> = (0..5).map(|_| fresh.look(0, 1, true)).collect();
        assert_eq!(told, [None, None, None, Some(4), Some(5)]);
    }

    #[test]
    fn too_few_looks_tell_nothing() {
        let mut fresh = Freshness::default();
        (0..LOOKS - 1).for_each(|i| assert_eq!(fresh.look(i, 1, false), None));
        assert!(!fresh.is_usable());
    }
}
