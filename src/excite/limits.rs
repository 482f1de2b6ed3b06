//! What a joint may do.

use super::{Asked, ROUNDING};
use crate::document::{Document, Section};
use crate::problem::{Problem, Result};
use std::path::Path;

/// Limits of a joint, each where it is known; for a prismatic joint `_rad` is m and `_nm` is N.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Lowest position, rad.
    pub low_rad: Option<f64>,
    /// Highest position, rad.
    pub high_rad: Option<f64>,
    /// rad/s.
    pub speed_rad_s: Option<f64>,
    /// rad/s^2.
    pub acceleration_rad_s2: Option<f64>,
    /// At the winch, N m.
    pub torque_nm: Option<f64>,
}

/// Further limits of a rig, which say nothing of a motion by itself.
const OF_THE_RIG: [&str; 3] = ["torque_step_nm", "lag_rad", "approach_rad_s"];

impl Limits {
    /// Reads `[limits]` of `file`; what else a rig's file holds is not looked at.
    ///
    /// Errors: no such section, an unknown key in it, an impossible number, an empty range.
    pub fn read(file: &Path) -> Result<Self> {
        Document::open(file)?.read(|root| {
            root.keys().for_each(|key| root.may(key).ignore());
            root.need("limits").such_as("[limits]", "what the joint may do").section(Self::read_section)
        })
    }

    fn read_section(section: &Section<'_>) -> Option<Self> {
        OF_THE_RIG.iter().for_each(|key| section.may(key).ignore());
        let limits = Self {
            low_rad: section.may("low_rad").number(),
            high_rad: section.may("high_rad").number(),
            speed_rad_s: section.may("speed_rad_s").positive(),
            acceleration_rad_s2: section.may("acceleration_rad_s2").positive(),
            torque_nm: section.may("torque_nm").positive(),
        };
        if let Some((low, high)) = limits.empty_range() {
            section.reject("high_rad", format!("is {high}, low_rad {low}"), "high_rad must be above low_rad");
        }
        Some(limits)
    }

    /// These where they are given, else `others`.
    pub fn or(self, others: Self) -> Self {
        Self {
            low_rad: self.low_rad.or(others.low_rad),
            high_rad: self.high_rad.or(others.high_rad),
            speed_rad_s: self.speed_rad_s.or(others.speed_rad_s),
            acceleration_rad_s2: self.acceleration_rad_s2.or(others.acceleration_rad_s2),
            torque_nm: self.torque_nm.or(others.torque_nm),
        }
    }

    /// Both ends of the range where it holds nothing.
    pub fn empty_range(&self) -> Option<(f64, f64)> {
        let (low, high) = (self.low_rad?, self.high_rad?);
        (low >= high).then_some((low, high))
    }

    /// Every limit that `asked` breaks.
    pub(super) fn broken_by(&self, asked: &Asked) -> Vec<Problem> {
        let of = &asked.extremes;
        let above = |what: &'static str, unit: &'static str, found: f64, limit: Option<f64>, cure: &'static str| {
            let limit = limit.filter(|limit| found > limit + ROUNDING * limit.abs().max(1.0))?;
            Some((what, unit, found, limit, cure))
        };
        let lowest = above("goes down to", "rad", -of.low_rad, self.low_rad.map(|low| -low), "narrow its range");
        let lowest = lowest.map(|(what, unit, found, limit, cure)| (what, unit, -found, -limit, cure));
        let slower = "use lower speeds or longer periods";
        let gentler = "lower its ramps' acceleration, or use longer periods";
        let torque_nm = asked.largest_nm().unwrap_or(0.0);
        [
            lowest,
            above("goes up to", "rad", of.high_rad, self.high_rad, "narrow its range"),
            above("reaches", "rad/s", of.speed_rad_s, self.speed_rad_s, slower),
            above("reaches", "rad/s^2", of.acceleration_rad_s2, self.acceleration_rad_s2, gentler),
            above("takes", "N m", torque_nm, self.torque_nm, "narrow its range, or choose a larger drive"),
        ]
        .into_iter()
        .flatten()
        .map(|(what, unit, found, limit, cure)| {
            let what = format!("{what} {found:.4} {unit}, and the limit is {limit:.4} {unit}");
            Problem::error(&asked.trajectory.name, what, cure)
        })
        .collect()
    }
}
