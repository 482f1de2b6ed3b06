//! The joint as it is seen on the wire, cycle by cycle: inputs -> cause, state -> outputs. Pure: it sends nothing and waits for
//! nothing, so that every fault can be played to it.

use super::bound::{At, Sent, bounded};
use super::cause::{Beyond, Cause};
use super::drive::{Condition, FOLLOWING_ERROR, INTERNAL_LIMIT, Mode};
use super::follow::Follow;
use super::fresh::Freshness;
use super::limits::{Limits, Measured, SPEED_CYCLES, Watch};
use super::rig::{Place, Rig};
use super::safety::{Patience, Request, Seen, State, Target};
use super::sensor::{Reading, SensorReader};

/// Slower than this counts as rest, rad/s ...
const REST_RAD_S: f64 = 0.01;
/// ... and of a coarse encoder what flickers by a count within the cycles of a speed.
const REST_COUNTS: f64 = 1.5;
/// Cycles of it that make sure.
const REST_CYCLES: u32 = 20;
/// How long the drive may take to switch, s: some have a brake to open.
const SWITCHING_S: f64 = 3.0;
/// How long the drive may stay enabled after a quick stop was commanded before voltage is taken away, s: some cycles, and slow firmware.
const OBEYING_S: f64 = 0.05;
/// How long a stop may take before voltage is taken away whatever is seen, s.
const STOPPING_S: f64 = 2.0;
/// How long the drive may take to lose torque without voltage, and again once out of OP, s: its watchdog, and its fault reaction.
const CUTTING_S: f64 = 0.3;
/// How many times the limit of speed, or the speed with which the stop began if that was higher, a joint may have while it is stopped:
/// the quick stop must have had time to act.
const STOP_ROOM: f64 = 1.5;

/// The drive and sensor of a rig, with what they said last.
#[derive(Debug, Clone)]
pub struct Axis {
    rig: Rig,
    places: Places,
    sensor: SensorReader,
    watch: Watch,
    patience: Patience,
    /// Slower than this the joint rests, rad/s.
    rest_rad_s: f64,
    state: State,
    cycles: u32,
    cause: Option<Cause>,
    doubt: Option<Cause>,
    resting: u32,
    target_rad: f64,
    target_counts: f64,
    target_rad_s: f64,
    last: Seen,
    follow: Follow,
    fresh: Freshness,
    /// What was sent last.
    sent: Sent,
    /// The way that was commanded, by the speed sent where that is what the drive follows, rad.
    way_rad: f64,
    /// Where the joint was when the stop began, rad, and how fast, rad/s.
    stop_from: Option<(f64, f64)>,
    /// Whether the last cycle has shown that torque is off.
    is_seen_off: bool,
    /// Whether the drive was ever asked for torque.
    was_armed: bool,
    error_code: Option<u16>,
    /// Cycles without an answer of the drive.
    silent: u32,
}

/// Where things stand in the drive's bytes.
#[derive(Debug, Clone)]
struct Places {
    control_word: Option<Place>,
    mode: Option<Place>,
    target_position: Option<Place>,
    target_velocity: Option<Place>,
    target_torque: Option<Place>,
    status_word: Option<Place>,
    position: Option<Place>,
    torque: Option<Place>,
    mode_display: Option<Place>,
    error_code: Option<Place>,
    counter: Option<Place>,
}

/// What one answer says.
#[derive(Debug, Clone, PartialEq)]
pub struct Now {
    /// rad.
    pub position_rad: f64,
    /// The torque sensor.
    pub sensor: Reading,
    /// The drive's status word.
    pub status_word: u16,
    /// The drive's own torque, N m at the winch; 0 where it is not mapped.
    pub drive_torque_nm: f64,
}

/// One answer of the bus, as its bytes.
#[derive(Debug, Clone, Copy)]
pub struct Inputs<'a> {
    /// What the drive sent.
    pub drive: &'a [u8],
    /// What the sensor's terminal sent.
    pub sensor: &'a [u8],
    /// Periods since the last answer: 1, and more after missed cycles.
    pub periods: u32,
}

