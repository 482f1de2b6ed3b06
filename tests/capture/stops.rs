//! Nothing runs away: what is sent stays within the limits, what is frozen is noticed, a stop ends with torque seen off or says so.

use super::{RIG, SWEEP, demo, moving_at, plan, rig, traced, truth};
use std::cell::{Cell, RefCell};
use std::path::Path;
use tautline::bus::{Bus, Fault, Joint, Terminal, When, drive_with};
use tautline::capture::cause::Cause;
use tautline::capture::drive::{Condition, Control};
use tautline::capture::in_process::InProcess;
use tautline::capture::operator::{Agrees, Operator};
use tautline::capture::rig::Rig;
use tautline::capture::session::{Outcome, Task, Torque, capture};

const CSV: &str = "mode = \"csv\"\ngains = { position_per_s = 20.0 }";
const CST: &str = "mode = \"cst\"\ngains = { stiffness_nm_rad = 60.0, damping_nm_s_rad = 1.5 }";

/// The demo's rig with other lines in place of some.
fn rig_with(changes: &[(&str, &str)]) -> Rig {
    let text = changes.iter().fold(RIG.to_string(), |text, (before, after)| {
        assert!(text.contains(before), "{before}");
        text.replace(before, after)
    });
    Rig::parse(Path::new("rig.toml"), &text).unwrap()
}

/// A rig in `mode` whose limit of speed is little above the plan's 0.4 rad/s, and in torque mode above what the joint does by itself
/// where it falls through its backlash.
fn slow_rig(mode: &str) -> Rig {
    let speed = if mode == CST { "speed_rad_s = 0.8" } else { "speed_rad_s = 0.5" };
    rig_with(&[("mode = \"csp\"", mode), ("speed_rad_s = 1.5", speed)])
}

/// What a joint did after its fault.
struct After {
    outcome: Outcome,
    /// Cycles until the drive had no torque.
    off: Option<u64>,
    /// Until then: the largest true speed, rad/s, and way, rad.
    speed_rad_s: f64,
    travel_rad: f64,
    /// Control words since then.
    control: Vec<u16>,
}

/// The sweep of `rig` with `faults` in the middle of its way up.
fn struck(rig: &Rig, faults: &[Fault]) -> After {
    let plan = plan(SWEEP);
    let at = moving_at(rig, &plan);
    let mut bus = demo();
    faults.iter().for_each(|fault| bus.inject(*fault, When::Cycle(at)));
    played(rig, bus, at)
}

impl std::fmt::Debug for After {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { outcome, off, speed_rad_s, travel_rad, .. } = self;
        let (cause, torque) = (&outcome.cause, &outcome.torque);
        write!(f, "{cause:?}, {torque:?}, off {off:?}, {speed_rad_s} rad/s, {travel_rad} rad")
    }
}

fn played(rig: &Rig, bus: Bus, at: u64) -> After {
    let (mut cycles, mut off, mut from) = (0, None, None);
    let (mut speed_rad_s, mut travel_rad, mut control) = (0.0f64, 0.0f64, Vec::new());
    let outcome = traced(bus, rig, &plan(SWEEP), &Agrees, &mut |_, bus| {
        if bus.cycles() < at {
            return;
        }
        cycles += 1;
        let word = bus.devices()[0].object(0x6040, 0).unwrap();
        control.push(u16::from_le_bytes([word[0], word[1]]));
        let truth = bus.truth();
        if off.is_none() {
            speed_rad_s = speed_rad_s.max(truth.velocity_rad_s.abs());
            travel_rad = travel_rad.max((truth.position_rad - *from.get_or_insert(truth.position_rad)).abs());
            off = (!Condition::of(bus.drive_status().unwrap()).has_torque()).then_some(cycles);
        }
    });
    After { outcome, off, speed_rad_s, travel_rad, control }
}

