//! One cycle after the other: wait for its moment, exchange, look, decide.

mod answer;
mod ask;
mod axes;
mod driven;

use super::axis::Axis;
use super::cause::Cause;
use super::evidence::Evidence;
use super::exchange::{Exchange, exchange};
use super::group;
use super::history;
use super::line::{Failure, Line};
use super::managers::{Manager, managers};
use super::master::states;
use super::recorder::Recorder;
use super::rig::Rig;
use super::safety::Request;
use super::wire::Wire;
use driven::Driven;
use ethercrab::MainDevice;
use serde_json::Value;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};

/// Share of a period within which an answer must come.
const ANSWER: f64 = 0.8;
/// The same of a stop that goes out a second time within its cycle.
const STOP_ANSWER: f64 = 0.2;

/// A mailbox is polled once in this many cycles, ...
const MAILBOX_CYCLES: u64 = 10;
/// ... and a register of a device in this one of them.
const EVIDENCE_CYCLE: u64 = 5;
/// Cycles missed one after the other from which on a drive stands still: one it bridges.
const GAP_CYCLES: u32 = 2;

/// Cycles without answers, one after the other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gap {
    /// None, or so few that the drive bridges them.
    None,
    /// Answers fail to come.
    Lasts,
    /// The first answer after that has come.
    Over,
}

/// Cycles that were not as they should be.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Began late.
    pub late: u32,
    /// Brought nothing: overslept, or without an answer in time.
    pub missed: u32,
}

/// The exchange in OP, run cycle by cycle.
pub struct Cycle<'a, 's, W, C> {
    line: &'a mut Line<'s, W>,
    main: &'a MainDevice<'a>,
    exchange: Exchange<C>,
    rig: Rig,
    /// The joint on it.
    pub joint: Driven,
    /// The axes that hold meanwhile.
    pub held: Vec<Driven>,
    /// Since they were last set back.
    pub counts: Counts,
    /// Whether samples are being recorded.
    pub records: bool,
    recorder: &'a mut Recorder,
    interrupted: &'a AtomicBool,
    number: u64,
    began_ns: u64,
    origin_ns: u64,
    missed_in_a_row: u32,
    /// Missed before the last answer.
    bridged: u32,
    /// Places of the devices without an axis that have a mailbox, the one to be looked into next first.
    mailboxes: VecDeque<usize>,
    bus_time_origin_ns: Option<u64>,
    evidence: Evidence,
    /// s from the beginning of the campaign to that of this run.
    began_s: f64,
    command_rad: f64,
}

impl<'a, 's, W: Wire, C> Cycle<'a, 's, W, C> {
    /// Cycles over `exchange`, beginning now, which is `began_s` after the campaign began.
    pub fn new(
        line: &'a mut Line<'s, W>,
        main: &'a MainDevice<'a>,
        exchange: Exchange<C>,
        rig: &Rig,
        recorder: &'a mut Recorder,
        interrupted: &'a AtomicBool,
        began_s: f64,
    ) -> Self {
        let named = |place: usize, name: &str| rig.name(place).unwrap_or_else(|| format!("device {place} (`{name}`)"));
        let evidence = Evidence::new(exchange.group.iter(main).enumerate().map(|(place, device)| {
            (named(place, device.name()), device.configured_address(), device.dc_support().any())
        }));
        let mut rigs = rig.each_axis().into_iter();
        let own = rigs.next().unwrap_or_else(|| rig.clone());
        let joint = Driven::new(line, main, &exchange, &own, Axis::new(&own));
        let held = rigs
            .zip(&rig.axes)
            .map(|(own, axis)| Driven::new(line, main, &exchange, &own, Axis::new(&own).holding(axis.holds)));
        let held: Vec<Driven> = held.collect();
        let is_axis = |place: usize| rig.drives().any(|drive| drive.identity.place == place);
        let mut mailboxes = VecDeque::new();
        for (place, device) in exchange.group.iter(main).enumerate().filter(|(place, _)| !is_axis(*place)) {
            mailboxes.extend(managers(line, &device).iter().any(Manager::is_mailbox_in).then_some(place));
        }
        let origin_ns = line.wire.now_ns();
        Self {
            line,
            main,
            exchange,
            rig: rig.clone(),
            joint,
            held,
            counts: Counts::default(),
            records: false,
            recorder,
            interrupted,
            number: 0,
            began_ns: origin_ns,
            origin_ns,
            missed_in_a_row: 0,
            bridged: 0,
            mailboxes,
            bus_time_origin_ns: None,
            evidence,
            began_s,
            command_rad: 0.0,
        }
    }

    /// The recorder that samples go to.
    pub fn recorder(&mut self) -> &mut Recorder {
        self.recorder
    }

