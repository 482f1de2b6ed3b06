//! The machine that decides, every cycle, what the drive is told: all states and all transitions are here.
//!
//! ```text
//!            arm                                 off, at rest       at rest, torque on
//! Watching ------> Disarming (drive was on) ------------> Readying ------------------> Holding <----> Moving
//!    ^      |----> Clearing (drive in fault) ------------>   |          hold / move       |             |
//!    |      '----------------------------------------------->|                            | release     |
//!    '-------------------------- off --------------------- Releasing <-------------------'             |
//!                                                            |                                          |
//!  any of them but Watching, a cause ------------> Stopping <-------------------------------------------'
//!                                                     |   |  at rest, and the drive holds on (option 5 to 8)
//!                    quick stop, until at rest or off;|   '------> Held
//!                    at once if it is not obeyed, if  |             |  nothing is wanted any more, or it does not hold
//!               the joint runs away, or after too long v             v
//!                                                  Cutting <--------'
//!                                                     | '------> Stopped   (off; for good: only a new start leads out)
//!                                                     |  disable voltage     ^ ^
//!                                                     v  still on            | | off after all
//!                                                  Leaving ------------------' |
//!                                                     |  out of OP             |
//!                                                     v  still not seen off    |
//!                                                   Lost ----------------------'
//! ```
//!
//! A dry run stays in Watching: no word that could give torque is ever sent there. Where nothing is wanted any more, the way up
//! ends in Releasing (from Disarming in Watching). Torque comes to a joint at rest, in the mode asked for, and not before: until
//! then limits and sensor have been looked at for as long as it takes to see that it rests. Two things are told to the drive: a command
//! (its control word) and what becomes of the target.
//!
//! A stop escalates by what the drive answers. Torque is off only where a fresh answer of the drive says so: no answer, an old one
//! or frozen inputs show nothing. A drive that does not obey the quick stop loses its voltage; one that keeps it is made to leave
//! OP; and one that is not seen off even then is Lost: whoever runs this must tell the operator so.

mod told;

pub use told::Target;

use super::drive::Condition;

/// Where we stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// Nothing but looking: no voltage.
    Watching,
    /// The drive was found enabled: it is stopped before it is taken over.
    Disarming,
    /// The drive was found in fault: the fault is acknowledged, once.
    Clearing,
    /// On the way to torque, the target at the joint's own position.
    Readying,
    /// Torque on, the target stands.
    Holding,
    /// Torque on, the target moves.
    Moving,
    /// At rest, on the way to no torque.
    Releasing,
    /// A cause came up: quick stop.
    Stopping,
    /// Stopped, and held by the drive's quick stop until nothing is wanted any more.
    Held,
    /// At rest, or quick stop did not help: no voltage.
    Cutting,
    /// Disabling voltage did not help: the drive is made to leave OP.
    Leaving,
    /// Nothing has shown that torque is off.
    Lost,
    /// Stopped, without voltage.
    Stopped,
}

/// What is wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Request {
    /// No torque.
    Watch,
    /// Torque on, at rest.
    Hold,
    /// Torque on, moving.
    Move,
}

/// All that decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Seen {
    /// What is wanted.
    pub request: Request,
    /// Where the drive stands.
    pub drive: Condition,
    /// Whether there is a reason to stop.
    pub has_cause: bool,
    /// Whether the joint rests.
    pub at_rest: bool,
    /// Whether the drive is in the mode asked for, as far as it tells.
    pub in_mode: bool,
    /// Whether `drive` is of this cycle: an answer came, and its inputs are alive.
    pub is_fresh: bool,
    /// Whether the measured position is not to be trusted: then rest is not seen.
    pub is_blind: bool,
    /// Whether the joint goes faster or farther than a stop may.
    pub runs_away: bool,
    /// Whether the drive holds the joint after a quick stop.
    pub holds: bool,
    /// Cycles that a brake takes to fall in: torque stays on for so long.
    pub engage: u32,
    /// Cycles since this state was entered.
    pub cycles: u32,
}

impl Default for Seen {
    /// Nothing seen, nothing wanted.
    fn default() -> Self {
        Self {
            request: Request::Watch,
            drive: Condition::NotReady,
            has_cause: false,
            at_rest: false,
            in_mode: false,
            is_fresh: false,
            is_blind: false,
            runs_away: false,
            holds: false,
            engage: 0,
            cycles: 0,
        }
    }
}

impl Seen {
    /// Whether a drive at rest after its quick stop may go on holding: it does so by its option, it said so last, and it is still
    /// wanted. A single missing answer drops no limb.
    fn may_be_held(&self) -> bool {
        self.holds && self.drive == Condition::QuickStop && self.request != Request::Watch
    }
}

