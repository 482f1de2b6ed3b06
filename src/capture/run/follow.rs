//! Along a motion, cycle by cycle, and through gaps in which no answers come.

use super::Run;
use crate::capture::cycle::Gap;
use crate::capture::safety::Request;
use crate::capture::wire::Wire;

/// After a gap the motion gets under way again at this share of the limit of acceleration.
const GENTLE: f64 = 0.5;
/// In a gap the target brakes by this share of a cycle's way in each cycle, and then goes back as fast, to where a drive stands that
/// heard nothing: a drive that hears us must not be stopped dead, one that does not must not find its next target far away.
const BRAKES: f64 = 0.5;
/// When a gap is noticed two samples have not been heard, a third is ready to be sent, and a drive bridges one: so many samples behind
/// the last commanded one it stands.
const BEHIND: f64 = 2.0;

/// Where along its samples a motion is.
#[derive(Debug, Clone, Copy)]
struct Pace {
    /// Samples gone, with their fraction.
    at: f64,
    /// Samples in a cycle: 1, less after a gap, and below 0 while the target goes back in one.
    pace: f64,
    /// Where a drive stands that hears nothing since the gap began.
    stands_at: Option<f64>,
}

impl Pace {
    fn new() -> Self {
        Self { at: 0.0, pace: 1.0, stands_at: None }
    }

    /// A cycle on. While no answers come the target brakes, and goes back to where a drive stands that bridged one cycle; with the first
    /// answer it stands where the drive has just been told to be, and gets under way again by `faster` a cycle.
    fn step(&mut self, gap: Gap, faster: f64, last: f64) {
        if gap == Gap::Over {
            (self.pace, self.stands_at) = (0.0, None);
            return;
        }
        if gap == Gap::Lasts {
            let stands_at = *self.stands_at.get_or_insert((self.at - BEHIND).max(0.0));
            self.pace = (self.pace - BRAKES).max(-BRAKES);
            self.at = (self.at + self.pace).min(last).max(stands_at);
            return;
        }
        // Whole samples stay whole.
        let is_whole = self.pace >= 1.0 && self.at.fract() == 0.0;
        self.pace = (self.pace.max(0.0) + faster).min(1.0);
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
            let gap = self.cycle.gap();
            if gap != Gap::None {
                self.cycle.joint.axis.resume();
            }
            pace.step(gap, faster, last as f64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_without_gaps_goes_through_every_sample() {
        let mut pace = Pace::new();
        for sample in 1..100 {
            pace.step(Gap::None, 0.01, 200.0);
            assert_eq!(pace.at, f64::from(sample));
        }
    }

    /// A gap of nine cycles, of which seven are known to be one: where a drive stands that heard nothing is where it is told to be.
    /// The last commanded sample is 100; the last that it heard 97, and one it bridges.
    #[test]
    fn a_gap_is_braked_into_and_left_slowly() {
        let mut pace = Pace { at: 100.0, ..Pace::new() };
        let mut all = vec![99.0, 100.0];
        for cycle in 0..300 {
            let gap = [Gap::Lasts, Gap::Over, Gap::None][usize::from(cycle >= 7) + usize::from(cycle > 7)];
            pace.step(gap, 0.01, 1e4);
            all.push(pace.at);
        }
        let steps: Vec<f64> = all.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(steps.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.75), "{:?}", &steps[..12]);
        assert!((all[8] - 98.0).abs() < 0.01, "{}", all[8]);
        assert!(steps[8..].windows(2).all(|pair| (-1e-9..0.011).contains(&(pair[1] - pair[0]))), "{:?}", &steps[6..20]);
        assert!((steps.last().unwrap() - 1.0).abs() < 1e-9);
    }

    /// A computer that slept sends, when it wakes, what it had ready: that is where the drive stands.
    #[test]
    fn after_sleep_the_target_stands_first() {
        let mut pace = Pace { at: 100.0, ..Pace::new() };
        pace.step(Gap::Over, 0.01, 1e4);
        assert_eq!((pace.at, pace.pace), (100.0, 0.0));
        pace.step(Gap::None, 0.01, 1e4);
        assert!((pace.at - 100.01).abs() < 1e-9);
    }

    #[test]
    fn no_gap_leads_beyond_the_end_or_the_beginning() {
        for at in [0.0, 1.0, 49.0] {
            let mut pace = Pace { at, ..Pace::new() };
            for cycle in 0..200 {
                pace.step(if cycle < 100 { Gap::Lasts } else { Gap::None }, 0.01, 50.0);
                assert!((0.0..=50.0).contains(&pace.at));
            }
        }
    }
}
