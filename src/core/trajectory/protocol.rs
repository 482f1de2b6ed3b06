//! The paper's motions.

use super::{Path, Protocol, Segment, Trajectory};
use crate::dynamics::JointKind;
use std::f64::consts::FRAC_PI_2;

/// Stroke of a prismatic joint's motions, m, in place of the paper's angles.
const STROKE_M: f64 = 0.1;
/// Acceleration of ramps, rad/s^2: the fastest sweep of the protocol then reaches its speed within a hundredth of its stroke.
pub const ACCELERATION_RAD_S2: f64 = 4.0;
/// Periods of the cascade, s: 1, 2, 10, 20 and 100 times 0.00625 Hz; 265.6 s in all.
pub const CASCADE_S: [f64; 5] = [160.0, 80.0, 16.0, 8.0, 1.6];
/// Period of the other joint, s: slow against the joint's own motion, and eight of them take as long as the cascade.
const SWING_S: f64 = 33.2;

/// Sweeps at constant speed, from one end to the other and back; as the paper has them by default.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uniform {
    /// Number of speeds.
    pub speeds: usize,
    /// The slowest, rad/s.
    pub slowest_rad_s: f64,
    /// The fastest, rad/s; those between are spaced evenly in their logarithm.
    pub fastest_rad_s: f64,
    /// Where they begin, rad.
    pub low_rad: f64,
    /// Where they turn back, rad.
    pub high_rad: f64,
    /// Of the ramps, rad/s^2.
    pub acceleration_rad_s2: f64,
    /// Rest before, between and after, s.
    pub rest_s: f64,
}

impl Default for Uniform {
    fn default() -> Self {
        Self {
            speeds: 20,
            slowest_rad_s: 0.02,
            fastest_rad_s: 0.4,
            low_rad: 0.0,
            high_rad: FRAC_PI_2,
            acceleration_rad_s2: ACCELERATION_RAD_S2,
            rest_s: 0.5,
        }
    }
}

impl Uniform {
    /// The speeds, rad/s, to a tenth of a mrad/s: a file's name and the declared speed then say the same.
    pub fn speeds_rad_s(&self) -> Vec<f64> {
        let ratio = self.fastest_rad_s / self.slowest_rad_s;
        let speed = |i: usize| self.slowest_rad_s * ratio.powf(i as f64 / (self.speeds.max(2) - 1) as f64);
        (0..self.speeds).map(|i| (speed(i) * 1e4).round() / 1e4).collect()
    }

    /// A motion for each speed, the slowest first.
    pub fn trajectories(&self) -> Vec<Trajectory> {
        self.speeds_rad_s().into_iter().map(|speed_rad_s| self.sweep(speed_rad_s)).collect()
    }

    fn sweep(&self, speed_rad_s: f64) -> Trajectory {
        let protocol = Protocol::Uniform { speed_rad_s };
        there_and_back(&format!("sweep_{speed_rad_s:.4}"), protocol, speed_rad_s, self)
    }
}

impl Trajectory {
    /// The sweep of the paper at `speed_rad_s`: 0 to 90 to 0 deg.
    pub fn sweep(speed_rad_s: f64) -> Self {
        Uniform::default().sweep(speed_rad_s)
    }

    /// One whole cosine period of each of `periods_s`, one after the other, between `low_rad` and `high_rad`.
    pub fn cosines(name: &str, periods_s: &[f64], low_rad: f64, high_rad: f64) -> Self {
        let period = |period_s: &f64| Segment::Cosine { low_rad, high_rad, period_s: *period_s, periods: 1 };
        alone(name, Protocol::Cosine, low_rad, periods_s.iter().map(period).collect())
    }

    /// The cascade of the paper: five periods, 20 to 60 deg.
    pub fn cascade() -> Self {
        Self::cosines("cosine", &CASCADE_S, 20f64.to_radians(), 60f64.to_radians())
    }

    /// The paper's motion with another joint moving along: the cascade at 40 to 90 deg, the other at 0 to 40 deg.
    pub fn wide_cascade() -> Self {
        let own = Self::cosines("multi_joint", &CASCADE_S, 40f64.to_radians(), 90f64.to_radians());
        own.beside_a_swing(0.0, 40f64.to_radians(), SWING_S)
    }

