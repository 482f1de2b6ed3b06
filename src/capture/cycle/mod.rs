//! One cycle after the other: wait for its moment, exchange, look, decide.

mod ask;

use super::axis::{Axis, Inputs, Now};
use super::cause::Cause;
use super::evidence::Evidence;
use super::line::{Failure, Line};
use super::managers::{Manager, managers};
use super::master::{Exchange, states};
use super::recorder::{Recorder, Sample};
use super::rig::Rig;
use super::safety::{Request, State};
use super::watchdog;
use super::wire::Wire;
use ethercrab::{MainDevice, SubDeviceState};
use std::sync::atomic::{AtomicBool, Ordering};

/// A cycle that begins later than this share of its period counts as late.
const LATE: f64 = 0.25;
/// Share of a period within which an answer must come.
const ANSWER: f64 = 0.8;

/// A mailbox is looked at once in so many cycles, ...
const MAILBOX_CYCLES: u64 = 10;
/// ... and a register of a device in this one of them.
const EVIDENCE_CYCLE: u64 = 5;
/// A drive that must leave OP is told so again after so many cycles.
const TOLD_AGAIN: u64 = 20;
/// Cycles missed one after the other from which on a drive stands still: one it bridges.
const GAP_CYCLES: u32 = 2;

/// Share of the distance from the middle between two pulses of the devices' clocks that a cycle makes good, and the most of a
/// period that it does.
const PULL: (f64, f64) = (0.02, 0.005);

/// Cycles without answers, one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gap {
    /// None, or so few that the drive bridges them.
    None,
    /// Answers fail to come.
    Lasts,
    /// The first answer after that has come.
    Over,
}

/// Cycles that were not as they should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Began late.
    pub late: u32,
    /// Brought nothing: overslept, or without an answer in time.
    pub missed: u32,
}

/// The exchange in OP, run cycle by cycle.
pub struct Cycle<'a, 's, W, C> {
    line: &'a mut Line<'s, W>,
    main: &'a MainDevice<'a>,
    exchange: Exchange<C>,
    rig: Rig,
    /// The joint on it.
    pub axis: Axis,
    /// What was last seen.
    pub now: Option<Now>,
    /// Since they were last set back.
    pub counts: Counts,
    /// Whether samples are being recorded.
    pub records: bool,
    recorder: &'a mut Recorder,
    interrupted: &'a AtomicBool,
    number: u64,
    began_ns: u64,
    origin_ns: u64,
    missed_in_a_row: u32,
    /// Missed before the last answer.
    bridged: u32,
    /// Where the drive's inputs stand in its memory, if that is known.
    drive_inputs: Option<Manager>,
    /// The drive's station address.
    drive_station: Option<u16>,
    bus_time_origin_ns: Option<u64>,
    evidence: Evidence,
    /// s from the beginning of the campaign to that of this run.
    began_s: f64,
    command_rad: f64,
}

impl<'a, 's, W: Wire, C> Cycle<'a, 's, W, C> {
    /// Cycles over `exchange`, beginning now, which is `began_s` after the campaign began.
    pub fn new(
        line: &'a mut Line<'s, W>,
        main: &'a MainDevice<'a>,
        exchange: Exchange<C>,
        rig: &Rig,
        recorder: &'a mut Recorder,
        interrupted: &'a AtomicBool,
        began_s: f64,
    ) -> Self {
        let named = |place: usize, name: &str| rig.name(place).unwrap_or_else(|| format!("device {place} (`{name}`)"));
        let evidence = Evidence::new(exchange.group.iter(main).enumerate().map(|(place, device)| {
            (named(place, device.name()), device.configured_address(), device.dc_support().any())
        }));
        let drive = exchange.group.subdevice(main, rig.drive.identity.place).ok();
        let drive_station = drive.as_ref().map(|drive| drive.configured_address());
        let drive_inputs = drive.and_then(|drive| managers(line, &drive).into_iter().find(Manager::is_inputs));
        let origin_ns = line.wire.now_ns();
        Self {
            line,
            main,
            exchange,
            rig: rig.clone(),
            axis: Axis::new(rig),
            now: None,
            counts: Counts::default(),
            records: false,
            recorder,
            interrupted,
            number: 0,
            began_ns: origin_ns,
            origin_ns,
            missed_in_a_row: 0,
            bridged: 0,
            drive_inputs,
            drive_station,
            bus_time_origin_ns: None,
            evidence,
            began_s,
            command_rad: 0.0,
        }
    }

