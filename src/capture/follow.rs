//! Whether the joint follows its command: the commanded travel against the measured one.
//!
//! Three rules. Where the command has gone on by `stuck_rad` in one direction, the measurement must have gone at least a tenth of it the
//! same way: else the encoder is frozen, the joint is blocked, or a sign is wrong. And the mean speeds over the last cycles must not differ
//! by more than half the limit of speed (all of it in torque mode). And a position that was moving must not stay at the same count from one
//! cycle to the next while the command goes on: no joint stops that abruptly.
//!
//! What cannot be known from positions: whether the joint or only its encoder stands still, and, while nothing is commanded,
//! whether an encoder that shows no change is alive (see `fresh`).

use super::cause::{Beyond, Cause};
use super::limits::Limits;
use super::watch::SPEED_CYCLES;
use std::collections::VecDeque;

/// Share of the commanded way that must be measured.
const FOLLOWED: f64 = 0.1;
/// Marks along the commanded way within `stuck_rad`.
const MARKS: usize = 8;
/// Share of the limit of speed by which measured and commanded speed may differ ...
const SPEED_GAP: f64 = 0.5;
/// ... the same in torque mode, where the loop of this program is compliant: a joint released by friction moves faster than its command ...
const SOFT_SPEED_GAP: f64 = 1.0;
/// ... and at least the speed gained at the limit of acceleration within this delay, s.
const DELAY_S: f64 = 0.02;

/// Cycles for which a position must stand to the count, ...
const STANDS: u32 = 4;
/// ... while the command advances by at least this many counts, ...
const STANDS_COUNTS: f64 = 3.0;
/// ... both, before and meanwhile, faster than this share of the limit of speed.
const MOVES: f64 = 0.15;

/// A position that has begun to stand.
#[derive(Debug, Clone, Copy)]
struct Stand {
    /// The commanded way then, rad.
    way_rad: f64,
    /// The measured speed until then, rad/s.
    speed_rad_s: f64,
    cycles: u32,
}

/// Commanded and measured way of the last cycles.
#[derive(Debug, Clone)]
pub struct Follow {
    stuck_rad: f64,
    gap_rad_s: f64,
    moves_rad_s: f64,
    count_rad: f64,
    period_s: f64,
    stand: Option<Stand>,
    /// Along the commanded way, `stuck_rad / MARKS` apart: way and position.
    marks: VecDeque<(f64, f64)>,
    /// Way, position and periods of the last cycles.
    recent: VecDeque<(f64, f64, u32)>,
}

impl Follow {
    /// Watches cycles of `period_s` of a joint whose position loop is soft, or stiff, and counts in steps of `count_rad`.
    pub fn new(limits: &Limits, period_s: f64, is_soft: bool, count_rad: f64) -> Self {
        let share = if is_soft { SOFT_SPEED_GAP } else { SPEED_GAP };
        Self {
            stuck_rad: limits.stuck_rad,
            gap_rad_s: (share * limits.speed_rad_s).max(DELAY_S * limits.acceleration_rad_s2),
            moves_rad_s: MOVES * limits.speed_rad_s,
            count_rad,
            period_s,
            stand: None,
            marks: VecDeque::with_capacity(MARKS + 2),
            recent: VecDeque::with_capacity(SPEED_CYCLES + 2),
        }
    }

    /// Forgets everything: nothing must be followed now.
    pub fn forget(&mut self) {
        self.marks.clear();
        self.recent.clear();
        self.stand = None;
    }

    /// The joint is measured at `position_rad`, `periods` after the last time, having been told to go `way_rad` in all.
    pub fn step(&mut self, way_rad: f64, position_rad: f64, periods: u32) -> Option<Cause> {
        let spacing_rad = self.stuck_rad / MARKS as f64;
        let is_next = |(way, _): &(f64, f64)| (way_rad - way).abs() >= spacing_rad;
        if self.marks.back().is_none_or(is_next) {
            self.marks.push_back((way_rad, position_rad));
        }
        let first = *self.marks.front()?;
        let (told_rad, followed_rad) = (way_rad - first.0, (position_rad - first.1) * (way_rad - first.0).signum());
        if self.marks.len() > MARKS {
            self.marks.pop_front();
        }
        let froze = self.froze(way_rad, position_rad);
        self.recent.push_back((way_rad, position_rad, periods));
        let stuck = (told_rad.abs() >= self.stuck_rad * (1.0 - 1e-9) && followed_rad < FOLLOWED * told_rad.abs())
            .then_some(Cause::NotFollowing(Beyond { found: followed_rad, limit: told_rad.abs() }));
        let gap = self.gap();
        froze.or(stuck).or(gap)
    }

