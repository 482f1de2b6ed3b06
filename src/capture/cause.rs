//! Why the joint was stopped, in words for the log and the exit message.

use super::drive::Condition;
use std::fmt;

/// What ends a motion early. Every one leads to a quick stop.
#[derive(Debug, Clone, PartialEq)]
pub enum Cause {
    /// No answer for this many consecutive cycles.
    MissedCycles(u32),
    /// Fewer devices than expected took part in a cycle.
    WorkingCounter {
        /// As it came back.
        found: u16,
        /// With all devices at work.
        expected: u16,
    },
    /// A device left the state in which it exchanges process data.
    DeviceState {
        /// Its place on the bus, from 0, and its name.
        device: String,
        /// Where it is now.
        state: String,
    },
    /// The drive reports a fault.
    DriveFault {
        /// Object 0x603F, where it is mapped.
        code: Option<u16>,
    },
    /// The drive brakes, though nobody told it to.
    DriveQuickStop,
    /// The drive let go, though nobody told it to.
    DriveLeft(Condition),
    /// The drive follows another mode than the one asked for.
    DriveMode {
        /// Object 0x6061.
        found: i64,
        /// Object 0x6060 as written.
        wanted: i64,
    },
    /// The drive put an emergency message into its mailbox: its code (CiA 301), where it can be read.
    Emergency(Option<u16>),
    /// Bit 11 of the status word.
    InternalLimit,
    /// Bit 13 of the status word: the drive says that it does not follow.
    FollowingError,
    /// The joint is farther from its command than the rig allows, rad.
    Lag(Beyond),
    /// The joint does not go the way that it is told: found and commanded, rad.
    NotFollowing(Beyond),
    /// Measured and commanded speed differ by too much, rad/s.
    SpeedGap(Beyond),
    /// The drive has sent no new inputs for this many cycles, though it answers.
    DriveStale(u32),
    /// In the first small motion torque and position had opposite signs: torque up less torque down, N m.
    Signs(f64),
    /// Too many cycles were missed while nothing moved: the number missed, of the number run.
    CycleQuality {
        /// Missed.
        missed: u32,
        /// In all.
        cycles: u32,
    },
    /// A device has no output watchdog that works.
    Watchdog(String),
    /// The joint is outside its range, rad.
    Position(Beyond),
    /// The joint is too fast, rad/s.
    Speed(Beyond),
    /// The joint does not come to rest, without which it gets no torque, rad/s.
    Restless(Beyond),
    /// The torque at the sensor is too large, N m.
    Torque(Beyond),
    /// The torque changed by more than it can from one sample to the next, N m: a cable that broke or a wire that came off.
    TorqueStep(Beyond),
    /// The position changed by more than it can from one sample to the next, rad.
    EncoderJump(Beyond),
    /// What was to be commanded is outside the limits: position, rad, or its change, rad/s.
    Command(Beyond),
    /// The sensor has sent no new reading for this many cycles.
    SensorStale(u32),
    /// The sensor is at the end of its range.
    SensorSaturated,
    /// The sensor reports an error of its own.
    SensorError,
    /// The sensor's value is no number.
    SensorNotANumber,
    /// The recording cannot be written.
    Recording(String),
    /// The operator asked for it.
    Interrupted,
    /// The drive did not do in time what it was told.
    DriveSlow {
        /// What it was to reach.
        wanted: &'static str,
        /// Where it is.
        found: Condition,
    },
    /// Another axis of the rig was stopped: its name, and why.
    OtherAxis(String, Box<Cause>),
    /// The EtherCAT stack failed.
    Stack(String),
    /// The program itself failed.
    Panic(String),
}

/// A value beyond a limit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beyond {
    /// What was found.
    pub found: f64,
    /// What is allowed.
    pub limit: f64,
}

impl Cause {
    /// Its name in files, without numbers.
    pub fn name(&self) -> &'static str {
        match self {
            Self::MissedCycles(_) => "missed_cycles",
            Self::WorkingCounter { .. } => "working_counter",
            Self::DeviceState { .. } => "device_state",
            Self::DriveFault { .. } => "drive_fault",
            Self::DriveQuickStop => "drive_quick_stop",
            Self::DriveLeft(_) => "drive_left",
            Self::DriveMode { .. } => "drive_mode",
            Self::Emergency(_) => "emergency",
            Self::InternalLimit => "internal_limit",
            Self::FollowingError => "following_error",
            Self::Lag(_) => "lag",
            Self::NotFollowing(_) => "not_following",
            Self::SpeedGap(_) => "speed_gap",
            Self::DriveStale(_) => "drive_stale",
            Self::Signs(_) => "signs",
            Self::CycleQuality { .. } => "cycle_quality",
            Self::Watchdog(_) => "watchdog",
            Self::Position(_) => "position",
            Self::Speed(_) => "speed",
            Self::Restless(_) => "restless",
            Self::Torque(_) => "torque",
            Self::TorqueStep(_) => "torque_step",
            Self::EncoderJump(_) => "encoder_jump",
            Self::Command(_) => "command",
            Self::SensorStale(_) => "sensor_stale",
            Self::SensorSaturated => "sensor_saturated",
            Self::SensorError => "sensor_error",
            Self::SensorNotANumber => "sensor_not_a_number",
            Self::Recording(_) => "recording",
            Self::Interrupted => "interrupted",
            Self::DriveSlow { .. } => "drive_slow",
            Self::OtherAxis(..) => "other_axis",
            Self::Stack(_) => "stack",
            Self::Panic(_) => "panic",
        }
    }
}

