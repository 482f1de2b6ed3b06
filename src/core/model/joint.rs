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

/// What is between the torque's sensor and the joint. The formula is the cable's in each: r1 / r2 is what a torque at the joint
/// is at the sensor, and friction at the joint is a force on r2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Drive {
    /// A cable over a winch and a pulley: r1 and r2 are their radii.
    #[default]
    Cable,
    /// A gear or belt of ratio i, torque on the motor's side: r1 / r2 = 1 / i with r2 = 1 m, so that friction forces in N are
    /// torques at the joint in N m; mu_c is the share of the load that the gear loses, 1 less its efficiency.
    Gear,
    /// Nothing: r1 = r2 = 1 m.
    Direct,
    /// A screw that moves a slide by `lead_m` a turn, torque of the motor in N m: r1 / r2 = lead / 2 pi with r2 = 1.
    Screw,
}

impl Drive {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Cable, Self::Gear, Self::Direct, Self::Screw];

    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cable => "cable",
            Self::Gear => "gear",
            Self::Direct => "direct",
            Self::Screw => "screw",
        }
    }
}

/// What a ruler tells of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint<S = f64> {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// What drives it.
    pub drive: Drive,
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
        let drive = Self::read_drive(section, kind);
        let radii = match drive {
            Drive::Cable => radii(section, kind),
            _ => ratio(section, drive),
        };
        let backlash_m = backlash(section, drive);
        let (winch_radius_m, pulley_radius_m) = radii?;
        Some(Self { name: name?, kind, drive, winch_radius_m, pulley_radius_m, backlash_m: backlash_m? })
    }

    /// Reads what drives a joint; a cable where it says nothing.
    pub fn read_drive(section: &Section<'_>, kind: JointKind) -> Drive {
        let drive = section.may("drive").choice(&Drive::ALL.map(|drive| (drive.name(), drive))).unwrap_or_default();
        if (drive == Drive::Screw) == (kind == JointKind::Revolute) && matches!(drive, Drive::Screw | Drive::Gear) {
            let what = format!("is {} on a {} joint", drive.name(), kind.name());
            section.reject("drive", what, "a gear turns a revolute joint, a screw moves a prismatic one");
        }
        drive
    }
}

impl<S: Scalar> Joint<S> {
    /// r1 / r2: a torque at the joint times this is a torque at the winch.
    pub fn transmission(&self) -> f64 {
        self.winch_radius_m / self.pulley_radius_m
    }

    /// Whether its sensor reads a force, N: a slide's does, except behind a screw, whose motor gives a torque.
    pub fn reads_force(&self) -> bool {
        self.kind == JointKind::Prismatic && self.drive != Drive::Screw
    }

    /// The joint travel that takes up the clearance, X_cl / r2, rad.
    pub fn backlash_rad(&self) -> S {
        self.backlash_m / self.pulley_radius_m
    }
}

/// r1 and r2 of a cable.
fn radii(section: &Section<'_>, kind: JointKind) -> Option<(f64, f64)> {
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
    let means = "the winch's radius in m; for a joint without a cable, `drive = \"gear\"`, `\"direct\"` or `\"screw\"`";
    let winch_radius_m = radius("winch_radius_m", "0.012", means);
    let pulley_radius_m = radius("pulley_radius_m", "0.040", "the radius of the pulley at the joint in m");
    Some((winch_radius_m?, pulley_radius_m?))
}

/// r1 and r2 that stand for the ratio of another drive; a model's file gives them as they are.
fn ratio(section: &Section<'_>, drive: Drive) -> Option<(f64, f64)> {
    let keys = ["winch_radius_m", "pulley_radius_m"];
    if keys.iter().all(|key| section.keys().any(|present| present == *key)) {
        return Some((section.need(keys[0]).positive()?, section.need(keys[1]).positive()?));
    }
    for key in keys.into_iter().filter(|key| section.keys().any(|present| present == *key)) {
        let what = format!("is given, and the joint's drive is `{}`", drive.name());
        section.reject(key, what, "delete it; a cable drive has radii");
        section.may(key).ignore();
    }
    match drive {
        Drive::Direct | Drive::Cable => Some((1.0, 1.0)),
        Drive::Gear => {
            let ratio =
                section.need("gear_ratio").such_as("100.0", "turns of the motor for one of the joint").positive();
            ratio.map(|ratio| (1.0 / ratio, 1.0))
        }
        Drive::Screw => {
            let lead_m =
                section.need("lead_m").such_as("0.005", "travel of the slide for a turn of the screw, m").positive();
            lead_m.map(|lead_m| (lead_m / std::f64::consts::TAU, 1.0))
        }
    }
}

/// The clearance: on the cable, or at the joint, which on an r2 of 1 m is the same number.
fn backlash(section: &Section<'_>, drive: Drive) -> Option<f64> {
    let is_given = |key: &str| section.keys().any(|present| present == key);
    if drive != Drive::Cable && !is_given("backlash_m") {
        return Some(section.may("backlash_rad").not_negative().unwrap_or(0.0));
    }
    let means = "the clearance as travel of the cable in m, 0 without any";
    let backlash_m = section.need("backlash_m").such_as("0.0008", means).not_negative();
    if let Some(backlash_m) = backlash_m.filter(|backlash_m| *backlash_m > POSSIBLE_BACKLASH_M) {
        let what = format!("is {backlash_m:e} m, which no cable has");
        section.reject("backlash_m", what, "give it in metres of cable: 0.8 mm is 0.0008");
    }
    backlash_m
}
