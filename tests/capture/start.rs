//! A bus that is not what the rig says does not start, and says why.

use super::{SWEEP, demo, plan, rig, run};
use ethercrab::Command;
use ethercrab::error::Error;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tautline::bus::{Bus, Fault, Joint, Terminal, When, drive};
use tautline::capture::cause::Cause;
use tautline::capture::found::scan;
use tautline::capture::group::{ailing, pre_op};
use tautline::capture::in_process::{Answers, InProcess};
use tautline::capture::line::with_line;
use tautline::capture::operator::Agrees;
use tautline::capture::plan::Plan;
use tautline::capture::rig::{Kind, Rig, starting_rig};
use tautline::capture::session::{Task, capture};
use tautline::capture::wire::Wire;
use tautline::dynamics::JointKind;

type Shared = Rc<RefCell<Bus>>;

/// A bus that outlives a session, with the time that has passed on it.
fn wire(bus: &Shared, since_ns: u64) -> InProcess<impl Answers> {
    let bus = Rc::clone(bus);
    InProcess::new(move |now_ns: u64, frame: &[u8]| {
        let replies = bus.borrow_mut().send(since_ns + now_ns, frame);
        replies.into_iter().map(|reply| (reply.at_ns - since_ns, reply.frame)).collect()
    })
}

/// Why a dry run of `rig` on `bus` does not start.
fn refused(bus: &Shared, since_ns: u64, rig: &Rig) -> String {
    let (plan, interrupted) = (plan(SWEEP), AtomicBool::new(false));
    let task = Task { rig, plan: &plan, armed: false, interrupted: &interrupted, operator: &Agrees };
    match capture(wire(bus, since_ns), &task, None, &Arc::default()) {
        Ok(outcome) => panic!("started: {outcome:?}"),
        Err(why) => why.0,
    }
}

fn shared() -> Shared {
    Rc::new(RefCell::new(demo()))
}

#[test]
fn a_drive_that_would_not_brake_is_refused() {
    for option in [-1i16, 0] {
        let bus = shared();
        with_line(wire(&bus, 0), |line, main| {
            let group = pre_op(line, main).unwrap();
            let drive = group.subdevice(main, 0).unwrap();
            line.run(async { drive.sdo_write(0x605A, 0u8, option).await as Result<(), Error> }).unwrap();
        });
        let why = refused(&bus, 60_000_000_000, &rig());
        assert!(why.contains("does not brake on a quick stop") && why.contains(&option.to_string()), "{why}");
    }
}

#[test]
fn devices_that_are_not_the_rigs_are_refused_by_name() {
    let with = |change: &dyn Fn(&mut Rig)| {
        let mut rig = rig();
        change(&mut rig);
        refused(&shared(), 0, &rig)
    };
    let why = with(&|rig| rig.drive.identity.vendor = 0x2);
    assert!(why.contains("`winch drive`") && why.contains("vendor is 0x00000abc"), "{why}");
    let why = with(&|rig| rig.sensor.identity.product = 7);
    assert!(why.contains("`torque terminal`") && why.contains("product code"), "{why}");
    let why = with(&|rig| rig.sensor.identity.revision = Some(2));
    assert!(why.contains("revision"), "{why}");
    let why = with(&|rig| rig.sensor.identity.place = 2);
    assert!(why.contains("should be device 2, and there are 2"), "{why}");
}

#[test]
fn process_data_that_a_device_does_not_have_are_refused() {
    let mut rig = rig();
    rig.sensor.inputs.pdos[0].entries[1].kind = Kind::Signed(32);
    let why = refused(&shared(), 0, &rig);
    assert!(why.contains("`torque terminal`") && why.contains("0x1a00") && why.contains("rig scan"), "{why}");
}

#[test]
fn a_device_in_error_is_named_with_its_reason() {
    with_line(wire(&shared(), 0), |line, main| {
        drop(pre_op(line, main).unwrap());
        assert_eq!(ailing(line, main), "");
        // From PRE-OP there is no way to OP but through SAFE-OP.
        line.run(Command::fpwr(0x1001, 0x0120).send(main, 0x0008u16)).unwrap();
        let later_ns = line.wire.now_ns() + 10_000_000;
        line.wire.sleep(later_ns);
        assert_eq!(ailing(line, main), "; device 1 is in error 0x0011: Invalid requested state change");
    });
}

