//! What is measured, held against the limits cycle by cycle.
//!
//! Whether the encoder has lost count shows in three ways. A **jump**: in one cycle the joint goes farther than it ever could. A **kink**:
//! its way changes from one cycle to the next as no torque can change it. A **slip**: in one cycle it goes farther than in those before and
//! after, which are alike. A joint that did so would be accelerated and braked within two cycles: an impact stops it at most, so the way of
//! its neighbours is allowed, and so are `SLIP_ACCELERATIONS` of the limit of acceleration. An answer with an old position is corrected by
//! the next one and is not a slip. Below that acceleration a slip cannot be distinguished from motion of the joint.

use super::cause::{Beyond, Cause};
use super::limits::{Limits, SPEED_ROOM};

/// How many times the limit of speed a jump of the position is: no joint gets there in one cycle.
const JUMP_SPEEDS: f64 = 5.0;
/// The same for the change of this travel from one cycle to the next, beyond what any torque can do to a joint within a cycle.
const KINK_SPEEDS: f64 = 2.0;
/// How many times the limit of acceleration takes a slip for a motion ...
const SLIP_ACCELERATIONS: f64 = 10.0;
/// ... and what share of the way of a cycle at the limit of speed.
const SLIP_SPEEDS: f64 = 0.1;
/// By how much the ways before and after a slip may differ, as a share of it.
const SLIP_ALIKE: f64 = 0.5;
/// Largest error that the encoder's counts add on a smooth motion: two counts for a kink, two for a slip, and noise.
const COUNTS: f64 = 4.0;
/// Cycles over which the measured speed is taken: in one, a count of the encoder more or less is a lot.
pub const SPEED_CYCLES: usize = 10;

/// What was measured in one cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// rad.
    pub position_rad: f64,
    /// At the sensor, N m; nothing where the sensor says nothing of use.
    pub torque_nm: Option<f64>,
    /// Where the joint was told to be when this was measured, rad; only where it should follow.
    pub command_rad: Option<f64>,
    /// Periods since the last measurement: 1, and more after missed cycles.
    pub periods: u32,
}

/// The limits, watching what is measured cycle by cycle.
#[derive(Debug, Clone)]
pub struct Watch {
    limits: Limits,
    period_s: f64,
    /// A count of the encoder, rad.
    count_rad: f64,
    last: Option<Measured>,
    /// Positions of the last cycles, the newest last, with the periods that each took.
    recent: Vec<(f64, u32)>,
    /// By how much the last position had jumped, rad.
    jumped_rad: Option<f64>,
}

impl Watch {
    /// Watches measurements every `period_s` of an encoder that counts in steps of `count_rad`.
    pub fn new(limits: Limits, period_s: f64, count_rad: f64) -> Self {
        Self { limits, period_s, count_rad, last: None, recent: Vec::with_capacity(SPEED_CYCLES + 1), jumped_rad: None }
    }

    /// The measured speed over the last cycles, rad/s; 0 until there are enough.
    pub fn speed_rad_s(&self) -> f64 {
        let (Some(first), Some(last)) = (self.recent.first(), self.recent.last()) else { return 0.0 };
        let periods: u32 = self.recent[1..].iter().map(|(_, periods)| periods).sum();
        if self.recent.len() <= SPEED_CYCLES { 0.0 } else { (last.0 - first.0) / (f64::from(periods) * self.period_s) }
    }

    /// The least speed that the joint can have had over the last two cycles, as far as its encoder counts, rad/s: sooner to tell that it
    /// runs away than [`Self::speed_rad_s`].
    pub fn surely_rad_s(&self) -> f64 {
        let [.., (first, _), (_, one), (last, other)] = self.recent[..] else { return 0.0 };
        let moved_rad = (last - first).abs() - COUNTS * self.count_rad;
        moved_rad.max(0.0) / (f64::from(one + other) * self.period_s)
    }

    /// The last measured position, rad.
    pub fn position_rad(&self) -> Option<f64> {
        self.last.map(|last| last.position_rad)
    }

    /// By how much the last measured position had jumped, rad, if it had: no joint goes so far in a cycle, so it is the encoder.
    pub fn jumped_rad(&self) -> Option<f64> {
        self.jumped_rad
    }

