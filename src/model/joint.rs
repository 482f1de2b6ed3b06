//! The joint's geometry.

use crate::document::Section;
use crate::dynamics::JointKind;
use crate::numerics::scalar::Scalar;
use std::ops::RangeInclusive;

/// Radii of winches and pulleys, m: one outside was most likely given in another unit.
const SANE_RADIUS_M: RangeInclusive<f64> = 1e-4..=1.0;

/// Radii that a winch or pulley can have at all, m: from a hair's to a mill wheel's. Beyond, nothing that follows is a number.
const POSSIBLE_RADIUS_M: RangeInclusive<f64> = 1e-6..=100.0;
/// The largest clearance that a cable can have, m.
const POSSIBLE_BACKLASH_M: f64 = 10.0;

/// What a ruler tells of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint<S = f64> {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// r1, m.
    pub winch_radius_m: f64,
    /// r2, m.
    pub pulley_radius_m: f64,
    /// X_cl, the clearance as displacement on the cable, m.
    pub backlash_m: S,
}

impl Joint {
    /// Reads the kind of a joint, which decides what all its units are; revolute where it says none.
    pub fn read_kind(section: &Section<'_>) -> JointKind {
        let kinds = [JointKind::Revolute, JointKind::Prismatic].map(|kind| (kind.name(), kind));
        section.may("kind").choice(&kinds).unwrap_or_default()
    }

    /// Reads `[joint]` of a campaign or `joint` of a model, its `kind` read before; faults go to the section.
    pub fn read(section: &Section<'_>, kind: JointKind) -> Option<Self> {
        let name = section.need("name").such_as("\"elbow\"", "any name").text();
        let radius = |key: &str, example: &str, means: &str| {
            let radius_m = section.need(key).such_as(example, means).positive()?;
            if kind == JointKind::Prismatic && radius_m != 1.0 {
                section.reject(key, format!("is {radius_m} on a prismatic joint"), "set it to 1.0: there is no arm");
            } else if !POSSIBLE_RADIUS_M.contains(&radius_m) {
                let (low, high) = (POSSIBLE_RADIUS_M.start(), POSSIBLE_RADIUS_M.end());
                let what = format!("is {radius_m:e} m, which no winch or pulley has");
                section.reject(key, what, format!("measure it: expected {low} to {high} m, 12 mm is 0.012"));
            } else if !SANE_RADIUS_M.contains(&radius_m) {
                let what = format!("is {radius_m} m, no likely radius of a winch or pulley");
                section.doubt(key, what, "give it in metres, not in millimetres: 12 mm is 0.012");
            }
            Some(radius_m)
        };
        let winch_radius_m = radius("winch_radius_m", "0.012", "the winch's radius in m");
        let pulley_radius_m = radius("pulley_radius_m", "0.040", "the radius of the pulley at the joint in m");
        let means = "the clearance as travel of the cable in m, 0 without any";
        let backlash_m = section.need("backlash_m").such_as("0.0008", means).not_negative();
        if let Some(backlash_m) = backlash_m.filter(|backlash_m| *backlash_m > POSSIBLE_BACKLASH_M) {
            let what = format!("is {backlash_m:e} m, which no cable has");
            section.reject("backlash_m", what, "give it in metres of cable: 0.8 mm is 0.0008");
        }
        Some(Self {
            name: name?,
            kind,
            winch_radius_m: winch_radius_m?,
            pulley_radius_m: pulley_radius_m?,
            backlash_m: backlash_m?,
        })
    }
}

impl<S: Scalar> Joint<S> {
    /// r1 / r2: a torque at the joint times this is a torque at the winch.
    pub fn transmission(&self) -> f64 {
        self.winch_radius_m / self.pulley_radius_m
    }

    /// The joint travel that takes up the clearance, X_cl / r2, rad.
    pub fn backlash_rad(&self) -> S {
        self.backlash_m / self.pulley_radius_m
    }
}
