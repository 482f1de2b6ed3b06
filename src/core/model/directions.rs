//! Which way a joint moves, along a whole recorded motion.

use super::Direction;
use std::ops::Range;

/// The direction in which `positions_rad` first go further than `deadband_rad`.
pub fn set_out(positions_rad: &[f64], deadband_rad: f64) -> Direction {
    let away_rad = positions_rad.iter().map(|x| x - positions_rad[0]).find(|away| away.abs() > deadband_rad);
    if away_rad.is_some_and(|away| away < 0.0) { Direction::Down } else { Direction::Up }
}

/// Where a joint turns.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// The samples before it at which the joint no longer moves as it came, and not yet back.
    pub rest: Range<usize>,
    /// Which way it moves from there on.
    pub to: Direction,
}

/// Where a joint turns: there its speed changes its sign, and it comes back by more than `deadband_rad`. At a rest that it leaves as it came
/// speeds are noise and a filter's ringing. Where the speed still has the old sign by then, the turn is where the joint is back by that.
pub fn turns(positions_rad: &[f64], velocity_rad_s: impl Fn(usize) -> f64, deadband_rad: f64) -> Vec<Turn> {
    let mut direction = set_out(positions_rad, deadband_rad);
    let moves = |at: usize, direction: Direction| Direction::of(velocity_rad_s(at)) == Some(direction);
    let mut turns: Vec<Turn> = Vec::new();
    let mut at_rad = positions_rad.first().copied().unwrap_or(0.0);
    for (i, x) in positions_rad.iter().enumerate() {
        let further_rad = (x - at_rad) * direction.sign();
        if further_rad < -deadband_rad {
            let to = direction.opposite();
            let after = turns.last().map_or(0, |turn| turn.rest.end);
            let leaves = i - (after..i).rev().take_while(|at| moves(*at, to)).count();
            let is_near = |at: &usize| (positions_rad[*at] - at_rad).abs() <= deadband_rad;
            let near = leaves - (after..leaves).rev().take_while(is_near).count();
            let arrives = (near..leaves).find(|at| !moves(*at, direction)).unwrap_or(leaves);
            turns.push(Turn { rest: arrives..leaves, to });
            (direction, at_rad) = (to, *x);
        } else if further_rad > 0.0 {
            at_rad = *x;
        }
    }
    turns
}

/// The direction of the motion at each of `positions_rad`. At rest it stays that of the last motion; before any, it is that of
/// the first.
pub fn directions(positions_rad: &[f64], turns: &[Turn], deadband_rad: f64) -> Vec<Direction> {
    let mut directions = Vec::with_capacity(positions_rad.len());
    let mut direction = set_out(positions_rad, deadband_rad);
    for turn in turns {
        directions.resize(turn.rest.end, direction);
        direction = turn.to;
    }
    directions.resize(positions_rad.len(), direction);
    directions
}

#[cfg(test)]
mod tests {
    use super::{Direction, Turn, directions, turns};

    fn speeds(positions_rad: &[f64]) -> impl Fn(usize) -> f64 + '_ {
        |i| positions_rad[(i + 1).min(positions_rad.len() - 1)] - positions_rad[i.saturating_sub(1)]
    }

    fn found(positions_rad: &[f64], deadband_rad: f64) -> Vec<Turn> {
        turns(positions_rad, speeds(positions_rad), deadband_rad)
    }

    /// A low-passed stop rings: the speed's sign changes, the joint has not turned.
    #[test]
    fn a_rest_that_the_joint_leaves_as_it_came_is_no_turn() {
        let position_rad = |i: usize| match i {
            0..50 => 1e-6 * (i as f64).sin(),
            50..100 => 1e-2 * (i as f64 - 50.0),
            100..200 => 0.5 + 1e-5 * (i as f64).sin(),
            200..250 => 0.5 + 1e-2 * (i as f64 - 200.0),
            _ => 1.0 + 1e-5 * (i as f64).sin(),
        };
        let up: Vec<f64> = (0..300).map(position_rad).collect();
        let down: Vec<f64> = up.iter().map(|x| -x).collect();
        for (positions_rad, way) in [(&up, Direction::Up), (&down, Direction::Down)] {
            assert_eq!(found(positions_rad, 1e-4), []);
            assert!(directions(positions_rad, &[], 1e-4).iter().all(|moving| *moving == way));
        }
        assert!(found(&up, 0.0).len() > 10);
        assert_eq!((turns(&[], |_| 0.0, 0.0), directions(&[], &[], 0.0)), (Vec::new(), Vec::new()));
    }

    #[test]
    fn rests_of_many_turns_are_in_order_and_apart() {
        let position_rad =
            |i: usize| ((0.02 * i as f64).sin() * 30.0).round() / 30.0 + 2e-3 * (12.9898 * i as f64).sin();
        let positions_rad: Vec<f64> = (0..4000).map(position_rad).collect();
        for deadband_rad in [0.0, 1e-3, 5e-3] {
            let turns = found(&positions_rad, deadband_rad);
            assert!(turns.len() > 20 && turns.iter().all(|turn| turn.rest.start <= turn.rest.end));
            assert!(turns.windows(2).all(|pair| pair[0].rest.end <= pair[1].rest.start && pair[0].to != pair[1].to));
            assert_eq!(directions(&positions_rad, &turns, deadband_rad).len(), positions_rad.len());
        }
        assert_eq!(found(&positions_rad, 5e-3).len(), 25);
    }

    #[test]
    fn a_turn_is_where_the_joint_leaves_the_other_way_after_its_rest() {
        for rest in [0, 100] {
            let position_rad = |i: usize| match i {
                0..100 => 1e-2 * i as f64,
                i if i < 100 + rest => 1.0 + 1e-5 * (i as f64).sin(),
                _ => 1.0 - 1e-2 * (i - 100 - rest) as f64,
            };
            let positions_rad: Vec<f64> = (0..200 + rest).map(position_rad).collect();
            for deadband_rad in [1e-4, 3e-2] {
                let turns = found(&positions_rad, deadband_rad);
                let [Turn { rest: at, to: Direction::Down }] = &turns[..] else { panic!("{turns:?}") };
                assert!(at.start.abs_diff(100) <= 5 && at.end.abs_diff(100 + rest) <= 5, "{at:?}");
                let moving = directions(&positions_rad, &turns, deadband_rad);
                assert_eq!(moving.iter().position(|moving| *moving == Direction::Down), Some(at.end));
                assert!(
                    moving.len() == positions_rad.len()
                        && moving[at.end..].iter().all(|moving| *moving == Direction::Down)
                );
            }
        }
    }
}
