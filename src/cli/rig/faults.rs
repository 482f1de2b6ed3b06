//! `tautline rig faults`: every fault that the software bus knows, played to a capture in virtual time, and what became of the joint.

mod allowed;
mod cases;

use crate::bus::{Bus, When};
use crate::capture::drive::{Condition, Control};
use crate::capture::in_process::InProcess;
use crate::capture::operator::Agrees;
use crate::capture::plan::Plan;
use crate::capture::rig::Rig;
use crate::capture::session::{Outcome, Task, capture};
use crate::cli::outcome::{JUDGED_BAD, Talk};
use crate::cli::wire::{RIG, demo_bus, demo_bus_of_two, rig_of_two};
use crate::dynamics::JointKind;
use crate::problem::{Problem, Result};
use allowed::Allowed;
use cases::{Case, MODES, TWO, cases};
use rayon::prelude::*;
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
/// Where in the sweep a fault strikes, rad.
const STRIKES_RAD: f64 = 0.8;
/// A joint that is slower than this is at rest.
const STILL_RAD_S: f64 = 1e-3;
/// How long the joint is looked at after the capture has ended, s.
const AFTER_S: f64 = 2.0;
/// A cycle of the rig, ns.
const CYCLE_NS: u64 = 1_000_000;
/// What became of it.
#[derive(Debug, Clone)]
struct Row {
    name: String,
    cause: String,
    /// From the fault until the drive had no torque, ms; none if it still has.
    off_ms: Option<f64>,
    /// True ones of the joint, and of the winch that was struck, until then, rad/s and rad.
    speed_rad_s: f64,
    travel_rad: f64,
    /// From the fault until the first command that is not to go on, ms.
    commanded_ms: Option<f64>,
    /// Of the winch that was struck, whether a joint hangs on it still or not, rad/s of the joint.
    winch_rad_s: f64,
    /// Of the one that was struck, rad.
    position_rad: (f64, f64),
    allowed: Allowed,
    warning: Option<String>,
    /// Why it is beyond the limits and one braking ramp, where no command could prevent that.
    beyond: Option<&'static str>,
    /// What is wrong with it.
    wrong: Option<&'static str>,
}

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let moments: Vec<(u64, u64)> = (0..MODES.len()).map(moments).collect::<Result<_>>()?;
    let cases: Vec<Case> = cases().into_iter().filter(|case| case.name().contains(&arguments.only)).collect();
    let one = |case: &Case| {
        let (moving, holding) = moments[case.mode];
        played(case, if case.holding { holding } else { moving })
    };
    let rows: Vec<Row> = cases.par_iter().map(one).collect::<Result<_>>()?;
    let wrong = rows.iter().filter(|row| row.wrong.is_some()).count();
    let beyond = rows.iter().filter(|row| row.beyond.is_some() && row.wrong.is_none()).count();
    talk.result(
        || json!({ "cases": rows.iter().map(Row::to_json).collect::<Vec<_>>(), "beyond": beyond, "wrong": wrong }),
        |out| {
            let [fault, off, speed, travel] = ["fault", "off, ms", "rad/s of", "rad of"];
            writeln!(out, "{fault:<62} {off:>8} {speed:>12} {travel:>13}  cause, last words")?;
            rows.iter().try_for_each(|row| row.write(out))?;
            let within = rows.len() - beyond - wrong;
            writeln!(out, "{} cases: {within} within the limits and one braking ramp,", rows.len())?;
            writeln!(out, "{beyond} beyond that by what no command could prevent, {wrong} beyond even that or silent")
        },
    )?;
    Ok(if wrong == 0 { ExitCode::SUCCESS } else { ExitCode::from(JUDGED_BAD) })
}

fn rig_of(mode: usize) -> Result<Rig> {
    let text = if mode == TWO { rig_of_two() } else { RIG.to_string() };
    let text = text
        .replace(MODES[0].1, MODES[mode].1)
        .replace("speed_rad_s = 1.5", &format!("speed_rad_s = {}", MODES[mode].2));
    Rig::parse(Path::new("rig.toml"), &text)
}