impl Axis {
    /// The joint of `rig`, not yet seen.
    pub fn new(rig: &Rig) -> Self {
        let (input, output) = (|role: &str| rig.drive.inputs.place(role), |role: &str| rig.drive.outputs.place(role));
        let period_s = rig.bus.period_s();
        let cycles = |time_s: f64| (time_s / period_s) as u32;
        Self {
            rig: rig.clone(),
            places: Places {
                control_word: output("control_word"),
                mode: output("mode"),
                target_position: output("target_position"),
                target_velocity: output("target_velocity"),
                target_torque: output("target_torque"),
                status_word: input("status_word"),
                position: input("position"),
                torque: input("torque"),
                mode_display: input("mode"),
                error_code: input("error_code"),
                counter: input("counter"),
            },
            sensor: SensorReader::new(&rig.sensor),
            watch: Watch::new(rig.limits, period_s),
            patience: Patience {
                switching: cycles(SWITCHING_S),
                obeying: cycles(OBEYING_S),
                stopping: cycles(STOPPING_S),
                cutting: cycles(CUTTING_S),
            },
            rest_rad_s: REST_RAD_S.max(REST_COUNTS / rig.drive.counts_per_rad / (SPEED_CYCLES as f64 * period_s)),
            state: State::Watching,
            cycles: 0,
            cause: None,
            doubt: None,
            resting: 0,
            target_rad: 0.0,
            target_counts: 0.0,
            target_rad_s: 0.0,
            last: Seen {
                request: Request::Watch,
                drive: Condition::NotReady,
                has_cause: false,
                at_rest: false,
                in_mode: false,
                is_fresh: false,
                is_blind: false,
                runs_away: false,
                cycles: 0,
            },
            follow: Follow::new(&soft(rig), period_s, rig.drive.mode == Mode::Torque, 1.0 / rig.drive.counts_per_rad),
            fresh: Freshness::default(),
            sent: Sent::default(),
            way_rad: 0.0,
            stop_from: None,
            is_seen_off: false,
            was_armed: false,
            error_code: None,
            silent: 0,
        }
    }

    /// Where the safety machine is.
    pub fn state(&self) -> State {
        self.state
    }

    /// Why it stopped, or is about to.
    pub fn cause(&self) -> Option<&Cause> {
        self.cause.as_ref()
    }

    /// What would have been a cause, had there been anything to stop.
    pub fn doubt(&self) -> Option<&Cause> {
        self.doubt.as_ref()
    }

    /// Where the joint is told to be, rad.
    pub fn target_rad(&self) -> f64 {
        self.target_rad
    }

    /// Measured, rad/s.
    pub fn speed_rad_s(&self) -> f64 {
        self.watch.speed_rad_s()
    }

    /// Whether the last cycle has shown, by a fresh answer of the drive, that torque is off.
    pub fn is_seen_off(&self) -> bool {
        self.is_seen_off
    }

    /// The drive's error code in the last answer, where it is mapped.
    pub fn error_code(&self) -> Option<u16> {
        self.error_code
    }

    /// Whether the last cycle brought an answer of the drive that is new.
    pub fn was_answered(&self) -> bool {
        self.silent == 0
    }

    /// Whether no answer has come for longer than the drive may take to switch.
    pub fn is_silent(&self) -> bool {
        self.silent >= self.patience.switching
    }

    /// Whether the drive was ever asked for torque.
    pub fn was_armed(&self) -> bool {
        self.was_armed
    }

    /// Whether something tells, cycle by cycle, that the drive's inputs are new.
    pub fn knows_fresh(&self) -> bool {
        self.fresh.is_usable()
    }

    /// Whether the rig maps a counter of the drive's own, so that nothing else need be asked.
    pub fn has_counter(&self) -> bool {
        self.places.counter.is_some()
    }

