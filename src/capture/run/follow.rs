//! Along a motion, cycle by cycle, and through gaps in which no answers come.

use super::Run;
use crate::capture::cycle::Gap;
use crate::capture::drive::Mode;
use crate::capture::safety::Request;
use crate::capture::wire::Wire;

/// After a gap the motion gets under way again at this share of the limit of acceleration.
const GENTLE: f64 = 0.5;
/// In a gap the target goes back by this share of a cycle's way in each cycle, to where a drive stands that heard nothing.
const BACK: f64 = 0.5;

/// Where along its samples a motion is.
///
/// What a drive does in a gap is not known: it may hear what is sent, or nothing. In position mode one that hears nothing bridges a
/// cycle and stands; what it hears first should be where it stands, or it would catch up within a cycle. One that hears everything
/// should not be stopped dead. So with the second cycle missed the target stands, and then goes back to where the first one would be. In
/// speed and torque mode a drive that hears nothing goes on as it was told last: there the target goes on as well, a little slower.
#[derive(Debug, Clone, Copy)]
struct Pace {
    /// Samples gone, with their fraction; -1 before the first.
    at: f64,
    /// Samples in a cycle: 1, less after a gap, and below 0 while the target goes back in one.
    pace: f64,
    /// Whether a drive that hears nothing comes to stand.
    stands: bool,
    /// Where it stands since the gap began.
    stands_at: Option<f64>,
}

impl Pace {
    fn new(mode: Mode) -> Self {
        Self { at: -1.0, pace: 1.0, stands: mode == Mode::Position, stands_at: None }
    }

    /// A cycle on; `faster` is by how much the pace may change in one.
    fn step(&mut self, gap: Gap, faster: f64, last: f64) {
        match gap {
            // Two samples have not been heard, or not answered: the last commanded one has yet to be sent, and it stands one behind.
            Gap::Lasts if self.stands => {
                let stands_at = *self.stands_at.get_or_insert((self.at - self.pace).max(0.0));
                self.pace = (self.pace - 1.0).max(-BACK);
                self.at = (self.at + self.pace).min(last).max(stands_at);
            }
            Gap::Lasts => {
                self.pace = (self.pace - faster).max(0.0);
                self.at = (self.at + self.pace).min(last);
            }
            // With the first answer it stands where the drive has just been told to be.
            Gap::Over if self.stands => (self.pace, self.stands_at) = (0.0, None),
            Gap::Over | Gap::None => {
                // Whole samples stay whole.
                let is_whole = self.pace >= 1.0 && self.at.fract() == 0.0;
                self.pace = (self.pace.max(0.0) + faster).min(1.0);
                self.at = if is_whole { self.at + 1.0 } else { (self.at + self.pace).min(last) };
            }
        }
    }

    /// Where that is, rad.
    fn position_rad(&self, positions_rad: &[f64]) -> f64 {
        let (before, share) = (self.sample(), self.at.max(0.0).fract());
        let after = (before + 1).min(positions_rad.len() - 1);
        positions_rad[before] + share * (positions_rad[after] - positions_rad[before])
    }

    /// The last sample that has been reached.
    fn sample(&self) -> usize {
        self.at.max(0.0) as usize
    }
}

impl<W: Wire, C> Run<'_, '_, W, C> {
    /// Along `positions_rad`, one a cycle, each told to `each`; false where that broke off. After a gap the motion gets under way
    /// again within the limit of acceleration.
    pub(super) fn follow(&mut self, positions_rad: &[f64], mut each: impl FnMut(&mut Self, usize)) -> bool {
        let Some(last) = positions_rad.len().checked_sub(1) else { return true };
        let (rig, last) = (self.task.rig, last as f64);
        let faster = GENTLE * rig.limits.acceleration_rad_s2 * rig.bus.period_s() / rig.limits.speed_rad_s;
        let mut pace = Pace::new(rig.drive.mode);
        while pace.at < last {
            let is_well = self.turn_by(Request::Move, |gap| {
                pace.step(gap, faster, last);
                Some(pace.position_rad(positions_rad))
            });
            if !is_well {
                return false;
            }
            each(self, pace.sample());
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motion_without_gaps_goes_through_every_sample() {
        let positions_rad: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.3).collect();
        let mut pace = Pace::new(Mode::Position);
        for position_rad in &positions_rad {
            pace.step(Gap::None, 0.01, 99.0);
            assert_eq!(pace.position_rad(&positions_rad), *position_rad);
        }
    }

    /// Where it is when a gap of `cycles` begins at sample 100, and after: as it is commanded, cycle by cycle. A gap is one from its
    /// second cycle on.
    fn through(mode: Mode, cycles: usize) -> Vec<f64> {
        let mut pace = Pace { at: 99.0, ..Pace::new(mode) };
        let mut all = vec![99.0];
        for cycle in 1..cycles + 300 {
            let gap = [Gap::None, Gap::Lasts, Gap::Over, Gap::None]
                [usize::from(cycle > 1) + usize::from(cycle > cycles) + usize::from(cycle > cycles + 1)];
            pace.step(gap, 0.01, 1e4);
            all.push(pace.at);
        }
        all
    }

    /// What is commanded in one cycle is sent in the next: the last that a drive heard before the gap is 98, and it stands at 99.
    #[test]
    fn what_is_heard_first_after_a_gap_is_near_where_the_drive_stands() {
        for (cycles, off) in [(2, 1.0), (3, 0.5), (4, 0.0), (9, 0.0)] {
            let all = through(Mode::Position, cycles);
            assert_eq!(all[cycles] - 99.0, off, "{cycles}");
            // Then it gets under way slowly.
            let steps: Vec<f64> = all[cycles..].windows(2).map(|pair| pair[1] - pair[0]).collect();
            assert_eq!(steps[0], 0.0);
            assert!(steps.windows(2).all(|pair| (-1e-9..0.011).contains(&(pair[1] - pair[0]))), "{:?}", &steps[..9]);
            assert!((steps.last().unwrap() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn a_drive_that_hears_all_is_braked_in_two_steps_and_one_that_goes_on_hardly() {
        let changes = |all: Vec<f64>| {
            let steps: Vec<f64> = all.windows(2).map(|pair| pair[1] - pair[0]).collect();
            steps.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max)
        };
        assert!(changes(through(Mode::Position, 9)) <= 1.0 + 1e-9);
        for mode in [Mode::Velocity, Mode::Torque] {
            assert!(changes(through(mode, 9)) < 0.011);
        }
    }

    /// A computer that slept sends, when it wakes, what it had ready: that is where the drive stands.
    #[test]
    fn after_sleep_the_target_stands_first() {
        let mut pace = Pace { at: 100.0, ..Pace::new(Mode::Position) };
        pace.step(Gap::Over, 0.01, 1e4);
        assert_eq!((pace.at, pace.pace), (100.0, 0.0));
        pace.step(Gap::None, 0.01, 1e4);
        assert!((pace.at - 100.01).abs() < 1e-9);
    }

    #[test]
    fn no_gap_leads_beyond_the_end_or_the_beginning() {
        for mode in [Mode::Position, Mode::Velocity] {
            for at in [-1.0, 0.0, 1.0, 49.0] {
                let mut pace = Pace { at, ..Pace::new(mode) };
                for cycle in 0..200 {
                    pace.step(if cycle < 100 { Gap::Lasts } else { Gap::None }, 0.01, 50.0);
                    assert!((-1.0..=50.0).contains(&pace.at) && pace.sample() <= 50);
                }
                assert_eq!(pace.at, 50.0);
            }
        }
    }
}
