//! Two drives on one bus: one follows the plan, the other holds; a fault of one stops both.

use super::{RIG, SWEEP, plan, traced, truth};
use std::path::Path;
use tautline::bus::{Bus, Fault, Joint, Terminal, When, two_axes};
use tautline::capture::cause::Cause;
use tautline::capture::drive::Condition;
use tautline::capture::operator::Agrees;
use tautline::capture::rig::Rig;
use tautline::capture::session::{Outcome, Torque};

const AXES: &str = include_str!("../../data/rigs/demo/axes.toml");

fn text(holds: &str) -> String {
    let tension = "holds = \"tension\"               # or \"position\": where it is when it gets torque\n\
                   tension_nm = 0.05               # at its winch, with the sign of its position; it comes within a second\n";
    assert!(AXES.contains(tension));
    format!("{RIG}{}", AXES.replace(tension, holds))
}

/// A second drive that holds its position moves a joint of its own, beside.
fn bus_for(holds: &str) -> Bus {
    match holds {
        POSITION => Bus::demo_of_two(truth(), 0.005, 1),
        _ => Bus::demo_antagonistic(truth(), 0.005, 1),
    }
}

fn rig(holds: &str) -> Rig {
    Rig::parse(Path::new("rig.toml"), &text(holds)).unwrap_or_else(|why| panic!("{why}"))
}

const TENSION: &str = "holds = \"tension\"\ntension_nm = 0.05\n";
const POSITION: &str = "holds = \"position\"\n";

fn refused(text: &str) -> String {
    Rig::parse(Path::new("rig.toml"), text).unwrap_err().to_string()
}

/// What was seen of a capture with two drives.
struct Seen {
    outcome: Outcome,
    /// Of the second drive's joint while the first moves: lowest and highest position, rad.
    second_rad: (f64, f64),
    /// What the second drive gives then, and what its cable pulls the joint with, N m.
    second_nm: (f64, f64),
    pull_nm: (f64, f64),
    /// The largest pull while the second drive has no torque, N m.
    pull_without_nm: f64,
    /// Cycles from the fault until the drives had no torque.
    off: Option<u64>,
}

fn seen(holds: &str, fault_at: Option<(u64, bool, Fault)>) -> Seen {
    let mut bus = bus_for(holds);
    if let Some((at, is_second, fault)) = fault_at {
        match is_second {
            true => bus.inject_into_second(fault, When::Cycle(at)),
            false => bus.inject(fault, When::Cycle(at)),
        }
    }
    let at = fault_at.map_or(u64::MAX, |(at, ..)| at);
    let nothing = (f64::MAX, f64::MIN);
    let (mut second_rad, mut second_nm, mut pull_nm, mut off) = (nothing, nothing, nothing, None);
    let (mut pull_without_nm, mut was_armed) = (0.0f64, false);
    let outcome = traced(bus, &rig(holds), &plan(SWEEP), &Agrees, &mut |_, bus| {
        if bus.cycles() < at && bus.truth().velocity_rad_s.abs() > 0.35 {
            let at_rad = bus.truth_of(1).position_rad;
            second_rad = (second_rad.0.min(at_rad), second_rad.1.max(at_rad));
            let word = bus.devices()[2].object(0x6077, 0).unwrap().to_vec();
            let nm = f64::from(i16::from_le_bytes([word[0], word[1]])) * 2e-3;
            second_nm = (second_nm.0.min(nm), second_nm.1.max(nm));
            pull_nm = (pull_nm.0.min(bus.pull_nm()), pull_nm.1.max(bus.pull_nm()));
        }
        was_armed |= bus.drive_statuses().any(|status| Condition::of(status).has_torque());
        if !was_armed {
            pull_without_nm = pull_without_nm.max(bus.pull_nm());
        }
        let is_off = bus.drive_statuses().all(|status| !Condition::of(status).has_torque());
        if off.is_none() && bus.cycles() >= at && is_off {
            off = Some(bus.cycles() - at);
        }
    });
    Seen { outcome, second_rad, second_nm, pull_nm, pull_without_nm, off }
}

/// The cycle in which the first joint is beyond 1 rad on its way up.
fn moving_at(holds: &str) -> u64 {
    let mut at = 0;
    traced(bus_for(holds), &rig(holds), &plan(SWEEP), &Agrees, &mut |_, bus| {
        if at == 0 && bus.truth().position_rad > 1.0 && bus.truth().velocity_rad_s > 0.2 {
            at = bus.cycles();
        }
    });
    at
}

