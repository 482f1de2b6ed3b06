//! What the joint may do: the same limits for what is commanded and for what is measured.

use super::cause::{Beyond, Cause};
use crate::document::Section;

/// Limits of a joint; for a prismatic one `_rad` is m and `_nm` is N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Lower end of its range, rad.
    pub low_rad: f64,
    /// Upper end, rad.
    pub high_rad: f64,
    /// rad/s.
    pub speed_rad_s: f64,
    /// Of the command, rad/s^2.
    pub acceleration_rad_s2: f64,
    /// At the sensor, N m.
    pub torque_nm: f64,
    /// Largest change of the torque from one sample to the next, N m.
    pub torque_step_nm: f64,
    /// Largest distance from the command, rad.
    pub lag_rad: f64,
    /// Speed of the moves between trials, rad/s.
    pub approach_rad_s: f64,
    /// Way that may be commanded before the joint must be seen to follow, rad.
    pub stuck_rad: f64,
    /// Way that a stop may take, rad: beyond it voltage is taken away at once.
    pub stop_rad: f64,
}

/// By how much the measured speed may be above the limit, as a share: noise and the controller's own swing.
pub const SPEED_ROOM: f64 = 1.25;
/// How many times the limit of speed a jump of the position is: no joint gets there in one cycle.
const JUMP_SPEEDS: f64 = 5.0;
/// The same of its change from one cycle to the next: what no torque can do to a joint in a cycle.
const KINK_SPEEDS: f64 = 2.0;
/// Share of the largest lag by which a command may go on before the joint must be seen to follow, where the rig says nothing else.
const STUCK: f64 = 0.1;
/// A move between trials at less than this takes half an hour and more, rad/s.
const SLOWEST_RAD_S: f64 = 0.001;
/// Cycles over which the measured speed is taken: in one, a count of the encoder more or less is a lot.
pub const SPEED_CYCLES: usize = 10;

impl Limits {
    /// Reads `[limits]`.
    pub fn read(section: &Section<'_>) -> Option<Self> {
        let positive = |key, example, means| section.need(key).such_as(example, means).positive();
        let low_rad = section.need("low_rad").such_as("-0.1", "the lowest position, rad").number();
        let high_rad = section.need("high_rad").such_as("1.7", "the highest position, rad").number();
        let speed_rad_s = positive("speed_rad_s", "0.6", "the highest speed, rad/s");
        let acceleration_rad_s2 = positive("acceleration_rad_s2", "8.0", "of commands, rad/s^2");
        let torque_nm = positive("torque_nm", "2.0", "the largest torque at the sensor, N m");
        let torque_step_nm = positive("torque_step_nm", "0.3", "the largest change from one sample to the next, N m");
        let lag_rad = positive("lag_rad", "0.05", "the largest distance from the command, rad");
        let approach_rad_s = section.may("approach_rad_s").positive();
        let stuck_rad = section.may("stuck_rad").positive();
        let stop_rad = section.may("stop_rad").positive();
        if let (Some(low), Some(high)) = (low_rad, high_rad)
            && low >= high
        {
            section.reject("high_rad", format!("is {high}, low_rad {low}"), "high_rad must be above low_rad");
        }
        let speed_rad_s = speed_rad_s?;
        if approach_rad_s.is_some_and(|approach| approach < SLOWEST_RAD_S) {
            let cure = format!("expected {SLOWEST_RAD_S} at least: moves between trials would take hours");
            section.reject("approach_rad_s", "is next to nothing", cure);
        }
        if approach_rad_s.is_some_and(|approach| approach > speed_rad_s) {
            section.reject("approach_rad_s", "is above speed_rad_s", "approach more slowly than that");
        }
        Some(Self {
            low_rad: low_rad?,
            high_rad: high_rad?,
            speed_rad_s,
            acceleration_rad_s2: acceleration_rad_s2?,
            torque_nm: torque_nm?,
            torque_step_nm: torque_step_nm?,
            lag_rad: lag_rad?,
            approach_rad_s: approach_rad_s.unwrap_or(speed_rad_s / 4.0),
            stuck_rad: stuck_rad.unwrap_or(STUCK * lag_rad?),
            // v^2 / 2a, as far as the command's own ramp would take, and what it may lag behind that.
            stop_rad: stop_rad.unwrap_or(speed_rad_s.powi(2) / (2.0 * acceleration_rad_s2?) + lag_rad?),
        })
    }

