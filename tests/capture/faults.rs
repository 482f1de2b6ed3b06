//! Every fault that the bus can have ends in a quick stop, is named, and leaves a recording that opens.

use super::{AT, SWEEP, Watched, demo, folder, plan, rig, run};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tautline::bus::{Bus, Fault, When};
use tautline::capture::cause::Cause;
use tautline::capture::drive::{Condition, Control};
use tautline::capture::in_process::InProcess;
use tautline::capture::operator::Agrees;
use tautline::capture::session::{Task, capture};
use tautline::capture::wire::Wire;
use tautline::log::{Campaign, read_trial};
use tempfile::TempDir;

/// After the cycle in which a fault can be seen the drive has its quick stop within so many.
const CYCLES: usize = 2;

/// What a fault should do.
struct Case {
    fault: Fault,
    /// Names of the cause that will do.
    causes: &'static [&'static str],
    /// Cycles until it can be seen: that many answers are missing, or values alike, or the joint must first be off by its limit.
    unseen: usize,
}

fn cases() -> Vec<Case> {
    let case = |fault, causes, unseen| Case { fault, causes, unseen };
    vec![
        case(Fault::Late { frames: 10, by_ns: 3_000_000 }, &["missed_cycles"], 2),
        case(Fault::Lost { frames: 10 }, &["missed_cycles"], 2),
        case(Fault::Unsent { frames: 10 }, &["missed_cycles"], 10),
        case(Fault::Corrupted { frames: 10 }, &["missed_cycles", "working_counter", "device_state"], 2),
        case(Fault::WorkingCounterShort { device: 0, frames: 1 }, &["working_counter"], 1),
        case(Fault::WorkingCounterShort { device: 1, frames: 5 }, &["working_counter"], 1),
        case(Fault::SafeOp { device: 0, code: 0x1A }, &["device_state"], 1),
        case(Fault::SafeOp { device: 1, code: 0x1A }, &["device_state"], 1),
        case(Fault::Gone { device: 1 }, &["working_counter", "device_state"], 1),
        // Nothing reaches the drive any more: its own watchdog (100 ms) stops it.
        case(Fault::Gone { device: 0 }, &["missed_cycles", "working_counter", "device_state"], 100),
        case(Fault::Emergency { device: 0, code: 0x8611 }, &["emergency"], 11),
        case(Fault::Watchdog { device: 0 }, &["device_state"], 1),
        case(Fault::Drive { code: 0x2310 }, &["drive_fault"], 1),
        case(Fault::QuickStop, &["drive_quick_stop", "drive_left"], 1),
        case(Fault::Inhibit, &["drive_left", "drive_quick_stop"], 1),
        case(Fault::InternalLimit, &["internal_limit"], 1),
        case(
            Fault::Blocked,
            &["not_following", "lag", "following_error", "drive_fault", "torque_step", "torque", "internal_limit"],
            300,
        ),
        case(Fault::CableBreak, &["torque_step", "torque"], 5),
        case(Fault::EncoderJump { by_rad: 0.03 }, &["encoder_jump"], 1),
        case(Fault::StaleSensor, &["sensor_stale"], 4),
        case(Fault::SaturatedSensor, &["sensor_saturated"], 1),
        case(Fault::NotANumber, &["sensor_error", "sensor_not_a_number"], 1),
        case(Fault::FrozenInputs { device: 0 }, &["drive_stale", "not_following"], 6),
        // What may be commanded before the joint must be seen to follow: 5 mrad at 0.4 rad/s, and as much as it had gone before.
        case(Fault::FrozenEncoder, &["not_following"], 25),
    ]
}

/// The sweep with `fault` at `at`, recorded; the folder is there to be looked at.
fn struck(fault: Fault, at: u64) -> (TempDir, Watched) {
    let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
    let mut bus: Bus = demo();
    bus.inject(fault, When::Cycle(at));
    let watched = run(bus, &rig, &plan, Some(folder(&out.path().join("c"), &rig, false)));
    (out, watched)
}