    /// The recorder that samples go to.
    pub fn recorder(&mut self) -> &mut Recorder {
        self.recorder
    }

    /// What the bus told of itself since this was last asked for.
    pub fn evidence(&mut self) -> serde_json::Value {
        self.evidence.tell()
    }

    /// Cycles so far.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Whether answers fail to come for so long that the drive stands still.
    pub fn gap(&self) -> Gap {
        match (self.missed_in_a_row, self.bridged) {
            (GAP_CYCLES.., _) => Gap::Lasts,
            (0, GAP_CYCLES..) => Gap::Over,
            _ => Gap::None,
        }
    }

    /// Whether the drive's output watchdog runs now; nothing where it does not tell.
    pub fn is_watched(&mut self) -> Option<bool> {
        let until_ns = self.line.wire.now_ns() + self.period_ns() / 2;
        let drive = self.exchange.group.subdevice(self.main, self.rig.drive.identity.place).ok()?;
        watchdog::is_fed(self.line, &drive, until_ns)
    }

    /// One cycle: the frame of its moment, with what was decided in the last one, and the next decision.
    pub fn turn(&mut self, request: Request, command_rad: Option<f64>) {
        let sent_ns = self.wait();
        let period_ns = self.period_ns();
        let until_ns = sent_ns + (ANSWER * period_ns as f64) as u64;
        let before = self.axis.state();
        let answer = self.line.run_until(until_ns, self.exchange.group.tx_rx_sync_system_time(self.main));
        match answer {
            Ok(seen) => {
                let states = &seen.subdevice_states;
                let fallen = states.iter().position(|state| *state != SubDeviceState::Op);
                self.answered(sent_ns, seen.working_counter, fallen.map(|at| (at, states[at])), seen.extra);
            }
            Err(Failure::TimedOut | Failure::Stack(_)) => self.missed(1),
            Err(Failure::Panic(words)) => {
                self.missed(1);
                self.panicked(words);
            }
        }
        if self.missed_in_a_row == 0 {
            self.look_for_news(until_ns);
        } else if self.axis.state().is_ending() {
            self.ask_drive(until_ns);
        }
        if self.number.is_multiple_of(MAILBOX_CYCLES) && self.missed_in_a_row == 0 {
            self.look_for_mail(until_ns);
        }
        if self.number % MAILBOX_CYCLES == EVIDENCE_CYCLE && self.missed_in_a_row == 0 {
            self.evidence.look(self.line, self.main, until_ns);
        }
        if let Some(why) = self.recorder.failed() {
            self.axis.blame(Cause::Recording(why));
        }
        if self.interrupted.load(Ordering::Relaxed) {
            self.axis.blame(Cause::Interrupted);
        }
        self.axis.step(request, command_rad);
        let is_leaving = self.axis.state() == State::Leaving;
        if is_leaving && (before != State::Leaving || self.number.is_multiple_of(TOLD_AGAIN)) {
            self.drop_drive();
        }
        self.command_rad = self.axis.target_rad();
        self.write();
        if self.axis.state() != before {
            self.tell(before);
        }
    }

    fn period_ns(&self) -> u64 {
        u64::from(self.rig.bus.cycle_us) * 1000
    }