/// S1: it had reached 4.17 rad/s at a limit of 0.5, and left its range.
#[test]
fn a_frozen_encoder_makes_no_joint_fast() {
    for mode in ["mode = \"csp\"", CSV, CST] {
        let after = struck(&slow_rig(mode), &[Fault::FrozenEncoder]);
        let name = after.outcome.cause.as_ref().map(Cause::name);
        assert!(matches!(name, Some("not_following" | "speed_gap" | "torque_step" | "lag")), "{mode}: {after:?}");
        assert!(after.speed_rad_s < if mode == CST { 1.0 } else { 0.625 }, "{mode}: {} rad/s", after.speed_rad_s);
        assert!(after.travel_rad < 0.1, "{mode}: {} rad", after.travel_rad);
        assert!(after.off.is_some_and(|cycles| cycles < 400), "{mode}: {after:?}");
    }
}

/// S6: frozen inputs were noticed after 479 ms in motion, and never while the joint was held.
#[test]
fn frozen_inputs_are_noticed_within_a_few_cycles() {
    for mode in ["mode = \"csp\"", CSV, CST] {
        let after = struck(&slow_rig(mode), &[Fault::FrozenInputs { device: 0 }]);
        let is_seen = matches!(after.outcome.cause, Some(Cause::DriveStale(_) | Cause::NotFollowing(_)));
        assert!(is_seen, "{mode}: {after:?}");
        let stopped = after.control.iter().position(|word| *word == Control::QuickStop.word());
        assert!(stopped.is_some_and(|cycles| cycles < 9), "{mode}: {stopped:?}");
        // Nothing that such a drive says shows that its torque is off.
        assert!(matches!(after.outcome.torque, Torque::NotShownOff(_)), "{mode}: {:?}", after.outcome.torque);
    }
}

#[test]
fn frozen_inputs_are_noticed_while_the_joint_is_held() {
    // The rest before the first sweep: enabled, and not moving.
    let (rig, mut held, mut still) = (rig(), 0, 0);
    let slow = plan(&SWEEP.replace("rest_s = 0.1", "rest_s = 1.0"));
    traced(demo(), &rig, &slow, &Agrees, &mut |_, bus| {
        let word = bus.devices()[0].object(0x6040, 0).unwrap()[0];
        let rests = u16::from(word) == Control::Enable.word() && bus.truth().velocity_rad_s.abs() < 1e-3;
        still = if rests { still + 1 } else { 0 };
        if held == 0 && still == 500 {
            held = bus.cycles();
        }
    });
    assert!(held > 0);
    let mut bus = demo();
    bus.inject(Fault::FrozenInputs { device: 0 }, When::Cycle(held));
    let mut stopped = None;
    let outcome = traced(bus, &rig, &slow, &Agrees, &mut |_, bus| {
        let word = bus.devices()[0].object(0x6040, 0).unwrap()[0];
        if stopped.is_none() && bus.cycles() > held && u16::from(word) == Control::QuickStop.word() {
            stopped = Some(bus.cycles() - held);
        }
    });
    assert!(matches!(outcome.cause, Some(Cause::DriveStale(_))), "{:?}", outcome.cause);
    assert!(stopped.is_some_and(|cycles| cycles < 9), "{stopped:?}");
}

/// A counter of the drive's own serves as well: here its status word stands for one that never changes, and is found useless.
#[test]
fn what_cannot_be_known_is_told() {
    #[derive(Debug, Default)]
    struct Reads(RefCell<Vec<String>>);
    impl Operator for Reads {
        fn ask(&self, lines: &[String], _: &str) {
            self.0.replace(lines.to_vec());
        }
        fn answer(&self) -> Option<bool> {
            Some(false)
        }
    }
    let told = |rig: &Rig| {
        let reads = Reads::default();
        traced(demo(), rig, &plan(SWEEP), &reads, &mut |_, _| ());
        reads.0.take().join("\n")
    };
    assert!(told(&rig()).contains("new every cycle"));
    let counted = rig_with(&[("as = \"error_code\"", "as = \"counter\"")]);
    assert!(told(&counted).contains("NOTHING TELLS WHETHER THE DRIVE'S INPUTS ARE NEW"), "{}", told(&counted));
}

