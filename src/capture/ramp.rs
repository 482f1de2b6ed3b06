//! Moves between trials, without a corner: half a cosine from where the joint is to where it should be.

use std::f64::consts::{FRAC_PI_2, PI};

/// A move from rest to rest: `from` + (`to` - `from`) (1 - cos(pi t / T)) / 2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ramp {
    from_rad: f64,
    to_rad: f64,
    duration_s: f64,
}

impl Ramp {
    /// The shortest one that goes neither faster than `speed_rad_s`, which it reaches in the middle (pi/2 distance / T), nor
    /// accelerates more than `acceleration_rad_s2`, as it does at its ends (pi^2/2 distance / T^2).
    pub fn new(from_rad: f64, to_rad: f64, speed_rad_s: f64, acceleration_rad_s2: f64) -> Self {
        let distance = (to_rad - from_rad).abs();
        let by_speed = FRAC_PI_2 * distance / speed_rad_s;
        let by_acceleration = PI * (distance / (2.0 * acceleration_rad_s2)).sqrt();
        Self { from_rad, to_rad, duration_s: by_speed.max(by_acceleration) }
    }

    /// How long it takes, s.
    pub fn duration_s(&self) -> f64 {
        self.duration_s
    }

    /// Where it is after each of the periods that it takes.
    pub fn positions_rad(&self, period_s: f64) -> Vec<f64> {
        let steps = (self.duration_s / period_s).ceil() as usize;
        (1..=steps).map(|step| self.position_rad(step as f64 * period_s)).collect()
    }

    /// Where it is after `time_s`, rad.
    pub fn position_rad(&self, time_s: f64) -> f64 {
        if time_s >= self.duration_s {
            return self.to_rad;
        }
        let share = (1.0 - (PI * time_s / self.duration_s).cos()) / 2.0;
        self.from_rad + share * (self.to_rad - self.from_rad)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_keeps_to_its_limits() {
        for (to_rad, speed, acceleration) in [(1.0, 0.2, 8.0), (1.0, 5.0, 0.5), (-0.3, 0.1, 1.0), (0.1, 0.1, 9.0)] {
            let ramp = Ramp::new(0.1, to_rad, speed, acceleration);
            let at: Vec<f64> =
                (0..=10_000).map(|i| ramp.position_rad(ramp.duration_s() * f64::from(i) / 1e4)).collect();
            assert_eq!((at[0], at[10_000]), (0.1, to_rad));
            let step = ramp.duration_s() / 1e4;
            if step == 0.0 {
                continue;
            }
            let speeds: Vec<f64> = at.windows(2).map(|pair| (pair[1] - pair[0]) / step).collect();
            assert!(speeds.iter().all(|v| v.abs() <= speed * (1.0 + 1e-6)));
            let steepest = speeds.windows(2).map(|pair| (pair[1] - pair[0]).abs() / step).fold(0.0, f64::max);
            assert!(steepest <= acceleration * (1.0 + 1e-3), "{steepest}");
        }
    }
}
