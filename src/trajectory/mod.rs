//! A motion's plan: position over time, from rest to rest.

use crate::dynamics::JointKind;
use std::f64::consts::TAU;

/// Stroke of a prismatic joint's motions, m, in place of the paper's angles.
const STROKE_M: f64 = 0.1;

/// A prescribed motion of one joint, angles in rad.
#[derive(Debug, Clone, PartialEq)]
pub enum Trajectory {
    /// From `low_rad` to `high_rad` and back at one speed, with ramps, resting at both ends: step 1 of the protocol.
    Uniform {
        /// Speed of the plateau, rad/s.
        speed_rad_s: f64,
        /// Acceleration of the ramps, rad/s^2.
        acceleration_rad_s2: f64,
        /// Rest at each end, s.
        dwell_s: f64,
        /// Where it starts and ends, rad.
        low_rad: f64,
        /// Where it turns, rad.
        high_rad: f64,
    },
    /// One whole cosine period of each length, one after the other: the paper's evaluation motion.
    Cosine {
        /// Periods, s.
        periods_s: Vec<f64>,
        /// Where each period starts and ends, rad.
        low_rad: f64,
        /// Where it turns, rad.
        high_rad: f64,
    },
}

impl Trajectory {
    /// The sweep of the paper at `speed_rad_s`: 0 to 90 to 0 deg.
    pub fn sweep(speed_rad_s: f64) -> Self {
        Self::Uniform {
            speed_rad_s,
            acceleration_rad_s2: 4.0,
            dwell_s: 0.5,
            low_rad: 0.0,
            high_rad: std::f64::consts::FRAC_PI_2,
        }
    }

    /// The cascade of the paper: 160, 80, 16, 8 and 1.6 s (1, 2, 10, 20, 100 times 0.00625 Hz), 20 to 60 deg, 265.6 s.
    pub fn cascade() -> Self {
        Self::Cosine {
            periods_s: vec![160.0, 80.0, 16.0, 8.0, 1.6],
            low_rad: 20f64.to_radians(),
            high_rad: 60f64.to_radians(),
        }
    }

    /// The paper's motion with another joint moving along: the cascade at 40 to 90 deg.
    pub fn wide_cascade() -> Self {
        Self::Cosine {
            periods_s: vec![160.0, 80.0, 16.0, 8.0, 1.6],
            low_rad: 40f64.to_radians(),
            high_rad: 90f64.to_radians(),
        }
    }

    /// For touching the joint while it rests: half a minute at 20 deg, a move, half a minute at 45 deg, and back.
    pub fn held() -> Self {
        Self::Uniform {
            speed_rad_s: 0.4,
            acceleration_rad_s2: 4.0,
            dwell_s: 30.0,
            low_rad: 20f64.to_radians(),
            high_rad: 45f64.to_radians(),
        }
    }

    /// For touching the joint while it moves: cosines of two frequencies, 20 to 60 deg.
    pub fn touched() -> Self {
        Self::Cosine {
            periods_s: vec![16.0, 16.0, 16.0, 8.0, 8.0, 8.0, 8.0],
            low_rad: 20f64.to_radians(),
            high_rad: 60f64.to_radians(),
        }
    }

    /// The same motion of a joint of this `kind`: a prismatic one goes its whole stroke where a revolute one turns from end to end.
    pub fn on(&self, kind: JointKind) -> Self {
        let mut motion = self.clone();
        if kind == JointKind::Prismatic {
            let (Self::Uniform { low_rad, high_rad, .. } | Self::Cosine { low_rad, high_rad, .. }) = &mut motion;
            (*low_rad, *high_rad) = (0.0, STROKE_M);
        }
        motion
    }

    /// Positions in rad, `rate_hz` a second.
    pub fn positions_rad(&self, rate_hz: f64) -> Vec<f64> {
        match self {
            Self::Uniform { speed_rad_s, acceleration_rad_s2, dwell_s, low_rad, high_rad } => {
                let there = leg(high_rad - low_rad, *speed_rad_s, *acceleration_rad_s2, rate_hz);
                let rest = |at: f64| std::iter::repeat_n(at, (dwell_s * rate_hz) as usize);
                rest(*low_rad)
                    .chain(there.iter().map(|s| low_rad + s))
                    .chain(rest(*high_rad))
                    .chain(there.iter().map(|s| high_rad - s))
                    .chain(rest(*low_rad))
                    .collect()
            }
            Self::Cosine { periods_s, low_rad, high_rad } => {
                let (middle, half) = ((low_rad + high_rad) / 2.0, (high_rad - low_rad) / 2.0);
                let period = |t: &f64| {
                    let n = (t * rate_hz).round() as usize;
                    (0..n).map(move |i| middle - half * (TAU * i as f64 / n as f64).cos())
                };
                periods_s.iter().flat_map(period).collect()
            }
        }
    }
}

/// Travel from 0 to `distance_rad`: a ramp up, a plateau, a ramp down; without a plateau where there is no room for one.
fn leg(distance_rad: f64, speed_rad_s: f64, acceleration_rad_s2: f64, rate_hz: f64) -> Vec<f64> {
    let speed = speed_rad_s.min((distance_rad * acceleration_rad_s2).sqrt());
    let ramp_s = speed / acceleration_rad_s2;
    let whole_s = distance_rad / speed + ramp_s;
    let at = |t: f64| {
        if t < ramp_s {
            0.5 * acceleration_rad_s2 * t * t
        } else if t < whole_s - ramp_s {
            speed * (t - ramp_s / 2.0)
        } else {
            distance_rad - 0.5 * acceleration_rad_s2 * (whole_s - t).max(0.0).powi(2)
        }
    };
    (0..(whole_s * rate_hz) as usize).map(|i| at(i as f64 / rate_hz)).collect()
}