    /// Waits for the moment of the next cycle; periods that were slept through are missed. Gives the time then.
    fn wait(&mut self) -> u64 {
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

    /// The drive is told to leave OP, past the stack. It alone: what else is on the bus goes on.
    fn drop_drive(&mut self) {
        match self.drive_station {
            Some(station) => self.line.drop_device(station),
            None => self.line.drop_out(),
        }
    }

    /// The stack panicked with these words: past it the drive is told to leave OP.
    fn panicked(&mut self, words: String) {
        self.drop_drive();
        self.axis.blame(Cause::Panic(words));
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

    fn missed(&mut self, cycles: u32) {
        self.counts.missed = self.counts.missed.saturating_add(cycles);
        self.missed_in_a_row = self.missed_in_a_row.saturating_add(cycles);
        if self.missed_in_a_row > self.rig.bus.missed_cycles_max {
            self.axis.blame(Cause::MissedCycles(self.missed_in_a_row));
        }
    }

    /// Takes an answer in, if all devices had a part in it.
    fn answered(
        &mut self,
        sent_ns: u64,
        working_counter: u16,
        fallen: Option<(usize, SubDeviceState)>,
        bus_time_ns: Option<u64>,
    ) {
        if let Some((place, state)) = fallen {
            let device = self.name(place);
            self.axis.blame(Cause::DeviceState { device, state: format!("{state:?}") });
        }
        let expected = self.exchange.working_counter;
        if working_counter != expected {
            // What explains the other comes first.
            self.axis.blame(Cause::WorkingCounter { found: working_counter, expected });
            return self.missed(1);
        }
        let periods = self.missed_in_a_row.saturating_add(1);
        self.bridged = std::mem::take(&mut self.missed_in_a_row);
        let group = &self.exchange.group;
        let (drive, sensor) = (self.rig.drive.identity.place, self.rig.sensor.identity.place);
        let (Ok(drive), Ok(sensor)) = (group.subdevice(self.main, drive), group.subdevice(self.main, sensor)) else {
            return self.axis.blame(Cause::Stack("a device is gone from the stack's list".to_string()));
        };
        let had_cause = self.axis.cause().is_some();
        let state = self.axis.state();
        let inputs = (drive.inputs_raw(), sensor.inputs_raw());
        let now = self.axis.take(&Inputs { drive: &inputs.0, sensor: &inputs.1, periods });
        drop(inputs);
        self.pull(bus_time_ns);
        let bus_time_ns = bus_time_ns.unwrap_or(0);
        let bus_origin_ns = *self.bus_time_origin_ns.get_or_insert(bus_time_ns);
        if self.records && !had_cause {
            self.record(sent_ns, state, working_counter, bus_time_ns.saturating_sub(bus_origin_ns), &now);
        }
        self.now = Some(now);
    }

    fn record(&mut self, sent_ns: u64, state: State, working_counter: u16, bus_time_ns: u64, now: &Now) {
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

    fn write(&mut self) {
        if let Ok(drive) = self.exchange.group.subdevice(self.main, self.rig.drive.identity.place) {
            self.axis.write(drive.io_raw_mut().outputs(), self.now.as_ref());
        }
    }

    fn name(&self, place: usize) -> String {
        self.rig.name(place).unwrap_or_else(|| format!("device {place}"))
    }

    /// A change of state, to the campaign's log.
    fn tell(&mut self, before: State) {
        let (state, drive) = (self.axis.state(), self.axis.drive());
        let why = match (state, self.axis.cause()) {
            (State::Stopping, Some(cause)) => format!(": {} ({cause})", cause.name()),
            _ => String::new(),
        };
        let line = format!("cycle {}: {} -> {}, drive {drive}{why}", self.number, before.name(), state.name());
        self.recorder.note(line);
    }

    /// The exchange ends: all devices leave OP. Gives where each of them was, in words.
    pub fn finish(self) -> String {
        let words = states(self.line, self.main, &self.exchange.group, &self.rig);
        self.line.drop_out();
        words
    }
}
