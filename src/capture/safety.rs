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
//!                                                     | at rest and let go, or too long
//!                                                     v
//!                                                  Stopped   (for good: only a new start leads out)
//! ```
//!
//! A dry run stays in Watching: no word that could give torque is ever sent there. Where nothing is wanted any more, the way up
//! ends in Releasing (from Disarming in Watching). Torque comes to a joint at rest, in the mode asked for, and not before: until
//! then limits and sensor have been looked at for as long as it takes to see that it rests. Two things are told to the drive: a command
//! (its control word) and what becomes of the target.

use super::drive::{Condition, Control};

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
    /// Cycles since this state was entered.
    pub cycles: u32,
}

/// What becomes of the target.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// It is where the joint is.
    Actual,
    /// It stays where it is.
    Held,
    /// It goes along the trajectory.
    Follows,
}

/// How long the drive may take for each step, in cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience {
    /// To get torque, or lose it.
    pub switching: u32,
    /// To come to rest.
    pub stopping: u32,
}

/// Cycles at a fault-reset bit that is low, then high: its rise is what counts.
const RESET_CYCLES: u32 = 10;

impl State {
    /// Every state that there is.
    pub const ALL: [Self; 9] = [
        Self::Watching,
        Self::Disarming,
        Self::Clearing,
        Self::Readying,
        Self::Holding,
        Self::Moving,
        Self::Releasing,
        Self::Stopping,
        Self::Stopped,
    ];