/// A rig moves one joint: what others should do meanwhile is said to be left out.
#[test]
fn a_motion_of_many_joints_is_captured_for_its_own() {
    let motion =
        "format = \"trajectory/1\"\nstart_rad = 0.0\n[[segments]]\nkind = \"sweep\"\nto_rad = 0.2\nspeed_rad_s = 0.2\n
        [[others]]\nstart_rad = 0.0\n[[others.segments]]\nkind = \"rest\"\nduration_s = 1.0\n";
    let out = tempfile::TempDir::new().unwrap();
    std::fs::write(out.path().join("both.toml"), motion).unwrap();
    let plan = "format = \"plan/1\"\n[[motions]]\ntrajectory = \"both.toml\"\n";
    std::fs::write(out.path().join("plan.toml"), plan).unwrap();
    let plan = Plan::read(&out.path().join("plan.toml"), JointKind::Revolute).unwrap();
    let outcome = run(demo(), &rig(), &plan, None).outcome;
    assert_eq!((outcome.cause, outcome.complete), (None, 1));
    assert!(
        outcome.report.iter().any(|line| line.starts_with("`both` moves 1 other joints along")),
        "{:?}",
        outcome.report
    );
}

#[test]
fn an_empty_bus_is_told() {
    let bus = Rc::new(RefCell::new(Bus::new(Vec::new())));
    let why = refused(&bus, 0, &rig());
    assert!(!why.is_empty());
}

#[test]
fn a_scan_writes_a_rig_that_reads_back() {
    let bus = shared();
    let found = with_line(wire(&bus, 0), scan).unwrap();
    let text = starting_rig("eth1", &found).unwrap();
    // As it is it serves nothing, and says what is missing.
    let refused = Rig::parse("rig.toml".as_ref(), &text).unwrap_err().to_string();
    for key in ["drive.counts_per_rad", "sensor.nm_per_count", "limits.torque_nm", "joint.name", "dynamics.gravity_nm"]
    {
        assert!(refused.contains(&format!("`{key}`: missing")), "{key}\n{refused}");
    }
    let is_key = |line: &&str| line.split_once(" = ").is_some_and(|(key, _)| !key.contains(' '));
    let fill = |line| str::strip_prefix(line, "# ").filter(is_key).unwrap_or(line);
    let filled: Vec<&str> = text.lines().map(fill).collect();
    let read = Rig::parse("rig.toml".as_ref(), &filled.join("\n")).unwrap();
    let known = rig();
    assert_eq!((read.drive.identity.vendor, read.drive.outputs), (0xABC, known.drive.outputs));
    assert_eq!(read.drive.inputs, known.drive.inputs);
    assert_eq!(read.sensor.inputs, known.sensor.inputs);
    assert_eq!(read.bus.interface, "eth1");
}

/// Numbers that would cut a target off, or switch a watch off, are refused before anything starts.
#[test]
fn a_rig_that_its_drive_cannot_count_is_refused() {
    for (key, absurd, expected) in [
        ("counts_per_rad = 166886.05", "counts_per_rad = 1e12", "which its position cannot hold"),
        ("zero_counts = 0                 # where", "zero_counts = 1e18 # where", "which its position cannot hold"),
        ("missed_cycles_max = 1 ", "missed_cycles_max = 20 ", "lets a gap of 0.021 s pass"),
        ("following_error_rad = 0.05", "following_error_rad = 1e9", "makes a following error of"),
        ("following_error_rad = 0.05", "following_error_rad = 1e-9", "makes a following error of 0.0 counts"),
        ("following_error_s = 0.01", "following_error_s = 1e9", "expected 10 s at most"),
        ("torque_max_nm = 2.0", "torque_max_nm = 1e9", "per mille of its rated torque"),
        ("torque_max_nm = 2.0", "torque_max_nm = 1e-9", "may give 0.0 per mille"),
        ("approach_rad_s = 0.3", "approach_rad_s = 1e-300", "would take hours"),
    ] {
        let text = super::RIG.replace(key, absurd);
        assert_ne!(text, super::RIG, "{key}");
        let refused = Rig::parse("rig.toml".as_ref(), &text).unwrap_err().to_string();
        assert!(refused.contains(expected), "{absurd}: {refused}");
    }
}

