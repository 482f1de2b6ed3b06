//! A brake that we let go: after torque is on, and closed before it is off; and what a drive remembers of its faults.

use super::{RIG, SWEEP, demo, folder, plan, rig, run, traced, truth};
use std::path::Path;
use tautline::bus::{Bus, Fault, Joint, Terminal, When, drive};
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
    Bus::new(vec![drive(0), Terminal::default().device(0)]).with_joint(Joint::new(truth(), 0.0, 0.005, 1).with_brake())
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

fn course(bus: Bus) -> (Course, tautline::capture::session::Outcome) {
    let mut course = Course::default();
    let outcome = traced(bus, &braked(), &plan(SWEEP), &Agrees, &mut |_, bus| {
        let at = bus.cycles();
        let is_open = bus.devices()[0].object(0x60FE, 1).is_some_and(|value| value[0] & 1 != 0);
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

#[test]
fn a_brake_opens_under_torque_and_closes_before_torque_goes() {
    let (course, outcome) = course(bus());
    assert_eq!((&outcome.cause, outcome.complete), (&None, 2), "{course:?}");
    let [torque, open, moved, off] = [course.torque, course.open, course.moved, course.off].map(Option::unwrap);
    let (closed, speed_rad_s) = course.closed.unwrap();
    assert!(torque < open && open + 50 <= moved && closed + 80 <= off && speed_rad_s < 0.01, "{course:?}");
}

/// In a stop it falls in once the joint rests, not while it moves.
#[test]
fn a_brake_does_not_fall_in_on_a_joint_that_moves() {
    let at = super::moving_at(&braked(), &plan(SWEEP));
    let mut bus = bus();
    bus.inject(Fault::StaleSensor, When::Cycle(at));
    let (course, outcome) = course(bus);
    assert_eq!(outcome.cause.as_ref().map(|cause| cause.name()), Some("sensor_stale"));
    assert!(course.closed.is_some_and(|(_, speed_rad_s)| speed_rad_s < 0.01), "{course:?}");
}

#[test]
fn a_brake_is_an_output_with_times() {
    let refused = |text: String| Rig::parse(Path::new("rig.toml"), &text).unwrap_err().to_string();
    assert!(refused(RIG.replace("[drive.inputs]", BRAKE)).contains("times and no output"));
    assert!(refused(RIG.replace(OUTPUT, WITH_OUTPUT)).contains("an output and no times"));
    let slow = RIG.replace("[drive.inputs]", &BRAKE.replace("0.08", "8.0")).replace(OUTPUT, WITH_OUTPUT);
    assert!(refused(slow).contains("2 s at most"));
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
