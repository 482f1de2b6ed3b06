//! What friction and gravity say of a torque's sign and the position's zero, before any model: friction opposes motion, and gravity
//! is 0 where sin(theta) is.
//!
//! y = s sin(q) + c cos(q) + f sign(v) + b by least squares on moving samples, away from the ends where the motion turns: f > 0 tells
//! the sign, atan(c / s) the zero.

use crate::numerics::linear::solve;
use crate::numerics::statistics::extent;
use nalgebra::{DMatrix, DVector};

/// Samples used at most.
const SAMPLES: usize = 4000;
/// Half of the samples over which a speed is taken.
const HALF: usize = 10;
/// This share of a recording's range of position at either end is left out.
const ENDS: f64 = 0.1;
/// A speed below this share of the fastest is too slow for its sign to count.
const MOVING: f64 = 0.02;
/// Standard errors that a coefficient must be away from 0 to say anything; samples of one stroke are not independent.
const CLEAR: f64 = 10.0;
/// The position must cover this angle, rad, for gravity to be told from an offset.
const SPAN_RAD: f64 = 0.5;

/// What the data say; `None` where they say nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Hints {
    /// The sign with which friction opposes motion.
    pub torque_sign: Option<f64>,
    /// What the position is to be shifted by for gravity to be 0 at 0, rad.
    pub zero_rad: Option<f64>,
    /// Half of the torque's change with the direction of motion, N m.
    pub friction_nm: f64,
}

/// Recordings of one joint: position in rad and torque in N m (before any sign), side by side.
pub(super) fn hints(recordings: &[(Vec<f64>, Vec<f64>)], turns: bool) -> Hints {
    let samples: usize = recordings.iter().map(|(position, _)| position.len()).sum();
    let step = (samples / SAMPLES).max(1);
    let (mut rows, mut fastest) = (Vec::new(), 0.0f64);
    for (position, torque) in recordings {
        let (low, high) = extent(position);
        let inner = low + ENDS * (high - low)..high - ENDS * (high - low);
        for i in (HALF..position.len().saturating_sub(HALF)).step_by(step) {
            let moved = position[i + HALF] - position[i - HALF];
            if inner.contains(&position[i]) && [torque[i], moved].iter().all(|x| x.is_finite()) {
                fastest = fastest.max(moved.abs());
                rows.push((position[i], moved, torque[i]));
            }
        }
    }
    rows.retain(|(_, moved, _)| moved.abs() > MOVING * fastest);
    let span =
        rows.iter().map(|row| row.0).fold(f64::MIN, f64::max) - rows.iter().map(|row| row.0).fold(f64::MAX, f64::min);
    let with_gravity = turns && span > SPAN_RAD;
    let columns = if with_gravity { 4 } else { 2 };
    if rows.len() < 10 * columns {
        return Hints::default();
    }
    let design = DMatrix::from_fn(rows.len(), columns, |i, j| match j {
        0 => rows[i].1.signum(),
        1 => 1.0,
        2 => rows[i].0.sin(),
        _ => rows[i].0.cos(),
    });
    let y = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.2));
    let Some(fit) = solve(design, y) else { return Hints::default() };
    let variance = fit.residual_sum / (rows.len() - columns) as f64;
    let covariance = variance * fit.unscaled_covariance();
    let se = |j: usize| covariance[(j, j)].sqrt();
    let friction = fit.coefficients[0];
    let torque_sign = (friction.abs() > CLEAR * se(0)).then_some(friction.signum());
    let zero_rad = torque_sign.filter(|_| with_gravity).and_then(|sign| {
        let (sine, cosine) = (sign * fit.coefficients[2], sign * fit.coefficients[3]);
        let size = sine.hypot(cosine);
        (size > CLEAR * se(2).hypot(se(3))).then(|| cosine.atan2(sine))
    });
    Hints { torque_sign, zero_rad, friction_nm: friction.abs() }
}
