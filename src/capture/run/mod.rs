//! The trials of a plan, one after the other, cycle by cycle; or a look without torque.

mod first;
mod follow;
pub mod jog;
mod release;

use super::cause::Cause;
use super::commission::Jogged;
use super::cycle::{Counts, Cycle, Gap};
use super::line::words;
use super::master::Findings;
use super::plan::PlannedTrial;
use super::ramp::Ramp;
use super::safety::{Request, State};
use super::task::{Live, Looked, Task};
use super::wire::Wire;
use crate::log::{Captured, TrialEntry};
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::Ordering;
use std::sync::{Arc, Mutex};

/// How long a dry run looks at the joint, s.
const LOOK_S: f64 = 2.0;
/// Cycles between two looks of whoever watches.
const WATCHED_CYCLES: u64 = 50;
/// A computer that misses more than this share of its cycles does not keep the cycle.
const MISSED_SHARE: f64 = 0.01;

/// The trials as they run.
pub(super) struct Run<'a, 's, W, C> {
    pub cycle: Cycle<'a, 's, W, C>,
    task: &'a Task<'a>,
    live: Arc<Mutex<Live>>,
    shown: Live,
    all: Counts,
    /// Whether a trial has begun and not ended.
    is_open: bool,
    /// The trial that ended last and has not been testified to: its log, and its cycles.
    closed: Option<(String, Counts)>,
    /// Trials recorded whole.
    pub complete: usize,
    /// What a look without torque saw.
    pub looked: Looked,
    /// What a jog has shown.
    pub jogged: Option<Jogged>,
    /// What the drives remember of their faults from before, by name.
    histories: Vec<(String, Value)>,
    /// What is told at the end.
    pub report: Vec<String>,
    /// Whether the operator did not want it.
    pub declined: bool,
}

impl<'a, 's, W: Wire, C> Run<'a, 's, W, C> {
    /// Nothing done yet.
    pub fn new(cycle: Cycle<'a, 's, W, C>, task: &'a Task<'a>, live: &Arc<Mutex<Live>>, findings: Findings) -> Self {
        let Findings { report, unwatched, histories, holds } = findings;
        let mut new = Self {
            cycle,
            task,
            live: Arc::clone(live),
            shown: Live::default(),
            all: Counts::default(),
            is_open: false,
            closed: None,
            complete: 0,
            looked: Looked::default(),
            jogged: None,
            histories,
            report,
            declined: false,
        };
        new.cycle.set_holds(&holds);
        unwatched.into_iter().for_each(|why| new.cycle.joint.axis.blame(Cause::Watchdog(why)));
        new
    }