    /// The same with one more joint swinging along from `low_rad` to `high_rad`, in whole periods of `period_s` or a little less,
    /// as many as there is time for.
    pub fn beside_a_swing(mut self, low_rad: f64, high_rad: f64, period_s: f64) -> Self {
        let whole_s = self.own.duration_s();
        let periods = (whole_s / period_s).ceil().max(1.0);
        let swing = Segment::Cosine { low_rad, high_rad, period_s: whole_s / periods, periods: periods as u32 };
        self.others.push(Path { start_rad: low_rad, segments: vec![swing] });
        self
    }

    /// For touching the joint while it rests: half a minute at 20 deg, a move, half a minute at 45 deg, and back.
    pub fn held() -> Self {
        let ends =
            Uniform { low_rad: 20f64.to_radians(), high_rad: 45f64.to_radians(), rest_s: 30.0, ..Uniform::default() };
        there_and_back("touched_held", Protocol::Interaction, 0.4, &ends)
    }

    /// For touching the joint while it moves: cosines of two frequencies, 20 to 60 deg.
    pub fn touched() -> Self {
        let periods_s = [16.0, 16.0, 16.0, 8.0, 8.0, 8.0, 8.0];
        let moving = Self::cosines("touched_moving", &periods_s, 20f64.to_radians(), 60f64.to_radians());
        Self { protocol: Protocol::Interaction, ..moving }
    }

    /// The same motion of a joint of this `kind`: a prismatic one goes its whole stroke where a revolute one turns from end to
    /// end.
    pub fn on(&self, kind: JointKind) -> Self {
        match kind {
            JointKind::Revolute => self.clone(),
            JointKind::Prismatic => Self { own: self.own.scaled_to(STROKE_M), ..self.clone() },
        }
    }
}

/// From end to end of `of` and back at one speed, resting at both.
fn there_and_back(name: &str, protocol: Protocol, speed_rad_s: f64, of: &Uniform) -> Trajectory {
    let rest = (of.rest_s > 0.0).then_some(Segment::Rest { duration_s: of.rest_s });
    let sweep = |to_rad| Segment::Sweep { to_rad, speed_rad_s, acceleration_rad_s2: of.acceleration_rad_s2 };
    let moves = [sweep(of.high_rad), sweep(of.low_rad)].into_iter().flat_map(|leg| [Some(leg), rest.clone()]);
    alone(name, protocol, of.low_rad, std::iter::once(rest.clone()).chain(moves).flatten().collect())
}

fn alone(name: &str, protocol: Protocol, start_rad: f64, segments: Vec<Segment>) -> Trajectory {
    let own = Path { start_rad, segments };
    Trajectory { name: name.to_string(), protocol, repeats: None, own, others: Vec::new() }
}

impl Path {
    /// The same motion between 0 and `stroke`, its times and speeds unchanged.
    fn scaled_to(&self, stroke: f64) -> Self {
        let ends = self.segments.iter().flat_map(|segment| match segment {
            Segment::Sweep { to_rad, .. } => [*to_rad; 2],
            Segment::Cosine { low_rad, high_rad, .. } => [*low_rad, *high_rad],
            Segment::Rest { .. } | Segment::Multisine { .. } => [self.start_rad; 2],
        });
        let (low, high) = ends.fold((self.start_rad, self.start_rad), |(low, high), x| (low.min(x), high.max(x)));
        if high <= low {
            return self.clone();
        }
        let scaled = |x: f64| stroke * ((x - low) / (high - low));
        let segment = |segment: &Segment| match segment.clone() {
            Segment::Sweep { to_rad, speed_rad_s, acceleration_rad_s2 } => {
                Segment::Sweep { to_rad: scaled(to_rad), speed_rad_s, acceleration_rad_s2 }
            }
            Segment::Cosine { low_rad, high_rad, period_s, periods } => {
                Segment::Cosine { low_rad: scaled(low_rad), high_rad: scaled(high_rad), period_s, periods }
            }
            other @ (Segment::Rest { .. } | Segment::Multisine { .. }) => other,
        };
        Self { start_rad: scaled(self.start_rad), segments: self.segments.iter().map(segment).collect() }
    }
}
