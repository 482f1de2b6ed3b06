//! Along a motion, cycle by cycle, and through gaps in which no answers come.

use super::Run;
use crate::capture::safety::Request;
use crate::capture::wire::Wire;

/// After a gap the motion gets under way again at this share of the limit of acceleration.
const GENTLE: f64 = 0.5;
/// In a gap the target comes to rest within so many cycles: a drive that hears us must not be stopped dead, one that does not must not
/// find its next target far away.
const BRAKING_CYCLES: f64 = 3.0;
/// Share of a cycle's way that the target then goes back in a cycle, to where a drive stands that heard nothing.
const BACK: f64 = 0.25;

/// Where along its samples a motion is.
#[derive(Debug, Clone, Copy)]
struct Pace {
    /// Samples gone, with their fraction.
    at: f64,
    /// Samples in a cycle: 1, and less after a gap.
    pace: f64,
    /// Where a drive stands that hears nothing since the gap began.
    stands_at: Option<f64>,
}

impl Pace {
    fn new() -> Self {
        Self { at: 0.0, pace: 1.0, stands_at: None }
    }

    /// A cycle on. While no answers come the target brakes, and goes back to where a drive stands that bridged one cycle; then it
    /// gets under way by `faster` a cycle.
    fn step(&mut self, in_gap: bool, faster: f64, last: f64) {
        if in_gap {
            let stands_at = *self.stands_at.get_or_insert((self.at - 1.0).max(0.0));
            self.pace = (self.pace - 1.0 / BRAKING_CYCLES).max(0.0);
            let brakes = self.pace > 1e-9;
            self.at = if brakes { (self.at + self.pace).min(last) } else { (self.at - BACK).max(stands_at) };
            return;
        }
        // Whole samples stay whole.
        let is_whole = self.pace >= 1.0 && self.at.fract() == 0.0;
        self.pace = if self.stands_at.take().is_some() { 0.0 } else { (self.pace + faster).min(1.0) };
        self.at = if is_whole && self.pace >= 1.0 { self.at + 1.0 } else { (self.at + self.pace).min(last) };
    }
}

impl<W: Wire, C> Run<'_, '_, W, C> {
    /// Along `positions_rad`, one a cycle, each told to `each`; false where that broke off. After a gap the motion gets under way
    /// again within the limit of acceleration.
    pub(super) fn follow(&mut self, positions_rad: &[f64], mut each: impl FnMut(&mut Self, usize)) -> bool {
        let Some(last) = positions_rad.len().checked_sub(1) else { return true };
        let (limits, period_s) = (&self.task.rig.limits, self.task.rig.bus.period_s());
        let faster = GENTLE * limits.acceleration_rad_s2 * period_s / limits.speed_rad_s;
        let mut pace = Pace::new();
        loop {
            let (before, share) = (pace.at as usize, pace.at.fract());
            let after = (before + 1).min(last);
            let position_rad = positions_rad[before] + share * (positions_rad[after] - positions_rad[before]);
            if !self.turn(Request::Move, Some(position_rad)) {
                return false;
            }
            each(self, before);
            if pace.at >= last as f64 {
                return true;
            }
            let in_gap = self.cycle.is_gap();
            if in_gap {
                self.cycle.axis.resume();
            }
            pace.step(in_gap, faster, last as f64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_without_gaps_goes_through_every_sample() {
        let mut pace = Pace::new();
        let seen: Vec<f64> = (0..100)
            .map(|_| {
                pace.step(false, 0.01, 200.0);
                pace.at
            })
            .collect();
        assert!(seen.iter().enumerate().all(|(i, at)| *at == i as f64 + 1.0));
    }

    #[test]
    fn a_gap_is_braked_into_and_left_slowly() {
        let mut pace = Pace { at: 100.0, ..Pace::new() };
        let mut all = vec![99.0, 100.0];
        for cycle in 0..300 {
            pace.step(cycle < 7, 0.01, 1e4);
            all.push(pace.at);
        }
        let steps: Vec<f64> = all.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.59), "{steps:?}");
        // Near where a drive stands that heard nothing; and then no faster than is gentle.
        assert!((all[8] - 99.0).abs() < 1.5, "{}", all[8]);
        assert!(steps[8..].windows(2).all(|pair| pair[1] - pair[0] < 0.011 || pair[0] < 0.0), "{:?}", &steps[6..20]);
        assert_eq!(*steps.last().unwrap(), 1.0);
    }

    #[test]
    fn no_gap_leads_beyond_the_end_or_the_beginning() {
        for at in [0.0, 1.0, 49.0] {
            let mut pace = Pace { at, ..Pace::new() };
            for cycle in 0..200 {
                pace.step(cycle < 100, 0.01, 50.0);
                assert!((0.0..=50.0).contains(&pace.at));
            }
        }
    }
}