/// S4: a drive that ignores its control word loses its torque by leaving OP.
#[test]
fn a_drive_that_ignores_its_control_word_is_dropped_out_of_op() {
    let after = struck(&rig(), &[Fault::IgnoredControl, Fault::StaleSensor]);
    assert!(matches!(after.outcome.cause, Some(Cause::SensorStale(_))), "{after:?}");
    assert_eq!(after.outcome.torque, Torque::Off);
    assert!(after.off.is_some_and(|cycles| cycles < 1000), "{after:?}");
    // On its way there it did not go on: the target came to rest.
    assert!(after.travel_rad < 0.1, "{after:?}");
}

/// S4: the bus is unplugged: nothing can be seen, and the last words say so.
#[test]
fn a_drive_that_is_gone_is_not_called_stopped() {
    let after = struck(&rig(), &[Fault::Gone { device: 0 }]);
    let Torque::NotShownOff(seen) = &after.outcome.torque else { panic!("{after:?}") };
    assert!(seen.contains("does not answer") && seen.contains("operation enabled"), "{seen}");
    let words = after.outcome.torque.warning().unwrap();
    assert!(words.starts_with("TORQUE IS NOT SHOWN TO BE OFF") && words.contains("EMERGENCY STOP"), "{words}");
    assert!(after.outcome.report.contains(&words));
}

/// S5: it had moved 7.8 rad during the stop, its position as reported being wrong.
#[test]
fn a_drive_that_does_not_obey_quick_stop_does_not_run_after_its_position() {
    for mode in ["mode = \"csp\"", CSV, CST] {
        for other in [Fault::FrozenEncoder, Fault::StaleSensor] {
            let after = struck(&slow_rig(mode), &[Fault::IgnoredQuickStop, other]);
            assert!(after.outcome.cause.is_some() && after.outcome.torque == Torque::Off, "{mode}: {after:?}");
            // Until the drive is off: a twentieth of a second in which it did not obey.
            assert!(after.off.is_some_and(|cycles| cycles < 150), "{mode}: {after:?}");
            assert!(after.travel_rad < 0.1, "{mode}: {after:?}");
        }
    }
}

/// A drive that runs at other speeds than it is told is noticed by them.
#[test]
fn a_drive_that_runs_off_is_noticed_by_its_speed() {
    let after = struck(&slow_rig(CSV), &[Fault::Runaway { factor: 4.0 }]);
    let name = after.outcome.cause.as_ref().map(Cause::name);
    assert!(matches!(name, Some("speed" | "speed_gap" | "encoder_jump" | "torque_step")), "{after:?}");
    assert!(after.travel_rad < 0.1, "{after:?}");
}

fn bus_of(drive: tautline::bus::Device) -> Bus {
    Bus::new(vec![drive, Terminal::default().device(0)]).with_joint(Joint::new(truth(), 0.0, 0.005, 1))
}

/// S2: a drive whose outputs do not feed the watchdog is made to; one that has none gets no torque, and a check tells so.
#[test]
fn there_is_no_torque_without_an_output_watchdog() {
    let (rig, plan) = (rig(), plan(SWEEP));
    let outcome = traced(bus_of(drive_with(0, false, &[])), &rig, &plan, &Agrees, &mut |_, _| ());
    assert_eq!((outcome.cause, outcome.complete), (None, 2));
    assert!(
        outcome.report.iter().any(|line| line == "`winch drive`: output watchdog 10 ms, read back"),
        "{:?}",
        outcome.report
    );

    let interrupted = std::sync::atomic::AtomicBool::new(false);
    for armed in [true, false] {
        let mut bus = demo();
        bus.inject(Fault::WatchdogOff { device: 0 }, 0);
        let wire = InProcess::new(move |now_ns: u64, frame: &[u8]| {
            bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
        });
        let task = Task { rig: &rig, plan: &plan, armed, interrupted: &interrupted, operator: &Agrees };
        match capture(wire, &task, None, &std::sync::Arc::default()) {
            Ok(outcome) => {
                assert!(!armed && matches!(outcome.doubt, Some(Cause::Watchdog(_))), "{outcome:?}");
            }
            Err(why) => assert!(armed && why.0.contains("HAS NO OUTPUT WATCHDOG"), "{}", why.0),
        }
    }
}

