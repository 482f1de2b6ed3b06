//! `[uncertainty]` of a campaign: how far its declared constants may be off. All keys are optional.

use crate::document::Section;

/// Half width of the 95 % interval of the position's zero where none is declared, rad: 5 deg, what is seen by eye.
pub const POSITION_ZERO_RAD: f64 = 0.087_266;
/// The largest that may be declared, rad: beyond a quarter of a turn the sign of gravity is not known.
const POSITION_ZERO_MOST_RAD: f64 = 1.5;
/// The largest share that may be declared, percent.
const MOST_PERCENT: f64 = 50.0;

/// Half widths of the 95 % intervals of what a campaign declares; 0 where it is taken as exact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertainty {
    /// Of the position's zero, rad; 0 takes the zero as declared and does not fit it.
    pub position_zero_rad: f64,
    /// Of the torque's zero, N m: an offset of the sensor looks like asymmetric Coulomb friction, no motion tells them apart.
    pub torque_zero_nm: f64,
    /// Of the torque's scale, percent.
    pub torque_scale_percent: f64,
    /// Of the gravity torque, declared or from a URDF, or of the measured load, percent.
    pub gravity_percent: f64,
    /// Of each of the two radii, percent.
    pub radii_percent: f64,
}

impl Default for Uncertainty {
    fn default() -> Self {
        Self {
            position_zero_rad: POSITION_ZERO_RAD,
            torque_zero_nm: 0.0,
            torque_scale_percent: 0.0,
            gravity_percent: 0.0,
            radii_percent: 0.0,
        }
    }
}

impl Uncertainty {
    /// Reads `[uncertainty]`; faults go to the section.
    pub(super) fn read(section: &Section<'_>) -> Option<Self> {
        let up_to = |key: &str, most: f64, unit: &str, otherwise: f64| {
            let value = section.may(key).not_negative();
            if let Some(x) = value.filter(|x| *x > most) {
                section.reject(key, format!("is {x} {unit}"), format!("expected 0 to {most} {unit}"));
            }
            value.unwrap_or(otherwise)
        };
        let percent = |key: &str| up_to(key, MOST_PERCENT, "percent", 0.0);
        Some(Self {
            position_zero_rad: up_to("position_zero_rad", POSITION_ZERO_MOST_RAD, "rad", POSITION_ZERO_RAD),
            torque_zero_nm: up_to("torque_zero_nm", f64::INFINITY, "N m", 0.0),
            torque_scale_percent: percent("torque_scale_percent"),
            gravity_percent: percent("gravity_percent"),
            radii_percent: percent("radii_percent"),
        })
    }

    /// Keys and values that differ from what holds where nothing is declared.
    pub(super) fn pairs(&self) -> Vec<(&'static str, toml::Value)> {
        let (mine, usual) = (self.named(), Self::default().named());
        // An unknown scale follows from what the columns lack.
        let differ = mine.into_iter().zip(usual).filter(|(mine, usual)| mine.1 != usual.1 && mine.1.is_finite());
        differ.map(|((key, value), _)| (key, value.into())).collect()
    }

    fn named(&self) -> [(&'static str, f64); 5] {
        [
            ("position_zero_rad", self.position_zero_rad),
            ("torque_zero_nm", self.torque_zero_nm),
            ("torque_scale_percent", self.torque_scale_percent),
            ("gravity_percent", self.gravity_percent),
            ("radii_percent", self.radii_percent),
        ]
    }

    /// Relative half width of 1 - mu_c = (r1/r2) G / A.
    pub fn of_loss(&self) -> f64 {
        let radii = self.radii_percent * std::f64::consts::SQRT_2;
        self.torque_scale_percent.hypot(self.gravity_percent).hypot(radii) / 100.0
    }

    /// Relative half width of a friction force, which goes as G B / (r2 A): the torque's scale cancels.
    pub fn of_force(&self) -> f64 {
        self.gravity_percent.hypot(self.radii_percent) / 100.0
    }
}
