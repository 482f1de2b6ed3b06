//! Where a joint rests: dry friction holds it there under any torque up to its own, so that no model knows which.

use crate::model::Turn;
use crate::numerics::filter::LowPass;

/// A joint that stays within this travel for [`REST_S`] to either side rests, rad: far below any sweep, above an encoder's noise.
pub const REST_RAD: f64 = 2e-4;
/// See [`REST_RAD`], s.
pub const REST_S: f64 = 0.1;

/// Rests before turns may make up this share of what the low-pass takes together: with more of it, friction that jumps is not known there.
const UNDECIDED_SHARE: f64 = 0.2;

/// Where the joint rests: it stays within [`REST_RAD`], or the encoder's noise, for [`REST_S`] before and after.
pub fn rests(positions_rad: &[f64], rate_hz: f64, deadband_rad: f64) -> Vec<bool> {
    let reach = ((REST_S * rate_hz) as usize).max(1);
    let limit_rad = REST_RAD.max(2.0 * deadband_rad);
    let last = positions_rad.len().saturating_sub(1);
    let travel = |i: usize| {
        let (before, after) = (positions_rad[i.saturating_sub(reach)], positions_rad[(i + reach).min(last)]);
        (before - positions_rad[i]).abs().max((after - positions_rad[i]).abs())
    };
    (0..positions_rad.len()).map(|i| travel(i) < limit_rad).collect()
}

/// Samples at which more than `UNDECIDED_SHARE` of what `lowpass` takes together is a rest before one of `turns`, also one shorter than
/// [`REST_S`]: friction goes from one branch to the other there, and the motion does not tell when. Held by its brakes or its command a joint
/// keeps the branch until it leaves; under a controller that still moves its command it sticks, and has changed over when it leaves.
pub fn before_turns(turns: &[Turn], samples: usize, lowpass: &LowPass) -> Vec<bool> {
    let mut share = vec![0.0; samples];
    turns.iter().for_each(|turn| share[turn.rest.clone()].fill(1.0));
    lowpass.zero_phase_in_place(&mut share);
    share.into_iter().map(|share| share > UNDECIDED_SHARE).collect()
}

#[cfg(test)]
mod tests {
    use super::before_turns;
    use crate::model::{Direction, Turn};
    use crate::numerics::filter::LowPass;

    #[test]
    fn friction_is_not_known_about_a_rest_that_the_low_pass_does_not_smooth_away() {
        let lowpass = LowPass::new(4, 5.0, 200.0).unwrap();
        let after = |rest: usize| {
            let turn = Turn { rest: 500..500 + rest, to: Direction::Down };
            let undecided = before_turns(&[turn], 1000, &lowpass);
            let first = undecided.iter().position(|undecided| *undecided);
            assert!(
                first.is_none_or(|first| 500 - first == undecided.iter().rposition(|u| *u).unwrap() + 1 - 500 - rest)
            );
            (undecided.iter().filter(|undecided| **undecided).count(), first)
        };
        assert_eq!(after(0), (0, None));
        assert_eq!(after(2), (0, None));
        // A rest of 15 ms is smoothed away at 5 Hz, one of 50 ms is not.
        assert_eq!(after(3), (0, None));
        assert!(after(10).0 > 0);
        let (samples, first) = after(100);
        assert!((110..130).contains(&samples) && first.unwrap() < 495, "{samples}, {first:?}");
    }
}
