//! The moment of a cycle, and what its answer says or that none came.

use super::Cycle;
use crate::capture::cause::Cause;
use crate::capture::exchange::Answer;
use crate::capture::recorder::Sample;
use crate::capture::safety::State;
use crate::capture::wire::Wire;

/// A cycle that begins later than this share of its period counts as late.
const LATE: f64 = 0.25;

/// Share of the distance from the middle between two pulses of the devices' clocks that a cycle makes good, and the most of a
/// period that it does.
const PULL: (f64, f64) = (0.02, 0.005);

impl<W: Wire, C> Cycle<'_, '_, W, C> {
    /// Waits for the moment of the next cycle; periods that were slept through are missed. Gives the time then.
    pub(super) fn wait(&mut self) -> u64 {
        let period_ns = self.period_ns();
        self.number += 1;
        let due_ns = self.origin_ns + self.number * period_ns;
        self.line.wire.sleep(due_ns);
        let now_ns = self.line.wire.now_ns();
        let overslept = (now_ns - due_ns.min(now_ns)) / period_ns;
        if overslept > 0 {
            self.number += overslept;
            self.missed(u32::try_from(overslept).unwrap_or(u32::MAX));
        }
        let late_ns = now_ns - (self.origin_ns + self.number * period_ns).min(now_ns);
        self.counts.late += u32::from(late_ns as f64 > LATE * period_ns as f64);
        now_ns
    }

    /// Keeps our frames in the middle between the pulses of the devices' clocks, which come at whole periods of their time: what
    /// a device does at its pulse is then over when the frame comes, however the clocks drift.
    fn pull(&mut self, bus_time_ns: Option<u64>) {
        let Some(bus_time_ns) = bus_time_ns.filter(|_| self.rig.bus.clocks) else { return };
        let period = self.period_ns() as f64;
        let off = (bus_time_ns % self.period_ns()) as f64 - period / 2.0;
        let pull = (PULL.0 * off).clamp(-PULL.1 * period, PULL.1 * period);
        self.origin_ns = self.origin_ns.saturating_add_signed(-pull as i64);
    }

    pub(super) fn missed(&mut self, cycles: u32) {
        self.counts.missed = self.counts.missed.saturating_add(cycles);
        self.missed_in_a_row = self.missed_in_a_row.saturating_add(cycles);
        if self.missed_in_a_row > self.rig.bus.missed_cycles_max {
            self.blame(Cause::MissedCycles(self.missed_in_a_row));
        }
    }

    /// Takes an answer in, if all devices had a part in it.
    pub(super) fn answered(&mut self, sent_ns: u64, answer: &Answer) {
        let Answer { working_counter, fallen, bus_time_ns } = *answer;
        if let Some((place, state)) = fallen {
            let device = self.name(place);
            self.blame(Cause::DeviceState { device, state: format!("{state:?}") });
        }
        let expected = self.exchange.working_counter;
        if working_counter != expected {
            // What explains the other comes first.
            self.blame(Cause::WorkingCounter { found: working_counter, expected });
            return self.missed(1);
        }
        let periods = self.missed_in_a_row.saturating_add(1);
        self.bridged = std::mem::take(&mut self.missed_in_a_row);
        let had_cause = self.joint.axis.cause().is_some();
        let state = self.joint.axis.state();
        let Self { main, exchange, joint, held, .. } = self;
        std::iter::once(joint).chain(held).for_each(|driven| driven.take(main, exchange, periods));
        self.pull(bus_time_ns);
        let bus_time_ns = bus_time_ns.unwrap_or(0);
        let bus_origin_ns = *self.bus_time_origin_ns.get_or_insert(bus_time_ns);
        if self.records && !had_cause {
            self.record(sent_ns, state, working_counter, bus_time_ns.saturating_sub(bus_origin_ns));
        }
    }

    fn record(&mut self, sent_ns: u64, state: State, working_counter: u16, bus_time_ns: u64) {
        let Some(now) = &self.joint.now else { return };
        // What is no number has no place in a log; it is in the cause.
        let torque_nm = (now.sensor.counts - self.rig.sensor.zero_counts) * self.rig.sensor.nm_per_count;
        if !torque_nm.is_finite() || !now.position_rad.is_finite() {
            return;
        }
        self.recorder.record(Sample {
            time_s: self.began_s + (sent_ns - self.began_ns) as f64 * 1e-9,
            cycle: self.number,
            state: state.name(),
            working_counter,
            position_rad: now.position_rad,
            torque_nm,
            command_rad: self.command_rad,
            bus_time_s: bus_time_ns as f64 * 1e-9,
            status_word: now.status_word,
            sensor_status: now.sensor.status,
            sensor_counts: now.sensor.counts,
            drive_torque_nm: now.drive_torque_nm,
            extras: [now.drive_velocity_rad_s, now.drive_current_per_mille],
        });
    }
}