/// The second cable pulls the joint down while the first goes up and down; slack it does not pull. What its drive gives stays what is
/// asked; at the joint it is that within what its winch's inertia takes.
#[test]
fn one_drive_follows_the_plan_while_the_other_holds_a_tension() {
    let Seen { outcome, second_nm, second_rad, pull_nm, pull_without_nm, .. } = seen(TENSION, None);
    assert_eq!((&outcome.cause, outcome.complete, &outcome.torque), (&None, 2, &Torque::Off), "{:?}", outcome.report);
    assert!((0.045..=0.055).contains(&second_nm.0) && second_nm.1 <= 0.055, "{second_nm:?} N m");
    assert!((0.03..0.07).contains(&pull_nm.0) && pull_nm.1 < 0.07 && pull_without_nm == 0.0, "{pull_nm:?} N m");
    assert!(second_rad.0 < -1.0, "the winch let its cable out: {second_rad:?} rad");
    assert!(outcome.report.iter().any(|line| line.starts_with("second drive: ")), "{:?}", outcome.report);
}

/// A second cable that breaks leaves its winch to run: both are stopped.
#[test]
fn a_second_cable_that_breaks_stops_both() {
    let at = moving_at(TENSION);
    let Seen { outcome, off, .. } = seen(TENSION, Some((at, true, Fault::CableBreak)));
    let cause = outcome.cause.clone().expect("not stopped");
    assert!(matches!(&cause, Cause::OtherAxis(name, _) if name == "second drive"), "{cause}");
    assert!(off.is_some_and(|cycles| cycles < 300), "{cause}: {off:?}");
}

#[test]
fn one_drive_follows_the_plan_while_the_other_holds_its_position() {
    let Seen { outcome, second_rad, .. } = seen(POSITION, None);
    assert_eq!((&outcome.cause, outcome.complete), (&None, 2));
    assert!(second_rad.1 - second_rad.0 < 1e-3, "{second_rad:?} rad");
}

#[test]
fn a_fault_of_one_stops_both() {
    let at = moving_at(TENSION);
    for (is_second, fault) in [
        (true, Fault::Drive { code: 0x2310 }),
        (true, Fault::FrozenInputs { device: 2 }),
        (true, Fault::Inhibit),
        (false, Fault::FrozenEncoder),
        (false, Fault::Drive { code: 0x2310 }),
    ] {
        let Seen { outcome, off, .. } = seen(TENSION, Some((at, is_second, fault)));
        let cause = outcome.cause.clone().unwrap_or_else(|| panic!("{fault:?}: not stopped"));
        let is_named = matches!(&cause, Cause::OtherAxis(name, _) if name == "second drive");
        assert_eq!(is_named, is_second, "{fault:?}: {cause}");
        assert!(off.is_some_and(|cycles| cycles < 200), "{fault:?}: {off:?}");
    }
}

/// A second drive that ignores its control word: the last words name it.
#[test]
fn a_second_drive_whose_torque_is_not_shown_off_is_named() {
    let at = moving_at(TENSION);
    let Seen { outcome, .. } = seen(TENSION, Some((at, true, Fault::FrozenInputs { device: 2 })));
    let warning = outcome.torque.warning().unwrap_or_default();
    assert!(warning.contains("`second drive`"), "{warning}");
}

#[test]
fn what_cannot_be_two_axes_is_refused() {
    assert!(refused(&text("holds = \"tension\"\n")).contains("tension_nm"));
    assert!(refused(&text("holds = \"tension\"\ntension_nm = 0.6\n")).contains("above torque_max_nm"));
    assert!(refused(&text(POSITION).replace("place = 2", "place = 0")).contains("one place on the bus"));
    assert!(refused(&text(POSITION).replace("place = 2", "place = 1")).contains("the sensor's place"));
    let without = text(TENSION);
    let (before, axes) = without.split_at(without.find("[[axes]]").unwrap());
    let axes =
        axes.replace("{ as = \"torque\", index = 0x6077, type = \"i16\" }", "{ index = 0x6077, type = \"i16\" }");
    assert!(refused(&format!("{before}{axes}")).contains("lack the drive's torque"));
    let csp = format!("{TENSION}mode = \"csp\"\n");
    assert!(refused(&text(&csp)).contains("cst"));
}

