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
/// Share of the largest lag by which a command may go on before the joint must be seen to follow, where the rig says nothing else.
const STUCK: f64 = 0.1;
/// A move between trials at less than this takes half an hour and more, rad/s.
const SLOWEST_RAD_S: f64 = 0.001;

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
