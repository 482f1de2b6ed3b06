//! The joint's geometry.

use crate::document::Section;
use crate::dynamics::JointKind;

/// What a ruler tells of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// r1, m.
    pub winch_radius_m: f64,
    /// r2, m.
    pub pulley_radius_m: f64,
    /// X_cl, the clearance as displacement on the cable, m.
    pub backlash_m: f64,
}

impl Joint {
    /// Reads `[joint]` of a campaign or `joint` of a model; faults go to the section.
    pub fn read(section: &Section<'_>) -> Option<Self> {
        let name = section.need("name").text();
        let kinds = [JointKind::Revolute, JointKind::Prismatic].map(|kind| (kind.name(), kind));
        let kind = section.may("kind").choice(&kinds).unwrap_or_default();
        let radius = |key: &str| {
            let radius_m = section.need(key).positive()?;
            if kind == JointKind::Prismatic && radius_m != 1.0 {
                section.reject(key, format!("is {radius_m} on a prismatic joint"), "set it to 1.0: there is no arm");
            }
            Some(radius_m)
        };
        let (winch_radius_m, pulley_radius_m) = (radius("winch_radius_m"), radius("pulley_radius_m"));
        let backlash_m = section.need("backlash_m").not_negative();
        Some(Self {
            name: name?,
            kind,
            winch_radius_m: winch_radius_m?,
            pulley_radius_m: pulley_radius_m?,
            backlash_m: backlash_m?,
        })
    }

    /// r1 / r2: a torque at the joint times this is a torque at the winch.
    pub fn transmission(&self) -> f64 {
        self.winch_radius_m / self.pulley_radius_m
    }

    /// The joint travel that takes up the clearance, X_cl / r2, rad.
    pub fn backlash_rad(&self) -> f64 {
        self.backlash_m / self.pulley_radius_m
    }
}
