//! `tautline rig faults`: every fault that the software bus knows, played to a capture in virtual time, and what became of the joint.

use crate::bus::{Bus, Fault, When};
use crate::capture::drive::Condition;
use crate::capture::in_process::InProcess;
use crate::capture::operator::Agrees;
use crate::capture::plan::Plan;
use crate::capture::rig::Rig;
use crate::capture::session::{Outcome, Task, capture};
use crate::cli::outcome::{JUDGED_BAD, Talk};
use crate::cli::wire::{RIG, demo_bus};
use crate::dynamics::JointKind;
use crate::problem::{Problem, Result};
use serde_json::{Value, json};
use std::cell::RefCell;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Only the cases whose name contains this
    #[arg(long, default_value = "")]
    only: String,
}

/// What is recorded: one sweep up and down.
const PLAN: &str =
    "format = \"plan/1\"\nrest_s = 0.5\n[[motions]]\nprotocol = \"uniform\"\nspeed_rad_s = 0.4\nrepeats = 1\n";
/// By how much the true speed may be above the limit, as a share: what the rig allows a measurement.
const ROOM: f64 = 1.25;
/// Where in the sweep a fault strikes, rad.
const STRIKES_RAD: f64 = 0.8;
/// How long the joint is looked at after the capture has ended, s.
const AFTER_S: f64 = 2.0;
/// A cycle of the rig, ns.
const CYCLE_NS: u64 = 1_000_000;
/// Modes, each with the lines of the rig that choose it, and its limit of speed, rad/s: not far above the plan, and above what the
/// joint does by itself in torque mode where it falls through its backlash.
const MODES: [(&str, &str, f64); 3] = [
    ("csp", "mode = \"csp\"", 0.5),
    ("csv", "mode = \"csv\"\ngains = { position_per_s = 20.0 }", 0.5),
    ("cst", "mode = \"cst\"\ngains = { stiffness_nm_rad = 60.0, damping_nm_s_rad = 1.5 }", 0.8),
];

/// One case: what strikes, in which mode, and whether the joint is held or moves then.
#[derive(Debug, Clone)]
struct Case {
    mode: usize,
    holding: bool,
    faults: Vec<Fault>,
}

/// What became of it.
#[derive(Debug, Clone)]
struct Row {
    name: String,
    cause: String,
    /// From the fault until the drive had no torque, ms; none if it still has.
    off_ms: Option<f64>,
    /// True ones of the joint until then, rad/s and rad.
    speed_rad_s: f64,
    travel_rad: f64,
    position_rad: (f64, f64),
    warning: Option<String>,
    /// What is wrong with it.
    wrong: Option<&'static str>,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let moments: Vec<(u64, u64)> = (0..MODES.len()).map(moments).collect::<Result<_>>()?;
    let mut rows = Vec::new();
    for case in cases().into_iter().filter(|case| case.name().contains(&arguments.only)) {
        let (moving, holding) = moments[case.mode];
        rows.push(played(&case, if case.holding { holding } else { moving })?);
    }
    let wrong = rows.iter().filter(|row| row.wrong.is_some()).count();
    talk.result(
        || json!({ "cases": rows.iter().map(Row::to_json).collect::<Vec<_>>(), "wrong": wrong }),
        |out| {
            writeln!(out, "{:<58} {:>8} {:>8} {:>8}  last words", "fault", "off, ms", "rad/s", "rad")?;
            rows.iter().try_for_each(|row| row.write(out))?;
            writeln!(out, "{} cases, {wrong} beyond the limits or silent", rows.len())
        },
    )?;
    Ok(if wrong == 0 { ExitCode::SUCCESS } else { ExitCode::from(JUDGED_BAD) })
}

