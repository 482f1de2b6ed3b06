//! A brake that we let go: after torque is on, and closed before it is off; and what a drive remembers of its faults.

use super::{RIG, SWEEP, demo, folder, plan, rig, run, traced, truth};
use std::path::Path;
use tautline::bus::{BrakeBy, Bus, Fault, Joint, Terminal, When, drive, outputs};
use tautline::capture::drive::Condition;
use tautline::capture::operator::Agrees;
use tautline::capture::rig::Rig;

const BRAKE: &str = "[drive.brake]\nrelease_s = 0.05\nengage_s = 0.08\n\n[drive.inputs]";
const OUTPUT: &str = "    { as = \"target_torque\", index = 0x6071, type = \"i16\" },\n";
const WITH_OUTPUT: &str = "    { as = \"target_torque\", index = 0x6071, type = \"i16\" },\n    \
                           { as = \"brake\", index = 0x60FE, sub = 1, type = \"u32\" },\n";

fn braked() -> Rig {
    let text = RIG.replace("[drive.inputs]", BRAKE).replace(OUTPUT, WITH_OUTPUT);
    Rig::parse(Path::new("rig.toml"), &text).unwrap_or_else(|why| panic!("{why}"))
}

fn bus() -> Bus {
    Bus::new(vec![drive(0), Terminal::default().device(0)]).with_joint(joint(BrakeBy::Drive))
}

fn joint(by: BrakeBy) -> Joint {
    Joint::new(truth(), 0.0, 0.005, 1).with_brake(by)
}

/// The brake on the first of the four outputs of a terminal behind the sensor.
const ON_TERMINAL: &str = r#"[drive.brake]
release_s = 0.05
engage_s = 0.08

[drive.brake.device]
place = 2
name = "outputs"
vendor = 0x00000ABC
product = 0x00000204

[drive.brake.device.outputs]
pdos = [
    { pdo = 0x1600, entries = [{ as = "brake", index = 0x7000, sub = 1, type = "bit" }] },
    { pdo = 0x1601, entries = [{ index = 0x7010, sub = 1, type = "bit" }] },
    { pdo = 0x1602, entries = [{ index = 0x7020, sub = 1, type = "bit" }] },
    { pdo = 0x1603, entries = [{ index = 0x7030, sub = 1, type = "bit" }] },
]

[drive.inputs]"#;

fn braked_by_terminal() -> Rig {
    let text = RIG.replace("[drive.inputs]", ON_TERMINAL);
    Rig::parse(Path::new("rig.toml"), &text).unwrap_or_else(|why| panic!("{why}"))
}

fn bus_with_terminal() -> Bus {
    let devices = vec![drive(0), Terminal::default().device(0), outputs()];
    Bus::new(devices).with_joint(joint(BrakeBy::Terminal))
}

/// In which cycles torque and an open brake began and ended, and how fast the joint was then.
#[derive(Debug, Default)]
struct Course {
    torque: Option<u64>,
    open: Option<u64>,
    moved: Option<u64>,
    closed: Option<(u64, f64)>,
    off: Option<u64>,
}

fn course(rig: &Rig, bus: Bus) -> (Course, tautline::capture::session::Outcome) {
    let mut course = Course::default();
    let outcome = traced(bus, rig, &plan(SWEEP), &Agrees, &mut |_, bus| {
        let at = bus.cycles();
        let output = bus.devices().get(2).map_or((0, 0x60FE), |_| (2, 0x7000));
        let is_open = bus.devices()[output.0].object(output.1, 1).is_some_and(|value| value[0] & 1 != 0);
        let speed_rad_s = bus.truth().velocity_rad_s.abs();
        let has_torque = Condition::of(bus.drive_status().unwrap_or(0)).has_torque();
        if has_torque {
            course.torque.get_or_insert(at);
        } else if course.torque.is_some() {
            course.off.get_or_insert(at);
        }
        if is_open {
            course.open.get_or_insert(at);
        } else if course.open.is_some() {
            course.closed.get_or_insert((at, speed_rad_s));
        }
        if is_open && speed_rad_s > 0.01 {
            course.moved.get_or_insert(at);
        }
    });
    (course, outcome)
}

