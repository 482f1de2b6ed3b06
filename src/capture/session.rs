//! A capture from end to end: the bus to OP, the trials of a plan one after the other, and back to no torque.

use super::axis::Now;
use super::cause::Cause;
use super::cycle::{Counts, Cycle};
use super::folder::{Folder, Origin};
use super::line::{Failure, Line, with_line};
use super::master::{self, Exchange, NotStarted};
use super::plan::{Plan, PlannedTrial};
use super::ramp::Ramp;
use super::realtime::Granted;
use super::recorder::Recorder;
use super::rig::Rig;
use super::safety::{Request, State};
use super::wire::Wire;
use crate::log::{Captured, TrialEntry};
use ethercrab::MainDevice;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// How long a dry run looks at the joint, s.
const LOOK_S: f64 = 2.0;
/// Cycles between two looks of whoever watches.
const WATCHED_CYCLES: u64 = 50;

/// What is to be done.
#[derive(Debug, Clone, Copy)]
pub struct Task<'t> {
    /// By which joint.
    pub rig: &'t Rig,
    /// Which trials.
    pub plan: &'t Plan,
    /// Whether the drive may get torque; else it is only looked at.
    pub armed: bool,
    /// Ends it early, by a quick stop.
    pub interrupted: &'t AtomicBool,
}

/// What is happening, for whoever watches.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Live {
    /// The trial, and how many there are in all.
    pub trial: usize,
    /// In all.
    pub trials: usize,
    /// The name of its log.
    pub name: String,
    /// Of its samples: recorded, and all.
    pub samples: (usize, usize),
    /// The safety machine's state.
    pub state: &'static str,
    /// rad.
    pub position_rad: f64,
    /// N m; nothing where the sensor is of no use.
    pub torque_nm: Option<f64>,
    /// What is left to the nearest limit of position, rad, and of torque, N m.
    pub margins: (f64, f64),
    /// Cycles that were not as they should be, in this trial.
    pub counts: Counts,
}

/// The torque sensor, looked at for a while.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Looked {
    /// How often.
    pub samples: u32,
    /// Mean of its counts.
    pub mean_counts: f64,
    /// Their standard deviation.
    pub sd_counts: f64,
}

