//! `tautline capture`.

use super::interrupt;
use super::keyboard::Keyboard;
use super::live::View;
use super::outcome::{JUDGED_BAD, TORQUE_ON, Talk};
use super::wire::{self, Described, text_of};
use crate::capture::folder::Folder;
use crate::capture::group::NotStarted;
use crate::capture::operator::{Agrees, Operator};
use crate::capture::plan::Plan;
use crate::capture::session::{Live, Outcome, Task, Torque, capture};
use crate::problem::{Problem, Result};
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Mutex};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  tautline capture --rig demo -o captured                          a software joint, in a minute
  tautline capture --rig rig.toml --plan plan.toml                 a dry run: checks everything, moves nothing
  tautline capture --rig rig.toml --plan plan.toml -o mine --arm   moves the joint and records it
  tautline capture --rig rig.toml --plan plan.toml -o mine --arm --resume

The joint is stopped by the drive's quick stop on any fault of bus, drive or sensor, on any limit, and on
Ctrl-C; what was recorded until then stands, the trial marked as incomplete. This is no safety function:
it never replaces the drive's safe torque off and an emergency stop in the operator's hand.
data/rigs/README.md says what a real rig needs.

With --arm the bus is brought to OP first, without torque; then devices with serial numbers, the drive's own
limits, watchdogs, faults, the cycle as kept and the first motion are shown, and a word must be typed. The first
motion is small and slow, and checks that the signs of drive and sensor fit.