/// With the watchdog that was set, a program that dies in speed mode leaves no joint running.
#[test]
fn a_program_that_dies_is_stopped_by_the_watchdog_that_it_set() {
    let rig = slow_rig(CSV);
    let at = moving_at(&rig, &plan(SWEEP));
    let mut bus = bus_of(drive_with(0, false, &[]));
    // As if killed: no frame reaches the drive any more.
    bus.inject(Fault::Gone { device: 0 }, When::Cycle(at));
    let after = played(&rig, bus, at);
    // 100 ms of its watchdog, and its own ramp.
    assert!(after.off.is_some_and(|cycles| cycles < 200), "{after:?}");
}

/// An operator who is asked once, and says no.
#[derive(Debug, Default)]
struct Asked {
    lines: RefCell<Vec<String>>,
    word: RefCell<String>,
    asked: Cell<u32>,
    patience: Cell<u32>,
}

impl Operator for Asked {
    fn ask(&self, lines: &[String], word: &str) {
        self.lines.replace(lines.to_vec());
        self.word.replace(word.to_string());
        self.asked.set(self.asked.get() + 1);
    }

    fn answer(&self) -> Option<bool> {
        self.patience.set(self.patience.get() + 1);
        (self.patience.get() > 500).then_some(false)
    }
}

/// S3, S8: what is asked is asked on an open bus, after everything is shown; without a yes no word that gives torque is sent, no fault
/// is cleared, and the bus goes on meanwhile.
#[test]
fn the_operator_sees_everything_first() {
    let mut bus = demo();
    bus.inject(Fault::Drive { code: 0x2310 }, When::Cycle(100));
    let (asked, mut words, mut last) = (Asked::default(), Vec::new(), Condition::Unknown);
    let outcome = traced(bus, &rig(), &plan(SWEEP), &asked, &mut |_, bus| {
        words.push(bus.devices()[0].object(0x6040, 0).unwrap()[0]);
        last = Condition::of(bus.drive_status().unwrap());
    });
    assert!(outcome.declined && outcome.complete == 0, "{outcome:?}");
    assert!(words.iter().all(|word| *word == 0) && words.len() > 900 && last == Condition::Fault, "{last}");
    let shown = asked.lines.take().join("\n");
    assert_eq!((asked.asked.get(), asked.word.take()), (1, "clear and arm".to_string()));
    for line in [
        "serial 0x0000002a",
        "quick stop: option 2, 20.0 rad/s^2",
        "output watchdog 10 ms, read back",
        "drive's limits of position, read back",
        "drive's own limits, read back",
        "of 500 cycles 0 late, 0 missed",
        "THE DRIVE IS IN FAULT (code 0x2310)",
        "will move by itself: first from",
        "the first of them begins at",
        "safe torque off",
    ] {
        assert!(shown.contains(line), "{line}\nis not in\n{shown}");
    }
}