/// How it went.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Trials recorded whole, by this run.
    pub complete: usize,
    /// Trials that were recorded before.
    pub before: usize,
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
    /// What was found on the bus, and what the operating system granted.
    pub report: Vec<String>,
    /// What was last seen.
    pub now: Option<Now>,
    /// Why not everything is on the disk, if so.
    pub unwritten: Option<String>,
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
    let done = folder.as_ref().map_or(Vec::new(), |folder| folder.trials().to_vec());
    let origin = folder.as_ref().map(Folder::origin);
    let waits = !wire.is_real_time();
    let mut recorder = folder.map_or_else(Recorder::none, |folder| Recorder::new(folder, waits));
    let granted = wire.is_real_time().then(Granted::ask);
    let outcome = with_line(wire, |line, main| {
        let run = || Session { task, done, origin, recorder: &mut recorder, live }.run(line, main);
        catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|panic| {
            line.drop_out();
            Err(NotStarted(format!("{}; the devices were told to leave OP", Failure::of_panic(&*panic))))
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

struct Session<'a> {
    task: &'a Task<'a>,
    done: Vec<TrialEntry>,
    origin: Option<Origin>,
    recorder: &'a mut Recorder,
    live: &'a Arc<Mutex<Live>>,
}

impl Session<'_> {
    fn run<W: Wire>(self, line: &mut Line<'_, W>, main: &MainDevice<'_>) -> Result<Outcome, NotStarted> {
        let rig = self.task.rig;
        let group = master::pre_op(line, main).map_err(|failure| NotStarted(format!("the bus: {failure}")))?;
        let report = master::prepare(line, main, &group, rig)?;
        let period = Duration::from_micros(rig.bus.cycle_us.into());
        match rig.bus.clocks {
            true => {
                let group = master::with_clocks(line, main, group, period)?;
                let exchange = master::to_op(line, main, group, rig)?;
                Ok(self.cycle(line, main, exchange, report))
            }
            false => {
                let group = master::with_data(line, main, group)?;
                let exchange = master::to_op(line, main, group, rig)?;
                Ok(self.cycle(line, main, exchange, report))
            }
        }
    }

    fn cycle<W: Wire, C>(
        self,
        line: &mut Line<'_, W>,
        main: &MainDevice<'_>,
        exchange: Exchange<C>,
        report: Vec<String>,
    ) -> Outcome {
        let Self { task, done, origin, recorder, live } = self;
        let began_s = origin.map_or(0.0, Origin::elapsed_s);
        let cycle = Cycle::new(line, main, exchange, task.rig, recorder, task.interrupted, began_s);
        let mut run = Run { cycle, task, live: live.clone(), shown: Live::default(), all: Counts::default() };
        let before = done.len();
        let (complete, looked) = if task.armed { (run.trials(&done), Looked::default()) } else { (0, run.look()) };
        run.release();
        run.gather();
        let (cycles, counts, now) = (run.cycle.number(), run.all, run.cycle.now.clone());
        let (cause, doubt) = (run.cycle.axis.cause().cloned(), run.cycle.axis.doubt().cloned());
        let left = run.cycle.finish();
        let report = match &cause {
            Some(_) => report.into_iter().chain([format!("where the devices were at the end: {left}")]).collect(),
            None => report,
        };
        Outcome { complete, before, cycles, counts, cause, doubt, looked, report, now, unwritten: None }
    }
}

/// The trials as they run.
struct Run<'a, 's, W, C> {
    cycle: Cycle<'a, 's, W, C>,
    task: &'a Task<'a>,
    live: Arc<Mutex<Live>>,
    shown: Live,
    all: Counts,
}

impl<W: Wire, C> Run<'_, '_, W, C> {
    /// Looks for a while, without torque.
    fn look(&mut self) -> Looked {
        let cycles = (LOOK_S / self.task.rig.bus.period_s()) as usize;
        self.shown.name = "looking".to_string();
        let mut counts = Vec::with_capacity(cycles);
        for _ in 0..cycles {
            if self.task.interrupted.load(Ordering::Relaxed) {
                break;
            }
            let missed = self.cycle.counts.missed;
            self.turn(Request::Watch, None);
            let fresh = self.cycle.now.as_ref().filter(|_| self.cycle.counts.missed == missed);
            counts.extend(fresh.map(|now| now.sensor.counts));
        }
        let samples = counts.len().max(1) as f64;
        let mean_counts = counts.iter().sum::<f64>() / samples;
        let sd_counts = (counts.iter().map(|x| (x - mean_counts).powi(2)).sum::<f64>() / samples).sqrt();
        Looked { samples: u32::try_from(counts.len()).unwrap_or(u32::MAX), mean_counts, sd_counts }
    }

    /// All trials that are not `done`; gives how many were recorded whole.
    fn trials(&mut self, done: &[TrialEntry]) -> usize {
        self.shown.trials = self.task.plan.trials.len();
        let (mut complete, mut home_rad) = (0, None);
        for (at, trial) in self.task.plan.trials.iter().enumerate() {
            if done.iter().any(|entry| entry.file == trial.entry.file) {
                continue;
            }
            self.shown = Live { trial: at + 1, name: trial.entry.file.clone(), ..self.shown.clone() };
            if !self.hold() {
                break;
            }
            home_rad.get_or_insert(self.cycle.axis.target_rad());
            if !(self.approach(trial.trajectory.own.start_rad) && self.record(trial)) {
                break;
            }
            complete += 1;
        }
        // Where the joint was at rest without torque it will be so again.
        if let Some(home_rad) = home_rad.filter(|_| self.cycle.axis.cause().is_none()) {
            self.approach(home_rad);
        }
        complete
    }

    /// Torque on and at rest; false where that is not reached.
    fn hold(&mut self) -> bool {
        while !matches!(self.cycle.axis.state(), State::Holding | State::Stopped) {
            self.turn(Request::Hold, None);
        }
        self.cycle.axis.state() == State::Holding
    }

    /// To `to_rad` along half a cosine, and at rest there.
    fn approach(&mut self, to_rad: f64) -> bool {
        let (limits, period_s) = (&self.task.rig.limits, self.task.rig.bus.period_s());
        let ramp =
            Ramp::new(self.cycle.axis.target_rad(), to_rad, limits.approach_rad_s, limits.acceleration_rad_s2 / 2.0);
        let steps = (ramp.duration_s() / period_s).ceil() as usize;
        for step in 1..=steps {
            if !self.turn(Request::Move, Some(ramp.position_rad(step as f64 * period_s))) {
                return false;
            }
        }
        let rest = (self.task.plan.rest_s / period_s).round() as usize;
        (0..rest).all(|_| self.turn(Request::Hold, None))
    }

    /// The trial itself; false where it broke off.
    fn record(&mut self, trial: &PlannedTrial) -> bool {
        let positions_rad = trial.trajectory.positions_rad(1.0 / self.task.rig.bus.period_s());
        self.gather();
        self.shown.samples = (0, positions_rad.len());
        self.cycle.recorder().begin(trial.entry.clone());
        while !self.cycle.recorder().is_ready() {
            self.turn(Request::Hold, None);
        }
        self.gather();
        self.cycle.records = true;
        let mut whole = true;
        for position_rad in positions_rad {
            whole = self.turn(Request::Move, Some(position_rad));
            if !whole {
                break;
            }
            self.shown.samples.0 += 1;
        }
        self.cycle.records = false;
        let Counts { late, missed } = self.gather();
        let incomplete = self.cycle.axis.cause().map(|cause| format!("{}: {cause}", cause.name()));
        self.cycle.recorder().end(Captured { incomplete, late_cycles: late, missed_cycles: missed });
        whole
    }

    /// Back to no torque, the way that the state asks for.
    fn release(&mut self) {
        while !matches!(self.cycle.axis.state(), State::Watching | State::Stopped) {
            self.turn(Request::Watch, None);
        }
        // The last word on the wire is that there is no voltage.
        for _ in 0..10 {
            self.turn(Request::Watch, None);
        }
    }

    /// One cycle; whether all is well.
    fn turn(&mut self, request: Request, command_rad: Option<f64>) -> bool {
        self.cycle.turn(request, command_rad);
        if self.cycle.number().is_multiple_of(WATCHED_CYCLES) {
            self.show();
        }
        self.cycle.axis.cause().is_none()
    }

    /// Adds the counts up, and sets them back; gives them.
    fn gather(&mut self) -> Counts {
        let counts = std::mem::take(&mut self.cycle.counts);
        self.all.late += counts.late;
        self.all.missed += counts.missed;
        counts
    }

    /// Shows where things are to whoever looks, unless they are looking just now: nothing is waited for.
    fn show(&mut self) {
        let limits = &self.task.rig.limits;
        self.shown.state = self.cycle.axis.state().name();
        self.shown.counts = self.cycle.counts;
        if let Some(now) = &self.cycle.now {
            let at = now.position_rad;
            self.shown.position_rad = at;
            self.shown.torque_nm = now.sensor.torque_nm;
            let torque_nm = now.sensor.torque_nm.map_or(0.0, f64::abs);
            self.shown.margins = ((at - limits.low_rad).min(limits.high_rad - at), limits.torque_nm - torque_nm);
        }
        if let Ok(mut live) = self.live.try_lock() {
            live.clone_from(&self.shown);
        }
    }
}