#[test]
fn a_rig_with_faults_lists_them_all() {
    let text = super::RIG
        .replace("cycle_us = 1000", "cycle_us = 10")
        .replace("sign = 1    ", "sign = 2    ")
        .replace("mode = \"csp\"", "mode = \"csb\"")
        .replace("{ as = \"position\", index = 0x6064, type = \"i32\" },", "")
        .replace("high_rad = 1.7", "high_rad = -1.7\nhigh_deg = 90");
    let found = Rig::parse("rig.toml".as_ref(), &text).unwrap_err().to_string();
    for fault in [
        "`bus.cycle_us`: is the number 10; expected a whole number from 250 to 20000",
        "`drive.sign`: is 2; expected 1 or -1",
        "`drive.mode`: is `csb`; expected one of csp, csv, cst; did you mean `cst`?",
        "`drive.inputs.entries`: lack `position`; add one with `as = \"position\"`",
        "`limits.high_rad`: is -1.7, low_rad -0.1; high_rad must be above low_rad",
        "`limits.high_deg`: unknown key `high_deg`; did you mean `high_rad`?",
    ] {
        assert!(found.contains(fault), "{fault}\nis not in\n{found}");
    }
}

/// The demo's drive with another terminal behind it.
fn with_terminal(terminal: Terminal) -> Bus {
    let truth = crate::capture::truth();
    Bus::new(vec![drive(0), terminal.device(0)]).with_joint(Joint::new(truth, 0.0, 0.005, 1))
}

#[test]
fn a_terminal_without_a_mailbox_serves_too() {
    let bus = with_terminal(Terminal { mailbox: false, ..Terminal::default() });
    let outcome = run(bus, &rig(), &plan(SWEEP), None).outcome;
    assert_eq!((outcome.cause, outcome.complete), (None, 2));
    assert!(outcome.report.iter().any(|line| line.contains("has no object dictionary")), "{:?}", outcome.report);
    let mut longer = rig();
    let entries = &mut longer.sensor.inputs.pdos[0].entries;
    entries.push(entries[1].clone());
    entries[2].role = None;
    let bus = Rc::new(RefCell::new(with_terminal(Terminal { mailbox: false, ..Terminal::default() })));
    let why = refused(&bus, 0, &longer);
    assert!(why.contains("`torque terminal` exchanges 4 bytes in"), "{why}");
}

#[test]
fn of_a_terminal_that_always_sends_more_the_first_is_read() {
    let bus = with_terminal(Terminal { two_channels: true, ..Terminal::default() });
    let outcome = run(bus, &rig(), &plan(SWEEP), None).outcome;
    assert_eq!((outcome.cause, outcome.complete), (None, 2));
    let told = "`torque terminal` sends 1 PDOs more behind 0x1a00, which are left alone";
    assert!(outcome.report.iter().any(|line| line == told), "{:?}", outcome.report);
    let bus = Rc::new(RefCell::new(with_terminal(Terminal { two_channels: true, ..Terminal::default() })));
    let mut other = rig();
    other.sensor.inputs.pdos[0].entries.reverse();
    assert!(refused(&bus, 0, &other).contains("does not take the process data"));
}

#[test]
fn a_value_that_is_no_number_stops_the_joint() {
    let mut rig = rig();
    let sensor = &mut rig.sensor;
    (sensor.identity.product, sensor.inputs.pdos[0].entries[1].kind) = (0x302, Kind::Real);
    (sensor.nm_per_count, sensor.saturated_counts) = (1.0, 4.9);
    let float = Terminal { float: true, ..Terminal::default() };
    let outcome = run(with_terminal(float), &rig, &plan(SWEEP), None).outcome;
    assert_eq!((outcome.cause, outcome.complete), (None, 2));
    let mut bus = with_terminal(float);
    bus.inject(Fault::NotANumber, When::Cycle(3000));
    let outcome = run(bus, &rig, &plan(SWEEP), None).outcome;
    assert_eq!((outcome.cause, outcome.complete), (Some(Cause::SensorNotANumber), 0));
}
