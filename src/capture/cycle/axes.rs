//! All axes together: the joint's own, and those that hold meanwhile. What stops one stops all.

use super::Cycle;
use super::driven::Driven;
use crate::capture::cause::Cause;
use crate::capture::safety::{Request, State};
use crate::capture::wire::Wire;

/// Cycles after which a drive that must leave OP is commanded to again.
const TOLD_AGAIN: u64 = 20;

impl<W: Wire, C> Cycle<'_, '_, W, C> {
    /// The first drive whose output watchdog does not run now, as far as they tell.
    pub fn unwatched(&mut self) -> Option<String> {
        let until_ns = self.line.wire.now_ns() + self.period_ns() / 2;
        let Self { line, main, exchange, joint, held, .. } = self;
        let mut all = std::iter::once(&*joint).chain(held.iter());
        let found = all.find(|driven| driven.is_watched(line, main, exchange, until_ns) == Some(false));
        found.map(|driven| driven.name.clone())
    }

    /// The joint's axis (0), or one that holds.
    pub(super) fn axis_at(&mut self, index: usize) -> &mut Driven {
        match index.checked_sub(1) {
            None => &mut self.joint,
            Some(held) => &mut self.held[held],
        }
    }

    /// All axes, the joint's first.
    pub fn axes(&self) -> impl Iterator<Item = &Driven> {
        std::iter::once(&self.joint).chain(&self.held)
    }

    /// Whether each axis' drive holds it after a quick stop (its option, 0x605A, is 5 to 8).
    pub fn set_holds(&mut self, holds: &[bool]) {
        for (index, holds) in holds.iter().enumerate().take(self.held.len() + 1) {
            self.axis_at(index).axis.set_holds(*holds);
        }
    }

    /// Whether the joint has torque and rests, and every other axis holds what it is to hold.
    pub fn is_held(&self) -> bool {
        self.axes().all(|driven| driven.axis.is_ready())
    }

    /// What would be a cause to stop an axis, the joint's first, if there were anything to stop.
    pub fn doubt(&self) -> Option<&Cause> {
        self.axes().find_map(|driven| driven.axis.doubt())
    }

    /// Whether any axis is in `state`.
    pub fn is_any(&self, state: State) -> bool {
        self.axes().any(|driven| driven.axis.state() == state)
    }

    /// A cause in one axis stops all.
    pub(super) fn stop_together(&mut self) {
        let first = self.axes().find_map(|driven| Some((driven.name.clone(), driven.axis.cause()?.clone())));
        let Some((name, cause)) = first else { return };
        let cause = match cause {
            Cause::OtherAxis(..) => cause,
            cause => Cause::OtherAxis(name, Box::new(cause)),
        };
        for index in 0..=self.held.len() {
            self.axis_at(index).axis.blame(cause.clone());
        }
    }

    /// The next decision of every axis; whether one of them begins to stop.
    pub(super) fn step(&mut self, request: Request, command_rad: Option<f64>) -> bool {
        let mut begins = false;
        let of_joint = self.of_joint(request);
        for index in 0..=self.held.len() {
            let number = self.number;
            let driven = self.axis_at(index);
            let before = driven.axis.state();
            match index {
                0 => driven.axis.step(of_joint, command_rad),
                _ => driven.axis.step(Driven::held(request), None),
            }
            let state = driven.axis.state();
            begins |= before.is_armed() && state.is_ending();
            if state == State::Leaving && (before != State::Leaving || number.is_multiple_of(TOLD_AGAIN)) {
                self.drop_drive(index);
            }
            if state != before {
                self.tell(index, before);
            }
        }
        begins
    }

    /// What is wanted of the joint's own axis: it holds until the others have let go. A tension that nothing stands against would pull it
    /// away.
    fn of_joint(&self, request: Request) -> Request {
        let holds = matches!(self.joint.axis.state(), State::Holding | State::Moving);
        match holds && self.held.iter().any(|driven| driven.axis.state().is_armed()) {
            true if request == Request::Watch => Request::Hold,
            _ => request,
        }
    }

    /// The drive of an axis is told to leave OP.
    fn drop_drive(&mut self, index: usize) {
        let Self { line, joint, held, .. } = self;
        match index.checked_sub(1) {
            None => joint.drop_out(line),
            Some(index) => held[index].drop_out(line),
        }
    }

    /// The stack panicked with these words: past it the drives are told to leave OP.
    pub(super) fn panicked(&mut self, words: String) {
        (0..=self.held.len()).for_each(|index| self.drop_drive(index));
        self.blame(Cause::Panic(words));
    }

    /// A change of state of an axis, to the campaign's log.
    fn tell(&mut self, index: usize, before: State) {
        let driven = self.axis_at(index);
        let (state, drive) = (driven.axis.state(), driven.axis.drive());
        let why = match (state, driven.axis.cause()) {
            (State::Stopping, Some(cause)) => format!(": {} ({cause})", cause.name()),
            _ => String::new(),
        };
        let who = if index == 0 { String::new() } else { format!("`{}` ", driven.name) };
        let line = format!("cycle {}: {who}{} -> {}, drive {drive}{why}", self.number, before.name(), state.name());
        self.recorder.note(line);
    }
}