    /// The first of `positions_rad`, commanded every `period_s` to a joint that rests at the first of them, that is outside: its
    /// index and why.
    pub fn first_beyond(&self, positions_rad: &[f64], period_s: f64) -> Option<(usize, &'static str, Beyond)> {
        let beyond = |found: f64, limit: f64| Beyond { found, limit };
        let speed = |i: usize| (positions_rad[i] - positions_rad[i.saturating_sub(1)]) / period_s;
        (0..positions_rad.len()).find_map(|i| {
            let at = positions_rad[i];
            let fault = if !at.is_finite() || at < self.low_rad {
                Some(("position, rad", beyond(at, self.low_rad)))
            } else if at > self.high_rad {
                Some(("position, rad", beyond(at, self.high_rad)))
            } else if speed(i).abs() > self.speed_rad_s {
                Some(("speed, rad/s", beyond(speed(i).abs(), self.speed_rad_s)))
            } else {
                let found = (speed(i) - speed(i.saturating_sub(1))).abs() / period_s;
                let is_beyond = found > self.acceleration_rad_s2;
                is_beyond.then_some(("acceleration, rad/s^2", beyond(found, self.acceleration_rad_s2)))
            };
            fault.map(|(what, beyond)| (i, what, beyond))
        })
    }

    /// Whether `command_rad` may follow `before_rad` within `period_s`. A joint that hangs a little outside its range, as far as
    /// its lag allows, may be led back into it.
    pub fn check_command(&self, before_rad: f64, command_rad: f64, period_s: f64) -> Option<Cause> {
        /// What is lost in counting: a command at the limit is within it.
        const ROUNDING: f64 = 1.0 + 1e-6;
        let speed = (command_rad - before_rad).abs() / period_s;
        let fault = |found, limit| Some(Cause::Command(Beyond { found, limit }));
        if command_rad.is_nan() || command_rad < self.low_rad.min(before_rad) - 1e-6 {
            fault(command_rad, self.low_rad)
        } else if command_rad > self.high_rad.max(before_rad) + 1e-6 {
            fault(command_rad, self.high_rad)
        } else if speed > self.speed_rad_s * ROUNDING {
            fault(speed, self.speed_rad_s)
        } else {
            None
        }
    }
}

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
    last: Option<Measured>,
    /// Positions of the last cycles, the newest last, with the periods that each took.
    recent: Vec<(f64, u32)>,
}

impl Watch {
    /// Watches measurements every `period_s`.
    pub fn new(limits: Limits, period_s: f64) -> Self {
        Self { limits, period_s, last: None, recent: Vec::with_capacity(SPEED_CYCLES + 1) }
    }

    /// The measured speed over the last cycles, rad/s; 0 until there are enough.
    pub fn speed_rad_s(&self) -> f64 {
        let (Some(first), Some(last)) = (self.recent.first(), self.recent.last()) else { return 0.0 };
        let periods: u32 = self.recent[1..].iter().map(|(_, periods)| periods).sum();
        if self.recent.len() <= SPEED_CYCLES { 0.0 } else { (last.0 - first.0) / (f64::from(periods) * self.period_s) }
    }

