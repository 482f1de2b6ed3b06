//! The last step before the wire: what is sent is kept within the limits, in every mode and whatever was computed before.

use super::limits::Limits;

/// What the drive is told to follow, in SI units of the joint.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sent {
    /// Target position, rad.
    pub position_rad: f64,
    /// Target speed, rad/s.
    pub speed_rad_s: f64,
    /// Target torque at the winch, N m.
    pub torque_nm: f64,
}

/// Where the joint is, as far as it is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    /// Measured, rad.
    pub position_rad: f64,
    /// Measured, rad/s.
    pub speed_rad_s: f64,
}

/// How many times the limit of acceleration a target speed may change with: corrections need some room beyond the plan.
const SLEW: f64 = 2.0;
/// Share of the limit of speed beyond it within which a driving torque fades: cut off at once it would shake the joint.
const FADES: f64 = 0.25;
/// What is lost in counting: a step at the limit of speed is within it.
const ROUNDING: f64 = 1.0 + 1e-6;

/// `wanted`, kept within `limits` and the drive's torque of `torque_max_nm`, `period_s` after `last` was sent. What is not a number is
/// replaced by standing still.
///
/// A target position moves no faster than the limit of speed and not out of the range (from outside only towards it). A target
/// speed changes no faster than `SLEW` times the limit of acceleration and leaves room to brake before an end of the range, by
/// v^2 <= 2 a d. A torque that drives the joint on fades from all the drive may give, at the limit of speed, to none.
pub fn bounded(wanted: Sent, last: Sent, at: At, limits: &Limits, torque_max_nm: f64, period_s: f64) -> Sent {
    let or = |value: f64, other: f64| if value.is_finite() { value } else { other };
    let step_rad = limits.speed_rad_s * period_s * ROUNDING;
    let position_rad = or(wanted.position_rad, last.position_rad)
        .clamp(last.position_rad - step_rad, last.position_rad + step_rad)
        .clamp(limits.low_rad.min(last.position_rad), limits.high_rad.max(last.position_rad));
    let slew_rad_s = SLEW * limits.acceleration_rad_s2 * period_s;
    let speed_rad_s = or(wanted.speed_rad_s, 0.0).clamp(last.speed_rad_s - slew_rad_s, last.speed_rad_s + slew_rad_s);
    // A joint that follows with some lag may be told to go on to the very end of its range.
    let room_rad = limits.lag_rad;
    let braking = |distance_rad: f64| (2.0 * limits.acceleration_rad_s2 * distance_rad.max(0.0)).sqrt();
    let here_rad = or(at.position_rad, last.position_rad);
    let down = braking(here_rad - limits.low_rad + room_rad).min(limits.speed_rad_s);
    let up = braking(limits.high_rad + room_rad - here_rad).min(limits.speed_rad_s);
    let speed_rad_s = speed_rad_s.clamp(-down, up);
    let torque_nm = or(wanted.torque_nm, 0.0).clamp(-torque_max_nm, torque_max_nm);
    let is_driven = torque_nm * at.speed_rad_s > 0.0;
    let left = (1.0 + FADES - at.speed_rad_s.abs() / limits.speed_rad_s) / FADES;
    let driving_nm = if is_driven { torque_max_nm * left.clamp(0.0, 1.0) } else { torque_max_nm };
    Sent { position_rad, speed_rad_s, torque_nm: torque_nm.clamp(-driving_nm, driving_nm) }
}

#[cfg(test)]
mod tests {
    use super::super::limits::EXAMPLE as LIMITS;
    use super::*;

    const PERIOD_S: f64 = 0.001;

    fn sent(position_rad: f64, speed_rad_s: f64, torque_nm: f64) -> Sent {
        Sent { position_rad, speed_rad_s, torque_nm }
    }

    /// Whatever is wanted, and whatever is measured.
    #[test]
    fn nothing_beyond_the_limits_is_ever_sent() {
        let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e9, -3.0, -0.4, 0.0, 1e-4, 0.7, 1.6, 1e9];
        let positions = [f64::NAN, -0.2, 0.0, 0.001, 0.75, 1.499, 1.5, 1.56, 9.0];
        for wanted in values {
            for position_rad in positions {
                for speed_rad_s in [f64::NAN, -2.0, -0.3, 0.0, 0.4, 3.0] {
                    let at = At { position_rad, speed_rad_s };
                    let mut last = sent(0.75, 0.0, 0.0);
                    for _ in 0..5000 {
                        let now = bounded(sent(wanted, wanted, wanted), last, at, &LIMITS, 1.2, PERIOD_S);
                        assert!((0.0..=1.5).contains(&now.position_rad), "{now:?}");
                        assert!((now.position_rad - last.position_rad).abs() <= 0.5 * PERIOD_S * 1.00001, "{now:?}");
                        assert!(now.speed_rad_s.abs() <= 0.5 && now.torque_nm.abs() <= 1.2, "{now:?}");
                        last = now;
                    }
                }
            }
        }
    }

    #[test]
    fn a_speed_leaves_room_to_brake() {
        let at = |position_rad| At { position_rad, speed_rad_s: 0.0 };
        let go = |position_rad, speed| {
            bounded(sent(0.0, speed, 0.0), sent(0.0, speed, 0.0), at(position_rad), &LIMITS, 1.0, PERIOD_S).speed_rad_s
        };
        assert_eq!((go(0.75, 0.5), go(0.75, -0.5)), (0.5, -0.5));
        assert_eq!((go(1.56, 0.5), go(-0.06, -0.5)), (0.0, 0.0));
        assert!(go(1.545, 0.5) < 0.3 && go(1.545, -0.5) == -0.5);
    }

    #[test]
    fn a_joint_outside_its_range_is_led_into_it_only() {
        let at = At { position_rad: 1.52, speed_rad_s: 0.0 };
        let go = |to| bounded(sent(to, 0.0, 0.0), sent(1.52, 0.0, 0.0), at, &LIMITS, 1.0, PERIOD_S).position_rad;
        assert_eq!(go(1.6), 1.52);
        assert!(go(1.4) < 1.52);
    }

    #[test]
    fn torque_does_not_drive_on_what_is_too_fast() {
        let torque = |speed_rad_s, torque_nm| {
            let at = At { position_rad: 0.5, speed_rad_s };
            bounded(sent(0.5, 0.0, torque_nm), sent(0.5, 0.0, 0.0), at, &LIMITS, 1.0, PERIOD_S).torque_nm
        };
        assert_eq!((torque(0.63, 0.8), torque(0.63, -0.8), torque(0.5, 0.8)), (0.0, -0.8, 0.8));
        assert!((torque(0.6, 0.8) - 0.2).abs() < 1e-9 && (torque(-0.6, -0.8) + 0.2).abs() < 1e-9);
    }
}