/// S10: the first motion is small, and finds a wrong sign of drive or sensor.
#[test]
fn a_wrong_sign_is_found_in_the_first_small_motion() {
    for change in [("sign = 1    ", "sign = -1    "), ("nm_per_count = 0.00015259255", "nm_per_count = -0.00015259255")]
    {
        let rig = rig_with(&[change, ("low_rad = -0.1", "low_rad = -0.5")]);
        let (mut from, mut travel_rad) = (None, 0.0f64);
        let outcome = traced(demo(), &rig, &plan(SWEEP), &Agrees, &mut |_, bus| {
            let at = bus.truth().position_rad;
            travel_rad = travel_rad.max((at - *from.get_or_insert(at)).abs());
        });
        assert!(matches!(outcome.cause, Some(Cause::Signs(_))), "{change:?}: {:?}", outcome.cause);
        assert!(travel_rad < 0.05, "{travel_rad}");
    }
    let outcome = traced(demo(), &rig(), &plan(SWEEP), &Agrees, &mut |_, _| ());
    assert!(outcome.report.iter().any(|line| line.contains("signs of drive and sensor fit")), "{:?}", outcome.report);
}

/// S10: the drive's own limits of position are the rig's, with the lag that it allows.
#[test]
fn the_drive_keeps_the_range_too() {
    let rig = rig();
    let (mut low, mut high) = (0, 0);
    traced(demo(), &rig, &plan(SWEEP), &Agrees, &mut |_, bus| {
        let end = |sub| i32::from_le_bytes(bus.devices()[0].object(0x607D, sub).unwrap().try_into().unwrap());
        (low, high) = (end(1), end(2));
    });
    assert_eq!((low, high), (rig.drive.counts(-0.15).round() as i32, rig.drive.counts(1.75).round() as i32));
}

/// S13: a drive that holds the joint after a quick stop goes on holding it until the operator has it let go.
#[test]
fn a_joint_that_the_drive_holds_is_held_until_the_operator_lets_it_go() {
    /// Arms, and lets go after a while.
    #[derive(Debug, Default)]
    struct Waits {
        words: RefCell<Vec<String>>,
        patience: Cell<u32>,
    }
    impl Operator for Waits {
        fn ask(&self, _: &[String], word: &str) {
            self.words.borrow_mut().push(word.to_string());
            self.patience.set(if word == "release" { 2000 } else { 0 });
        }
        fn answer(&self) -> Option<bool> {
            let left = self.patience.get();
            self.patience.set(left.saturating_sub(1));
            (left == 0).then_some(true)
        }
    }
    let (rig, plan, waits) = (rig(), plan(SWEEP), Waits::default());
    let at = moving_at(&rig, &plan);
    let mut bus = bus_of(drive_with(0, true, &[]));
    bus.set_object(0, 0x605A, 6);
    bus.inject(Fault::StaleSensor, When::Cycle(at));
    let (mut held, mut moved_rad, mut from_rad) = (0, 0.0f64, None);
    let outcome = traced(bus, &rig, &plan, &waits, &mut |_, bus| {
        let truth = bus.truth();
        if Condition::of(bus.drive_status().unwrap()) == Condition::QuickStop && truth.velocity_rad_s.abs() < 1e-3 {
            held += 1;
            let from_rad = *from_rad.get_or_insert(truth.position_rad);
            moved_rad = moved_rad.max((truth.position_rad - from_rad).abs());
        }
    });
    assert_eq!(waits.words.take(), ["arm", "release"]);
    assert!(held > 1900 && moved_rad < 0.01, "held for {held} cycles, moved {moved_rad} rad");
    assert_eq!(outcome.torque, Torque::Off);
}

/// S13: one drive that must leave OP takes no other device along.
#[test]
fn other_devices_stay_in_op_while_a_drive_is_dropped_out() {
    let (rig, plan) = (rig(), plan(SWEEP));
    let at = moving_at(&rig, &plan);
    let mut bus = demo();
    [Fault::IgnoredControl, Fault::StaleSensor].into_iter().for_each(|fault| bus.inject(fault, When::Cycle(at)));
    let mut apart = 0;
    traced(bus, &rig, &plan, &Agrees, &mut |_, bus| {
        let state = |place: usize| bus.devices()[place].al_status() & 0xF;
        apart += u32::from(state(0) == 4 && state(1) == 8);
    });
    assert!(apart > 5, "{apart} cycles");
}

