//! Back to no torque.

use super::Run;
use crate::capture::safety::{Request, State};
use crate::capture::wire::Wire;
use std::sync::atomic::Ordering;

/// Cycles without voltage that end a run: the last word on the wire ...
const LAST_CYCLES: usize = 10;
/// ... and how many at most, while torque has not been seen off: an answer may be late.
const MOST_LAST_CYCLES: usize = 100;
/// What the operator types to have a held joint let go.
const WORD: &str = "release";

impl<W: Wire, C> Run<'_, '_, W, C> {
    /// Back to no torque, the way that the state asks for. A joint that the drive holds after its quick stop is held until the
    /// operator has it let go.
    pub fn release(&mut self) {
        let mut is_let_go = false;
        while self.cycle.axes().any(|driven| !driven.axis.state().is_over()) {
            if self.cycle.is_any(State::Held) && !is_let_go {
                self.hold_until_told();
                is_let_go = true;
            }
            let is_stopping = self.cycle.is_any(State::Stopping) && !is_let_go;
            self.turn(if is_stopping { Request::Hold } else { Request::Watch }, None);
        }
        for cycle in 0..MOST_LAST_CYCLES {
            if cycle >= LAST_CYCLES && self.cycle.axes().all(|driven| driven.axis.is_seen_off()) {
                break;
            }
            self.turn(Request::Watch, None);
        }
    }

    /// The bus goes on until the operator answers, asks for the end once more, or the drive holds no longer.
    fn hold_until_told(&mut self) {
        let why = self.cycle.joint.axis.cause().map_or(String::new(), |cause| format!(" ({cause})"));
        let lines = [format!("STOPPED{why}. The drive holds the joint with torque: support it before you let it go.")];
        self.task.operator.ask(&lines, WORD);
        self.task.interrupted.store(false, Ordering::Relaxed);
        self.shown.name = "held".to_string();
        while self.cycle.is_any(State::Held)
            && self.task.operator.answer().is_none()
            && !self.task.interrupted.load(Ordering::Relaxed)
            && !self.cycle.joint.axis.is_silent()
        {
            self.turn(Request::Hold, None);
        }
    }
}
