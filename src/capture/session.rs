//! A capture from end to end: the bus to OP, the trials of a plan one after the other, and back to no torque.

use super::axis::Now;
use super::cause::Cause;
use super::commission::Jogged;
use super::cycle::{Counts, Cycle};
use super::exchange::Exchange;
use super::folder::Folder;
use super::group::{self, NotStarted};
use super::line::{Line, with_line, words};
use super::master::{self, Findings};
use super::origin::Origin;
use super::realtime::Granted;
use super::recorder::Recorder;
use super::run::Run;
use super::run::jog::Jogger;
use super::wire::Wire;
use crate::log::TrialEntry;
use ethercrab::MainDevice;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};

pub use super::task::{Live, Looked, Task};
pub use super::torque::Torque;

/// How it went.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Trials recorded whole, by this run.
    pub complete: usize,
    /// Trials that were recorded before.
    pub before: usize,
    /// Of them, broken off.
    pub broken_before: usize,
    /// Cycles of this run.
    pub cycles: u64,
    /// Of them, not as they should be.
    pub counts: Counts,
    /// Why it was stopped, if it was.
    pub cause: Option<Cause>,
    /// What would have stopped it, had it been armed.
    pub doubt: Option<Cause>,
    /// What a dry run saw of the sensor.
    pub looked: Looked,
    /// What a jog has shown, where it ended as it was asked to.
    pub jogged: Option<Jogged>,
    /// What was found on the bus, and what the operating system granted.
    pub report: Vec<String>,
    /// What was last seen.
    pub now: Option<Now>,
    /// Why not everything is on the disk, if so.
    pub unwritten: Option<String>,
    /// Whether the operator, asked, did not want it.
    pub declined: bool,
    /// What is known of the drive's torque at the end.
    pub torque: Torque,
}

/// Captures `task` over `wire` into `folder`, telling `live`.
///
/// Errors: the bus does not start. What stops a motion later is in the outcome. Whatever happens, panics included, the devices
/// are told to leave OP.
pub fn capture<W: Wire>(
    wire: W,
    task: &Task<'_>,
    folder: Option<Folder>,
    live: &Arc<Mutex<Live>>,
) -> Result<Outcome, NotStarted> {
    session(wire, task, Deed::Trials, folder, live)
}

/// Moves the joint of `task` over `wire` as `jogger` asks for, telling `live`. Nothing is recorded.
///
/// Errors: the bus does not start.
pub fn jog<W: Wire>(
    wire: W,
    task: &Task<'_>,
    jogger: &dyn Jogger,
    live: &Arc<Mutex<Live>>,
) -> Result<Outcome, NotStarted> {
    session(wire, task, Deed::Jog(jogger), None, live)
}

fn session<W: Wire>(
    wire: W,
    task: &Task<'_>,
    deed: Deed<'_>,
    folder: Option<Folder>,
    live: &Arc<Mutex<Live>>,
) -> Result<Outcome, NotStarted> {
    let done = folder.as_ref().map_or(Vec::new(), |folder| folder.trials().to_vec());
    let origin = folder.as_ref().map(|folder| folder.origin().clone());
    let waits = !wire.is_real_time();
    let mut recorder = folder.map_or_else(Recorder::none, |folder| Recorder::new(folder, waits));
    let granted = wire.is_real_time().then(Granted::ask);
    let outcome = with_line(wire, |line, main| {
        let run = || Session { task, deed, done, origin, recorder: &mut recorder, live }.run(line, main);
        catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|panic| {
            line.drop_out(group::stations(task.rig));
            Err(NotStarted(format!("something panicked: {}; the devices were told to leave OP", words(&*panic))))
        })
    });
    let outcome = outcome.map(|outcome| Outcome {
        report: outcome.report.into_iter().chain(granted.map(|granted| granted.words())).collect(),
        ..outcome
    });
    match &outcome {
        Ok(outcome) => outcome.report.iter().for_each(|line| recorder.note(line.clone())),
        Err(NotStarted(why)) => recorder.note(format!("not started: {why}")),
    }
    let unwritten = recorder.finish();
    outcome.map(|outcome| Outcome { unwritten, ..outcome })
}