/// S13: at the end the rig's devices leave OP, each by its own address; what else is on the bus stays as it is.
#[test]
fn other_devices_stay_in_op_at_the_end() {
    let devices = vec![tautline::bus::drive(0), Terminal::default().device(0), Terminal::default().device(0)];
    let bus = Bus::new(devices).with_joint(Joint::new(truth(), 0.0, 0.005, 1));
    let shared = std::rc::Rc::new(RefCell::new(bus));
    let (rig, plan, interrupted) = (rig(), plan(SWEEP), std::sync::atomic::AtomicBool::new(false));
    let (answering, last_ns) = (std::rc::Rc::clone(&shared), std::rc::Rc::new(Cell::new(0)));
    let told_ns = std::rc::Rc::clone(&last_ns);
    let wire = InProcess::new(move |now_ns: u64, frame: &[u8]| {
        told_ns.set(now_ns);
        answering.borrow_mut().send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
    });
    let task = Task { rig: &rig, plan: &plan, armed: false, interrupted: &interrupted, operator: &Agrees };
    capture(wire, &task, None, &std::sync::Arc::default()).unwrap();
    // A change of state takes its time.
    shared.borrow_mut().advance(last_ns.get() + 10_000_000);
    let states: Vec<u16> = shared.borrow().devices().iter().map(|device| device.al_status() & 0xF).collect();
    assert_eq!(states, [4, 4, 8]);
}

/// S11: devices are told apart by serial number; what takes outputs and is not in the rig is named before it is brought to OP.
#[test]
fn other_devices_than_the_rigs_are_named() {
    let refused = |bus: Bus, rig: &Rig| {
        let (plan, interrupted, mut bus) = (plan(SWEEP), std::sync::atomic::AtomicBool::new(false), bus);
        let wire = InProcess::new(move |now_ns: u64, frame: &[u8]| {
            bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
        });
        let task = Task { rig, plan: &plan, armed: false, interrupted: &interrupted, operator: &Agrees };
        capture(wire, &task, None, &std::sync::Arc::default()).map_err(|why| why.0)
    };
    let other = rig_with(&[("product = 0x00000402", "product = 0x00000402\nserial = 43")]);
    let why = refused(demo(), &other).unwrap_err();
    assert!(why.contains("`winch drive`") && why.contains("serial number is 0x0000002a"), "{why}");
    let three = || {
        let devices = vec![tautline::bus::drive(0), Terminal::default().device(0), tautline::bus::drive(0)];
        Bus::new(devices).with_joint(Joint::new(truth(), 0.0, 0.005, 1))
    };
    let why = refused(three(), &rig()).unwrap_err();
    assert!(why.contains("device 2 (`TL7402`) takes outputs and is not in the rig"), "{why}");
    let allowed = rig_with(&[("clocks = true", "others = [2]\nclocks = true")]);
    let outcome = refused(three(), &allowed).unwrap();
    assert!(outcome.report.iter().any(|line| line.contains("device 2") && line.contains("IS NOT IN THE RIG")));
}

/// D1: objects that CiA 402 leaves to the maker may be missing, if the rig says so.
#[test]
fn a_drive_without_optional_objects_serves() {
    let bus = || bus_of(drive_with(0, true, &[0x605E, 0x6072, 0x6085]));
    let (plan, interrupted) = (plan(SWEEP), std::sync::atomic::AtomicBool::new(false));
    let mut refusing = bus();
    let wire = InProcess::new(move |now_ns: u64, frame: &[u8]| {
        refusing.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
    });
    let rig = rig();
    let task = Task { rig: &rig, plan: &plan, armed: true, interrupted: &interrupted, operator: &Agrees };
    let why = capture(wire, &task, None, &std::sync::Arc::default()).unwrap_err().0;
    assert!(why.contains("0x605e") && why.contains("add `without = [0x605e]` to [drive]"), "{why}");
    let without = rig_with(&[("mode = \"csp\"", "mode = \"csp\"\nwithout = [0x605E, 0x6072, 0x6085]")]);
    let outcome = traced(bus(), &without, &plan, &Agrees, &mut |_, _| ());
    assert_eq!((outcome.cause, outcome.complete), (None, 2));
    assert!(outcome.report.iter().any(|line| line.contains("MAXIMUM TORQUE IS UNKNOWN")), "{:?}", outcome.report);
    let read_back = outcome.report.iter().find(|line| line.contains("drive's own limits, read back")).unwrap();
    assert_eq!(
        read_back, "drive's own limits, read back: following error 8344 counts, for 10 ms",
        "torque was never read"
    );
}

