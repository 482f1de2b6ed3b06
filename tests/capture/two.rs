//! Two drives on one bus: one follows the plan, the other holds; a fault of one stops both.

use super::{RIG, SWEEP, plan, traced, truth};
use std::path::Path;
use tautline::bus::{Bus, Fault, When};
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
    /// What the second drive gives then, N m.
    second_nm: (f64, f64),
    /// Cycles from the fault until the drives had no torque.
    off: Option<u64>,
}

fn seen(holds: &str, mut bus: Bus, fault_at: Option<(u64, bool, Fault)>) -> Seen {
    if let Some((at, is_second, fault)) = fault_at {
        match is_second {
            true => bus.inject_into_second(fault, When::Cycle(at)),
            false => bus.inject(fault, When::Cycle(at)),
        }
    }
    let at = fault_at.map_or(u64::MAX, |(at, ..)| at);
    let (mut second_rad, mut second_nm, mut off) = ((f64::MAX, f64::MIN), (f64::MAX, f64::MIN), None);
    let outcome = traced(bus, &rig(holds), &plan(SWEEP), &Agrees, &mut |_, bus| {
        if bus.cycles() < at && bus.truth().velocity_rad_s.abs() > 0.35 {
            let at_rad = bus.truth_of(1).position_rad;
            second_rad = (second_rad.0.min(at_rad), second_rad.1.max(at_rad));
            let word = bus.devices()[2].object(0x6077, 0).unwrap().to_vec();
            let nm = f64::from(i16::from_le_bytes([word[0], word[1]])) * 2e-3;
            second_nm = (second_nm.0.min(nm), second_nm.1.max(nm));
        }
        let is_off = bus.drive_statuses().all(|status| !Condition::of(status).has_torque());
        if off.is_none() && bus.cycles() >= at && is_off {
            off = Some(bus.cycles() - at);
        }
    });
    Seen { outcome, second_rad, second_nm, off }
}

fn bus() -> Bus {
    Bus::demo_of_two(truth(), 0.005, 1)
}

/// The cycle in which the first joint is beyond 1 rad on its way up.
fn moving_at(holds: &str) -> u64 {
    let mut at = 0;
    traced(bus(), &rig(holds), &plan(SWEEP), &Agrees, &mut |_, bus| {
        if at == 0 && bus.truth().position_rad > 1.0 && bus.truth().velocity_rad_s > 0.2 {
            at = bus.cycles();
        }
    });
    at
}

#[test]
fn one_drive_follows_the_plan_while_the_other_holds_a_tension() {
    let Seen { outcome, second_nm, .. } = seen(TENSION, bus(), None);
    assert_eq!((&outcome.cause, outcome.complete, &outcome.torque), (&None, 2, &Torque::Off), "{:?}", outcome.report);
    assert!((0.045..=0.055).contains(&second_nm.0) && second_nm.1 <= 0.055, "{second_nm:?} N m");
    assert!(outcome.report.iter().any(|line| line.starts_with("second drive: ")), "{:?}", outcome.report);
}

#[test]
fn one_drive_follows_the_plan_while_the_other_holds_its_position() {
    let Seen { outcome, second_rad, .. } = seen(POSITION, bus(), None);
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
        let Seen { outcome, off, .. } = seen(TENSION, bus(), Some((at, is_second, fault)));
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
    let Seen { outcome, .. } = seen(TENSION, bus(), Some((at, true, Fault::FrozenInputs { device: 2 })));
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
