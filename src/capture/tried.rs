//! The first motion with torque: small, slow, up and back. It shows whether the signs of drive and sensor fit each other.
//!
//! Friction acts against every motion. So at the winch the torque going up is above that going down, at the same positions, by
//! twice the friction, whatever the load. Where the difference is negative beyond the sensor's noise, the position or the torque has
//! the wrong sign. What this cannot show: both signs wrong at once, which differ only by gravity, and that vanishes where a
//! joint hangs.

use super::ramp::Ramp;
use super::rig::Rig;

/// How far it goes: 2 degrees.
pub(super) const TRIED_RAD: f64 = 0.035;
/// The most of the joint's range that this may be.
const SHARE_OF_RANGE: f64 = 0.05;
/// Its highest speed, rad/s, where the approach is not slower.
const SPEED_RAD_S: f64 = 0.04;
/// Share of the limit of acceleration that it takes.
const GENTLE: f64 = 0.1;
/// A difference is significant from this many of its standard errors on, and from this share of the limit of torque.
const ERRORS: f64 = 5.0;
const SHARE_OF_TORQUE: f64 = 0.002;

/// Up and back from `from_rad`, sampled every period: away from the nearer end of the range; back no farther than to its end, where
/// the joint hangs outside.
pub(super) fn motion(rig: &Rig, from_rad: f64) -> [Vec<f64>; 2] {
    let (limits, period_s) = (&rig.limits, rig.bus.period_s());
    let way_rad = TRIED_RAD.min(SHARE_OF_RANGE * (limits.high_rad - limits.low_rad));
    let is_low = from_rad < (limits.low_rad + limits.high_rad) / 2.0;
    let to_rad = if is_low { from_rad + way_rad } else { from_rad - way_rad };
    let speed_rad_s = SPEED_RAD_S.min(limits.approach_rad_s);
    let sampled = |from_rad, to_rad| {
        let ramp = Ramp::new(from_rad, to_rad, speed_rad_s, GENTLE * limits.acceleration_rad_s2);
        ramp.positions_rad(period_s)
    };
    [sampled(from_rad, to_rad), sampled(to_rad, from_rad.clamp(limits.low_rad, limits.high_rad))]
}

/// Whether the signs of drive and sensor fit each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Fit {
    /// They do.
    Fits,
    /// They do not: torque up less torque down, N m.
    Opposed(f64),
    /// There is too little friction to tell.
    Unknown,
}

/// What the torques of the two ways, going up and going down, say of the signs, and in words.
pub(super) fn signs(rig: &Rig, up_nm: &[f64], down_nm: &[f64]) -> (Fit, String) {
    let (up, down) = (middle(up_nm), middle(down_nm));
    let difference_nm = rig.signal.torque_sign * (up.0 - down.0);
    let error_nm = ERRORS * (up.1.powi(2) + down.1.powi(2)).sqrt() + SHARE_OF_TORQUE * rig.limits.torque_nm;
    let told = format!("torque up less torque down {difference_nm:+.4} N m, what it takes to tell {error_nm:.4} N m");
    if difference_nm < -error_nm {
        (Fit::Opposed(difference_nm), format!("THE SIGNS OF DRIVE AND SENSOR DO NOT FIT EACH OTHER ({told})"))
    } else if difference_nm > error_nm {
        (Fit::Fits, format!("the signs of drive and sensor fit each other ({told})"))
    } else {
        (Fit::Unknown, format!("WHETHER THE SIGNS FIT CANNOT BE TOLD, there is too little friction ({told})"))
    }
}

/// Mean of the middle half, where the motion is neither beginning nor ending, and its standard error.
fn middle(torques_nm: &[f64]) -> (f64, f64) {
    let quarter = torques_nm.len() / 4;
    let inner = &torques_nm[quarter..torques_nm.len() - quarter];
    let count = inner.len().max(1) as f64;
    let mean = inner.iter().sum::<f64>() / count;
    let variance = inner.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    (mean, (variance / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig() -> Rig {
        Rig::parse("rig.toml".as_ref(), include_str!("../../data/rigs/demo/rig.toml")).unwrap()
    }

    #[test]
    fn the_first_motion_is_small_slow_and_within_the_range() {
        let rig = rig();
        for from_rad in [rig.limits.low_rad, 0.0, 0.9, rig.limits.high_rad] {
            let [there, back] = motion(&rig, from_rad);
            let all: Vec<f64> = there.iter().chain(&back).copied().collect();
            assert!(all.iter().all(|at| (rig.limits.low_rad..=rig.limits.high_rad).contains(at)));
            assert!(all.iter().all(|at| (at - from_rad).abs() <= TRIED_RAD + 1e-12));
            assert!(all.windows(2).all(|pair| (pair[1] - pair[0]).abs() <= 1.001 * SPEED_RAD_S * 1e-3));
            assert!((back.last().unwrap() - from_rad).abs() < 1e-12);
        }
    }

    #[test]
    fn torque_must_be_larger_going_up() {
        let rig = rig();
        let noisy =
            |mean: f64| (0..1000).map(|i| mean + 0.005 * f64::from(i * 7919 % 13 - 6) / 6.0).collect::<Vec<_>>();
        let told = |up, down| signs(&rig, &noisy(up), &noisy(down));
        assert!(told(0.1, 0.06).1.contains("fit each other"));
        assert!(matches!(told(0.06, 0.1).0, Fit::Opposed(_)));
        let unknown = told(0.1, 0.0995);
        assert!(unknown.0 == Fit::Unknown && unknown.1.contains("CANNOT BE TOLD"), "{unknown:?}");
        assert_eq!(signs(&rig, &[], &[]).0, Fit::Unknown);
    }
}