    /// What tells whether the drive's inputs are new has this value now.
    pub fn freshen(&mut self, signal: u32) {
        if let Some(looks) = self.fresh.look(signal, self.state != State::Watching) {
            self.blame(Cause::DriveStale(looks));
        }
    }

    /// Where the drive's own machine stood in the last answer.
    pub fn drive(&self) -> Condition {
        self.last.drive
    }

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
            command_rad: self.must_follow().then_some(self.target_rad),
            periods: inputs.periods,
        };
        if let Some(counter) = drive(self.places.counter).filter(|_| inputs.periods == 1) {
            self.freshen(counter as i64 as u32);
        }
        let beyond = self.watch.step(&measured);
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
        let drive_torque_nm = drive_torque * 1e-3 * self.rig.drive.rated_torque_nm;
        Now { position_rad, sensor, status_word, drive_torque_nm }
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
        if !self.must_follow() {
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
                || self.watch.speed_rad_s().abs() > STOP_ROOM * from_rad_s.abs().max(limits.speed_rad_s)
        };
        !is_blind && self.stop_from.is_some_and(runs)
    }

    /// Whether torque is on, so that the drive must follow.
    fn must_follow(&self) -> bool {
        matches!(self.state, State::Holding | State::Moving)
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
    fn slow(&self) -> Cause {
        let found = self.last.drive;
        match self.state {
            State::Readying if !self.last.at_rest => {
                Cause::Restless(Beyond { found: self.speed_rad_s().abs(), limit: self.rest_rad_s })
            }
            State::Readying => Cause::DriveSlow { wanted: "operation enabled", found },
            _ => Cause::DriveSlow { wanted: "switched off", found },
        }
    }

    /// A reason to stop that came up elsewhere. It counts only where there is something to stop, and the first one stays.
    pub fn blame(&mut self, cause: Cause) {
        let can_stop = self.state.is_armed() || matches!(self.state, State::Disarming | State::Clearing);
        let place = if can_stop { &mut self.cause } else { &mut self.doubt };
        place.get_or_insert(cause);
    }

    /// A reason to stop, whatever is being done.
    pub fn fail(&mut self, cause: Cause) {
        self.cause.get_or_insert(cause);
    }

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
        let is_blind = self.cause.as_ref().is_some_and(Cause::blinds);
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
        let torque_nm = drive.gains.stiffness_nm_rad * behind_rad
            + drive.gains.damping_nm_s_rad * (self.target_rad_s - measured_rad_s);
        let (speed_rad_s, torque_nm) = match target {
            Target::Held | Target::Follows => (self.target_rad_s + drive.gains.position_per_s * behind_rad, torque_nm),
            // No measurement has a part in it: it may be what is wrong.
            Target::Brakes => (self.target_rad_s, 0.0),
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
        set(self.places.target_position, counts);
        set(self.places.target_velocity, drive.sign * self.sent.speed_rad_s * drive.counts_per_rad);
        set(self.places.target_torque, drive.sign * self.sent.torque_nm / drive.rated_torque_nm * 1e3);
    }

    /// After a gap in which the drive may have stood still: a speed that is sent goes on from the one that is measured.
    pub fn resume(&mut self) {
        self.sent.speed_rad_s = self.watch.speed_rad_s();
    }
}

/// The rig's limits, where in torque mode our own loop makes the joint as soft as its stiffness: by so much of the command friction
/// may hold it.
fn soft(rig: &Rig) -> Limits {
    let Rig { drive, limits, .. } = rig;
    let wound_up_rad = match drive.mode {
        Mode::Torque => (drive.torque_max_nm / drive.gains.stiffness_nm_rad).min(limits.lag_rad),
        Mode::Position | Mode::Velocity => 0.0,
    };
    Limits { stuck_rad: limits.stuck_rad.max(wound_up_rad), ..*limits }
}
