//! A joint moved by hand from the keyboard: slow, small, and only while it is asked for.

use super::Run;
use crate::capture::commission::{Jogged, Sample};
use crate::capture::limits::Limits;
use crate::capture::safety::Request;
use crate::capture::wire::Wire;
use std::fmt::Debug;

/// The fastest that it goes, rad/s, where the approach is not slower.
pub const SPEED_RAD_S: f64 = 0.04;
/// Share of the limit of acceleration that it takes.
const GENTLE: f64 = 0.1;
/// The most samples of the torque that are kept in each direction.
const KEPT: usize = 60_000;

/// What is asked for now.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Jog {
    /// Up, as the rig counts.
    Up,
    /// Down.
    Down,
    /// Stand still.
    Rest,
    /// Stand still, and no torque after that.
    End,
}

/// Whoever asks. The bus goes on cycling: nothing here may wait.
pub trait Jogger: Debug {
    /// What is asked for, `time_s` after torque came.
    fn wanted(&self, time_s: f64) -> Jog;
}

/// Position and speed that are commanded.
#[derive(Debug, Clone, Copy)]
struct Command {
    position_rad: f64,
    speed_rad_s: f64,
}

impl Command {
    /// A period on: towards the speed that is wanted along a ramp, and not faster than it can be braked before an end of the range.
    fn step(&mut self, wanted: Jog, limits: &Limits, period_s: f64) {
        let top_rad_s = SPEED_RAD_S.min(limits.approach_rad_s);
        let ramp_rad_s2 = GENTLE * limits.acceleration_rad_s2;
        let braked = |room_rad: f64| top_rad_s.min((2.0 * ramp_rad_s2 * room_rad.max(0.0)).sqrt());
        let goal_rad_s = match wanted {
            Jog::Up => braked(limits.high_rad - self.position_rad),
            Jog::Down => -braked(self.position_rad - limits.low_rad),
            Jog::Rest | Jog::End => 0.0,
        };
        let step_rad_s = ramp_rad_s2 * period_s;
        self.speed_rad_s += (goal_rad_s - self.speed_rad_s).clamp(-step_rad_s, step_rad_s);
        let next_rad = self.position_rad + self.speed_rad_s * period_s;
        // From outside its range it goes only towards it.
        let (low_rad, high_rad) = (limits.low_rad.min(self.position_rad), limits.high_rad.max(self.position_rad));
        self.position_rad = next_rad.clamp(low_rad, high_rad);
    }
}

impl<W: Wire, C> Run<'_, '_, W, C> {
    /// Gives torque, once it is granted, and follows `jogger` until it ends; keeps what was seen.
    pub fn jog(&mut self, jogger: &dyn Jogger) {
        if !self.asks() || !self.hold() {
            return;
        }
        self.shown.name = "jog".to_string();
        let (limits, period_s) = (&self.task.rig.limits, self.task.rig.bus.period_s());
        let top_rad_s = SPEED_RAD_S.min(limits.approach_rad_s);
        let mut command = Command { position_rad: self.cycle.joint.axis.target_rad(), speed_rad_s: 0.0 };
        let mut jogged = Jogged { ends_rad: (f64::MAX, f64::MIN), ..Jogged::default() };
        for cycle in 0u64.. {
            let wanted = jogger.wanted(cycle as f64 * period_s);
            command.step(wanted, limits, period_s);
            if !self.turn(Request::Move, Some(command.position_rad)) {
                return;
            }
            if let Some(now) = &self.cycle.joint.now {
                let position_rad = now.position_rad;
                jogged.end_rad = position_rad;
                jogged.ends_rad = (jogged.ends_rad.0.min(position_rad), jogged.ends_rad.1.max(position_rad));
                let side = if command.speed_rad_s > 0.0 { &mut jogged.up } else { &mut jogged.down };
                let is_steady = command.speed_rad_s.abs() >= top_rad_s * (1.0 - 1e-9) && side.len() < KEPT;
                let drive_nm = now.drive_torque_nm;
                let sample = now.sensor.torque_nm.map(|torque_nm| Sample { position_rad, torque_nm, drive_nm });
                side.extend(sample.filter(|_| is_steady));
            }
            if wanted == Jog::End && command.speed_rad_s == 0.0 {
                break;
            }
        }
        self.tell_jog(jogged.ends_rad);
        self.jogged = Some(jogged);
    }

    fn tell_jog(&mut self, (low_rad, high_rad): (f64, f64)) {
        let drive = &self.task.rig.drive;
        let (low_counts, high_counts) = (drive.counts(low_rad), drive.counts(high_rad));
        self.report.push(format!(
            "moved between {low_rad:+.4} and {high_rad:+.4} rad, {:.0} counts ({low_counts:.0} to {high_counts:.0})",
            (high_counts - low_counts).abs()
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::capture::limits::EXAMPLE as LIMITS;

    #[test]
    fn a_jog_stays_slow_and_within_the_range() {
        for from_rad in [-0.02, 0.0, 0.7, 1.5, 1.52] {
            for wanted in [Jog::Up, Jog::Down] {
                let mut command = Command { position_rad: from_rad, speed_rad_s: 0.0 };
                for cycle in 0..60_000 {
                    let before = command;
                    command.step(if cycle < 50_000 { wanted } else { Jog::Rest }, &LIMITS, 1e-3);
                    assert!(command.speed_rad_s.abs() <= SPEED_RAD_S + 1e-12);
                    assert!((command.speed_rad_s - before.speed_rad_s).abs() <= 0.81e-3);
                    assert!(LIMITS.check_command(before.position_rad, command.position_rad, 1e-3).is_none());
                }
                assert_eq!(command.speed_rad_s, 0.0);
            }
        }
    }
}