    /// The last measured position, rad.
    pub fn position_rad(&self) -> Option<f64> {
        self.last.map(|last| last.position_rad)
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
        let jump_rad = JUMP_SPEEDS * limits.speed_rad_s * self.period_s * f64::from(now.periods);
        let jumped = last.and_then(|last| above((now.position_rad - last.position_rad).abs(), jump_rad));
        let kink =
            self.kink_rad().and_then(|kink_rad| above(kink_rad, KINK_SPEEDS * limits.speed_rad_s * self.period_s));
        let jumped = jumped.or(kink);
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

/// Limits of a joint that tests are made with.
#[cfg(test)]
pub(super) const EXAMPLE: Limits = Limits {
    low_rad: 0.0,
    high_rad: 1.5,
    speed_rad_s: 0.5,
    acceleration_rad_s2: 8.0,
    torque_nm: 2.0,
    torque_step_nm: 0.3,
    lag_rad: 0.05,
    approach_rad_s: 0.1,
    stuck_rad: 0.005,
    stop_rad: 0.1,
};

#[cfg(test)]
mod tests {
    use super::EXAMPLE as LIMITS;
    use super::*;

    fn at(position_rad: f64) -> Measured {
        Measured { position_rad, torque_nm: Some(0.5), command_rad: Some(position_rad), periods: 1 }
    }

    /// The cause that comes up when `then` follows a second of rest at 0.5 rad.
    fn after_rest(then: Measured) -> Option<Cause> {
        let mut watch = Watch::new(LIMITS, 0.001);
        assert!((0..1000).all(|_| watch.step(&at(0.5)).is_none()));
        watch.step(&then)
    }

    #[test]
    fn what_is_within_passes() {
        let mut watch = Watch::new(LIMITS, 0.001);
        let moves = (0..2000).map(|i| at(0.1 + 0.49e-3 * f64::from(i)));
        assert!(moves.map(|m| watch.step(&m)).all(|cause| cause.is_none()));
        assert!((watch.speed_rad_s() - 0.49).abs() < 1e-9);
    }

    #[test]
    fn each_limit_is_told_by_name() {
        let name = |m: Measured| after_rest(m).map(|cause| cause.name());
        assert_eq!(name(Measured { position_rad: 0.6, ..at(0.6) }), Some("encoder_jump"));
        assert_eq!(name(Measured { position_rad: 0.5012, ..at(0.5012) }), Some("encoder_jump"));
        assert_eq!(name(Measured { position_rad: 0.5008, ..at(0.5008) }), None);
        assert_eq!(name(Measured { position_rad: f64::NAN, ..at(0.5) }), Some("encoder_jump"));
        assert_eq!(name(Measured { torque_nm: Some(0.1), ..at(0.5) }), Some("torque_step"));
        assert_eq!(name(Measured { command_rad: Some(0.56), ..at(0.5) }), Some("lag"));
        assert_eq!(name(Measured { torque_nm: None, ..at(0.5) }), None);
    }

    #[test]
    fn what_creeps_beyond_is_told_too() {
        let run = |measured: &dyn Fn(f64) -> Measured| {
            let mut watch = Watch::new(LIMITS, 0.001);
            (0..20_000).find_map(|i| watch.step(&measured(f64::from(i) * 1e-3))).map(|cause| cause.name())
        };
        assert_eq!(run(&|t| at(0.5 + 0.4 * t)), Some("position"));
        assert_eq!(run(&|t| at(0.5 - 0.4 * t)), Some("position"));
        assert_eq!(run(&|t| at(0.7 * t)), Some("speed"));
        assert_eq!(run(&|t| Measured { torque_nm: Some(0.5 + t), ..at(0.5) }), Some("torque"));
    }

    #[test]
    fn missed_cycles_are_allowed_for() {
        let mut watch = Watch::new(LIMITS, 0.001);
        assert_eq!(watch.step(&at(0.5)), None);
        let late = Measured { periods: 3, torque_nm: Some(1.1), ..at(0.507) };
        assert_eq!(watch.step(&late), None);
    }

    #[test]
    fn commands_are_checked_before_they_are_sent() {
        // Up to 0.4 rad/s at 4 rad/s^2.
        let sweep: Vec<f64> = (0..100).map(|i| 2e-6 * f64::from(i).powi(2)).collect();
        assert_eq!(LIMITS.first_beyond(&sweep, 0.001), None);
        let what = |positions: &[f64]| LIMITS.first_beyond(positions, 0.001).map(|(i, what, _)| (i, what));
        assert_eq!(what(&[0.0, 0.000004, -0.1]), Some((2, "position, rad")));
        assert_eq!(what(&[0.0, 0.0006]), Some((1, "speed, rad/s")));
        assert_eq!(what(&[0.0, 0.0, 0.0004]), Some((2, "acceleration, rad/s^2")));
        assert_eq!(what(&[0.0, 0.0004]), Some((1, "acceleration, rad/s^2")));
        assert_eq!(LIMITS.check_command(0.1, 0.1005, 0.001), None);
        assert!(LIMITS.check_command(0.1, 0.102, 0.001).is_some());
        assert!(LIMITS.check_command(1.5, 1.501, 0.001).is_some());
        assert!(
            LIMITS.check_command(1.52, 1.5203, 0.001).is_some()
                && LIMITS.check_command(-0.02, -0.0203, 0.001).is_some()
        );
        assert!(
            LIMITS.check_command(1.52, 1.5197, 0.001).is_none()
                && LIMITS.check_command(-0.02, -0.0197, 0.001).is_none()
        );
        assert!(LIMITS.check_command(0.5, f64::NAN, 0.001).is_some());
    }
}
