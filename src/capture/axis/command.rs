//! What the drive is told.

use super::{Axis, Now};
use crate::capture::bound::{At, Sent, bounded};
use crate::capture::rig::Place;
use crate::capture::safety::{Request, Seen, State, Target};

/// How long a tension takes to come, and to go, s.
pub(super) const TENSION_S: f64 = 1.0;
/// Share of it that may be left then.
const ALMOST: f64 = 0.05;

impl Axis {
    /// One cycle on: from what was taken in and what is wanted, to what the drive is told. `command_rad` is where the joint is to
    /// be next, for a `Move`.
    pub fn step(&mut self, request: Request, command_rad: Option<f64>) {
        let period_s = self.rig.bus.period_s();
        if self.state == State::Moving || (self.state == State::Holding && request == Request::Move) {
            let beyond =
                command_rad.and_then(|command| self.rig.limits.check_command(self.target_rad, command, period_s));
            if let Some(cause) = beyond {
                self.blame(cause);
            }
        }
        let is_blind = self.is_blind();
        let seen = Seen { request, has_cause: self.cause.is_some(), is_blind, cycles: self.cycles, ..self.last };
        let next = self.state.next(&seen, self.patience);
        if next == State::Stopping && self.cause.is_none() {
            self.cause = Some(self.slow());
        }
        self.cycles = if next == self.state { self.cycles.saturating_add(1) } else { 0 };
        if next == State::Stopping && self.state != next {
            let from_rad = self.watch.position_rad().unwrap_or(self.target_rad);
            self.stop_from = Some((from_rad, self.watch.speed_rad_s()));
        }
        self.state = next;
        self.was_armed |= next.is_armed();
        self.is_seen_off &= seen.is_fresh;
        self.silent = if seen.is_fresh { 0 } else { self.silent.saturating_add(1) };
        self.last = Seen { cycles: self.cycles, is_fresh: false, ..seen };
        match (next.target(), command_rad) {
            (Target::Follows, Some(command)) => {
                self.target_rad_s = (command - self.target_rad) / period_s;
                self.target_rad = command;
                self.target_counts = self.rig.drive.counts(command);
            }
            (Target::Brakes, _) => {
                let slower = self.target_rad_s.abs() - self.rig.limits.acceleration_rad_s2 * period_s;
                self.target_rad_s = slower.max(0.0).copysign(self.target_rad_s);
                self.target_rad += self.target_rad_s * period_s;
            }
            _ => self.target_rad_s = 0.0,
        }
    }

    /// Writes the drive's outputs: what follows from the target, kept within the limits as the last step of all.
    pub fn write(&mut self, outputs: &mut [u8], now: Option<&Now>) {
        let (drive, target) = (&self.rig.drive, self.state.target());
        let (measured_rad, period_s) = (now.map(|now| now.position_rad), self.rig.bus.period_s());
        let behind_rad = measured_rad.map_or(0.0, |measured_rad| self.target_rad - measured_rad);
        let measured_rad_s = self.watch.speed_rad_s();
        let torque_nm = self.wanted_nm(behind_rad, measured_rad_s);
        let (speed_rad_s, torque_nm) = match target {
            Target::Held | Target::Follows => (self.target_rad_s + drive.gains.position_per_s * behind_rad, torque_nm),
            // A position that cannot be trusted has no part in a stop.
            Target::Brakes if self.is_blind() && self.tension_nm.is_none() => (self.target_rad_s, self.carrying_nm()),
            Target::Brakes => (self.target_rad_s, torque_nm),
            Target::Actual => (0.0, 0.0),
        };
        let wanted = Sent { position_rad: self.target_rad, speed_rad_s, torque_nm };
        self.sent = match target {
            // No torque: a target that is where the joint is, wherever that be.
            Target::Actual => wanted,
            _ => {
                let at = At { position_rad: measured_rad.unwrap_or(f64::NAN), speed_rad_s: measured_rad_s };
                bounded(wanted, self.sent, at, &self.rig.limits, drive.torque_max_nm, period_s)
            }
        };
        self.way_rad += self.sent.speed_rad_s * period_s;
        let counts = if target == Target::Actual { self.target_counts } else { drive.counts(self.sent.position_rad) };
        let mut set = |place: Option<Place>, value: f64| {
            if let Some(place) = place {
                place.set(outputs, value);
            }
        };
        set(self.places.control_word, f64::from(self.state.control(&self.last).word()));
        set(self.places.mode, f64::from(drive.mode.code()));
        let lets_go = self.state.lets_brake_go(&self.last);
        let brake = drive.brake.as_ref().filter(|_| lets_go);
        self.brake_word = brake.map_or(0.0, |brake| f64::from(1u32 << brake.bit));
        set(self.places.brake, self.brake_word);
        set(self.places.target_position, counts);
        set(self.places.target_velocity, drive.sign * self.sent.speed_rad_s * drive.counts_per_rad);
        set(self.places.target_torque, drive.sign * self.sent.torque_nm / drive.rated_torque_nm * 1e3);
        self.unbraked = if lets_go { self.unbraked.saturating_add(1) } else { 0 };
    }

    /// What is wanted of a drive in torque mode, N m: to bring the joint to its target, or the tension that it holds, which comes and
    /// goes within `TENSION_S` and ends at once with a stop.
    fn wanted_nm(&self, behind_rad: f64, measured_rad_s: f64) -> f64 {
        let gains = &self.rig.drive.gains;
        match self.tension_nm {
            None => gains.stiffness_nm_rad * behind_rad + gains.damping_nm_s_rad * (self.target_rad_s - measured_rad_s),
            Some(_) if self.state.target() == Target::Brakes => 0.0,
            Some(tension_nm) => {
                let step_nm = tension_nm.abs() * self.rig.bus.period_s() / TENSION_S;
                let tension_nm = if self.state == State::Releasing { 0.0 } else { tension_nm };
                self.sent.torque_nm + (tension_nm - self.sent.torque_nm).clamp(-step_nm, step_nm)
            }
        }
    }

    /// Whether it holds, and may move: its brake is open, and a tension, which comes along a ramp, is there.
    pub fn is_ready(&self) -> bool {
        let released = self.rig.drive.brake.as_ref().map_or(0.0, |brake| brake.release_s / self.rig.bus.period_s());
        let reached = |tension_nm: f64| (tension_nm - self.sent.torque_nm).abs() <= ALMOST * tension_nm.abs();
        self.state == State::Holding && f64::from(self.unbraked) >= released && self.tension_nm.is_none_or(reached)
    }

    /// After a gap in which the drive may have stood still: a speed that is sent goes on from the one that is measured, where the joint
    /// follows. A stop goes on as it began.
    pub fn resume(&mut self) {
        if self.must_follow() {
            self.sent.speed_rad_s = self.watch.speed_rad_s();
        }
    }

    /// The torque at the winch that carries the joint where it was told to be, N m: friction then brakes it. Without torque it would
    /// fall, with the last torque go on.
    fn carrying_nm(&self) -> f64 {
        let joint = &self.rig.joint;
        joint.transmission() * self.rig.dynamics.gravity_nm(joint.kind, self.target_rad)
    }
}
