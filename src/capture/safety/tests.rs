//! Every state with everything that can be seen.

use super::*;
use crate::capture::drive::Control;

const PATIENCE: Patience = Patience { switching: 100, obeying: 50, stopping: 1000, cutting: 99 };

/// Everything that can be seen, at the counts of cycles that matter.
fn everything() -> impl Iterator<Item = Seen> {
    let requests = [Request::Watch, Request::Hold, Request::Move];
    requests.into_iter().flat_map(move |request| {
        Condition::ALL.into_iter().flat_map(move |drive| {
            (0..128u32).flat_map(move |bits| {
                [0, 1, 49, 50, 99, 100, 1000].into_iter().map(move |cycles| Seen {
                    request,
                    drive,
                    has_cause: bits & 1 != 0,
                    at_rest: bits & 2 != 0,
                    in_mode: bits & 4 != 0,
                    is_fresh: bits & 8 != 0,
                    is_blind: bits & 16 != 0,
                    runs_away: bits & 32 != 0,
                    holds: bits & 64 != 0,
                    engage: 0,
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
        holds: false,
        engage: 0,
        cycles: 0,
    }
}

/// Torque stays on while a brake falls in, and no longer.
#[test]
fn a_brake_falls_in_under_torque() {
    let at = |cycles| Seen { engage: 80, cycles, ..seen(Request::Watch, Condition::Enabled) };
    assert_eq!(State::Releasing.control(&at(79)), Control::Enable);
    assert_eq!(State::Releasing.control(&at(80)), Control::SwitchOn);
    for state in State::ALL {
        let goes = state.lets_brake_go(&Seen { at_rest: false, ..at(5) });
        assert_eq!(goes, matches!(state, State::Holding | State::Moving | State::Stopping), "{state:?}");
    }
    assert!(!State::Stopping.lets_brake_go(&at(5)));
    assert!(State::Stopping.lets_brake_go(&Seen { is_blind: true, ..at(5) }));
    assert!(!State::Stopping.lets_brake_go(&Seen { at_rest: false, ..seen(Request::Watch, Condition::Ready) }));
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
            (State::Stopping, &[State::Stopping, State::Held, State::Cutting][..]),
            (State::Held, &[State::Held, State::Cutting]),
            (State::Cutting, &[State::Cutting, State::Leaving, State::Stopped]),
            (State::Leaving, &[State::Leaving, State::Lost, State::Stopped]),
            (State::Lost, &[State::Lost, State::Stopped]),
        ];
        for (state, to) in ways {
            let after = state.next(&seen, PATIENCE);
            assert!(to.contains(&after), "{state:?} {seen:?}");
            assert!(
                seen.cycles < 1000 || after != state || matches!(state, State::Lost | State::Held),
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
    // One that still follows without voltage is made to leave OP as soon as one that ignored the quick stop loses its voltage, one on its
    // way to no torque later.
    let cutting = |drive, cycles| State::Cutting.next(&Seen { cycles, ..moving(drive) }, PATIENCE);
    assert_eq!((cutting(Condition::Enabled, 49), cutting(Condition::Enabled, 50)), (Cutting, Leaving));
    assert_eq!((cutting(Condition::QuickStop, 98), cutting(Condition::QuickStop, 99)), (Cutting, Leaving));
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
    let drawn: [(State, &[State]); 13] = [
        (Watching, &[Watching, Disarming, Clearing, Readying, Stopping]),
        (Disarming, &[Watching, Disarming, Readying, Stopping]),
        (Clearing, &[Clearing, Readying, Releasing, Stopping]),
        (Readying, &[Readying, Holding, Releasing, Stopping]),
        (Holding, &[Holding, Moving, Releasing, Stopping]),
        (Moving, &[Holding, Moving, Releasing, Stopping]),
        (Releasing, &[Watching, Releasing, Stopping]),
        (Stopping, &[Stopping, Held, Cutting]),
        (Held, &[Held, Cutting]),
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

/// Only a drive that says so is taken to hold, and not longer than it is wanted.
#[test]
fn a_joint_is_held_only_while_it_is_seen_to_be() {
    for seen in everything().filter(|seen| State::Held.next(seen, PATIENCE) == State::Held) {
        assert!(seen.holds && seen.drive == Condition::QuickStop, "{seen:?}");
        assert!(seen.request != Request::Watch && !seen.runs_away, "{seen:?}");
        assert_eq!(State::Held.control(&seen), Control::QuickStop);
    }
}