/// All cases: every fault in position mode, those that differ by the mode in the others, and pairs of the worst.
fn cases() -> Vec<Case> {
    let single = [
        Fault::Late { frames: 10, by_ns: 3_000_000 },
        Fault::Lost { frames: 10 },
        Fault::Unsent { frames: 10 },
        Fault::Corrupted { frames: 10 },
        Fault::WorkingCounterShort { device: 0, frames: 1 },
        Fault::WorkingCounterShort { device: 1, frames: 5 },
        Fault::SafeOp { device: 0, code: 0x1A },
        Fault::SafeOp { device: 1, code: 0x1A },
        Fault::Gone { device: 1 },
        Fault::Gone { device: 0 },
        Fault::Emergency { device: 0, code: 0x8611 },
        Fault::Watchdog { device: 0 },
        Fault::Drive { code: 0x2310 },
        Fault::QuickStop,
        Fault::Inhibit,
        Fault::InternalLimit,
        Fault::Blocked,
        Fault::CableBreak,
        Fault::EncoderJump { by_rad: 0.03 },
        Fault::EncoderJump { by_rad: -0.03 },
        Fault::StaleSensor,
        Fault::SaturatedSensor,
        Fault::NotANumber,
        Fault::FrozenInputs { device: 0 },
        Fault::FrozenEncoder,
    ];
    // What a stop may meet; each with a sensor that goes stale, which is what asks for the stop.
    let stop = |fault| vec![fault, Fault::StaleSensor];
    let pairs = [
        stop(Fault::IgnoredControl),
        stop(Fault::IgnoredQuickStop),
        stop(Fault::FrozenInputs { device: 0 }),
        stop(Fault::Gone { device: 0 }),
        vec![Fault::IgnoredQuickStop, Fault::EncoderJump { by_rad: 0.03 }],
        vec![Fault::IgnoredQuickStop, Fault::FrozenEncoder],
        vec![Fault::IgnoredControl, Fault::FrozenEncoder],
        vec![Fault::IgnoredControl, Fault::FrozenInputs { device: 0 }],
        vec![Fault::IgnoredQuickStop, Fault::CableBreak],
        vec![Fault::IgnoredControl, Fault::Gone { device: 1 }],
        vec![Fault::WatchdogOff { device: 0 }, Fault::Gone { device: 0 }],
        vec![Fault::Blocked, Fault::StaleSensor],
    ];
    let in_other_modes = |fault: &&Fault| {
        !matches!(fault, Fault::Late { .. } | Fault::Corrupted { .. } | Fault::WorkingCounterShort { .. })
    };
    let case = |mode, holding, faults| Case { mode, holding, faults };
    let mut all: Vec<Case> = single.iter().map(|fault| case(0, false, vec![*fault])).collect();
    for mode in 0..MODES.len() {
        let others = single.iter().filter(in_other_modes).filter(|_| mode > 0);
        all.extend(others.map(|fault| case(mode, false, vec![*fault])));
        all.extend(pairs.iter().map(|faults| case(mode, false, faults.clone())));
        all.push(case(mode, true, vec![Fault::FrozenInputs { device: 0 }]));
        all.push(case(mode, true, vec![Fault::Gone { device: 0 }]));
    }
    all.push(case(1, false, vec![Fault::Runaway { factor: 4.0 }]));
    all.push(case(1, false, vec![Fault::Runaway { factor: 4.0 }, Fault::IgnoredQuickStop]));
    all.push(case(1, false, vec![Fault::Runaway { factor: -1.0 }]));
    all
}

impl Case {
    fn name(&self) -> String {
        let faults: Vec<String> =
            self.faults.iter().map(|fault| format!("{fault:?}").replace(" {", "").replace(" }", "")).collect();
        let when = if self.holding { " while held" } else { "" };
        format!("{} {}{when}", MODES[self.mode].0, faults.join(" + "))
    }
}

fn rig_of(mode: usize) -> Result<Rig> {
    let text = RIG
        .replace(MODES[0].1, MODES[mode].1)
        .replace("speed_rad_s = 1.5", &format!("speed_rad_s = {}", MODES[mode].2));
    Rig::parse(Path::new("rig.toml"), &text)
}

/// What is looked at after every frame with process data: time, ns, and the bus.
type Look<'l> = &'l mut dyn FnMut(u64, &Bus);

/// A capture of the plan on `bus`; `look` sees every cycle, and those after its end for a while.
fn captured(rig: &Rig, bus: Bus, look: Look<'_>) -> Result<Outcome> {
    let plan = Plan::parse(Path::new("plan.toml"), PLAN, JointKind::Revolute)?;
    let shared = Rc::new(RefCell::new(bus));
    let (interrupted, mut last_ns) = (AtomicBool::new(false), 0);
    let answers = |now_ns: u64, frame: &[u8]| {
        let mut bus = shared.borrow_mut();
        let cycles = bus.cycles();
        let replies = bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect();
        if bus.cycles() > cycles {
            look(now_ns, &bus);
        }
        last_ns = now_ns;
        replies
    };
    let task = Task { rig, plan: &plan, armed: true, interrupted: &interrupted, operator: &Agrees };
    let outcome = capture(InProcess::new(answers), &task, None, &Arc::default())
        .or_else(|why| Problem::error("demo", why.0, "report it").alone())?;
    for _ in 0..(AFTER_S * 1e9) as u64 / CYCLE_NS {
        last_ns += CYCLE_NS;
        let mut bus = shared.borrow_mut();
        bus.advance(last_ns);
        look(last_ns, &bus);
    }
    Ok(outcome)
}

