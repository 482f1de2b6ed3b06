//! Before the trials: what is shown and asked, and a first small motion.

use super::Run;
use crate::capture::briefing::{Sight, briefing};
use crate::capture::cause::Cause;
use crate::capture::safety::Request;
use crate::capture::tried::{self, Fit};
use crate::capture::wire::Wire;
use std::sync::atomic::Ordering;

/// Cycles that are looked at before the operator is asked.
const BRIEFED_CYCLES: u32 = 500;

impl<W: Wire, C> Run<'_, '_, W, C> {
    /// Looks for a moment, shows everything to the operator, and waits for the answer while the bus goes on; false where it is no.
    pub(super) fn asks(&mut self) -> bool {
        self.shown.name = "looking".to_string();
        self.cycle.recorder().note(format!("looking for {BRIEFED_CYCLES} cycles, without torque"));
        for _ in 0..BRIEFED_CYCLES {
            self.turn(Request::Watch, None);
        }
        self.judge_cycle(BRIEFED_CYCLES);
        if let Some(name) = self.cycle.unwatched() {
            let why = format!("the output watchdog of `{name}` does not run (register 0x0440), though it is set");
            self.cycle.joint.axis.fail(Cause::Watchdog(why));
            return false;
        }
        let axis = &self.cycle.joint.axis;
        let now = self.cycle.joint.now.as_ref();
        let sight = Sight {
            drive: axis.drive(),
            error_code: axis.error_code(),
            position_rad: now.map_or(f64::NAN, |now| now.position_rad),
            knows_fresh: axis.knows_fresh(),
            cycles: BRIEFED_CYCLES,
            counts: self.cycle.counts,
            doubt: axis.doubt().map(ToString::to_string),
        };
        let (lines, word) = briefing(self.task.rig, self.task.plan, &self.report, &sight);
        lines.iter().for_each(|line| self.cycle.recorder().note(format!("shown: {line}")));
        self.task.operator.ask(&lines, word);
        self.shown.name = "asking".to_string();
        loop {
            if let Some(answer) = self.task.operator.answer() {
                self.declined = !answer;
                self.cycle
                    .recorder()
                    .note(format!("asked for `{word}`: {}", if answer { "given" } else { "not given" }));
                return answer;
            }
            if self.task.interrupted.load(Ordering::Relaxed) {
                self.declined = true;
                return false;
            }
            self.turn(Request::Watch, None);
        }
    }

    /// The first motion: small and slow, up and back; false where it showed something wrong.
    pub(super) fn tries(&mut self) -> bool {
        self.shown.name = "first motion".to_string();
        let from_rad = self.cycle.joint.axis.target_rad();
        let ways = tried::motion(self.task.rig, from_rad);
        let goes_up = ways[0].last().is_some_and(|to_rad| *to_rad > from_rad);
        let [there, back] = ways.map(|positions_rad| {
            let mut torques_nm = Vec::with_capacity(positions_rad.len());
            self.follow(&positions_rad, |run, _| {
                torques_nm.extend(run.cycle.joint.now.as_ref().and_then(|now| now.sensor.torque_nm));
            });
            torques_nm
        });
        if self.cycle.joint.axis.cause().is_some() {
            return false;
        }
        let (up_nm, down_nm) = if goes_up { (there, back) } else { (back, there) };
        let (fit, told) = tried::signs(self.task.rig, &up_nm, &down_nm);
        let told = format!("first motion: {told}");
        self.cycle.recorder().note(told.clone());
        self.report.push(told);
        if let Fit::Opposed(torque_nm) = fit {
            self.cycle.joint.axis.blame(Cause::Signs(torque_nm));
        }
        !matches!(fit, Fit::Opposed(_))
    }
}