impl Cause {
    /// Whether it says that the measured position is not to be trusted.
    pub fn blinds(&self) -> bool {
        matches!(
            self,
            Self::NotFollowing(_) | Self::DriveStale(_) | Self::EncoderJump(_) | Self::SpeedGap(_) | Self::Lag(_)
        )
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MissedCycles(n) => write!(f, "no answer from the bus for {n} cycles one after the other"),
            Self::WorkingCounter { found, expected } => {
                write!(f, "the working counter is {found} and not {expected}: a device does not take part")
            }
            Self::DeviceState { device, state } => write!(f, "{device} fell back to {state}"),
            Self::DriveFault { code: Some(code) } => write!(f, "the drive reports fault {code:#06x}"),
            Self::DriveFault { code: None } => write!(f, "the drive reports a fault"),
            Self::DriveQuickStop => write!(f, "the drive made a quick stop of its own"),
            Self::DriveLeft(condition) => write!(f, "the drive let go: {condition}"),
            Self::DriveMode { found, wanted } => write!(f, "the drive follows mode {found} and not {wanted}"),
            Self::Emergency(Some(code)) => write!(f, "the drive sent emergency message {code:#06x}"),
            Self::Emergency(None) => write!(f, "the drive sent an unsolicited message"),
            Self::InternalLimit => write!(f, "the drive is at a limit of its own (status bit 11)"),
            Self::FollowingError => write!(f, "the drive reports a following error (status bit 13)"),
            Self::CycleQuality { missed, cycles } => {
                write!(f, "{missed} of {cycles} cycles were missed: this computer does not keep the cycle")
            }
            Self::Watchdog(why) => write!(f, "{why}"),
            Self::Recording(why) => write!(f, "the recording cannot be written: {why}"),
            Self::Interrupted => write!(f, "stopped by the operator"),
            Self::DriveSlow { wanted, found: Condition::SwitchOnDisabled } if *wanted == "operation enabled" => {
                write!(
                    f,
                    "the drive stays in `{}`: is its power on, and its safe torque off released?",
                    Condition::SwitchOnDisabled
                )
            }
            Self::DriveSlow { wanted, found } => write!(f, "the drive did not get to `{wanted}` in time: {found}"),
            Self::OtherAxis(name, why) => write!(f, "of `{name}`: {why}"),
            Self::Stack(why) => write!(f, "the EtherCAT stack failed: {why}"),
            Self::Panic(why) => write!(f, "the program failed: {why}"),
            _ => self.of_measured(f),
        }
    }
}

impl Cause {
    /// Those that are seen in what was measured, in words.
    fn of_measured(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lag(beyond) => write!(f, "the joint is {} rad off its command", beyond),
            Self::NotFollowing(Beyond { found, limit }) => write!(
                f,
                "the joint moved {found:.4} rad where it was told to move {limit:.4}: it is blocked, its encoder stands still, \
                 or the drive's sign is wrong"
            ),
            Self::SpeedGap(beyond) => write!(f, "measured and commanded speed differ by {} rad/s", beyond),
            Self::DriveStale(n) => {
                write!(f, "the drive's inputs are frozen: it has sent nothing new for {n} cycles, though it answers")
            }
            Self::Signs(torque_nm) => write!(
                f,
                "the torque going up is {torque_nm:+.4} N m above that going down, and friction makes that positive: the sign of \
                 the drive (sign) or of the sensor (nm_per_count, torque_sign) is wrong"
            ),
            Self::Position(beyond) => write!(f, "the joint is at {} rad", beyond),
            Self::Speed(beyond) => write!(f, "the joint moves at {} rad/s", beyond),
            Self::Restless(beyond) => {
                write!(f, "the joint must rest before it gets torque, and moves at {} rad/s", beyond)
            }
            Self::Torque(beyond) => write!(f, "the torque is {} N m", beyond),
            Self::TorqueStep(beyond) => {
                write!(f, "the torque jumped by {} N m: has a cable or a wire come off?", beyond)
            }
            Self::EncoderJump(beyond) => write!(f, "the position jumped by {} rad", beyond),
            Self::Command(beyond) => write!(f, "the command would be {}", beyond),
            Self::SensorStale(n) => write!(f, "the torque sensor has sent nothing new for {n} cycles"),
            Self::SensorSaturated => write!(f, "the torque sensor is at the end of its range"),
            Self::SensorError => write!(f, "the torque sensor's terminal reports an error"),
            Self::SensorNotANumber => write!(f, "the torque sensor's value is no number"),
            other => write!(f, "{}", other.name()),
        }
    }
}

impl fmt::Display for Beyond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.4} (allowed: {:.4})", self.found, self.limit)
    }
}