/// Entries of a direction of a device with two axes: those of `own` play their roles, the other axis' are left alone.
fn pdos(first: u16, objects: &[(&str, u16, &str)], own: u16) -> String {
    let entries = |axis: u16| {
        let one = |(role, index, kind): &(&str, u16, &str)| {
            let role = if axis == own { format!("as = \"{role}\", ") } else { String::new() };
            format!("{{ {role}index = {:#06x}, type = \"{kind}\" }}", index + 0x800 * axis)
        };
        objects.iter().map(one).collect::<Vec<_>>().join(", ")
    };
    let pdo = |axis: u16| format!("{{ pdo = {:#06x}, entries = [{}] }}", first + 0x10 * axis, entries(axis));
    format!("pdos = [{}, {}]", pdo(0), pdo(1))
}

const OUTPUTS: [(&str, u16, &str); 5] = [
    ("control_word", 0x6040, "u16"),
    ("target_position", 0x607A, "i32"),
    ("mode", 0x6060, "i8"),
    ("target_velocity", 0x60FF, "i32"),
    ("target_torque", 0x6071, "i16"),
];
const INPUTS: [(&str, u16, &str); 6] = [
    ("status_word", 0x6041, "u16"),
    ("position", 0x6064, "i32"),
    ("velocity", 0x606C, "i32"),
    ("torque", 0x6077, "i16"),
    ("mode", 0x6061, "i8"),
    ("error_code", 0x603F, "u16"),
];

/// The text of a rig with other contents of the section `[name]`, up to the next blank line or the end.
fn with_section(text: &str, name: &str, contents: &str) -> String {
    let heading = format!("[{name}]\n");
    let from = text.find(&heading).unwrap() + heading.len();
    let until = text[from..].find("\n\n").map_or(text.len(), |length| from + length);
    format!("{}{contents}{}", &text[..from], &text[until..])
}

/// S12: a device of two axes. Each axis is read and set at its own objects, 0x800 apart; the first one's stay what they are.
#[test]
fn each_axis_of_one_device_gets_its_own_limits() {
    let text = RIG.replace("product = 0x00000402", "product = 0x00000403");
    let text = with_section(&text, "drive.outputs", &pdos(0x1600, &OUTPUTS, 0));
    let text = with_section(&text, "drive.inputs", &pdos(0x1A00, &INPUTS, 0));
    let axes = self::text(POSITION)[RIG.len()..].replace("place = 2", "place = 0\naxis = 1");
    let axes = axes.replace("product = 0x00000402", "product = 0x00000403").replace("serial = 43", "serial = 42");
    let axes = axes.replace("following_error_rad = 0.05", "following_error_rad = 0.04");
    let axes = with_section(&axes, "axes.outputs", &pdos(0x1600, &OUTPUTS, 1));
    let axes = with_section(&axes, "axes.inputs", &pdos(0x1A00, &INPUTS, 1));
    let rig = Rig::parse(Path::new("rig.toml"), &format!("{text}{axes}")).unwrap_or_else(|why| panic!("{why}"));
    let joint = || Joint::new(truth(), 0.0, 0.005, 1);
    let bus = Bus::new(vec![two_axes(0), Terminal::default().device(0)]).with_joint(joint()).with_joint(joint());
    let (mut objects, mut second_rad) = (Vec::new(), (f64::MAX, f64::MIN));
    let outcome = traced(bus, &rig, &plan(SWEEP), &Agrees, &mut |_, bus| {
        let number = |index: u16, sub: u8| {
            let bytes = bus.devices()[0].object(index, sub).unwrap();
            bytes.iter().rev().fold(0i64, |number, byte| number << 8 | i64::from(*byte))
        };
        if objects.is_empty() {
            let of = |axis: u16| (number(0x6065 + axis, 0), number(0x6072 + axis, 0), number(0x607D + axis, 1) as i32);
            objects = vec![of(0), of(0x800)];
        }
        if bus.truth().velocity_rad_s.abs() > 0.35 {
            let at_rad = bus.truth_of(1).position_rad;
            second_rad = (second_rad.0.min(at_rad), second_rad.1.max(at_rad));
        }
    });
    assert_eq!((&outcome.cause, outcome.complete), (&None, 2), "{:?}", outcome.report);
    let counts = |rad: f64| (rad * rig.drive.counts_per_rad).round() as i64;
    let expected = [(0.05, 1000, -0.15), (0.04, 250, -1.85)];
    let expected = expected.map(|(window, torque, low)| (counts(window), torque, counts(low) as i32));
    assert_eq!(objects, expected);
    assert!(second_rad.1 - second_rad.0 < 1e-3, "{second_rad:?} rad");
}