    /// What the bus told of itself since this was last asked for: its devices, and the axes that hold.
    pub fn evidence(&mut self) -> (Value, Value) {
        (self.evidence.tell(), self.held.iter_mut().map(Driven::tell).collect())
    }

    /// Cycles so far.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Whether answers fail to come for so long that the drive stands still.
    fn gap(&self) -> Gap {
        match (self.missed_in_a_row, self.bridged) {
            (GAP_CYCLES.., _) => Gap::Lasts,
            (0, GAP_CYCLES..) => Gap::Over,
            _ => Gap::None,
        }
    }

    /// One cycle: the frame of its moment, with what was decided in the last one, and the next decision. `command_rad` tells, by whether
    /// answers come, where the joint is to be next.
    pub fn turn(&mut self, request: Request, command_rad: impl FnOnce(Gap) -> Option<f64>) {
        let sent_ns = self.wait();
        let period_ns = self.period_ns();
        let until_ns = sent_ns + (ANSWER * period_ns as f64) as u64;
        match self.line.run_until(until_ns, exchange(&self.exchange.group, self.main)) {
            Ok(answer) => self.answered(sent_ns, &answer),
            Err(Failure::TimedOut | Failure::Stack(_)) => self.missed(1),
            Err(Failure::Panic(words)) => {
                self.missed(1);
                self.panicked(words);
            }
        }
        self.ask(until_ns);
        if let Some(why) = self.recorder.failed() {
            self.blame(Cause::Recording(why));
        }
        if self.interrupted.load(Ordering::Relaxed) {
            self.blame(Cause::Interrupted);
        }
        self.stop_together();
        let gap = self.gap();
        if gap == Gap::Over {
            self.joint.axis.resume();
        }
        let is_new = self.step(request, command_rad(gap));
        self.command_rad = self.joint.axis.target_rad();
        self.write();
        if is_new && self.missed_in_a_row == 0 && self.rig.bus.clocks {
            self.stop_at_once();
        }
    }

    /// What is asked for beside the process data.
    fn ask(&mut self, until_ns: u64) {
        let is_answered = self.missed_in_a_row == 0;
        let mut panicked = None;
        let Self { line, main, exchange, joint, held, number, .. } = self;
        for driven in std::iter::once(joint).chain(held) {
            if is_answered {
                let asked = driven.look_for_news(line, main, exchange, *number, until_ns);
                panicked = panicked.or(asked.err());
            } else if driven.axis.state().is_ending() {
                driven.ask(line, main, until_ns);
            }
        }
        if let Some(words) = panicked {
            self.panicked(words);
        }
        if self.number.is_multiple_of(MAILBOX_CYCLES) && is_answered {
            self.look_for_mail(until_ns);
        }
        if self.number % MAILBOX_CYCLES == EVIDENCE_CYCLE && is_answered {
            self.evidence.look(self.line, self.main, until_ns);
        }
    }

    /// A reason to stop that is of no axis.
    fn blame(&mut self, cause: Cause) {
        self.joint.axis.blame(cause);
    }

    /// A stop that has just been decided goes out in the same cycle, where devices work by their clocks' pulses: the next pulse acts on
    /// it, a cycle earlier. Nothing of its answer is used.
    fn stop_at_once(&mut self) {
        let until_ns = self.line.wire.now_ns() + (STOP_ANSWER * self.period_ns() as f64) as u64;
        let _ = self.line.run_until(until_ns, exchange(&self.exchange.group, self.main));
    }

    fn period_ns(&self) -> u64 {
        u64::from(self.rig.bus.cycle_us) * 1000
    }

    fn write(&mut self) {
        let Self { main, exchange, joint, held, .. } = self;
        std::iter::once(joint).chain(held).for_each(|driven| driven.write(main, exchange));
    }

    fn name(&self, place: usize) -> String {
        self.rig.name(place).unwrap_or_else(|| format!("device {place}"))
    }

    /// The exchange ends: the rig's devices leave OP; others on the bus stay as they are. Gives where each of them was, in words.
    /// After a stop the drives are asked what they remember of it.
    pub fn finish(self) -> String {
        let words = states(self.line, self.main, &self.exchange.group, &self.rig);
        self.line.drop_out(group::stations(&self.rig));
        if self.joint.axis.cause().is_some() {
            for drive in self.rig.drives() {
                let Ok(device) = self.exchange.group.subdevice(self.main, drive.identity.place) else { continue };
                let history = history::read(self.line, &device).map(|history| (drive.identity.name.clone(), history));
                self.recorder.remembered("after", history.into_iter().collect());
            }
            group::heard(self.line, &self.rig).into_iter().for_each(|what| self.recorder.note(what));
        }
        words
    }
}