    /// The state of the next cycle.
    pub fn next(self, seen: &Seen, patience: Patience) -> Self {
        let is_off = !seen.drive.has_torque();
        let waited = seen.cycles >= patience.switching;
        match self {
            Self::Stopped => Self::Stopped,
            Self::Stopping if seen.cycles >= patience.stopping => Self::Stopped,
            Self::Stopping if seen.at_rest && seen.cycles > 0 => Self::Stopped,
            Self::Stopping => Self::Stopping,
            // A dry run has nothing to stop; what it sees is told all the same.
            Self::Watching if seen.request == Request::Watch => Self::Watching,
            _ if seen.has_cause => Self::Stopping,
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
            Self::Readying if seen.drive == Condition::Enabled => Self::Holding,
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

    /// What the drive is told in this state, where it stands so.
    pub fn control(self, seen: &Seen) -> Control {
        match self {
            Self::Watching | Self::Stopped => Control::DisableVoltage,
            // Braking first, and no voltage once the joint rests.
            Self::Disarming if seen.drive.has_torque() && !seen.at_rest => Control::QuickStop,
            Self::Disarming => Control::DisableVoltage,
            Self::Clearing if seen.cycles < RESET_CYCLES => Control::DisableVoltage,
            Self::Clearing => Control::ResetFault,
            // A step before torque it waits for the joint and the mode.
            Self::Readying if seen.drive == Condition::SwitchedOn && !(seen.at_rest && seen.in_mode) => {
                Control::SwitchOn
            }
            Self::Readying => seen.drive.towards_enabled(),
            Self::Holding | Self::Moving => Control::Enable,
            Self::Releasing if seen.drive == Condition::Enabled => Control::SwitchOn,
            Self::Releasing => Control::DisableVoltage,
            Self::Stopping => Control::QuickStop,
        }
    }

    /// What becomes of the target in this state.
    pub fn target(self) -> Target {
        match self {
            Self::Holding | Self::Releasing => Target::Held,
            Self::Moving => Target::Follows,
            Self::Watching | Self::Disarming | Self::Clearing | Self::Readying | Self::Stopping | Self::Stopped => {
                Target::Actual
            }
        }
    }

    /// Whether the drive is asked for torque: then everything that can be wrong is a cause.
    pub fn is_armed(self) -> bool {
        matches!(self, Self::Readying | Self::Holding | Self::Moving | Self::Releasing)
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
            Self::Stopped => "stopped",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: Patience = Patience { switching: 100, stopping: 1000 };

    /// Everything that can be seen, at the counts of cycles that matter.
    fn everything() -> impl Iterator<Item = Seen> {
        let requests = [Request::Watch, Request::Hold, Request::Move];
        let flags = [0, 1, 2, 3, 4, 5, 6, 7].map(|bits| (bits & 1 != 0, bits & 2 != 0, bits & 4 != 0));
        requests.into_iter().flat_map(move |request| {
            Condition::ALL.into_iter().flat_map(move |drive| {
                flags.into_iter().flat_map(move |(has_cause, at_rest, in_mode)| {
                    [0, 1, 99, 100, 1000].into_iter().map(move |cycles| Seen {
                        request,
                        drive,
                        has_cause,
                        at_rest,
                        in_mode,
                        cycles,
                    })
                })
            })
        })
    }

    fn seen(request: Request, drive: Condition) -> Seen {
        Seen { request, drive, has_cause: false, at_rest: true, in_mode: true, cycles: 0 }
    }

    #[test]
    fn a_cause_stops_whatever_is_armed_in_one_cycle() {
        for seen in everything().filter(|seen| seen.has_cause) {
            for state in State::ALL.into_iter().filter(|state| state.is_armed()) {
                let next = state.next(&seen, PATIENCE);
                assert_eq!(next, State::Stopping, "{state:?} {seen:?}");
                assert_eq!(next.control(&seen), Control::QuickStop);
                assert_eq!(next.target(), Target::Actual);
            }
        }
    }

    #[test]
    fn stopped_is_for_good() {
        for seen in everything() {
            assert_eq!(State::Stopped.next(&seen, PATIENCE), State::Stopped);
            assert_eq!(State::Stopped.control(&seen), Control::DisableVoltage);
            let after = State::Stopping.next(&seen, PATIENCE);
            assert!(matches!(after, State::Stopping | State::Stopped), "{seen:?}");
            assert!(seen.cycles < PATIENCE.stopping || after == State::Stopped, "a stop ends: {seen:?}");
        }
    }

    #[test]
    fn a_dry_run_never_asks_for_torque() {
        for seen in everything().filter(|seen| seen.request == Request::Watch) {
            assert_eq!(State::Watching.next(&seen, PATIENCE), State::Watching);
            assert_eq!(State::Watching.control(&seen), Control::DisableVoltage);
        }
    }

    #[test]
    fn torque_is_asked_for_only_on_the_way_and_there() {
        for seen in everything() {
            for state in State::ALL {
                let gives = state.control(&seen) == Control::Enable;
                assert!(!gives || matches!(state, State::Readying | State::Holding | State::Moving), "{state:?}");
            }
        }
    }

    #[test]
    fn the_target_moves_only_in_moving_and_moving_comes_only_from_holding() {
        for state in State::ALL {
            assert_eq!(state.target() == Target::Follows, state == State::Moving);
            for seen in everything() {
                let arrives = state.next(&seen, PATIENCE) == State::Moving;
                assert!(!arrives || matches!(state, State::Holding | State::Moving), "{state:?} {seen:?}");
            }
        }
    }

    #[test]
    fn a_drive_that_is_on_already_is_stopped_first() {
        let armed = |drive| State::Watching.next(&seen(Request::Hold, drive), PATIENCE);
        for drive in Condition::ALL.into_iter().filter(|drive| drive.has_torque()) {
            assert_eq!(armed(drive), State::Disarming, "{drive}");
        }
        let moving = Seen { at_rest: false, ..seen(Request::Hold, Condition::Enabled) };
        assert_eq!(State::Disarming.control(&moving), Control::QuickStop);
        assert_eq!(State::Disarming.next(&moving, PATIENCE), State::Disarming);
        assert_eq!(armed(Condition::Fault), State::Clearing);
        assert_eq!(armed(Condition::SwitchOnDisabled), State::Readying);
    }

    #[test]
    fn the_way_up_and_down_is_walked() {
        let way = [
            (State::Watching, Request::Hold, Condition::SwitchOnDisabled, State::Readying, Control::Shutdown),
            (State::Readying, Request::Hold, Condition::Ready, State::Readying, Control::SwitchOn),
            (State::Readying, Request::Hold, Condition::SwitchedOn, State::Readying, Control::Enable),
            (State::Readying, Request::Hold, Condition::Enabled, State::Holding, Control::Enable),
            (State::Holding, Request::Move, Condition::Enabled, State::Moving, Control::Enable),
            (State::Moving, Request::Hold, Condition::Enabled, State::Holding, Control::Enable),
            (State::Holding, Request::Watch, Condition::Enabled, State::Releasing, Control::SwitchOn),
            (State::Releasing, Request::Watch, Condition::SwitchedOn, State::Watching, Control::DisableVoltage),
        ];
        for (state, request, drive, next, control) in way {
            let seen = seen(request, drive);
            assert_eq!(state.next(&seen, PATIENCE), next, "{state:?}");
            assert_eq!(next.control(&seen), control, "{next:?}");
        }
    }

    #[test]
    fn a_drive_that_takes_too_long_is_stopped() {
        for state in [State::Disarming, State::Clearing, State::Readying, State::Releasing] {
            let stuck = Seen { cycles: 100, at_rest: false, ..seen(Request::Hold, Condition::Unknown) };
            assert_eq!(state.next(&stuck, PATIENCE), State::Stopping, "{state:?}");
            assert_eq!(state.next(&Seen { cycles: 99, ..stuck }, PATIENCE), state);
        }
    }

    #[test]
    fn a_fault_is_reset_by_a_rising_bit() {
        let fault = |cycles| Seen { cycles, ..seen(Request::Hold, Condition::Fault) };
        let words: Vec<u16> = (0..20).map(|cycles| State::Clearing.control(&fault(cycles)).word()).collect();
        assert_eq!(words.windows(2).filter(|pair| pair[0] & 0x80 == 0 && pair[1] & 0x80 != 0).count(), 1);
    }

    #[test]
    fn torque_comes_to_a_joint_at_rest_in_the_right_mode() {
        for seen in everything().filter(|seen| seen.drive == Condition::SwitchedOn) {
            let gives = State::Readying.control(&seen) == Control::Enable;
            assert_eq!(gives, seen.at_rest && seen.in_mode, "{seen:?}");
        }
    }

    #[test]
    fn the_transitions_are_those_of_the_drawing() {
        use State::*;
        let drawn: [(State, &[State]); 9] = [
            (Watching, &[Watching, Disarming, Clearing, Readying, Stopping]),
            (Disarming, &[Watching, Disarming, Readying, Stopping]),
            (Clearing, &[Clearing, Readying, Releasing, Stopping]),
            (Readying, &[Readying, Holding, Releasing, Stopping]),
            (Holding, &[Holding, Moving, Releasing, Stopping]),
            (Moving, &[Holding, Moving, Releasing, Stopping]),
            (Releasing, &[Watching, Releasing, Stopping]),
            (Stopping, &[Stopping, Stopped]),
            (Stopped, &[Stopped]),
        ];
        for (from, expected) in drawn {
            let leads = |to: &State| everything().any(|seen| from.next(&seen, PATIENCE) == *to);
            let found: Vec<State> = State::ALL.into_iter().filter(leads).collect();
            assert_eq!(found, expected, "{from:?}");
        }
    }

    #[test]
    fn where_nothing_is_wanted_no_torque_comes() {
        for drive in Condition::ALL {
            let (mut state, mut cycles) = (State::Readying, 0);
            while !matches!(state, State::Watching | State::Stopped) && cycles < 2000 {
                let now = Seen { cycles, ..seen(Request::Watch, drive) };
                state = state.next(&now, PATIENCE);
                assert_ne!(state.control(&now), Control::Enable, "{drive}");
                cycles += 1;
            }
            assert!(matches!(state, State::Watching | State::Stopped), "{drive} ends in {state:?}");
        }
    }
}