/// How long the drive may take for each step, in cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience {
    /// To get torque, or lose it.
    pub switching: u32,
    /// To leave "operation enabled" on a quick stop, or once told to disable voltage.
    pub obeying: u32,
    /// To come to rest.
    pub stopping: u32,
    /// To lose torque without voltage, and again once out of OP.
    pub cutting: u32,
}

impl State {
    /// Every state that there is.
    pub const ALL: [Self; 13] = [
        Self::Watching,
        Self::Disarming,
        Self::Clearing,
        Self::Readying,
        Self::Holding,
        Self::Moving,
        Self::Releasing,
        Self::Stopping,
        Self::Held,
        Self::Cutting,
        Self::Leaving,
        Self::Lost,
        Self::Stopped,
    ];

    /// The state of the next cycle.
    pub fn next(self, seen: &Seen, patience: Patience) -> Self {
        let is_off = seen.is_fresh && !seen.drive.has_torque();
        let waited = seen.cycles >= patience.switching;
        match self {
            Self::Stopped => Self::Stopped,
            Self::Stopping if is_off || seen.runs_away || seen.cycles >= patience.stopping => Self::Cutting,
            Self::Stopping if seen.at_rest && !seen.is_blind && seen.cycles > 0 => {
                if seen.may_be_held() {
                    Self::Held
                } else {
                    Self::Cutting
                }
            }
            Self::Stopping if seen.drive == Condition::Enabled && seen.cycles >= patience.obeying => Self::Cutting,
            Self::Stopping => Self::Stopping,
            Self::Held if seen.may_be_held() && !seen.runs_away => Self::Held,
            Self::Held => Self::Cutting,
            Self::Cutting | Self::Leaving | Self::Lost if is_off && seen.cycles > 0 => Self::Stopped,
            // A drive that still follows is deaf, one on its way to no torque may take its time.
            Self::Cutting if seen.is_fresh && seen.drive == Condition::Enabled && seen.cycles >= patience.obeying => {
                Self::Leaving
            }
            Self::Cutting if seen.cycles >= patience.cutting => Self::Leaving,
            Self::Leaving if seen.cycles >= patience.cutting => Self::Lost,
            Self::Cutting | Self::Leaving | Self::Lost => self,
            // A dry run has nothing to stop; causes are reported all the same.
            Self::Watching if seen.request == Request::Watch => Self::Watching,
            _ if seen.has_cause => Self::Stopping,
            // Who does not answer is not taken over.
            Self::Watching if !seen.is_fresh => Self::Watching,
            Self::Watching => match seen.drive {
                Condition::Fault => Self::Clearing,
                _ if is_off => Self::Readying,
                _ => Self::Disarming,
            },
            Self::Disarming if is_off && seen.at_rest => match seen.request {
                Request::Watch => Self::Watching,
                Request::Hold | Request::Move => Self::Readying,
            },
            Self::Clearing | Self::Readying if seen.request == Request::Watch => Self::Releasing,
            Self::Clearing if is_off && seen.drive != Condition::Fault => Self::Readying,
            Self::Readying if seen.is_fresh && seen.drive == Condition::Enabled => Self::Holding,
            Self::Disarming | Self::Clearing | Self::Readying if waited => Self::Stopping,
            Self::Disarming | Self::Clearing | Self::Readying => self,
            Self::Holding | Self::Moving => match seen.request {
                Request::Watch => Self::Releasing,
                Request::Hold => Self::Holding,
                Request::Move => Self::Moving,
            },
            Self::Releasing if is_off => Self::Watching,
            Self::Releasing if waited => Self::Stopping,
            Self::Releasing => Self::Releasing,
        }
    }

    /// Whether the drive is asked for torque: then everything that can be wrong is a cause.
    pub fn is_armed(self) -> bool {
        matches!(self, Self::Readying | Self::Holding | Self::Moving | Self::Releasing)
    }

    /// Whether a stop is under way: where the drive stands is then asked for in every way.
    pub fn is_ending(self) -> bool {
        matches!(self, Self::Stopping | Self::Held | Self::Cutting | Self::Leaving | Self::Lost | Self::Stopped)
    }

    /// Whether nothing more will happen here by itself.
    pub fn is_over(self) -> bool {
        matches!(self, Self::Watching | Self::Lost | Self::Stopped)
    }

    /// Its name in recordings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Watching => "watching",
            Self::Disarming => "disarming",
            Self::Clearing => "clearing",
            Self::Readying => "readying",
            Self::Holding => "holding",
            Self::Moving => "moving",
            Self::Releasing => "releasing",
            Self::Stopping => "stopping",
            Self::Held => "held",
            Self::Cutting => "cutting",
            Self::Leaving => "leaving",
            Self::Lost => "lost",
            Self::Stopped => "stopped",
        }
    }
}

#[cfg(test)]
mod tests;
