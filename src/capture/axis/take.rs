//! What an answer says, and any reason to stop in it.

use super::{Axis, Inputs, Now};
use crate::capture::cause::{Beyond, Cause};
use crate::capture::drive::{Condition, FOLLOWING_ERROR, INTERNAL_LIMIT, Mode};
use crate::capture::rig::Place;
use crate::capture::safety::{State, Target};
use crate::capture::watch::Measured;

/// Cycles at rest that make sure.
const REST_CYCLES: u32 = 20;
/// How many times the limit of speed, or the speed at which the stop began if that was higher, a joint may have while it is stopped:
/// the quick stop must have had time to act.
const STOP_ROOM: f64 = 1.5;

impl Axis {
    /// Takes an answer in: what it says, and any reason to stop in it, of which the first one stays.
    pub fn take(&mut self, inputs: &Inputs<'_>) -> Now {
        let drive = |place: Option<Place>| place.map(|place| place.get(inputs.drive));
        let status_word = drive(self.places.status_word).unwrap_or(0.0) as u16;
        let counts = drive(self.places.position).unwrap_or(f64::NAN);
        let position_rad = self.rig.drive.position_rad(counts);
        let sensor = self.sensor.read(inputs.sensor, inputs.periods);
        let measured = Measured {
            position_rad,
            torque_nm: sensor.torque_nm,
            command_rad: self.must_keep_to_path().then_some(self.target_rad),
            periods: inputs.periods,
        };
        if let Some(counter) = drive(self.places.counter) {
            self.freshen(counter as i64 as u32, inputs.periods);
        }
        let beyond = self.watch.step(&measured);
        self.jump_with_encoder();
        let beyond = beyond.or(self.follows(position_rad, inputs.periods));
        let condition = Condition::of(status_word);
        // What explains the others comes first.
        let left = self.left(condition, inputs.drive);
        let complains = self.complains(condition, status_word, inputs.drive);
        if let Some(cause) = left.or_else(|| sensor.cause.clone()).or(beyond).or(complains) {
            self.blame(cause);
        }
        let rests = self.watch.speed_rad_s().abs() < self.rest_rad_s && position_rad.is_finite();
        self.resting = if rests { self.resting + 1 } else { 0 };
        self.note(condition);
        self.error_code = drive(self.places.error_code).map(|code| code as u16);
        self.last.runs_away = self.runs_away(position_rad);
        self.last.in_mode = self.other_mode(inputs.drive).is_none();
        self.last.at_rest = self.resting >= REST_CYCLES;
        if self.state.target() == Target::Actual && counts.is_finite() {
            (self.target_counts, self.target_rad, self.target_rad_s) = (counts, position_rad, 0.0);
        }
        let drive_torque = drive(self.places.torque).unwrap_or(0.0);
        let drive_torque_nm = self.rig.drive.sign * drive_torque * 1e-3 * self.rig.drive.rated_torque_nm;
        let drive_velocity_rad_s =
            drive(self.places.velocity).map(|counts| self.rig.drive.sign * counts / self.rig.drive.counts_per_rad);
        let drive_current_per_mille = drive(self.places.current);
        Now { position_rad, sensor, status_word, drive_torque_nm, drive_velocity_rad_s, drive_current_per_mille }
    }

    /// An encoder that has lost count counts from elsewhere: the target goes along. A drive that does not obey a stop would else drive the
    /// joint back to it, with all its torque.
    fn jump_with_encoder(&mut self) {
        if let Some(jumped_rad) = self.watch.jumped_rad().filter(|_| self.state.target() != Target::Actual) {
            self.target_rad += jumped_rad;
            self.sent.position_rad += jumped_rad;
        }
    }

    /// What the drive says of itself in an answer of this cycle: `status_word`, where nothing else of the answer is of use.
    pub fn take_status(&mut self, status_word: u16) {
        self.note(Condition::of(status_word));
    }

    fn note(&mut self, condition: Condition) {
        self.last.drive = condition;
        self.last.is_fresh = !self.fresh.is_stale();
        self.is_seen_off = self.last.is_fresh && !condition.has_torque();
    }

    /// Whether the joint goes the way that it is told.
    fn follows(&mut self, position_rad: f64, periods: u32) -> Option<Cause> {
        if !self.must_keep_to_path() {
            self.follow.forget();
            return None;
        }
        let way_rad = if self.rig.drive.mode == Mode::Velocity { self.way_rad } else { self.target_rad };
        self.follow.step(way_rad, position_rad, periods)
    }

    /// Whether the joint goes faster or farther than a stop may, as far as its position can be trusted.
    fn runs_away(&self, position_rad: f64) -> bool {
        let limits = &self.rig.limits;
        let is_blind = self.cause.as_ref().is_some_and(Cause::blinds);
        let runs = |(from_rad, from_rad_s): (f64, f64)| {
            (position_rad - from_rad).abs() > limits.stop_rad
                || self.watch.speed_rad_s().abs().max(self.watch.surely_rad_s())
                    > STOP_ROOM * from_rad_s.abs().max(limits.speed_rad_s)
        };
        !is_blind && self.stop_from.is_some_and(runs)
    }

    /// Whether torque is on, so that the drive must follow.
    pub(super) fn must_follow(&self) -> bool {
        matches!(self.state, State::Holding | State::Moving)
    }

    /// Whether the position must be where it is told to be: an axis that holds a tension goes where that and its load take it.
    fn must_keep_to_path(&self) -> bool {
        self.must_follow() && self.tension_nm.is_none()
    }

    /// How the drive left the state in which it follows.
    fn left(&self, condition: Condition, bytes: &[u8]) -> Option<Cause> {
        match condition {
            Condition::Fault if self.state == State::Clearing => None,
            Condition::Fault | Condition::FaultReaction => {
                Some(Cause::DriveFault { code: self.places.error_code.map(|place| place.get(bytes) as u16) })
            }
            Condition::QuickStop if self.must_follow() => Some(Cause::DriveQuickStop),
            Condition::Enabled => None,
            other => self.must_follow().then_some(Cause::DriveLeft(other)),
        }
    }

    /// What the drive complains of while it follows.
    fn complains(&self, condition: Condition, status_word: u16, bytes: &[u8]) -> Option<Cause> {
        if !self.must_follow() || condition != Condition::Enabled {
            return None;
        }
        if self.rig.drive.mode == Mode::Position && status_word & FOLLOWING_ERROR != 0 {
            Some(Cause::FollowingError)
        } else if status_word & INTERNAL_LIMIT != 0 {
            Some(Cause::InternalLimit)
        } else {
            self.other_mode(bytes)
        }
    }

    /// The drive's mode, where it tells one that it should not be in.
    fn other_mode(&self, bytes: &[u8]) -> Option<Cause> {
        let wanted = i64::from(self.rig.drive.mode.code());
        let found = self.places.mode_display.map(|place| place.get(bytes) as i64);
        found.filter(|found| *found != wanted).map(|found| Cause::DriveMode { found, wanted })
    }

    /// Why the drive did not get where it should in time.
    pub(super) fn slow(&self) -> Cause {
        let found = self.last.drive;
        match self.state {
            State::Readying if !self.last.at_rest => {
                Cause::Restless(Beyond { found: self.speed_rad_s().abs(), limit: self.rest_rad_s })
            }
            State::Readying => Cause::DriveSlow { wanted: "operation enabled", found },
            _ => Cause::DriveSlow { wanted: "switched off", found },
        }
    }
}
