//! One piece of a motion, from rest to rest.

use std::f64::consts::{PI, TAU};

/// A piece of a motion; it begins where the one before ended. For a prismatic joint `_rad` holds metres.
#[derive(Debug, Clone, PartialEq)]
pub enum Segment {
    /// The joint rests.
    Rest {
        /// How long, s.
        duration_s: f64,
    },
    /// At one speed with ramps at both ends; without a plateau where there is no room for one.
    Sweep {
        /// Where it ends, rad.
        to_rad: f64,
        /// Speed of the plateau, rad/s.
        speed_rad_s: f64,
        /// Acceleration of the ramps, rad/s^2.
        acceleration_rad_s2: f64,
    },
    /// Whole periods of a cosine, from whichever end the joint is at.
    Cosine {
        /// Lower end, rad.
        low_rad: f64,
        /// Upper end, rad.
        high_rad: f64,
        /// Length of a period, s.
        period_s: f64,
        /// How many.
        periods: u32,
    },
    /// A sum of sines about where the joint is, faded in and out.
    Multisine {
        /// How long, s.
        duration_s: f64,
        /// How long it takes to fade in, and again to fade out, s.
        fade_s: f64,
        /// The sines.
        waves: Vec<Wave>,
    },
}

/// One sine: `amplitude_rad` sin(2 pi `frequency_hz` t + `phase_rad`).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Half its stroke, rad.
    pub amplitude_rad: f64,
    /// Hz.
    pub frequency_hz: f64,
    /// At the segment's beginning, rad.
    pub phase_rad: f64,
}

impl Segment {
    /// Where the joint is after it, from `from_rad`, rad.
    pub fn end_rad(&self, from_rad: f64) -> f64 {
        match self {
            Self::Sweep { to_rad, .. } => *to_rad,
            Self::Rest { .. } | Self::Cosine { .. } | Self::Multisine { .. } => from_rad,
        }
    }

    /// Of a sweep, the speed of its plateau, rad/s.
    pub(super) fn sweep_speed_rad_s(&self) -> Option<f64> {
        match self {
            Self::Sweep { speed_rad_s, .. } => Some(*speed_rad_s),
            Self::Rest { .. } | Self::Cosine { .. } | Self::Multisine { .. } => None,
        }
    }

    /// How long it takes from `from_rad`, s.
    pub fn duration_s(&self, from_rad: f64) -> f64 {
        match self {
            Self::Rest { duration_s } | Self::Multisine { duration_s, .. } => *duration_s,
            Self::Sweep { to_rad, speed_rad_s, acceleration_rad_s2 } => {
                Leg::new((to_rad - from_rad).abs(), *speed_rad_s, *acceleration_rad_s2).duration_s
            }
            Self::Cosine { period_s, periods, .. } => period_s * f64::from(*periods),
        }
    }

    /// How many samples it has from `from_rad`, `rate_hz` a second.
    pub fn samples(&self, from_rad: f64, rate_hz: f64) -> usize {
        match self {
            // The sample at which a leg ends is the first of what follows.
            Self::Sweep { .. } => (self.duration_s(from_rad) * rate_hz) as usize,
            // Whole samples in each period, so that each starts where the one before did.
            Self::Cosine { period_s, periods, .. } => period_samples(*period_s, rate_hz) * *periods as usize,
            Self::Rest { .. } | Self::Multisine { .. } => (self.duration_s(from_rad) * rate_hz).round() as usize,
        }
    }

    /// Its positions from `from_rad`, rad, added to `out`.
    pub fn append(&self, from_rad: f64, rate_hz: f64, out: &mut Vec<f64>) {
        let samples = self.samples(from_rad, rate_hz);
        match self {
            Self::Rest { .. } => out.extend(std::iter::repeat_n(from_rad, samples)),
            Self::Sweep { to_rad, speed_rad_s, acceleration_rad_s2 } => {
                let leg = Leg::new((to_rad - from_rad).abs(), *speed_rad_s, *acceleration_rad_s2);
                let sign = (to_rad - from_rad).signum();
                out.extend((0..samples).map(|i| from_rad + sign * leg.travel_rad(i as f64 / rate_hz)));
            }
            Self::Cosine { low_rad, high_rad, period_s, .. } => {
                let (middle, half) = ((low_rad + high_rad) / 2.0, (high_rad - low_rad) / 2.0);
                let from_end = if from_rad > middle { half } else { -half };
                let n = period_samples(*period_s, rate_hz);
                out.extend((0..samples).map(|i| middle + from_end * (TAU * (i % n) as f64 / n as f64).cos()));
            }
            Self::Multisine { duration_s, fade_s, waves } => {
                let at = |t: f64| from_rad + faded(t.min(duration_s - t) / fade_s) * sum_rad(waves, t);
                out.extend((0..samples).map(|i| at(i as f64 / rate_hz)));
            }
        }
    }
}

fn period_samples(period_s: f64, rate_hz: f64) -> usize {
    (period_s * rate_hz).round() as usize
}

fn sum_rad(waves: &[Wave], t: f64) -> f64 {
    waves.iter().map(|wave| wave.amplitude_rad * (TAU * wave.frequency_hz * t + wave.phase_rad).sin()).sum()
}

/// From 0 to 1 over a `share` of 0 to 1, without a corner.
fn faded(share: f64) -> f64 {
    (1.0 - (PI * share.clamp(0.0, 1.0)).cos()) / 2.0
}

/// A travel from rest to rest: a ramp up, a plateau, a ramp down.
struct Leg {
    distance_rad: f64,
    speed_rad_s: f64,
    acceleration_rad_s2: f64,
    duration_s: f64,
}

impl Leg {
    fn new(distance_rad: f64, speed_rad_s: f64, acceleration_rad_s2: f64) -> Self {
        let speed_rad_s = speed_rad_s.min((distance_rad * acceleration_rad_s2).sqrt());
        let plateau_s = if distance_rad > 0.0 { distance_rad / speed_rad_s } else { 0.0 };
        let duration_s = plateau_s + speed_rad_s / acceleration_rad_s2;
        Self { distance_rad, speed_rad_s, acceleration_rad_s2, duration_s }
    }

    /// How far it has come after `t` seconds, rad.
    fn travel_rad(&self, t: f64) -> f64 {
        let ramp_s = self.speed_rad_s / self.acceleration_rad_s2;
        if t < ramp_s {
            0.5 * self.acceleration_rad_s2 * t * t
        } else if t < self.duration_s - ramp_s {
            self.speed_rad_s * (t - ramp_s / 2.0)
        } else {
            self.distance_rad - 0.5 * self.acceleration_rad_s2 * (self.duration_s - t).max(0.0).powi(2)
        }
    }
}
