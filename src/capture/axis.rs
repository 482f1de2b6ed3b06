//! The joint as it is seen on the wire, cycle by cycle: inputs -> cause, state -> outputs. Pure: it sends nothing and waits for
//! nothing, so that every fault can be played to it.

use super::cause::{Beyond, Cause};
use super::drive::{Condition, FOLLOWING_ERROR, INTERNAL_LIMIT, Mode};
use super::limits::{Measured, SPEED_CYCLES, Watch};
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
/// How long a stop may take before voltage is taken away whatever is seen, s.
const STOPPING_S: f64 = 2.0;

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
            },
            sensor: SensorReader::new(&rig.sensor),
            watch: Watch::new(rig.limits, period_s),
            patience: Patience { switching: cycles(SWITCHING_S), stopping: cycles(STOPPING_S) },
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
                cycles: 0,
            },
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
        let beyond = self.watch.step(&measured);
        let condition = Condition::of(status_word);
        // What explains the others comes first.
        let left = self.left(condition, inputs.drive);
        let complains = self.complains(condition, status_word, inputs.drive);
        if let Some(cause) = left.or_else(|| sensor.cause.clone()).or(beyond).or(complains) {
            self.blame(cause);
        }
        let rests = self.watch.speed_rad_s().abs() < self.rest_rad_s && position_rad.is_finite();
        self.resting = if rests { self.resting + 1 } else { 0 };
        self.last.drive = condition;
        self.last.in_mode = self.other_mode(inputs.drive).is_none();
        self.last.at_rest = self.resting >= REST_CYCLES;
        if self.state.target() == Target::Actual && counts.is_finite() {
            (self.target_counts, self.target_rad, self.target_rad_s) = (counts, position_rad, 0.0);
        }
        let drive_torque = drive(self.places.torque).unwrap_or(0.0);
        let drive_torque_nm = drive_torque * 1e-3 * self.rig.drive.rated_torque_nm;
        Now { position_rad, sensor, status_word, drive_torque_nm }
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
        let seen = Seen { request, has_cause: self.cause.is_some(), cycles: self.cycles, ..self.last };
        let next = self.state.next(&seen, self.patience);
        if next == State::Stopping && self.cause.is_none() {
            self.cause = Some(self.slow());
        }
        self.cycles = if next == self.state { self.cycles.saturating_add(1) } else { 0 };
        self.state = next;
        self.last = Seen { cycles: self.cycles, ..seen };
        match (next.target(), command_rad) {
            (Target::Follows, Some(command)) => {
                self.target_rad_s = (command - self.target_rad) / period_s;
                self.target_rad = command;
                self.target_counts = self.rig.drive.counts(command);
            }
            _ => self.target_rad_s = 0.0,
        }
    }

    /// Writes the drive's outputs.
    pub fn write(&self, outputs: &mut [u8], now: Option<&Now>) {
        let mut set = |place: Option<Place>, value: f64| {
            if let Some(place) = place {
                place.set(outputs, value);
            }
        };
        let drive = &self.rig.drive;
        let behind_rad = now.map_or(0.0, |now| self.target_rad - now.position_rad);
        let is_closed = self.state.target() != Target::Actual;
        let speed_rad_s = if is_closed { self.target_rad_s + drive.gains.position_per_s * behind_rad } else { 0.0 };
        let torque_nm = drive.gains.stiffness_nm_rad * behind_rad
            + drive.gains.damping_nm_s_rad * (self.target_rad_s - self.watch.speed_rad_s());
        let torque_nm = if is_closed { torque_nm.clamp(-drive.torque_max_nm, drive.torque_max_nm) } else { 0.0 };
        set(self.places.control_word, f64::from(self.state.control(&self.last).word()));
        set(self.places.mode, f64::from(drive.mode.code()));
        set(self.places.target_position, self.target_counts);
        set(self.places.target_velocity, drive.sign * speed_rad_s * drive.counts_per_rad);
        set(self.places.target_torque, drive.sign * torque_nm / drive.rated_torque_nm * 1e3);
    }
}