/// What is done with the joint.
#[derive(Debug, Clone, Copy)]
enum Deed<'a> {
    /// The trials of the plan, or a look where it is not armed.
    Trials,
    /// What someone at the keyboard asks for.
    Jog(&'a dyn Jogger),
}

struct Session<'a> {
    task: &'a Task<'a>,
    deed: Deed<'a>,
    done: Vec<TrialEntry>,
    origin: Option<Origin>,
    recorder: &'a mut Recorder,
    live: &'a Arc<Mutex<Live>>,
}

impl Session<'_> {
    fn run<W: Wire>(self, line: &mut Line<'_, W>, main: &MainDevice<'_>) -> Result<Outcome, NotStarted> {
        let rig = self.task.rig;
        let group = group::pre_op(line, main).map_err(|failure| {
            let (interface, ailing) = (&rig.bus.interface, group::ailing(line, main));
            NotStarted(format!("the devices on `{interface}` cannot be brought to PRE-OP: {failure}{ailing}"))
        })?;
        let mut findings = master::prepare(line, main, &group, rig)?;
        findings.report.extend(self.task.plan.left_out());
        match rig.bus.clocks {
            true => {
                let group = master::with_clocks(line, main, group, rig, &mut findings)?;
                self.must_be_watched(&findings)?;
                let exchange =
                    master::to_op(line, main, group, rig).inspect_err(|_| line.drop_out(group::stations(rig)))?;
                Ok(self.cycle(line, main, exchange, findings))
            }
            false => {
                let group = master::with_data(line, main, group, rig, &mut findings)?;
                self.must_be_watched(&findings)?;
                let exchange =
                    master::to_op(line, main, group, rig).inspect_err(|_| line.drop_out(group::stations(rig)))?;
                Ok(self.cycle(line, main, exchange, findings))
            }
        }
    }

    /// No torque without a watchdog.
    fn must_be_watched(&self, findings: &Findings) -> Result<(), NotStarted> {
        match findings.unwatched.as_ref().filter(|_| self.task.armed) {
            Some(why) => Err(NotStarted(format!("no torque without it: {why}"))),
            None => Ok(()),
        }
    }

    fn cycle<W: Wire, C>(
        self,
        line: &mut Line<'_, W>,
        main: &MainDevice<'_>,
        exchange: Exchange<C>,
        mut findings: Findings,
    ) -> Outcome {
        let Self { task, deed, done, origin, recorder, live } = self;
        findings
            .report
            .extend(group::heard(line, task.rig).into_iter().map(|what| format!("while the bus started {what}")));
        let began_s = origin.map_or(0.0, |origin| origin.elapsed().0);
        let cycle = Cycle::new(line, main, exchange, task.rig, recorder, task.interrupted, began_s);
        let mut run = Run::new(cycle, task, live, findings);
        run.guarded(|run| match deed {
            _ if !task.armed => run.look(),
            Deed::Trials => run.trials(&done),
            Deed::Jog(jogger) => run.jog(jogger),
        });
        run.guarded(Run::close);
        run.guarded(Run::release);
        run.guarded(Run::testify);
        let (complete, looked, before) = (run.complete, run.looked, done.len());
        let broken_before = done.iter().filter(|trial| trial.is_incomplete()).count();
        let (cycles, counts, now) = (run.cycle.number(), run.counts(), run.cycle.joint.now.clone());
        let (cause, doubt) = (run.cycle.joint.axis.cause().cloned(), run.cycle.doubt().cloned());
        let (declined, mut report) = (run.declined, std::mem::take(&mut run.report));
        let jogged = run.jogged.take();
        let axes = run.cycle.axes().map(|driven| (driven.name.as_str(), &driven.axis));
        let torque = Torque::of(axes, task.rig.bus.watchdog_ms);
        let left = run.cycle.finish();
        if cause.is_some() {
            report.push(format!("where the devices were at the end: {left}"));
        }
        report.extend(torque.warning());
        let unwritten = None;
        Outcome {
            complete,
            before,
            broken_before,
            cycles,
            counts,
            cause,
            doubt,
            looked,
            jogged,
            report,
            now,
            unwritten,
            declined,
            torque,
        }
    }
}