/// What the rig takes out of `without` is not touched, even where the drive has it, and nothing says that it was read back.
#[test]
fn objects_that_the_rig_leaves_alone_are_told_as_they_stand() {
    let (mut before, mut after) = (None, None);
    let left = rig_with(&[("mode = \"csp\"", "mode = \"csp\"\nwithout = [0x6065, 0x6066, 0x6072, 0x607D]")]);
    let outcome = traced(demo(), &left, &plan(SWEEP), &Agrees, &mut |_, bus| {
        after = bus.devices()[0].object(0x6072, 0).map(<[u8]>::to_vec);
        before.get_or_insert(after.clone());
    });
    assert_eq!((outcome.complete, before), (2, Some(after)));
    let told = outcome.report.join("\n");
    assert!(told.contains("NONE OF THE DRIVE'S OWN LIMITS WAS READ BACK"), "{told}");
    for name in ["FOLLOWING-ERROR WINDOW", "FOLLOWING-ERROR TIME", "MAXIMUM TORQUE"] {
        assert!(
            told.lines().any(|l| l.starts_with(&format!("THE DRIVE'S {name} IS")) && l.contains("was not set")),
            "{told}"
        );
    }
    assert!(told.contains("NO LIMITS OF POSITION of its own (0x607d, which the rig says"), "{told}");
}

/// D6: a computer that misses one cycle in eleven does not keep the cycle.
#[test]
fn a_computer_that_misses_cycles_fails_its_check() {
    let (rig, plan, interrupted) = (rig(), plan(SWEEP), std::sync::atomic::AtomicBool::new(false));
    let mut bus = demo();
    (0..400).for_each(|i| bus.inject(Fault::Lost { frames: 1 }, When::Cycle(200 + 11 * i)));
    let wire = InProcess::new(move |now_ns: u64, frame: &[u8]| {
        bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
    });
    let task = Task { rig: &rig, plan: &plan, armed: false, interrupted: &interrupted, operator: &Agrees };
    let outcome = capture(wire, &task, None, &std::sync::Arc::default()).unwrap();
    assert!(matches!(outcome.doubt, Some(Cause::CycleQuality { .. })), "{:?}", outcome.doubt);
}

/// The stop goes out in the cycle in which its cause came in: struck after one frame, seen by the next, a millisecond later.
#[test]
fn a_stop_goes_out_in_the_cycle_of_its_cause() {
    let (rig, sweep) = (rig(), plan(SWEEP));
    let at = moving_at(&rig, &sweep);
    let mut bus = demo();
    bus.inject(Fault::SaturatedSensor, When::Cycle(at));
    let (mut struck_ns, mut told_ns) = (0, None);
    let outcome = traced(bus, &rig, &sweep, &Agrees, &mut |now_ns, bus| {
        if bus.cycles() <= at + 1 {
            struck_ns = now_ns;
        } else if bus.devices()[0].object(0x6040, 0).unwrap()[0] != Control::Enable.word() as u8 {
            told_ns.get_or_insert(now_ns);
        }
    });
    assert_eq!(outcome.cause, Some(Cause::SensorSaturated));
    // The drive takes its control word at its next pulse: half a cycle later.
    let after_ms = (told_ns.unwrap() - struck_ns) as f64 * 1e-6;
    assert!(after_ms < 2.2, "{after_ms} ms");
}
