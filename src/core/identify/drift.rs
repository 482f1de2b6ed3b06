//! A torque that drifts within a trial.
//!
//! The slower a sweep, the longer it takes, and the more of a drift of r N m/s comes into its leg: along it time correlates with the
//! regressor of (17), sin(theta), with slope s = cov(t, sin) / var(sin), so that the leg shows A + r s. On the way up s is positive, on the
//! way down negative, and it falls with speed: r follows from the A of all legs by weighted least squares, with a mean A of its own in each
//! direction. B of a leg is off by r times the time since the trial began, which differs from speed to speed and is not part of any
//! interval.

use super::legs::LegFit;
use super::sums::columns;
use crate::dynamics::JointKind;
use crate::model::Direction;
use crate::numerics::statistics::{mean, student_t};
use crate::prepare::{Leg, Trial};
use crate::problem::Problem;
use std::path::Path;

/// A drift this many half widths of its 95 % interval from none is one.
const CLEAR: f64 = 2.0;
/// So many samples of a leg tell how time goes along it.
const SAMPLES: usize = 200;
/// Legs below which the scatter of A tells nothing.
const LEGS_MIN: usize = 6;
/// A drift that moves no leg by this share of A is not reported.
const NEGLIGIBLE: f64 = 1e-3;

/// How time goes along a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LegTime {
    /// How time grows with the regressor, s.
    pub per_regressor_s: f64,
    /// How long the leg lasts, s.
    pub lasts_s: f64,
}

/// Of every leg of `trial`, in their order.
pub fn leg_times(trial: &Trial, gravity_nm: f64, kind: JointKind) -> Vec<LegTime> {
    trial.legs.iter().map(|leg| leg_time(trial, leg, gravity_nm, kind)).collect()
}

fn leg_time(trial: &Trial, leg: &Leg, gravity_nm: f64, kind: JointKind) -> LegTime {
    let time = |i: usize| trial.log.time_s[i] - trial.log.time_s[leg.samples.start];
    let (mut n, mut x, mut t, mut xx, mut xt) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let stride = (leg.samples.len() / SAMPLES).max(1);
    for i in leg.used().step_by(stride) {
        let [gravity, _, rest] = columns(trial, gravity_nm, kind, i);
        let (regressor, time) = (gravity + rest, time(i));
        n += 1.0;
        x += regressor;
        t += time;
        xx += regressor * regressor;
        xt += regressor * time;
    }
    LegTime { per_regressor_s: (xt - x * t / n) / (xx - x * x / n), lasts_s: time(leg.samples.end - 1) }
}

/// A torque that drifts alike in all trials.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drift {
    /// How fast, N m/s.
    pub rate_nm_s: f64,
    /// Half width of its 95 % interval, N m/s.
    pub half_width_nm_s: f64,
    /// How much that is over the longest leg, N m.
    pub largest_nm: f64,
}

impl Drift {
    /// The drift that `legs` show, with their `times`; `None` where it is not significant.
    pub fn of(legs: &[&LegFit], times: &[LegTime]) -> Option<Self> {
        let usable = |(leg, time): &(&LegFit, &LegTime)| {
            leg.a_nm.is_finite() && leg.a_se_nm > 0.0 && leg.a_se_nm.is_finite() && time.per_regressor_s.is_finite()
        };
        let all: Vec<(&LegFit, &LegTime)> = legs.iter().copied().zip(times).filter(usable).collect();
        if all.len() < LEGS_MIN {
            return None;
        }
        // Legs of one direction less their weighted mean, in time and in A.
        let (mut square, mut product) = (0.0, 0.0);
        let mut centred = Vec::with_capacity(all.len());
        for direction in Direction::BOTH {
            let mine = || all.iter().filter(|(leg, _)| leg.direction == direction);
            let weight = |leg: &LegFit| leg.a_se_nm.powi(-2);
            let total: f64 = mine().map(|(leg, _)| weight(leg)).sum();
            let middle = |value: &dyn Fn(&LegFit, &LegTime) -> f64| {
                mine().map(|(leg, time)| weight(leg) * value(leg, time)).sum::<f64>() / total
            };
            let (time_s, a_nm) = (middle(&|_, time| time.per_regressor_s), middle(&|leg, _| leg.a_nm));
            for (leg, time) in mine() {
                let (x, y, w) = (time.per_regressor_s - time_s, leg.a_nm - a_nm, weight(leg));
                square += w * x * x;
                product += w * x * y;
                centred.push((x, y, w));
            }
        }
        let rate_nm_s = product / square;
        let freedom = all.len() as f64 - 3.0;
        let left = centred.iter().map(|(x, y, w)| w * (y - rate_nm_s * x).powi(2)).sum::<f64>() / freedom;
        // Scatter below the standard errors does not narrow the interval.
        let half_width_nm_s = student_t(freedom) * (left.max(1.0) / square).sqrt();
        let longest_s = all.iter().map(|(_, time)| time.lasts_s).fold(0.0, f64::max);
        let a_nm = mean(&all.iter().map(|(leg, _)| leg.a_nm.abs()).collect::<Vec<f64>>());
        let largest_nm = (rate_nm_s * longest_s).abs();
        let is_clear = rate_nm_s.abs() > CLEAR * half_width_nm_s && largest_nm > NEGLIGIBLE * a_nm;
        is_clear.then_some(Self { rate_nm_s, half_width_nm_s, largest_nm })
    }

    /// What the reader of `campaign` is told.
    pub fn problem(&self, campaign: &Path) -> Problem {
        let what = format!(
            "the torque drifts within the trials, by {:.4} mN m/s (95 % +- {:.4}), {:.1} mN m over the longest leg: A of slow legs \
             differs from that of fast ones",
            1e3 * self.rate_nm_s,
            1e3 * self.half_width_nm_s,
            1e3 * self.largest_nm
        );
        let cure = "no parameter is called pinned; let the sensor warm up, or tare it before each trial";
        Problem::warning(campaign, what, cure)
    }
}