fn is_enabled(bus: &Bus) -> bool {
    Condition::of(bus.drive_status().unwrap_or(0)) == Condition::Enabled
}

/// The cycles at which a fault strikes a joint that moves, and one that is held, in a capture without faults.
fn moments(mode: usize) -> Result<(u64, u64)> {
    let (mut moving, mut holding) = (0, 0);
    captured(&rig_of(mode)?, demo_bus(1)?, &mut |_, bus| {
        let truth = bus.truth();
        if moving == 0 && is_enabled(bus) {
            if truth.velocity_rad_s.abs() < 1e-3 && truth.position_rad < STRIKES_RAD {
                holding = bus.cycles();
            }
            if truth.position_rad > STRIKES_RAD && truth.velocity_rad_s > 0.3 {
                moving = bus.cycles();
            }
        }
    })?;
    if moving == 0 || holding == 0 {
        let what = format!("in {} the joint does not get through its sweep without a fault", MODES[mode].0);
        return Problem::error("demo", what, "report it").alone();
    }
    Ok((moving, holding))
}

/// A capture in which the faults of `case` strike at the cycle `at`.
fn played(case: &Case, at: u64) -> Result<Row> {
    let (rig, mut bus) = (rig_of(case.mode)?, demo_bus(1)?);
    case.faults.iter().for_each(|fault| bus.inject(*fault, When::Cycle(at)));
    let (mut began, mut off_ns, mut speed_rad_s, mut travel_rad) = (None, None, 0.0f64, 0.0f64);
    let mut position_rad = (f64::MAX, f64::MIN);
    let outcome = captured(&rig, bus, &mut |now_ns, bus| {
        let truth = bus.truth();
        if bus.cycles() < at || off_ns.is_some() {
            return;
        }
        let (began_ns, from_rad) = *began.get_or_insert((now_ns, truth.position_rad));
        speed_rad_s = speed_rad_s.max(truth.velocity_rad_s.abs());
        travel_rad = travel_rad.max((truth.position_rad - from_rad).abs());
        position_rad = (position_rad.0.min(truth.position_rad), position_rad.1.max(truth.position_rad));
        let has_torque = Condition::of(bus.drive_status().unwrap_or(0)).has_torque();
        off_ns = (!has_torque).then(|| now_ns - began_ns);
    })?;
    let cause = outcome.cause.as_ref().map_or("nothing", |cause| cause.name()).to_string();
    let warning = outcome.torque.warning();
    let mut row = Row {
        name: case.name(),
        cause,
        off_ms: off_ns.map(|ns| ns as f64 * 1e-6),
        speed_rad_s,
        travel_rad,
        position_rad,
        warning,
        wrong: None,
    };
    row.wrong = row.judged(&rig, outcome.cause.is_some());
    Ok(row)
}

impl Row {
    /// What is wrong: faster than is allowed to be measured, outside the range by more than a braking ramp, or silent.
    fn judged(&self, rig: &Rig, has_cause: bool) -> Option<&'static str> {
        let limits = &rig.limits;
        let room_rad = limits.lag_rad + limits.stop_rad;
        let is_outside =
            self.position_rad.0 < limits.low_rad - room_rad || self.position_rad.1 > limits.high_rad + room_rad;
        if !has_cause {
            Some("silent")
        } else if self.off_ms.is_none() && self.warning.is_none() {
            Some("torque on, and not told")
        } else if self.speed_rad_s > ROOM * limits.speed_rad_s {
            Some("too fast")
        } else {
            is_outside.then_some("out of its range")
        }
    }

    fn to_json(&self) -> Value {
        json!({
            "fault": self.name, "cause": self.cause, "off_ms": self.off_ms, "speed_rad_s": self.speed_rad_s,
            "travel_rad": self.travel_rad, "warning": self.warning, "wrong": self.wrong,
        })
    }

    fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        let Self { name, cause, speed_rad_s, travel_rad, .. } = self;
        let off = self.off_ms.map_or("never".to_string(), |ms| format!("{ms:.0}"));
        let shown = if self.warning.is_some() { ", TORQUE NOT SHOWN OFF" } else { "" };
        let wrong = self.wrong.map_or(String::new(), |wrong| format!("  <-- {wrong}"));
        writeln!(out, "{name:<58} {off:>8} {speed_rad_s:>8.3} {travel_rad:>8.4}  {cause}{shown}{wrong}")
    }
}
