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
//!                                                     |  quick stop, until at rest or off; at once if it is not obeyed,
//!                                                     v  if the joint runs away, or after too long
//!                                                  Cutting ------> Stopped   (off; for good: only a new start leads out)
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
    /// It comes to rest along a ramp of its own, whatever is measured: a drive that does not obey must not run after a position
    /// that runs away.
    Brakes,
}

/// How long the drive may take for each step, in cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience {
    /// To get torque, or lose it.
    pub switching: u32,
    /// To leave "operation enabled" on a quick stop.
    pub obeying: u32,
    /// To come to rest.
    pub stopping: u32,
    /// To lose torque without voltage, and again once out of OP.
    pub cutting: u32,
}

/// Cycles at a fault-reset bit that is low, then high: its rise is what counts.
const RESET_CYCLES: u32 = 10;

impl State {
    /// Every state that there is.
    pub const ALL: [Self; 12] = [
        Self::Watching,
        Self::Disarming,
        Self::Clearing,
        Self::Readying,
        Self::Holding,
        Self::Moving,
        Self::Releasing,
        Self::Stopping,
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
            Self::Stopping if seen.at_rest && !seen.is_blind && seen.cycles > 0 => Self::Cutting,
            Self::Stopping if seen.drive == Condition::Enabled && seen.cycles >= patience.obeying => Self::Cutting,
            Self::Stopping => Self::Stopping,
            Self::Cutting | Self::Leaving | Self::Lost if is_off && seen.cycles > 0 => Self::Stopped,
            Self::Cutting if seen.cycles >= patience.cutting => Self::Leaving,
            Self::Leaving if seen.cycles >= patience.cutting => Self::Lost,
            Self::Cutting | Self::Leaving | Self::Lost => self,
            // A dry run has nothing to stop; what it sees is told all the same.
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

    /// What the drive is told in this state, where it stands so.
    pub fn control(self, seen: &Seen) -> Control {
        match self {
            Self::Watching | Self::Cutting | Self::Leaving | Self::Lost | Self::Stopped => Control::DisableVoltage,
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
            Self::Stopping | Self::Cutting | Self::Leaving | Self::Lost => Target::Brakes,
            Self::Watching | Self::Disarming | Self::Clearing | Self::Readying | Self::Stopped => Target::Actual,
        }
    }

    /// Whether the drive is asked for torque: then everything that can be wrong is a cause.
    pub fn is_armed(self) -> bool {
        matches!(self, Self::Readying | Self::Holding | Self::Moving | Self::Releasing)
    }

    /// Whether a stop is under way: where the drive stands is then asked for in every way.
    pub fn is_ending(self) -> bool {
        matches!(self, Self::Stopping | Self::Cutting | Self::Leaving | Self::Lost | Self::Stopped)
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
            Self::Cutting => "cutting",
            Self::Leaving => "leaving",
            Self::Lost => "lost",
            Self::Stopped => "stopped",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PATIENCE: Patience = Patience { switching: 100, obeying: 50, stopping: 1000, cutting: 99 };

    /// Everything that can be seen, at the counts of cycles that matter.
    fn everything() -> impl Iterator<Item = Seen> {
        let requests = [Request::Watch, Request::Hold, Request::Move];
        requests.into_iter().flat_map(move |request| {
            Condition::ALL.into_iter().flat_map(move |drive| {
                (0..64u32).flat_map(move |bits| {
                    [0, 1, 49, 50, 99, 100, 1000].into_iter().map(move |cycles| Seen {
                        request,
                        drive,
                        has_cause: bits & 1 != 0,
                        at_rest: bits & 2 != 0,
                        in_mode: bits & 4 != 0,
                        is_fresh: bits & 8 != 0,
                        is_blind: bits & 16 != 0,
                        runs_away: bits & 32 != 0,
                        cycles,
                    })
                })
            })
        })
    }

    fn seen(request: Request, drive: Condition) -> Seen {
        Seen {
            request,
            drive,
            has_cause: false,
            at_rest: true,
            in_mode: true,
            is_fresh: true,
            is_blind: false,
            runs_away: false,
            cycles: 0,
        }
    }

    #[test]
    fn a_cause_stops_whatever_is_armed_in_one_cycle() {
        for seen in everything().filter(|seen| seen.has_cause) {
            for state in State::ALL.into_iter().filter(|state| state.is_armed()) {
                let next = state.next(&seen, PATIENCE);
                assert_eq!(next, State::Stopping, "{state:?} {seen:?}");
                assert_eq!(next.control(&seen), Control::QuickStop);
                assert_eq!(next.target(), Target::Brakes);
            }
        }
    }

    #[test]
    fn stopped_is_for_good() {
        for seen in everything() {
            assert_eq!(State::Stopped.next(&seen, PATIENCE), State::Stopped);
            assert_eq!(State::Stopped.control(&seen), Control::DisableVoltage);
            let ways = [
                (State::Stopping, &[State::Stopping, State::Cutting][..]),
                (State::Cutting, &[State::Cutting, State::Leaving, State::Stopped]),
                (State::Leaving, &[State::Leaving, State::Lost, State::Stopped]),
                (State::Lost, &[State::Lost, State::Stopped]),
            ];
            for (state, to) in ways {
                let after = state.next(&seen, PATIENCE);
                assert!(to.contains(&after), "{state:?} {seen:?}");
                assert!(
                    seen.cycles < 1000 || after != state || state == State::Lost,
                    "every step ends: {state:?} {seen:?}"
                );
                assert_ne!(state.target(), Target::Actual, "no target runs after a position in {state:?}");
            }
        }
    }

    /// What counts as off is a fresh answer of the drive that says so, and nothing else.
    #[test]
    fn a_stop_is_over_only_where_torque_is_seen_off() {
        for seen in everything() {
            for state in State::ALL.into_iter().filter(|state| *state != State::Stopped) {
                if state.next(&seen, PATIENCE) == State::Stopped {
                    assert!(seen.is_fresh && !seen.drive.has_torque(), "{state:?} {seen:?}");
                }
            }
        }
    }

    #[test]
    fn a_stop_escalates_by_what_the_drive_answers() {
        let walk = |answer: &dyn Fn(State, u32) -> Seen| {
            let (mut state, mut cycles, mut way) = (State::Stopping, 0, vec![State::Stopping]);
            for at in 0..3000 {
                let next = state.next(&Seen { cycles, ..answer(state, at) }, PATIENCE);
                cycles = if next == state { cycles + 1 } else { 0 };
                if next != state {
                    way.push(next);
                }
                state = next;
            }
            way
        };
        let moving = |drive| Seen { at_rest: false, ..seen(Request::Move, drive) };
        use State::*;
        // Obeys: brakes, rests, is off.
        let obeys = |state: State, at: u32| match state {
            Stopping => Seen { at_rest: at > 60, ..seen(Request::Move, Condition::QuickStop) },
            _ => seen(Request::Move, Condition::SwitchOnDisabled),
        };
        assert_eq!(walk(&obeys), [Stopping, Cutting, Stopped]);
        // Ignores the quick stop only; ignores every command until it leaves OP; ignores everything; is not there.
        let deaf = |state: State, _| match state {
            Stopping => moving(Condition::Enabled),
            _ => seen(Request::Move, Condition::SwitchOnDisabled),
        };
        assert_eq!(walk(&deaf), [Stopping, Cutting, Stopped]);
        let deafer = |state: State, _| match state {
            Leaving => seen(Request::Move, Condition::Fault),
            _ => moving(Condition::Enabled),
        };
        assert_eq!(walk(&deafer), [Stopping, Cutting, Leaving, Stopped]);
        assert_eq!(walk(&|_, _| moving(Condition::Enabled)), [Stopping, Cutting, Leaving, Lost]);
        let gone = |_, _| Seen { is_fresh: false, ..seen(Request::Move, Condition::SwitchOnDisabled) };
        assert_eq!(walk(&gone), [Stopping, Cutting, Leaving, Lost]);
        // Runs away on its quick stop.
        let away = |_, at| Seen { runs_away: at > 5, ..moving(Condition::QuickStop) };
        assert_eq!(walk(&away)[..2], [Stopping, Cutting]);
    }

    #[test]
    fn a_position_that_is_not_trusted_shows_no_rest() {
        let blind = Seen { is_blind: true, cycles: 5, ..seen(Request::Move, Condition::QuickStop) };
        assert_eq!(State::Stopping.next(&blind, PATIENCE), State::Stopping);
        assert_eq!(State::Stopping.next(&Seen { is_blind: false, ..blind }, PATIENCE), State::Cutting);
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
        let drawn: [(State, &[State]); 12] = [
            (Watching, &[Watching, Disarming, Clearing, Readying, Stopping]),
            (Disarming, &[Watching, Disarming, Readying, Stopping]),
            (Clearing, &[Clearing, Readying, Releasing, Stopping]),
            (Readying, &[Readying, Holding, Releasing, Stopping]),
            (Holding, &[Holding, Moving, Releasing, Stopping]),
            (Moving, &[Holding, Moving, Releasing, Stopping]),
            (Releasing, &[Watching, Releasing, Stopping]),
            (Stopping, &[Stopping, Cutting]),
            (Cutting, &[Cutting, Leaving, Stopped]),
            (Leaving, &[Leaving, Lost, Stopped]),
            (Lost, &[Lost, Stopped]),
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
            while !state.is_over() && cycles < 2000 {
                let now = Seen { cycles, ..seen(Request::Watch, drive) };
                state = state.next(&now, PATIENCE);
                assert_ne!(state.control(&now), Control::Enable, "{drive}");
                cycles += 1;
            }
            assert!(state.is_over(), "{drive} ends in {state:?}");
        }
    }
}
