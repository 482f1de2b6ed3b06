//! The paper's motions.

use super::{Path, Segment, Trajectory};
use crate::dynamics::JointKind;
use std::f64::consts::FRAC_PI_2;

/// Stroke of a prismatic joint's motions, m, in place of the paper's angles.
const STROKE_M: f64 = 0.1;
/// Acceleration of ramps, rad/s^2: the fastest sweep of the protocol then reaches its speed within a hundredth of its stroke.
pub(super) const ACCELERATION_RAD_S2: f64 = 4.0;
/// Periods of the cascade, s: 1, 2, 10, 20 and 100 times 0.00625 Hz; 265.6 s in all.
const CASCADE_S: [f64; 5] = [160.0, 80.0, 16.0, 8.0, 1.6];

impl Trajectory {
    /// The sweep of the paper at `speed_rad_s`: 0 to 90 to 0 deg.
    pub fn sweep(speed_rad_s: f64) -> Self {
        there_and_back("sweep", speed_rad_s, 0.5, 0.0, FRAC_PI_2)
    }

    /// The cascade of the paper: five periods, 20 to 60 deg.
    pub fn cascade() -> Self {
        cosines("cosine", &CASCADE_S, 20f64.to_radians(), 60f64.to_radians())
    }

    /// The paper's motion with another joint moving along: the cascade at 40 to 90 deg.
    pub fn wide_cascade() -> Self {
        cosines("multi_joint", &CASCADE_S, 40f64.to_radians(), 90f64.to_radians())
    }

    /// For touching the joint while it rests: half a minute at 20 deg, a move, half a minute at 45 deg, and back.
    pub fn held() -> Self {
        there_and_back("held", 0.4, 30.0, 20f64.to_radians(), 45f64.to_radians())
    }

    /// For touching the joint while it moves: cosines of two frequencies, 20 to 60 deg.
    pub fn touched() -> Self {
        let periods_s = [16.0, 16.0, 16.0, 8.0, 8.0, 8.0, 8.0];
        cosines("moving", &periods_s, 20f64.to_radians(), 60f64.to_radians())
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

/// From `low_rad` to `high_rad` and back, resting at both ends.
fn there_and_back(name: &str, speed_rad_s: f64, dwell_s: f64, low_rad: f64, high_rad: f64) -> Trajectory {
    let rest = Segment::Rest { duration_s: dwell_s };
    let sweep = |to_rad| Segment::Sweep { to_rad, speed_rad_s, acceleration_rad_s2: ACCELERATION_RAD_S2 };
    alone(name, low_rad, vec![rest.clone(), sweep(high_rad), rest.clone(), sweep(low_rad), rest])
}

/// One whole cosine period of each length, one after the other.
fn cosines(name: &str, periods_s: &[f64], low_rad: f64, high_rad: f64) -> Trajectory {
    let period = |period_s: &f64| Segment::Cosine { low_rad, high_rad, period_s: *period_s, periods: 1 };
    alone(name, low_rad, periods_s.iter().map(period).collect())
}

fn alone(name: &str, start_rad: f64, segments: Vec<Segment>) -> Trajectory {
    Trajectory { name: name.to_string(), repeats: None, own: Path { start_rad, segments }, others: Vec::new() }
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