    /// The first limit that `now` breaks.
    pub fn step(&mut self, now: &Measured) -> Option<Cause> {
        if self.recent.len() > SPEED_CYCLES {
            self.recent.remove(0);
        }
        self.recent.push((now.position_rad, now.periods));
        let last = self.last.replace(*now);
        let limits = &self.limits;
        let above = |found: f64, limit: f64| (found.is_nan() || found > limit).then_some(Beyond { found, limit });
        let (step_rad, counts_rad) = (limits.speed_rad_s * self.period_s, COUNTS * self.count_rad);
        let jump_rad = JUMP_SPEEDS * step_rad * f64::from(now.periods) + counts_rad;
        let jumped = last.and_then(|last| above((now.position_rad - last.position_rad).abs(), jump_rad));
        let kink = self.kink_rad().and_then(|kink_rad| above(kink_rad, KINK_SPEEDS * step_rad + counts_rad));
        let slip = self.slip_rad(step_rad).filter(|_| kink.is_none());
        let moved_rad = last.map_or(0.0, |last| now.position_rad - last.position_rad);
        self.jumped_rad = kink.map(|_| moved_rad).or(slip.map(|(slip_rad, _)| slip_rad)).filter(|rad| rad.is_finite());
        let jumped = jumped.or(kink).or(slip.and_then(|(slip_rad, limit)| above(slip_rad.abs(), limit)));
        let torque_step = last.and_then(|last| Some((now.torque_nm? - last.torque_nm?).abs()));
        let torque_step = torque_step.and_then(|step| above(step, limits.torque_step_nm * f64::from(now.periods)));
        let lag = now.command_rad.and_then(|command| above((command - now.position_rad).abs(), limits.lag_rad));
        let speed = above(self.speed_rad_s().abs(), SPEED_ROOM * limits.speed_rad_s);
        // What explains the others comes first.
        jumped
            .map(Cause::EncoderJump)
            .or(torque_step.map(Cause::TorqueStep))
            .or_else(|| now.torque_nm.and_then(|torque| above(torque.abs(), limits.torque_nm)).map(Cause::Torque))
            .or_else(|| self.outside(now.position_rad).map(Cause::Position))
            .or(speed.map(Cause::Speed))
            .or(lag.map(Cause::Lag))
    }

    /// By how much the way of the last cycle differs from that of the one before, where neither was missed, rad.
    fn kink_rad(&self) -> Option<f64> {
        let [.., (first, _), (second, 1), (third, 1)] = self.recent[..] else { return None };
        Some(((third - second) - (second - first)).abs())
    }

    /// By how much the way of the last cycle but one differs from its neighbours, which are alike, and what a joint may; nothing where it
    /// may do that, or a cycle was missed.
    fn slip_rad(&self, step_rad: f64) -> Option<(f64, f64)> {
        let [.., (first, _), (second, 1), (third, 1), (fourth, 1)] = self.recent[..] else { return None };
        let (before, way, after) = (second - first, third - second, fourth - third);
        let aside = (before + after) / 2.0;
        let slip_rad = way - aside;
        let accelerated_rad = SLIP_ACCELERATIONS * self.limits.acceleration_rad_s2 * self.period_s.powi(2);
        let limit = aside.abs() + accelerated_rad.max(SLIP_SPEEDS * step_rad) + COUNTS * self.count_rad;
        let is_alike = (after - before).abs() <= SLIP_ALIKE * slip_rad.abs();
        (is_alike && slip_rad.abs() > limit).then_some((slip_rad, limit))
    }

