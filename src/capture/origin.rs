//! When a campaign began, so that a capture that goes on after a break stamps its samples by the same clock.
//!
//! The time of day may be set back or forth between two runs. Therefore the time since the computer was started counts where it was not
//! restarted meanwhile, and the time of day only where it was. In any case no sample is stamped earlier than those already recorded.

use std::time::{SystemTime, UNIX_EPOCH};

/// What a run is later than the last recorded sample at least, s.
const AFTER_S: f64 = 1.0;
/// How the line of `capture.log` begins that holds the origin.
const LINE: &str = "clock: ";

/// The beginning.
#[derive(Debug, Clone, PartialEq)]
pub struct Origin {
    /// By the time of day, s since 1970.
    since_1970_s: f64,
    /// Which start of the computer, and s since then; nothing where it does not tell.
    since_start: Option<(String, f64)>,
    /// The last recorded sample, s since the beginning.
    recorded_s: f64,
}

impl Origin {
    /// Now.
    pub fn now() -> Self {
        Self { since_1970_s: today_s(), since_start: since_start(), recorded_s: 0.0 }
    }

    /// The origin that `notes` (capture.log) tell of, whose campaign holds samples up to `recorded_s`.
    pub fn of_notes(notes: &str, recorded_s: f64) -> Self {
        let since_1970_s = notes.split(' ').next().and_then(|stamp| stamp.parse().ok()).unwrap_or_else(today_s);
        let told = notes.lines().find_map(|line| line.split_once(LINE)).map(|(_, told)| told);
        let since_start = told.and_then(|told| {
            let (start, rest) = told.split_once(' ')?;
            Some((start.to_string(), rest.trim_end_matches(" s").parse().ok()?))
        });
        Self { since_1970_s, since_start, recorded_s }
    }

    /// The line of `capture.log` that holds it.
    pub fn to_line(&self) -> String {
        match &self.since_start {
            Some((start, s)) => format!("{LINE}{start} {s:.3} s"),
            None => format!("{LINE}the time of day"),
        }
    }

    /// How long ago that is, s, and by which clock.
    pub fn elapsed(&self) -> (f64, &'static str) {
        self.elapsed_at(today_s(), since_start())
    }

    fn elapsed_at(&self, today_s: f64, since_start: Option<(String, f64)>) -> (f64, &'static str) {
        let (elapsed_s, clock) = match (&self.since_start, since_start) {
            (Some((start, began_s)), Some((now, now_s))) if *start == now => {
                (now_s - began_s, "the time since the computer was started")
            }
            _ => (today_s - self.since_1970_s, "the time of day"),
        };
        let earliest_s = if self.recorded_s > 0.0 { self.recorded_s + AFTER_S } else { 0.0 };
        if elapsed_s < earliest_s {
            return (earliest_s, "the last recorded sample, since the time of day was set back");
        }
        (elapsed_s, clock)
    }
}

/// The time of day, s since 1970.
pub(super) fn today_s() -> f64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs_f64()
}

/// Which start of the computer this is, and s since then, sleep included.
#[cfg(target_os = "linux")]
fn since_start() -> Option<(String, f64)> {
    let start = std::fs::read_to_string("/proc/sys/kernel/random/boot_id").ok()?.trim().to_string();
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the structure lives through the call.
    let failed = unsafe { libc::clock_gettime(libc::CLOCK_BOOTTIME, &raw mut time) };
    (failed == 0 && !start.is_empty()).then_some((start, time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9))
}

#[cfg(not(target_os = "linux"))]
fn since_start() -> Option<(String, f64)> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_break_is_measured_by_the_clock_that_was_not_set() {
        let began = Origin { since_1970_s: 1000.0, since_start: Some(("a".to_string(), 50.0)), recorded_s: 0.0 };
        let notes = format!("1000.000 capture begins\n1000.001 {}\n", began.to_line());
        let read = Origin::of_notes(&notes, 30.0);
        assert_eq!(read, Origin { recorded_s: 30.0, ..began });
        let at = |today_s, start: &str, s| read.elapsed_at(today_s, Some((start.to_string(), s))).0;
        // Not restarted: the time of day may be anything.
        assert_eq!((at(900.0, "a", 150.0), at(9e9, "a", 150.0)), (100.0, 100.0));
        // Restarted: the time of day, unless it was set back behind what is recorded.
        assert_eq!((at(1200.0, "b", 5.0), at(900.0, "b", 5.0)), (200.0, 31.0));
        // An older campaign, without the line.
        assert_eq!(Origin::of_notes("1000.000 capture begins\n", 0.0).elapsed_at(1007.0, None).0, 7.0);
    }
}