    /// Acts. A panic has the drive in its hands: it is a cause like any other, and what comes next stops the drive.
    pub fn guarded(&mut self, act: impl FnOnce(&mut Self)) {
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| act(self))) {
            self.cycle.joint.axis.fail(Cause::Panic(words(&*panic)));
        }
    }

    /// Looks for a while, without torque.
    pub fn look(&mut self) {
        let cycles = (LOOK_S / self.task.rig.bus.period_s()) as usize;
        self.shown.name = "looking".to_string();
        let (mut counts, mut seen_rad) = (Vec::with_capacity(cycles), (f64::MAX, f64::MIN));
        for _ in 0..cycles {
            if self.task.interrupted.load(Ordering::Relaxed) {
                break;
            }
            let missed = self.cycle.counts.missed;
            self.turn(Request::Watch, None);
            let fresh = self.cycle.joint.now.as_ref().filter(|_| self.cycle.counts.missed == missed);
            if let Some(now) = fresh {
                counts.push(now.sensor.counts);
                seen_rad = (seen_rad.0.min(now.position_rad), seen_rad.1.max(now.position_rad));
            }
        }
        let samples = counts.len().max(1) as f64;
        let mean_counts = counts.iter().sum::<f64>() / samples;
        let sd_counts = (counts.iter().map(|x| (x - mean_counts).powi(2)).sum::<f64>() / samples).sqrt();
        self.judge_cycle(u32::try_from(cycles).unwrap_or(u32::MAX));
        let samples = u32::try_from(counts.len()).unwrap_or(u32::MAX);
        self.looked = Looked { samples, mean_counts, sd_counts, spread_rad: (seen_rad.1 - seen_rad.0).max(0.0) };
    }

    /// Whether this computer keeps the cycle, as seen over `cycles` without torque.
    fn judge_cycle(&mut self, cycles: u32) {
        let missed = self.cycle.counts.missed;
        if f64::from(missed) > MISSED_SHARE * f64::from(cycles) {
            self.cycle.joint.axis.blame(Cause::CycleQuality { missed, cycles });
        }
    }

    /// All trials that are not `done`.
    pub fn trials(&mut self, done: &[TrialEntry]) {
        if !self.asks() {
            return;
        }
        let before = std::mem::take(&mut self.histories);
        self.cycle.recorder().remembered("before", before);
        if !self.hold() || !self.tries() {
            return;
        }
        self.gather();
        self.shown.trials = self.task.plan.trials.len();
        let mut home_rad: Option<f64> = None;
        for (at, trial) in self.task.plan.trials.iter().enumerate() {
            if done.iter().any(|entry| entry.file == trial.entry.file) {
                continue;
            }
            self.shown = Live { trial: at + 1, name: trial.entry.file.clone(), ..self.shown.clone() };
            if !self.hold() {
                break;
            }
            home_rad.get_or_insert(self.cycle.joint.axis.target_rad());
            if !(self.approach(trial.trajectory.own.start_rad) && self.record(trial)) {
                break;
            }
            self.complete += 1;
        }
        // Where the joint was at rest without torque it will be so again, or near it.
        let limits = &self.task.rig.limits;
        let home_rad = home_rad.map(|home_rad| home_rad.clamp(limits.low_rad, limits.high_rad));
        if let Some(home_rad) = home_rad.filter(|_| self.cycle.joint.axis.cause().is_none()) {
            self.approach(home_rad);
        }
    }

    /// Torque on and at rest; false where that is not reached.
    fn hold(&mut self) -> bool {
        while !self.cycle.is_held() && !matches!(self.cycle.joint.axis.state(), State::Stopped | State::Lost) {
            self.turn(Request::Hold, None);
            if self.cycle.joint.axis.state() == State::Watching && self.cycle.joint.axis.is_silent() {
                self.cycle.joint.axis.fail(Cause::MissedCycles(self.task.rig.bus.missed_cycles_max + 1));
                return false;
            }
        }
        self.cycle.is_held()
    }

    /// To `to_rad` along half a cosine, and at rest there.
    fn approach(&mut self, to_rad: f64) -> bool {
        let (limits, period_s) = (&self.task.rig.limits, self.task.rig.bus.period_s());
        let ramp = Ramp::new(
            self.cycle.joint.axis.target_rad(),
            to_rad,
            limits.approach_rad_s,
            limits.acceleration_rad_s2 / 2.0,
        );
        if !self.follow(&ramp.positions_rad(period_s), |_, _| {}) {
            return false;
        }
        let rest = (self.task.plan.rest_s / period_s).round() as usize;
        (0..rest).all(|_| self.turn(Request::Hold, None))
    }

    /// The trial itself; false where it broke off.
    fn record(&mut self, trial: &PlannedTrial) -> bool {
        let positions_rad = trial.trajectory.positions_rad(1.0 / self.task.rig.bus.period_s());
        self.gather();
        self.shown.samples = (0, positions_rad.len());
        self.is_open = true;
        // What came before is no evidence of this trial.
        self.cycle.evidence();
        self.cycle.recorder().begin(trial.entry.clone());
        while !self.cycle.recorder().is_ready() && self.turn(Request::Hold, None) {}
        self.gather();
        self.cycle.records = true;
        let whole = self.follow(&positions_rad, |run, at| run.shown.samples.0 = at + 1);
        self.close();
        if whole {
            self.testify();
        }
        whole
    }

    /// Ends the trial that has begun, if one has.
    pub fn close(&mut self) {
        self.cycle.records = false;
        let Counts { late, missed } = self.gather();
        let incomplete = self.cycle.joint.axis.cause().map(|cause| format!("{}: {cause}", cause.name()));
        if std::mem::take(&mut self.is_open) {
            self.closed = Some((self.shown.name.clone(), Counts { late, missed }));
            self.cycle.recorder().end(Captured { incomplete, late_cycles: late, missed_cycles: missed });
        }
    }

    /// What the bus told of itself in the trial that has ended, to the disk. Of one that broke off it is asked for after the stop: by then
    /// emergency messages have come.
    pub fn testify(&mut self) {
        if let Some((trial, Counts { late, missed })) = self.closed.take() {
            let (devices, axes) = self.cycle.evidence();
            let line = json!({
                "trial": trial, "late_cycles": late, "missed_cycles": missed, "devices": devices, "axes": axes,
            });
            self.cycle.recorder().evidence(line.to_string());
        }
    }

    /// Cycles that were not as they should be, in all.
    pub fn counts(&mut self) -> Counts {
        self.gather();
        self.all
    }

    /// One cycle; whether all is well.
    fn turn(&mut self, request: Request, command_rad: Option<f64>) -> bool {
        self.turn_by(request, |_| command_rad)
    }

    /// The same, where the command hangs on whether answers come.
    fn turn_by(&mut self, request: Request, command_rad: impl FnOnce(Gap) -> Option<f64>) -> bool {
        self.cycle.turn(request, command_rad);
        if self.cycle.number().is_multiple_of(WATCHED_CYCLES) {
            self.show();
        }
        self.cycle.joint.axis.cause().is_none()
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
        self.shown.state = self.cycle.joint.axis.state().name();
        self.shown.counts = self.cycle.counts;
        if let Some(now) = &self.cycle.joint.now {
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