Exit status: 0 all trials recorded (or the dry run found nothing), 1 stopped, 2 bad input or no start,
3 TORQUE IS NOT SHOWN TO BE OFF: press the emergency stop.")]
pub struct Arguments {
    /// The rig: a rig.toml, or `demo`
    #[arg(long)]
    rig: PathBuf,
    /// What to record: a plan.toml [default with --rig demo: eight speeds and a cosine cascade]
    #[arg(long)]
    plan: Option<PathBuf>,
    /// Folder to write: campaign.toml, a CSV per trial, capture.log
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Give the drive torque, after asking; without it nothing moves
    #[arg(long, requires = "output")]
    arm: bool,
    /// Go on with a capture that was broken off, with its next trial
    #[arg(long, requires = "output")]
    resume: bool,
    /// Let the demo's joint move in real time
    #[arg(long)]
    real_time: bool,
    /// Seed of the demo's noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// The demo's plan.
const DEMO_PLAN: &str = include_str!("../../data/rigs/demo/plan.toml");

pub fn run(arguments: &Arguments, talk: &Talk) -> Result<ExitCode> {
    let described = Described::read(&arguments.rig)?;
    let rig = &described.rig;
    let (plan_file, plan_text) = arguments.plan_text(described.is_demo)?;
    let plan = Plan::parse(&plan_file, &plan_text, rig.joint.kind)?;
    plan.check(&plan_file, &rig.limits, rig.bus.period_s())?;
    // Nothing of the demo can be hurt.
    let armed = arguments.arm || (described.is_demo && arguments.output.is_some());
    let texts = [("rig.toml", described.text.as_str()), ("plan.toml", plan_text.as_str())];
    let wire = wire::open(&rig.bus.interface, arguments.real_time, arguments.seed)?;
    let folder = match &arguments.output {
        Some(path) if armed && arguments.resume => Some(Folder::resume(path, rig, &texts)?),
        Some(path) if armed => Some(Folder::create(path, rig, &texts)?),
        _ => None,
    };
    let live = Arc::new(Mutex::new(Live::default()));
    let view = View::new(talk, &live);
    let keyboard = Keyboard::default();
    let operator: &dyn Operator = if described.is_demo { &Agrees } else { &keyboard };
    let task = Task { rig, plan: &plan, armed, interrupted: interrupt::noted(), operator };
    let outcome = capture(wire, &task, folder, &live);
    drop(view);
    let abandon = || {
        if let Some(path) = arguments.output.as_deref().filter(|_| armed && !arguments.resume) {
            Folder::abandon(path);
        }
    };
    match outcome {
        Ok(outcome) if outcome.declined => {
            abandon();
            Problem::error("operator", "did not type the word that was asked for", "nothing was enabled").alone()
        }
        Ok(outcome) => tell(arguments, &plan, &outcome, armed, talk),
        Err(NotStarted(why)) => {
            abandon();
            let cure = "nothing was enabled; `tautline rig scan` shows who answers";
            Problem::error(&arguments.rig, why, cure).alone()
        }
    }
}

impl Arguments {
    fn plan_text(&self, is_demo: bool) -> Result<(PathBuf, String)> {
        match &self.plan {
            Some(file) => Ok((file.clone(), text_of(file)?)),
            None if is_demo => Ok((PathBuf::from("data/rigs/demo/plan.toml"), DEMO_PLAN.to_string())),
            None => Problem::error("command line", "names no plan", "say what to record with --plan").alone(),
        }
    }
}

fn tell(arguments: &Arguments, plan: &Plan, outcome: &Outcome, armed: bool, talk: &Talk) -> Result<ExitCode> {
    let folder = arguments.output.as_deref().filter(|_| armed);
    talk.result(|| to_json(folder, plan, outcome), |out| write_text(out, folder, plan, outcome))?;
    let why = outcome.cause.as_ref().map(ToString::to_string).or(outcome.unwritten.clone());
    if let Some(why) = &why {
        let _ = writeln!(anstream::stderr(), "stopped: {why}");
    }
    // The last words of all.
    if let Some(warning) = outcome.torque.warning() {
        let _ = writeln!(anstream::stderr(), "{warning}");
        return Ok(ExitCode::from(TORQUE_ON));
    }
    if why.is_some() {
        return Ok(ExitCode::from(JUDGED_BAD));
    }
    if let Some(doubt) = outcome.doubt.as_ref().filter(|_| !armed) {
        let _ = writeln!(anstream::stderr(), "would be stopped: {doubt}");
        return Ok(ExitCode::from(JUDGED_BAD));
    }
    Ok(ExitCode::SUCCESS)
}

/// The outcome for programs.
pub fn to_json(folder: Option<&Path>, plan: &Plan, outcome: &Outcome) -> Value {
    let named = |cause: &crate::capture::cause::Cause| json!({ "name": cause.name(), "what": cause.to_string() });
    json!({
        "campaign": folder,
        "trials": plan.trials.len(),
        "complete": outcome.complete,
        "recorded_before": outcome.before,
        "broken_before": outcome.broken_before,
        "cycles": outcome.cycles,
        "late_cycles": outcome.counts.late,
        "missed_cycles": outcome.counts.missed,
        "stopped_by": outcome.cause.as_ref().map(named),
        "would_stop": outcome.doubt.as_ref().map(named),
        "unwritten": outcome.unwritten,
        "torque_off": outcome.torque == Torque::Off,
        "torque_warning": outcome.torque.warning(),
        "report": outcome.report,
    })
}

fn write_text(out: &mut impl Write, folder: Option<&Path>, plan: &Plan, outcome: &Outcome) -> io::Result<()> {
    for line in &outcome.report {
        writeln!(out, "{line}")?;
    }
    let (late, missed) = (outcome.counts.late, outcome.counts.missed);
    writeln!(out, "{} cycles: {late} late, {missed} missed", outcome.cycles)?;
    if let Some(now) = &outcome.now {
        let torque = now.sensor.torque_nm.map_or("of no use".to_string(), |torque| format!("{torque:+.4} N m"));
        writeln!(out, "joint at {:+.4} rad, torque {torque}", now.position_rad)?;
    }
    let trials = plan.trials.len();
    match folder {
        Some(folder) => {
            let (done, before) = (outcome.complete, outcome.before);
            let before = match (before, outcome.broken_before) {
                (0, _) => String::new(),
                (before, 0) => format!(", {before} before"),
                (before, broken) => format!(", {before} before, of which {broken} broken off"),
            };
            writeln!(out, "{}: {done} of {trials} trials recorded{before}", folder.display())
        }
        None => writeln!(out, "a dry run: {trials} trials fit the limits, nothing was enabled; --arm records them"),
    }
}
