//! A device's distributed clock: a local oscillator, what turns it into system time, and the pulses that it gives.

use super::memory::Memory;
use super::registers as at;

/// Share of a difference from the reference clock that one sample of it takes away: the control loop's gain.
const CATCHES_UP: i64 = 4;

/// The shortest period of pulses that a device here keeps up with, ns.
pub const SHORTEST_CYCLE_NS: u32 = 50_000;
/// Pulses that are caught up with after a pause, at most.
const MANY: u64 = 10_000;

/// One clock.
#[derive(Debug, Clone)]
pub struct Clock {
    /// What the oscillator showed when the bus began, ns: devices are never switched on together.
    began_ns: u64,
    /// How much too fast it runs, parts per billion.
    drift_ppb: i64,
    /// What the control loop took away, ns.
    corrected_ns: i64,
    /// When SYNC0 comes next, ns of system time.
    next_pulse_ns: Option<u64>,
}

impl Clock {
    /// A clock that showed `began_ns` at time 0 and runs `drift_ppb` too fast.
    pub fn new(began_ns: u64, drift_ppb: i64) -> Self {
        Self { began_ns, drift_ppb, corrected_ns: 0, next_pulse_ns: None }
    }

    /// What the oscillator shows at `now_ns`.
    pub fn local_ns(&self, now_ns: u64) -> u64 {
        let drift_ns = i128::from(now_ns) * i128::from(self.drift_ppb) / 1_000_000_000;
        self.began_ns.wrapping_add(now_ns).wrapping_add(drift_ns as u64).wrapping_sub(self.corrected_ns as u64)
    }

    /// The system time at `now_ns`.
    pub fn system_ns(&self, memory: &Memory, now_ns: u64) -> u64 {
        self.local_ns(now_ns).wrapping_add(memory.u64(at::TIME_OFFSET))
    }

    /// Puts the present time where a master reads it.
    pub fn show(&self, memory: &mut Memory, now_ns: u64) {
        let time_ns = self.system_ns(memory, now_ns);
        memory.put(at::SYSTEM_TIME, &time_ns.to_le_bytes());
    }

    /// Notes when a frame came in at the first port and back at the second, if there is anything behind.
    pub fn latch(&self, memory: &mut Memory, in_ns: u64, back_ns: Option<u64>) {
        let local_ns = self.local_ns(in_ns);
        memory.put(at::RECEIVE_TIMES, &(local_ns as u32).to_le_bytes());
        memory.put(at::RECEIVE_TIMES + 4, &back_ns.map_or(0, |ns| self.local_ns(ns) as u32).to_le_bytes());
        memory.put(at::RECEIVE_TIME, &local_ns.to_le_bytes());
    }

    /// Takes a sample of the reference clock: moves towards it, and shows by how much it was off. Samples of 4 bytes are the
    /// time's lower half.
    pub fn follow(&mut self, memory: &mut Memory, reference: &[u8], now_ns: u64) {
        let Some(low) = reference.first_chunk::<4>() else { return };
        let delay_ns = memory.u32(at::TIME_DELAY);
        let expected_ns = u32::from_le_bytes(*low).wrapping_add(delay_ns);
        // Both halves wrap; near each other the lower tells.
        let ahead_ns = (self.system_ns(memory, now_ns) as u32).wrapping_sub(expected_ns) as i32;
        self.corrected_ns += i64::from(ahead_ns) / CATCHES_UP;
        let shown = ahead_ns.unsigned_abs() & 0x7FFF_FFFF | u32::from(ahead_ns < 0) << 31;
        memory.put(at::TIME_DIFFERENCE, &shown.to_le_bytes());
    }

    /// Starts or stops the pulses as the registers say; a start that has passed never comes, as on the chip.
    pub fn activate(&mut self, memory: &Memory, now_ns: u64) {
        let wanted = memory.u8(at::SYNC_ACTIVATION) & 3 == 3 && memory.u32(at::SYNC0_CYCLE) >= SHORTEST_CYCLE_NS;
        let start_ns = memory.u64(at::SYNC_START);
        let ahead_ns = start_ns.wrapping_sub(self.system_ns(memory, now_ns)) as i64;
        self.next_pulse_ns = (wanted && ahead_ns > 0).then_some(start_ns);
    }

    /// Whether SYNC0 gives pulses, or will.
    pub fn is_running(&self) -> bool {
        self.next_pulse_ns.is_some()
    }

    /// When the next pulse comes, as the bus counts time at `now_ns`.
    pub fn next_pulse_ns(&self, memory: &Memory, now_ns: u64) -> Option<u64> {
        let ahead_ns = self.next_pulse_ns?.wrapping_sub(self.system_ns(memory, now_ns)) as i64;
        Some(now_ns.saturating_add_signed(ahead_ns.max(0)))
    }

    /// The pulse came at `now_ns`: on to the next. Where the master set the clock far ahead, those between are left out.
    pub fn pulse(&mut self, memory: &Memory, now_ns: u64) {
        let cycle_ns = u64::from(memory.u32(at::SYNC0_CYCLE).max(SHORTEST_CYCLE_NS));
        let time_ns = self.system_ns(memory, now_ns);
        self.next_pulse_ns = self.next_pulse_ns.map(|ns| {
            let missed = (time_ns.wrapping_sub(ns) as i64).max(0) as u64 / cycle_ns;
            ns.wrapping_add(cycle_ns * if missed > MANY { missed } else { 1 })
        });
    }
}