    /// A position that moved until the last cycle, and stands now to the count.
    fn froze(&mut self, way_rad: f64, position_rad: f64) -> Option<Cause> {
        let last = self.recent.back().filter(|(_, last_rad, _)| *last_rad == position_rad);
        let (Some((last_way_rad, ..)), Some(first)) = (last.copied(), self.recent.front().copied()) else {
            self.stand = None;
            return None;
        };
        let periods: u32 = self.recent.iter().skip(1).map(|(_, _, periods)| periods).sum();
        let speed_rad_s = (position_rad - first.1) / (f64::from(periods.max(1)) * self.period_s);
        let stand = self.stand.get_or_insert(Stand { way_rad: last_way_rad, speed_rad_s, cycles: 0 });
        stand.cycles += 1;
        let told_rad = way_rad - stand.way_rad;
        let told_rad_s = told_rad.abs() / (f64::from(stand.cycles) * self.period_s);
        let is_told = told_rad.abs() >= STANDS_COUNTS * self.count_rad && told_rad_s >= self.moves_rad_s;
        let moved = stand.speed_rad_s * told_rad.signum() >= self.moves_rad_s;
        (stand.cycles >= STANDS && is_told && moved)
            .then_some(Cause::NotFollowing(Beyond { found: 0.0, limit: told_rad.abs() }))
    }

    /// Commanded and measured mean speed, too far apart.
    fn gap(&mut self) -> Option<Cause> {
        if self.recent.len() <= SPEED_CYCLES {
            return None;
        }
        let (first, last) = (self.recent.pop_front()?, *self.recent.back()?);
        let periods: u32 = self.recent.iter().map(|(_, _, periods)| periods).sum();
        let time_s = f64::from(periods) * self.period_s;
        let found = ((last.0 - first.0) - (last.1 - first.1)).abs() / time_s;
        (found > self.gap_rad_s).then_some(Cause::SpeedGap(Beyond { found, limit: self.gap_rad_s }))
    }
}

#[cfg(test)]
mod tests {
    use super::super::limits::EXAMPLE as LIMITS;
    use super::*;

    /// After how many cycles of `way` and `position` (rad, of the cycle's number) it complains, and of what.
    fn told(way: impl Fn(f64) -> f64, position: impl Fn(f64) -> f64) -> Option<(u32, &'static str)> {
        counted(1e-5, way, position)
    }

    /// The same of an encoder that counts in steps of `count_rad`.
    fn counted(count_rad: f64, way: impl Fn(f64) -> f64, position: impl Fn(f64) -> f64) -> Option<(u32, &'static str)> {
        let mut follow = Follow::new(&LIMITS, 0.001, false, count_rad);
        (0..3000u32).find_map(|i| {
            let t = f64::from(i) * 1e-3;
            follow.step(way(t), position(t), 1).map(|cause| (i, cause.name()))
        })
    }

    #[test]
    fn what_follows_with_a_delay_passes() {
        let wave = |t: f64| 0.3 - 0.3 * (1.5 * t).cos();
        assert_eq!(told(wave, |t| wave((t - 0.02).max(0.0))), None);
        // Held by friction for a moment where it turns round, and counted coarsely.
        assert_eq!(counted(5e-4, wave, |t| (wave((t - 0.005).max(0.0)) * 2000.0).round() / 2000.0), None);
    }

    #[test]
    fn what_stands_still_is_told_after_the_way_that_is_allowed() {
        for speed in [0.03, 0.2, 0.4] {
            let (cycles, name) = told(|t| speed * t, |_| 0.7).unwrap();
            assert!((f64::from(cycles) * 1e-3 * speed) < 0.0055, "{speed}: {cycles}");
            assert!(name == "not_following" || speed > 0.25, "{name}");
        }
        // Frozen on the way: no later than after twice that.
        let (cycles, _) = told(|t| 0.1 * t, |t| 0.1 * t.min(1.0)).unwrap();
        assert!((1000..1100).contains(&cycles), "{cycles}");
    }

    #[test]
    fn what_freezes_in_motion_is_told_within_a_few_cycles() {
        for speed in [0.1, 0.2, 0.4] {
            let (cycles, name) = told(|t| speed * t, |t| speed * t.min(1.0)).unwrap();
            assert!(name == "not_following" && (1003..1006).contains(&cycles), "{speed}: {cycles}");
        }
    }

    #[test]
    fn what_goes_the_other_way_or_runs_off_is_told() {
        assert_eq!(told(|t| 0.1 * t, |t| -0.1 * t).map(|told| told.1), Some("not_following"));
        assert_eq!(told(|t| 0.1 * t, |t| 0.5 * t).map(|told| told.1), Some("speed_gap"));
        assert_eq!(told(|_| 0.1, |t| 0.4 * t).map(|told| told.1), Some("speed_gap"));
        assert_eq!(told(|_| 0.1, |_| 0.1), None);
    }
}