fn bus_of(mode: usize) -> Result<Bus> {
    if mode == TWO { demo_bus_of_two(1) } else { demo_bus(1) }
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

/// The cycles at which a fault strikes a joint that moves, and one that is held (in the middle of its longest rest), in a capture
/// without faults.
fn moments(mode: usize) -> Result<(u64, u64)> {
    let (mut moving, mut holding, mut still, mut longest) = (0, 0, 0, 0);
    captured(&rig_of(mode)?, bus_of(mode)?, &mut |_, bus| {
        let truth = bus.truth();
        if moving == 0 && is_enabled(bus) {
            still = if truth.velocity_rad_s.abs() < STILL_RAD_S { still + 1 } else { 0 };
            if still > longest {
                (longest, holding) = (still, bus.cycles() - still / 2);
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

/// What a joint does from a fault on, until its torque is off.
#[derive(Debug, Clone, Copy)]
struct Moved {
    /// Which one: 0 is the joint of the plan, 1 the second winch.
    index: usize,
    from_rad: Option<f64>,
    speed_rad_s: f64,
    travel_rad: f64,
    position_rad: (f64, f64),
}

impl Moved {
    fn new(index: usize) -> Self {
        Self { index, from_rad: None, speed_rad_s: 0.0, travel_rad: 0.0, position_rad: (f64::MAX, f64::MIN) }
    }

    fn look(&mut self, bus: &Bus) {
        let truth = bus.truth_of(self.index);
        let from_rad = *self.from_rad.get_or_insert(truth.position_rad);
        self.speed_rad_s = self.speed_rad_s.max(truth.velocity_rad_s.abs());
        self.travel_rad = self.travel_rad.max((truth.position_rad - from_rad).abs());
        self.position_rad = (self.position_rad.0.min(truth.position_rad), self.position_rad.1.max(truth.position_rad));
    }

    /// Its way counts from now on.
    fn restart(&mut self) {
        (self.from_rad, self.travel_rad) = (None, 0.0);
    }
}

/// A capture in which the faults of `case` strike at the cycle `at`. The joint is looked at until no drive has torque any more, the second
/// winch, where it is struck, until its own has none; of the two the larger speed and travel count.
fn played(case: &Case, at: u64) -> Result<Row> {
    let (rig, mut bus) = (rig_of(case.mode)?, bus_of(case.mode)?);
    case.faults.iter().for_each(|fault| match case.second {
        true => bus.inject_into_second(*fault, When::Cycle(at)),
        false => bus.inject(*fault, When::Cycle(at)),
    });
    let struck = usize::from(case.second);
    let (mut began_ns, mut off_ns, mut commanded_ns) = (None, None, None);
    let (mut joint, mut winch, mut winch_rad_s) = (Moved::new(0), Moved::new(struck), 0.0f64);
    let allowed = Allowed::of(&rig.each_axis()[struck], &case.faults);
    let outcome = captured(&rig, bus, &mut |now_ns, bus| {
        if bus.cycles() < at || off_ns.is_some() {
            return;
        }
        let began_ns = *began_ns.get_or_insert(now_ns);
        let word = bus.devices()[2 * struck].object(0x6040, 0).and_then(|word| word.first_chunk::<2>());
        if commanded_ns.is_none() && word.is_some_and(|word| u16::from_le_bytes(*word) != Control::Enable.word()) {
            commanded_ns = Some(now_ns - began_ns);
            if allowed.from_command {
                joint.restart();
                winch.restart();
            }
        }
        let has_torque: Vec<bool> = bus.drive_statuses().map(|word| Condition::of(word).has_torque()).collect();
        joint.look(bus);
        winch_rad_s = winch_rad_s.max(bus.truth_of(struck).winch_rad_s.abs());
        if has_torque.get(struck) == Some(&true) {
            winch.look(bus);
        }
        off_ns = (!has_torque.contains(&true)).then(|| now_ns - began_ns);
    })?;
    let (speed_rad_s, travel_rad) = (joint.speed_rad_s.max(winch.speed_rad_s), joint.travel_rad.max(winch.travel_rad));
    let cause = outcome.cause.as_ref().map_or("nothing", |cause| cause.name()).to_string();
    let warning = outcome.torque.warning();
    let mut row = Row {
        name: case.name(),
        cause,
        off_ms: off_ns.map(|ns| ns as f64 * 1e-6),
        speed_rad_s,
        travel_rad,
        commanded_ms: commanded_ns.map(|ns| ns as f64 * 1e-6),
        winch_rad_s,
        position_rad: winch.position_rad,
        allowed,
        warning,
        beyond: None,
        wrong: None,
    };
    row.wrong = row.judged(outcome.cause.is_some());
    row.beyond = row.is_beyond();
    Ok(row)
}

impl Row {
    /// What is wrong: faster, farther or elsewhere than is allowed, or silent.
    fn judged(&self, has_cause: bool) -> Option<&'static str> {
        let Allowed { within, beyond, range_rad, .. } = &self.allowed;
        let bound = beyond.map_or(*within, |(_, bound)| bound);
        let is_outside = self.position_rad.0 < *range_rad.start() || self.position_rad.1 > *range_rad.end();
        [
            (!has_cause, "silent"),
            (self.off_ms.is_none() && self.warning.is_none(), "torque on, and not told"),
            (self.speed_rad_s > bound.speed_rad_s, "too fast"),
            (self.travel_rad > bound.travel_rad, "too far"),
            (self.winch_rad_s > bound.speed_rad_s, "winch too fast"),
            (is_outside, "out of its range"),
        ]
        .into_iter()
        .find_map(|(is_so, wrong)| is_so.then_some(wrong))
    }

    /// Why it is beyond the limits and one braking ramp, if it is.
    fn is_beyond(&self) -> Option<&'static str> {
        let is_within = self.allowed.within.holds(self.speed_rad_s, self.travel_rad);
        self.allowed.beyond.filter(|_| !is_within).map(|(why, _)| why)
    }

    fn to_json(&self) -> Value {
        json!({
            "fault": self.name, "cause": self.cause, "off_ms": self.off_ms, "speed_rad_s": self.speed_rad_s,
            "travel_rad": self.travel_rad, "winch_rad_s": self.winch_rad_s, "commanded_ms": self.commanded_ms,
            "speed_allowed_rad_s": self.allowed.within.speed_rad_s, "travel_allowed_rad": self.allowed.within.travel_rad,
            "beyond": self.beyond, "warning": self.warning, "wrong": self.wrong,
        })
    }

    fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        let Self { name, cause, speed_rad_s, travel_rad, allowed, .. } = self;
        let off = self.off_ms.map_or("never".to_string(), |ms| format!("{ms:.0}"));
        let shown = if self.warning.is_some() { ", TORQUE NOT SHOWN OFF" } else { "" };
        let beyond = self.beyond.map_or(String::new(), |why| format!("  beyond: {why}"));
        let wrong = self.wrong.map_or(String::new(), |wrong| format!("  <-- {wrong}"));
        let (allowed_rad_s, allowed_rad) = (allowed.within.speed_rad_s, allowed.within.travel_rad);
        let moved = format!("{speed_rad_s:>6.3} {allowed_rad_s:>5.3} {travel_rad:>7.4} {allowed_rad:>5.3}");
        writeln!(out, "{name:<62} {off:>8} {moved}  {cause}{shown}{beyond}{wrong}")
    }
}
