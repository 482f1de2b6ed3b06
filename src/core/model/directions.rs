//! Which way a joint moves, along a whole recorded motion.

use super::Direction;

/// The direction in which `positions_rad` first go further than `deadband_rad`.
pub fn set_out(positions_rad: &[f64], deadband_rad: f64) -> Direction {
    let away_rad = positions_rad.iter().map(|x| x - positions_rad[0]).find(|away| away.abs() > deadband_rad);
    if away_rad.is_some_and(|away| away < 0.0) { Direction::Down } else { Direction::Up }
}

/// The direction of the motion at each of `positions_rad`: the sign of its speed, but a joint has turned only where it then comes back by more
/// than `deadband_rad`. At rest, where speeds are noise and a filter's ringing, it stays that of the last motion.
pub fn directions(positions_rad: &[f64], velocity_rad_s: impl Fn(usize) -> f64, deadband_rad: f64) -> Vec<Direction> {
    let mut direction = set_out(positions_rad, deadband_rad);
    let mut directions: Vec<Direction> = Vec::with_capacity(positions_rad.len());
    let (mut at_rad, mut turned) = (positions_rad.first().copied().unwrap_or(0.0), 0);
    for (i, x) in positions_rad.iter().enumerate() {
        let further_rad = (x - at_rad) * direction.sign();
        if further_rad < -deadband_rad {
            direction = direction.opposite();
            let back = |at: &usize| Direction::of(velocity_rad_s(*at)) == Some(direction);
            turned = i - (turned..i).rev().take_while(back).count();
            directions[turned..].fill(direction);
        }
        if further_rad.abs() > deadband_rad || further_rad > 0.0 {
            at_rad = *x;
        }
        directions.push(direction);
    }
    directions
}

#[cfg(test)]
mod tests {
    use super::{Direction, directions};

    /// A low-passed stop rings: the speed's sign changes, the joint has not turned.
    #[test]
    fn ringing_at_rest_is_no_motion_and_a_turn_is_where_the_speed_changes_sign() {
        let position_rad = |i: usize| match i {
            0..100 => 1e-2 * i as f64,
            100..200 => 1.0 + 1e-5 * (i as f64).sin(),
            _ => 1.0 - 1e-4 * (i as f64 - 200.0).powi(2),
        };
        let positions_rad: Vec<f64> = (0..300).map(position_rad).collect();
        let speed = |i: usize| position_rad((i + 1).min(299)) - position_rad(i.saturating_sub(1));
        for (deadband_rad, off) in [(1e-4, 5), (5e-3, 5)] {
            let found = directions(&positions_rad, speed, deadband_rad);
            let turned = found.iter().position(|moving| *moving == Direction::Down).unwrap();
            assert!(turned.abs_diff(200) <= off, "{turned}");
            assert!(found[turned..].iter().all(|moving| *moving == Direction::Down));
        }
        assert!(directions(&positions_rad, speed, 0.0)[100..200].contains(&Direction::Down));
        let down: Vec<f64> = positions_rad.iter().map(|x| -x).collect();
        let [back, forth] = [directions(&down, |i| -speed(i), 1e-4), directions(&positions_rad, speed, 1e-4)];
        assert!(back.iter().zip(forth).all(|(back, forth)| *back == forth.opposite()));
        assert!(directions(&[], speed, 0.0).is_empty());
    }
}
