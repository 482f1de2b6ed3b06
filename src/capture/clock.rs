//! The one clock that the EtherCAT stack knows: the wire's, real or virtual.
//!
//! Without its `std` feature `ethercrab` takes time from an embassy time driver. Ours says what the wire said last to the thread
//! that polls, and remembers the next moment at which a timer wants to be looked at. So a bus in virtual time is exact to the
//! microsecond, time-outs and lost frames included, and any number of buses run side by side in threads of one process.

use embassy_time_driver::{Driver, time_driver_impl};
use std::cell::Cell;
use std::task::Waker;

thread_local! {
    static NOW_US: Cell<u64> = const { Cell::new(0) };
    static ALARM_US: Cell<u64> = const { Cell::new(u64::MAX) };
}

/// Ticks are microseconds, by the feature of the driver's crate.
struct WireClock;

impl Driver for WireClock {
    fn now(&self) -> u64 {
        NOW_US.get()
    }

    /// Whoever waits is polled again at that moment: nobody needs to be woken.
    fn schedule_wake(&self, at: u64, _waker: &Waker) {
        ALARM_US.set(ALARM_US.get().min(at));
    }
}

time_driver_impl!(static CLOCK: WireClock = WireClock);

/// The time that was set last, ns.
pub fn now_ns() -> u64 {
    NOW_US.get() * 1000
}

/// Sets this thread's clock before timers are polled, and forgets the alarms set until then.
pub fn set_ns(now_ns: u64) {
    NOW_US.set(now_ns / 1000);
    ALARM_US.set(u64::MAX);
}

/// When the next of the timers polled since then runs out, ns.
pub fn alarm_ns() -> u64 {
    ALARM_US.get().saturating_mul(1000)
}
