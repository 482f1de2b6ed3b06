//! The joint as it is seen on the wire, cycle by cycle: inputs -> cause (`take`), state -> outputs (`command`). Pure: it sends nothing
//! and waits for nothing, so that every fault can be played to it.

mod command;
mod take;

use super::bound::Sent;
use super::cause::Cause;
use super::drive::{Condition, Mode};
use super::follow::Follow;
use super::fresh::Freshness;
use super::limits::Limits;
use super::rig::{Drive, Holds, Place, Rig};
use super::safety::{Patience, Seen, State};
use super::sensor::{Reading, SensorReader};
use super::watch::{SPEED_CYCLES, Watch};

/// Slower than this counts as rest, rad/s ...
const REST_RAD_S: f64 = 0.01;
/// ... and of a coarse encoder what flickers by a count within the cycles of a speed.
const REST_COUNTS: f64 = 1.5;
/// How long the drive may take to switch, s: some have a brake to open.
const SWITCHING_S: f64 = 3.0;
/// How long the drive may stay enabled after a quick stop was commanded before voltage is taken away, and again before it is made to leave
/// OP, s: some cycles, and slow firmware.
pub const OBEYING_S: f64 = 0.02;
/// How long a stop may take before voltage is taken away whatever is seen, s.
const STOPPING_S: f64 = 2.0;
/// How long the drive may take to lose torque without voltage, and again once out of OP, s: its watchdog, and its fault reaction.
const CUTTING_S: f64 = 0.3;
/// The drive and sensor of a rig, with what they said last.
#[derive(Debug, Clone)]
pub struct Axis {
    rig: Rig,
    places: Places,
    /// The torque that it holds at its winch, N m; else it follows or holds a position.
    tension_nm: Option<f64>,
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
    /// Cycles for which the brake has been let go.
    unbraked: u32,
    /// What its output is told.
    brake_word: f64,
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
    brake: Option<Place>,
    status_word: Option<Place>,
    position: Option<Place>,
    torque: Option<Place>,
    velocity: Option<Place>,
    current: Option<Place>,
    mode_display: Option<Place>,
    error_code: Option<Place>,
    counter: Option<Place>,
}

impl Places {
    fn of(drive: &Drive) -> Self {
        let (input, output) = (|role: &str| drive.inputs.place(role), |role: &str| drive.outputs.place(role));
        Self {
            control_word: output("control_word"),
            mode: output("mode"),
            target_position: output("target_position"),
            target_velocity: output("target_velocity"),
            target_torque: output("target_torque"),
            brake: output("brake"),
            status_word: input("status_word"),
            position: input("position"),
            torque: input("torque"),
            velocity: input("velocity"),
            current: input("current"),
            mode_display: input("mode"),
            error_code: input("error_code"),
            counter: input("counter"),
        }
    }
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
    /// The drive's own speed, rad/s of the joint (counts/s at its object 0x606C), where it is mapped.
    pub drive_velocity_rad_s: Option<f64>,
    /// The drive's current, per mille of rated, where it is mapped.
    pub drive_current_per_mille: Option<f64>,
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
    /// The axis of `rig`, not yet seen.
    pub fn new(rig: &Rig) -> Self {
        let period_s = rig.bus.period_s();
        let is_soft = rig.drive.mode == Mode::Torque;
        let engage = rig.drive.brake.as_ref().map_or(0, |brake| (brake.engage_s / period_s).ceil() as u32);
        Self {
            rig: rig.clone(),
            places: Places::of(&rig.drive),
            tension_nm: None,
            sensor: SensorReader::new(&rig.sensor),
            watch: Watch::new(rig.limits, period_s, 1.0 / rig.drive.counts_per_rad),
            patience: patience(period_s),
            rest_rad_s: REST_RAD_S.max(REST_COUNTS / rig.drive.counts_per_rad / (SPEED_CYCLES as f64 * period_s)),
            state: State::Watching,
            cycles: 0,
            cause: None,
            doubt: None,
            resting: 0,
            target_rad: 0.0,
            target_counts: 0.0,
            target_rad_s: 0.0,
            last: Seen { engage, ..Seen::default() },
            unbraked: 0,
            brake_word: 0.0,
            follow: Follow::new(&soft(rig), period_s, is_soft, 1.0 / rig.drive.counts_per_rad),
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

    /// The same, which holds something and follows no path.
    pub fn holding(self, holds: Holds) -> Self {
        let tension_nm = match holds {
            Holds::Position => None,
            Holds::Tension(tension_nm) => Some(tension_nm),
        };
        // A tension fades before its drive is switched off.
        let fades = tension_nm.map_or(0, |_| (command::TENSION_S / self.rig.bus.period_s()).ceil() as u32);
        let last = Seen { engage: self.last.engage.max(fades), ..self.last };
        Self { tension_nm, last, ..self }
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

    /// What the output that lets the brake go is told, as its bits.
    pub fn brake_word(&self) -> f64 {
        self.brake_word
    }

    /// Whether the last cycle brought an answer of the drive that is new.
    pub fn was_answered(&self) -> bool {
        self.silent == 0
    }

    /// Whether no answer has come for longer than the drive may take to switch.
    pub fn is_silent(&self) -> bool {
        self.silent >= self.patience.switching
    }

    /// The drive holds the joint after a quick stop (its option, 0x605A, is 5 to 8).
    pub fn set_holds(&mut self, holds: bool) {
        self.last.holds = holds;
    }

    /// Whether the measured position cannot be trusted now: a cause says so, or the drive's answer is old or missing.
    fn is_blind(&self) -> bool {
        self.cause.as_ref().is_some_and(Cause::blinds) || self.fresh.is_stale() || self.silent > 0
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

    /// The signal that shows whether the drive's inputs are new has this value now, `periods` after the last check.
    pub fn freshen(&mut self, signal: u32, periods: u32) {
        if let Some(looks) = self.fresh.look(signal, periods, self.state != State::Watching) {
            self.blame(Cause::DriveStale(looks));
        }
    }

    /// Where the drive's own machine stood in the last answer.
    pub fn drive(&self) -> Condition {
        self.last.drive
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
}

fn patience(period_s: f64) -> Patience {
    let cycles = |time_s: f64| (time_s / period_s) as u32;
    Patience {
        switching: cycles(SWITCHING_S),
        obeying: cycles(OBEYING_S),
        stopping: cycles(STOPPING_S),
        cutting: cycles(CUTTING_S),
    }
}

/// The rig's limits, widened in torque mode, where the loop of this program is only as stiff as its gain: friction may hold the joint back
/// by the corresponding lag.
fn soft(rig: &Rig) -> Limits {
    let Rig { drive, limits, .. } = rig;
    let wound_up_rad = match drive.mode {
        Mode::Torque => (drive.torque_max_nm / drive.gains.stiffness_nm_rad).min(limits.lag_rad),
        Mode::Position | Mode::Velocity => 0.0,
    };
    Limits { stuck_rad: limits.stuck_rad.max(wound_up_rad), ..*limits }
}
