//! How far, how fast and how hard a motion moves the joint.

use super::{Path, Segment, Wave};
use crate::numerics::difference::{acceleration, velocity};
use std::f64::consts::{PI, TAU};

/// Samples in a period of a multisine's fastest wave: between two of them a peak is missed by less than 0.05 %.
const SAMPLES_PER_PERIOD: f64 = 100.0;
/// And no fewer than this while it fades in, or a wave that is slower than its fading would be missed.
const SAMPLES_PER_FADE: f64 = 100.0;
/// What needs more is bounded, not sampled.
const SAMPLES_MAX: f64 = 1e7;

/// The largest values of a motion; for a prismatic joint `_rad` is m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// Lowest position, rad.
    pub low_rad: f64,
    /// Highest position, rad.
    pub high_rad: f64,
    /// Highest speed, rad/s.
    pub speed_rad_s: f64,
    /// Highest acceleration, rad/s^2.
    pub acceleration_rad_s2: f64,
}

impl Path {
    /// Its extremes.
    pub fn extremes(&self) -> Extremes {
        let at_rest = Extremes::at_rest(self.start_rad);
        self.walk().map(|(from_rad, segment)| segment.extremes(from_rad)).fold(at_rest, Extremes::and)
    }
}

impl Extremes {
    fn at_rest(at_rad: f64) -> Self {
        Self { low_rad: at_rad, high_rad: at_rad, speed_rad_s: 0.0, acceleration_rad_s2: 0.0 }
    }

    /// Those of two motions together.
    pub fn and(self, other: Self) -> Self {
        Self {
            low_rad: self.low_rad.min(other.low_rad),
            high_rad: self.high_rad.max(other.high_rad),
            speed_rad_s: self.speed_rad_s.max(other.speed_rad_s),
            acceleration_rad_s2: self.acceleration_rad_s2.max(other.acceleration_rad_s2),
        }
    }
}

impl Segment {
    /// Its extremes from `from_rad`.
    fn extremes(&self, from_rad: f64) -> Extremes {
        match self {
            Self::Rest { .. } => Extremes::at_rest(from_rad),
            Self::Sweep { to_rad, speed_rad_s, acceleration_rad_s2 } => Extremes {
                low_rad: from_rad.min(*to_rad),
                high_rad: from_rad.max(*to_rad),
                // Where there is no room for a plateau the two ramps meet below it.
                speed_rad_s: speed_rad_s.min(((to_rad - from_rad).abs() * acceleration_rad_s2).sqrt()),
                acceleration_rad_s2: if *to_rad == from_rad { 0.0 } else { *acceleration_rad_s2 },
            },
            Self::Cosine { low_rad, high_rad, period_s, .. } => {
                let (half_rad, omega_rad_s) = ((high_rad - low_rad) / 2.0, TAU / period_s);
                Extremes {
                    low_rad: *low_rad,
                    high_rad: *high_rad,
                    speed_rad_s: half_rad * omega_rad_s,
                    acceleration_rad_s2: half_rad * omega_rad_s * omega_rad_s,
                }
            }
            Self::Multisine { fade_s, waves, .. } => self.sampled(from_rad, *fade_s, waves),
        }
    }

    fn sampled(&self, from_rad: f64, fade_s: f64, waves: &[Wave]) -> Extremes {
        let fastest_hz = waves.iter().map(|wave| wave.frequency_hz).fold(0.0, f64::max);
        let rate_hz = (SAMPLES_PER_PERIOD * fastest_hz).max(SAMPLES_PER_FADE / fade_s);
        if self.duration_s(from_rad) * rate_hz > SAMPLES_MAX {
            return bounds(from_rad, fade_s, waves);
        }
        let mut positions_rad = Vec::new();
        self.append(from_rad, rate_hz, &mut positions_rad);
        let largest = |values: Vec<f64>| values.into_iter().map(f64::abs).fold(0.0, f64::max);
        let reached = |at: Extremes, x: &f64| at.and(Extremes::at_rest(*x));
        Extremes {
            speed_rad_s: largest(velocity(&positions_rad, rate_hz)),
            acceleration_rad_s2: largest(acceleration(&positions_rad, rate_hz)),
            ..positions_rad.iter().fold(Extremes::at_rest(from_rad), reached)
        }
    }
}

/// What a multisine cannot exceed: all waves at their peak at once, and the steepest fading at once with them.
fn bounds(from_rad: f64, fade_s: f64, waves: &[Wave]) -> Extremes {
    let sum = |order: i32| -> f64 {
        waves.iter().map(|wave| wave.amplitude_rad.abs() * (TAU * wave.frequency_hz).powi(order)).sum()
    };
    // The fading (1 - cos(pi t / T)) / 2 and its derivatives.
    let omega = PI / fade_s;
    let (first, second) = (omega / 2.0, omega * omega / 2.0);
    Extremes {
        low_rad: from_rad - sum(0),
        high_rad: from_rad + sum(0),
        speed_rad_s: sum(1) + first * sum(0),
        acceleration_rad_s2: sum(2) + 2.0 * first * sum(1) + second * sum(0),
    }
}