#[test]
fn every_fault_ends_in_a_quick_stop_and_is_named() {
    let mut wrong = Vec::new();
    for Case { fault, causes, unseen } in cases() {
        let (out, Watched { outcome, control, status }) = struck(fault, *AT);
        let name = outcome.cause.as_ref().map_or("nothing", |cause| cause.name());
        let mut fail = |what: String| wrong.push(format!("{fault:?}: {what}"));
        if !causes.contains(&name) {
            fail(format!("the cause is {name}: {:?}", outcome.cause));
        }
        // Either our command has reached the drive, or the drive has stopped by itself.
        let at = *AT as usize;
        let is_stopped =
            |i: usize| control[i] == Control::QuickStop.word() || Condition::of(status[i]) != Condition::Enabled;
        let stopped = (at..control.len()).find(|i| is_stopped(*i));
        if Condition::of(status[at - 1]) != Condition::Enabled {
            fail("the joint was not moving".to_string());
        }
        if stopped.is_none_or(|stopped| stopped > at + unseen + CYCLES) {
            fail(format!("stopped after {:?} cycles", stopped.map(|stopped| stopped - at)));
        }
        if Condition::of(*status.last().unwrap()) == Condition::Enabled {
            fail("the drive has torque at the end".to_string());
        }
        // The recording opens, with its trial marked, up to the fault.
        let campaign = Campaign::read(&out.path().join("c")).unwrap();
        let log = read_trial(&campaign, 0).unwrap();
        let why = campaign.trials[0].capture.as_ref().and_then(|capture| capture.incomplete.clone());
        if !why.as_ref().is_some_and(|why| why.starts_with(name)) {
            fail(format!("the trial is marked {why:?}"));
        }
        let notes = std::fs::read_to_string(out.path().join("c/capture.log")).unwrap();
        if !notes.contains(name) || log.time_s.len() < 2000 {
            fail(format!("{} samples, notes:\n{notes}", log.time_s.len()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn single_frames_that_come_late_twice_or_not_at_all_do_no_harm() {
    for fault in [
        Fault::Late { frames: 1, by_ns: 900_000 },
        Fault::Late { frames: 1, by_ns: 40_000_000 },
        Fault::Lost { frames: 1 },
        Fault::Duplicated { frames: 50 },
    ] {
        let (out, Watched { outcome, .. }) = struck(fault, *AT);
        assert_eq!((outcome.cause.clone(), outcome.complete), (None, 2), "{fault:?}");
        let missed = u32::from(!matches!(fault, Fault::Duplicated { .. }));
        assert_eq!(outcome.counts.missed, missed, "{fault:?}");
        let campaign = Campaign::read(&out.path().join("c")).unwrap();
        let counted: u32 = campaign.trials.iter().map(|t| t.capture.as_ref().unwrap().missed_cycles).sum();
        assert_eq!(counted, missed);
        read_trial(&campaign, 0).unwrap();
    }
}

#[test]
fn an_operator_stops_it() {
    let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
    let interrupted = AtomicBool::new(false);
    let mut bus = demo();
    let answers = |now_ns: u64, frame: &[u8]| {
        interrupted.store(bus.cycles() >= *AT, Ordering::Relaxed);
        bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
    };
    let task = Task { rig: &rig, plan: &plan, armed: true, interrupted: &interrupted, operator: &Agrees };
    let folder = folder(&out.path().join("c"), &rig, false);
    let outcome = capture(InProcess::new(answers), &task, Some(folder), &Arc::default()).unwrap();
    assert_eq!(outcome.cause, Some(Cause::Interrupted));
    assert!(!Condition::of(bus.drive_status().unwrap()).has_torque());
    assert!(Campaign::read(&out.path().join("c")).unwrap().trials[0].is_incomplete());
}

/// Whatever panics on the way of a frame: the drive is stopped, the recording stands, and the process goes on.
#[test]
fn a_panic_of_the_stack_stops_the_drive() {
    let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
    let interrupted = AtomicBool::new(false);
    let (mut bus, mut panics) = (demo(), 1);
    let answers = |now_ns: u64, frame: &[u8]| {
        if bus.cycles() == *AT && panics > 0 {
            panics -= 1;
            panic!("as if the stack had");
        }
        bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
    };
    let task = Task { rig: &rig, plan: &plan, armed: true, interrupted: &interrupted, operator: &Agrees };
    let folder = folder(&out.path().join("c"), &rig, false);
    let outcome = capture(InProcess::new(answers), &task, Some(folder), &Arc::default()).unwrap();
    assert_eq!(outcome.cause, Some(Cause::Panic("as if the stack had".to_string())));
    assert!(!Condition::of(bus.drive_status().unwrap()).has_torque());
    let campaign = Campaign::read(&out.path().join("c")).unwrap();
    assert!(campaign.trials[0].is_incomplete() && read_trial(&campaign, 0).is_ok());
}

/// A wire on which the program itself fails, so many times from a moment on.
struct Failing<W> {
    wire: W,
    at_ns: u64,
    times: u32,
}

impl<W: Wire> Wire for Failing<W> {
    fn now_ns(&self) -> u64 {
        self.wire.now_ns()
    }

    fn send(&mut self, frame: &[u8]) -> io::Result<()> {
        self.wire.send(frame)
    }

    fn receive(&mut self, buffer: &mut [u8], until_ns: u64) -> io::Result<Option<usize>> {
        self.wire.receive(buffer, until_ns)
    }

    fn sleep(&mut self, until_ns: u64) {
        if self.now_ns() >= self.at_ns && self.times > 0 {
            self.times -= 1;
            panic!("as if the program had");
        }
        self.wire.sleep(until_ns);
    }

    fn is_real_time(&self) -> bool {
        self.wire.is_real_time()
    }
}

/// What fails outside the stack stops the drive too, and takes nothing of the recording away.
#[test]
fn a_panic_of_the_program_stops_the_drive() {
    const AT_NS: u64 = 10_000_000_000;
    for times in [1, u32::MAX] {
        let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
        let (interrupted, mut bus, mut last_ns) = (AtomicBool::new(false), demo(), 0);
        let answers = |now_ns: u64, frame: &[u8]| {
            last_ns = now_ns;
            bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
        };
        let wire = Failing { wire: InProcess::new(answers), at_ns: AT_NS, times };
        let task = Task { rig: &rig, plan: &plan, armed: true, interrupted: &interrupted, operator: &Agrees };
        let folder = folder(&out.path().join("c"), &rig, false);
        let outcome = capture(wire, &task, Some(folder), &Arc::default()).unwrap();
        assert_eq!(outcome.cause, Some(Cause::Panic("as if the program had".to_string())), "{times}");
        assert!(last_ns > AT_NS, "nothing was sent after it: {times}");
        bus.advance(last_ns + 1_000_000_000);
        assert!(!Condition::of(bus.drive_status().unwrap()).has_torque(), "{times}");
        let campaign = Campaign::read(&out.path().join("c")).unwrap();
        let why = campaign.trials[0].capture.as_ref().and_then(|capture| capture.incomplete.clone());
        assert!(why.as_ref().is_some_and(|why| why.starts_with("panic")), "{why:?}");
        assert!(read_trial(&campaign, 0).unwrap().time_s.len() > 2000);
    }
}

/// What the drive said before it had torque is history; it does not hide what it says later.
#[test]
fn an_old_emergency_message_hides_no_new_one() {
    let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
    let mut bus = demo();
    bus.inject(Fault::Emergency { device: 0, code: 0x1000 }, When::Cycle(5));
    bus.inject(Fault::Emergency { device: 0, code: 0x8611 }, When::Cycle(*AT));
    let outcome = run(bus, &rig, &plan, Some(folder(&out.path().join("c"), &rig, false))).outcome;
    assert_eq!(outcome.cause, Some(Cause::Emergency(Some(0x8611))));
    let notes = std::fs::read_to_string(out.path().join("c/capture.log")).unwrap();
    assert!(notes.contains("emergency message 0x1000, before there was torque"), "{notes}");
}

/// An emergency message during a transfer of objects makes the stack panic: it is kept from it, and told.
#[test]
fn an_emergency_while_the_bus_starts_is_told_and_hinders_nothing() {
    let (rig, plan) = (rig(), plan(SWEEP));
    let interrupted = AtomicBool::new(false);
    let task = Task { rig: &rig, plan: &plan, armed: false, interrupted: &interrupted, operator: &Agrees };
    let mut told = 0;
    for at_ms in 0..60 {
        let mut bus = demo();
        // Two of them, as of a drive with two faults: its mailbox holds one after the other.
        for code in [0x1000, 0x7500] {
            bus.inject(Fault::Emergency { device: 0, code }, at_ms * 1_000_000);
        }
        let answers = |now_ns: u64, frame: &[u8]| {
            bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
        };
        let outcome = capture(InProcess::new(answers), &task, None, &Arc::default()).unwrap();
        let says =
            |code| outcome.report.iter().any(|line| line.contains("while the bus started") && line.contains(code));
        told += u32::from(says("`winch drive` sent emergency message 0x1000") && says("0x7500"));
        assert!(!Condition::of(bus.drive_status().unwrap()).has_torque());
    }
    assert!(told > 5, "{told} came while objects were asked for");
}
