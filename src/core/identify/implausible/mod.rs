//! What physics says against a campaign's declared scale, sign, zero, radii and gravity, before any model.
//!
//! All moving samples of all trials: y = g r G(q) + c r G'(q) + (f + h r G(q)) sign(v) + b by least squares, with r = r1/r2 and G
//! gravity and measured load as declared. Friction takes from the motion, so f + h r G > 0 on average: else a sign is wrong. g is
//! 1 / (1 - mu_c), between 1 and 2 where friction takes less than half of the load: else scale, radii or gravity are wrong, and
//! a mistake that people make may explain by how much. c / g is the tangent of the position's zero; sweeps tell that better, leg by
//! leg (`zero`). Near its ends a motion turns, and friction passes from one branch to the other: there nothing is counted. What
//! friction has of speed, in each direction, is fitted along, without sweeps as a line and a fall at low speed.

mod evidence;
mod gain;
mod zero;

pub use evidence::{Evidence, evidence};

use super::reading::Reading;
use crate::log::Campaign;
use crate::problem::Problem;
use evidence::{by_legs, fit, legs_of, rows_of};
use gain::gain;
use zero::zero;

/// Friction below this share of the torque says nothing of a sign.
const FRICTION_SHARE: f64 = 0.01;
/// A zero is looked for within this, rad, where sweeps tell it.
const ZERO_MOST_RAD: f64 = 0.5;

/// What is most likely wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// The sign of the torque, or of the position.
    Sign,
    /// The torque's scale or unit.
    Scale,
    /// The position's zero.
    Zero,
    /// A radius or the ratio.
    Radius,
    /// The gravity torque.
    Gravity,
}

impl Cause {
    /// Its name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sign => "sign",
            Self::Scale => "scale",
            Self::Zero => "zero",
            Self::Radius => "radius",
            Self::Gravity => "gravity",
        }
    }

    /// The key of `campaign.toml` that it concerns.
    fn key(self) -> &'static str {
        match self {
            Self::Sign => "signal.torque_sign",
            Self::Scale => "columns.torque",
            Self::Zero => "columns.position",
            Self::Radius => "joint.winch_radius_m",
            Self::Gravity => "dynamics.gravity_nm",
        }
    }
}

/// A contradiction between data and declaration.
#[derive(Debug, Clone, PartialEq)]
pub struct Doubt {
    /// What may explain it, the likeliest first.
    pub causes: Vec<Cause>,
    /// What is contradicted, with its figure.
    pub what: String,
    /// How to mend it.
    pub cure: String,
}

impl Doubt {
    /// As a problem of the campaign.
    pub fn problem(&self, campaign: &Campaign) -> Problem {
        let key = self.causes.first().map_or("", |cause| cause.key());
        Problem::warning(&campaign.file, self.what.as_str(), self.cure.as_str()).in_column(key)
    }
}

/// Contradictions between `campaign` and its `readings`, the gravest first.
pub fn implausible(campaign: &Campaign, readings: &[Reading]) -> Vec<Doubt> {
    let rows = rows_of(campaign, readings);
    let legs = legs_of(readings);
    let Some(found) = fit(&rows, !legs.is_empty()) else { return Vec::new() };
    let mut doubts = Vec::new();
    doubts.extend(sign(&found));
    let is_scaled = campaign.columns.torque_from.is_none_or(|from| from.is_scaled());
    if doubts.is_empty() && found.has_load && is_scaled {
        doubts.extend(gain(campaign, &by_legs(campaign, found, &legs)));
    }
    if doubts.is_empty() && found.has_load {
        doubts.extend(zero(campaign, &found, &rows, &legs));
    }
    doubts
}

/// Friction that drives, or a load that pulls the wrong way.
fn sign(found: &Evidence) -> Option<Doubt> {
    let Evidence { gain, friction_nm, torque_nm, has_load, .. } = *found;
    if friction_nm.abs() < FRICTION_SHARE * torque_nm {
        return None;
    }
    let cure = "turn torque_sign in [signal], or, if the position counts the other way, give its column `scale = -1.0`";
    if friction_nm < 0.0 {
        let what = format!(
            "moving up the torque is {:.3} N m smaller than moving down: friction would drive the joint{}; the torque's sign is wrong",
            -2.0 * friction_nm,
            if has_load && gain < 0.0 { ", and gravity would lift it" } else { "" }
        );
        return Some(Doubt { causes: vec![Cause::Sign], what, cure: cure.to_string() });
    }
    (has_load && gain < 0.0).then(|| Doubt {
        causes: vec![Cause::Gravity, Cause::Zero, Cause::Sign],
        what: format!("the torque follows {gain:.2} times the declared load, though friction opposes motion: gravity is turned about"),
        cure: "turn the sign of gravity_nm, or correct the zero of the position: it may be off by 180 deg".to_string(),
    })
}
