//! What happens in a trial, and how each joint moves in it.

use crate::dynamics::Motion;
use crate::effects::Sample;
use crate::numerics::difference::{acceleration, velocity};

/// What happens in a trial, sample by sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Course {
    /// Position of the joint, rad.
    pub position_rad: Vec<f64>,
    /// Positions of the other joints, in the order of a chain or of the campaign's columns, rad or m.
    pub others_rad: Vec<Vec<f64>>,
    /// What a person adds at the winch, N m; nothing where empty.
    pub contact_nm: Vec<f64>,
    /// When the trial begins, s since the campaign did.
    pub began_s: f64,
}

/// The motions of a course, `rate_hz` samples a second.
pub(super) struct Motions {
    pub own: Vec<Motion>,
    pub others: Vec<Vec<Motion>>,
    pub rate_hz: f64,
    pub began_s: f64,
}

impl Motions {
    pub fn new(course: &Course, rate_hz: f64) -> Self {
        Self {
            own: moving(&course.position_rad, rate_hz),
            others: course.others_rad.iter().map(|positions| moving(positions, rate_hz)).collect(),
            rate_hz,
            began_s: course.began_s,
        }
    }

    /// Sample `i` as effects see it; `others` is room for the other joints' motions.
    pub fn sample<'o>(&self, i: usize, others: &'o mut Vec<Motion>) -> Sample<'o> {
        others.clear();
        others.extend(self.others.iter().map(|other| other[i]));
        let time_s = i as f64 / self.rate_hz;
        Sample { time_s, elapsed_s: self.began_s + time_s, own: self.own[i], others }
    }
}

fn moving(positions: &[f64], rate_hz: f64) -> Vec<Motion> {
    let (speeds, accelerations) = (velocity(positions, rate_hz), acceleration(positions, rate_hz));
    let motion = |((position, velocity), acceleration): ((&f64, f64), f64)| Motion {
        position: *position,
        velocity,
        acceleration,
    };
    positions.iter().zip(speeds).zip(accelerations).map(motion).collect()
}