    /// How far outside its range the joint is, with the room that following its command takes.
    fn outside(&self, position_rad: f64) -> Option<Beyond> {
        let (low, high) = (self.limits.low_rad - self.limits.lag_rad, self.limits.high_rad + self.limits.lag_rad);
        if position_rad < low {
            Some(Beyond { found: position_rad, limit: low })
        } else {
            (position_rad.is_nan() || position_rad > high).then_some(Beyond { found: position_rad, limit: high })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::limits::EXAMPLE as LIMITS;
    use super::*;

    /// A count of an encoder as servo drives have it.
    const COUNT_RAD: f64 = 1e-5;

    fn at(position_rad: f64) -> Measured {
        Measured { position_rad, torque_nm: Some(0.5), command_rad: Some(position_rad), periods: 1 }
    }

    /// The cause that comes up when `then` follows a second of rest at 0.5 rad.
    fn after_rest(then: Measured) -> Option<Cause> {
        let mut watch = Watch::new(LIMITS, 0.001, COUNT_RAD);
        assert!((0..1000).all(|_| watch.step(&at(0.5)).is_none()));
        watch.step(&then)
    }

    #[test]
    fn what_is_within_passes() {
        let mut watch = Watch::new(LIMITS, 0.001, COUNT_RAD);
        let moves = (0..2000).map(|i| at(0.1 + 0.49e-3 * f64::from(i)));
        assert!(moves.map(|m| watch.step(&m)).all(|cause| cause.is_none()));
        assert!((watch.speed_rad_s() - 0.49).abs() < 1e-9);
    }

    #[test]
    fn each_limit_is_told_by_name() {
        let name = |m: Measured| after_rest(m).map(|cause| cause.name());
        assert_eq!(name(Measured { position_rad: 0.6, ..at(0.6) }), Some("encoder_jump"));
        assert_eq!(name(Measured { position_rad: 0.5012, ..at(0.5012) }), Some("encoder_jump"));
        // What a joint could have begun to do is told once it has not gone on.
        assert_eq!(name(Measured { position_rad: 0.5008, ..at(0.5008) }), None);
        assert_eq!(name(Measured { position_rad: f64::NAN, ..at(0.5) }), Some("encoder_jump"));
        assert_eq!(name(Measured { torque_nm: Some(0.1), ..at(0.5) }), Some("torque_step"));
        assert_eq!(name(Measured { command_rad: Some(0.56), ..at(0.5) }), Some("lag"));
        assert_eq!(name(Measured { torque_nm: None, ..at(0.5) }), None);
    }

    #[test]
    fn what_creeps_beyond_is_told_too() {
        let run = |measured: &dyn Fn(f64) -> Measured| {
            let mut watch = Watch::new(LIMITS, 0.001, COUNT_RAD);
            (0..20_000).find_map(|i| watch.step(&measured(f64::from(i) * 1e-3))).map(|cause| cause.name())
        };
        assert_eq!(run(&|t| at(0.5 + 0.4 * t)), Some("position"));
        assert_eq!(run(&|t| at(0.5 - 0.4 * t)), Some("position"));
        assert_eq!(run(&|t| at(0.7 * t)), Some("speed"));
        assert_eq!(run(&|t| Measured { torque_nm: Some(0.5 + t), ..at(0.5) }), Some("torque"));
    }

    /// By how much the position has jumped, as it is told, where it goes `way(i)` in cycle `i`; counted in steps of `count_rad`.
    fn slipped(count_rad: f64, way: impl Fn(u32) -> f64) -> Option<(u32, f64)> {
        let mut watch = Watch::new(LIMITS, 0.001, count_rad);
        let mut position_rad = 0.5;
        (0..200).find_map(|i| {
            position_rad += way(i);
            let counted_rad = (position_rad / count_rad).round() * count_rad;
            let told = watch.step(&at(counted_rad)).map(|cause| cause.name());
            assert!(told.is_none_or(|name| name == "encoder_jump"), "{told:?}");
            told.map(|_| (i, watch.jumped_rad().unwrap()))
        })
    }

    #[test]
    fn a_position_that_jumps_by_less_than_a_motion_is_told_one_cycle_later() {
        for (speed, jump) in
            [(0.0, 0.2e-3), (0.0, -0.2e-3), (0.1, 0.3e-3), (0.4, 0.6e-3), (0.4, -0.6e-3), (-0.4, 0.6e-3)]
        {
            let (cycle, told) = slipped(COUNT_RAD, |i| speed * 1e-3 + if i == 100 { jump } else { 0.0 }).unwrap();
            assert!(cycle == 101 && (told - jump).abs() < 5e-5, "{speed} rad/s, {jump} rad: {told} rad after {cycle}");
        }
    }

    #[test]
    fn what_joints_and_buses_do_is_no_jump() {
        let steady = 0.4e-3;
        // Stopped by an impact for a cycle; thrown back for good; released; at the limit of acceleration.
        let stopped = |i: u32| if i == 100 { 0.0 } else { steady };
        let thrown = |i: u32| if i < 100 { steady } else { -steady };
        let released = |i: u32| if i < 100 { 0.0 } else { steady };
        let wave = |i: u32| 0.1e-3 * (f64::from(i) * 0.08).sin();
        for motion in [&stopped as &dyn Fn(u32) -> f64, &thrown, &released, &wave] {
            assert_eq!(slipped(COUNT_RAD, motion), None);
        }
        // Answers that bring the last position once more, by a cycle or by half.
        for late in [1.0, 0.5] {
            let jittered = |i: u32| match i {
                100 => (1.0 - late) * steady,
                101 | 104 => (1.0 + late) * steady,
                103 => (1.0 - late) * steady,
                _ => steady,
            };
            assert_eq!(slipped(COUNT_RAD, jittered), None);
            let kept = |i: u32| match i {
                100 => (1.0 - late) * steady,
                105 => (1.0 + late) * steady,
                _ => steady,
            };
            assert_eq!(slipped(COUNT_RAD, kept), None);
        }
        // A coarse encoder: of a quarter of the way of a cycle at the limit of speed, and of one and a half.
        for count_rad in [0.125e-3, 0.75e-3] {
            for speed in [0.03e-3, 0.11e-3, 0.31e-3, 0.49e-3] {
                assert_eq!(slipped(count_rad, |_| speed), None, "{count_rad} {speed}");
            }
        }
    }

    #[test]
    fn missed_cycles_are_allowed_for() {
        let mut watch = Watch::new(LIMITS, 0.001, COUNT_RAD);
        assert_eq!(watch.step(&at(0.5)), None);
        let late = Measured { periods: 3, torque_nm: Some(1.1), ..at(0.507) };
        assert_eq!(watch.step(&late), None);
    }
}