/// By an output of the drive, and by one of a terminal.
#[test]
fn a_brake_opens_under_torque_and_closes_before_torque_goes() {
    for (rig, bus) in [(braked(), bus()), (braked_by_terminal(), bus_with_terminal())] {
        let (course, outcome) = course(&rig, bus);
        assert_eq!((&outcome.cause, outcome.complete), (&None, 2), "{course:?}");
        let [torque, open, moved, off] = [course.torque, course.open, course.moved, course.off].map(Option::unwrap);
        let (closed, speed_rad_s) = course.closed.unwrap();
        assert!(torque < open && open + 50 <= moved && closed + 80 <= off && speed_rad_s < 0.01, "{course:?}");
    }
}

/// In a stop it falls in once the joint rests, not while it moves.
#[test]
fn a_brake_does_not_fall_in_on_a_joint_that_moves() {
    for (rig, mut bus) in [(braked(), bus()), (braked_by_terminal(), bus_with_terminal())] {
        bus.inject(Fault::StaleSensor, When::Cycle(super::moving_at(&braked(), &plan(SWEEP))));
        let (course, outcome) = course(&rig, bus);
        assert_eq!(outcome.cause.as_ref().map(|cause| cause.name()), Some("sensor_stale"));
        // A drive that lets go by itself once the joint stands (option 2) leaves it to the brake, which takes its time.
        let is_late = |at: u64, speed_rad_s: f64| speed_rad_s < 0.01 || course.off.is_some_and(|off| off <= at);
        assert!(course.closed.is_some_and(|(at, speed_rad_s)| is_late(at, speed_rad_s)), "{course:?}");
    }
}

/// A terminal that falls out of OP closes the brake by itself, and stops the joint.
#[test]
fn a_brake_terminal_that_fails_stops_the_joint() {
    let mut bus = bus_with_terminal();
    bus.inject(Fault::SafeOp { device: 2, code: 0x1B }, When::Cycle(super::moving_at(&braked(), &plan(SWEEP))));
    let (_, outcome) = course(&braked_by_terminal(), bus);
    let name = outcome.cause.as_ref().map(|cause| cause.name());
    assert!(matches!(name, Some("device_state" | "working_counter")), "{:?}", outcome.cause);
}

#[test]
fn a_brake_is_an_output_with_times() {
    let refused = |text: String| Rig::parse(Path::new("rig.toml"), &text).unwrap_err().to_string();
    assert!(refused(RIG.replace("[drive.inputs]", BRAKE)).contains("times and no output"));
    assert!(refused(RIG.replace(OUTPUT, WITH_OUTPUT)).contains("an output and no times"));
    let slow = RIG.replace("[drive.inputs]", &BRAKE.replace("0.08", "8.0")).replace(OUTPUT, WITH_OUTPUT);
    assert!(refused(slow).contains("2 s at most"));
    let twice = RIG.replace("[drive.inputs]", ON_TERMINAL).replace(OUTPUT, WITH_OUTPUT);
    assert!(refused(twice).contains("an output of the drive and one of another device"));
    let on_sensor = RIG.replace("[drive.inputs]", &ON_TERMINAL.replace("place = 2", "place = 1"));
    assert!(refused(on_sensor).contains("at the place of a drive or the sensor"));
}

/// Of a drive that was stopped by a fault of its own, and had one before.
#[test]
fn what_the_drive_remembers_is_evidence() {
    let out = tempfile::TempDir::new().unwrap();
    let path = out.path().join("captured");
    let mut bus = demo();
    bus.inject(Fault::Drive { code: 0x2310 }, When::Cycle(*super::AT));
    let watched = run(bus, &rig(), &plan(SWEEP), Some(folder(&path, &rig(), false)));
    assert_eq!(watched.outcome.cause.as_ref().map(|cause| cause.name()), Some("drive_fault"));
    let text = std::fs::read_to_string(path.join("drive_faults.jsonl")).unwrap();
    let lines: Vec<serde_json::Value> = text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let of = |when: &str| &lines.iter().find(|line| line["when"] == when).unwrap()["fault_history"]["messages"];
    assert_eq!(of("before"), &serde_json::json!([]));
    assert_eq!(of("after")[0]["code"], "0x2310e800", "{text}");
}
