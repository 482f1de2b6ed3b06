//! The figures: results made into panels and series, one file each.

mod amplitude;
pub mod comparison;
mod confidence;
pub mod diagnosis;
pub mod evaluation;
pub mod excitation;
pub mod fleet;
pub mod friction;
pub mod interaction;
pub mod repeatability;
mod residual_cloud;
mod residual_time;
mod sweep;
mod transition;
pub mod validation;

use super::chart::Figure;
use crate::identify::Identification;

/// Makes a figure of an identification; `None` where the data for it are absent.
pub type Make = fn(&Identification) -> Option<Figure>;

/// All figures of an identification, in the order of the protocol.
pub const FIGURES: [Make; 8] = [
    sweep::figure,
    amplitude::figure,
    friction::figure,
    transition::figure,
    residual_time::figure,
    residual_cloud::against_position,
    residual_cloud::against_speed,
    confidence::figure,
];

/// Letters, digits, dots and dashes; what else a name holds becomes an underscore.
fn slug(name: &str) -> String {
    let stem = name.strip_suffix(".csv").or_else(|| name.strip_suffix(".parquet")).unwrap_or(name);
    stem.chars().map(|c| if c.is_alphanumeric() || matches!(c, '.' | '-') { c } else { '_' }).collect()
}
