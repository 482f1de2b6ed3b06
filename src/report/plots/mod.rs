//! The figures of an identification, one file each, and the list that the HTML and the image files go by.

mod amplitude;
pub mod comparison;
mod confidence;
pub mod diagnosis;
pub mod evaluation;
pub mod excitation;
pub mod fleet;
mod friction;
pub mod interaction;
pub mod repeatability;
mod residual_cloud;
mod residual_time;
mod sweep;
mod transition;

use super::chart::Drawn;
use crate::identify::Identification;

/// One figure.
pub struct Figure {
    /// Name of its file, without extension.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// What it shows, and what to look for.
    pub caption: &'static str,
    /// Draws it as SVG; `None` where the data for it are absent.
    pub draw: fn(&Identification) -> Drawn<Option<String>>,
}

/// All figures, in the order of the protocol.
pub const FIGURES: [Figure; 8] = [
    Figure {
        name: "sweep",
        title: "One sweep, as recorded and as fitted",
        caption: "Torque of the sweep of middle speed: as recorded, after the low-pass, and the fitted A sin(θ) + B of each \
                  leg. The fit should run through the middle of the low-passed signal over the whole leg; a bend that it \
                  does not follow is load that A sin(θ) does not describe, a ripple is torque that changes with position.",
        draw: sweep::draw,
    },
    Figure {
        name: "amplitude",
        title: "Load amplitude A of every leg",
        caption: "A of each leg with its standard error, the mean over legs (line) and ± one standard deviation (band). A \
                  should not depend on speed: a slope or a bend says that load and friction are not apart, and then μ_c, \
                  which comes from the mean of A, is wrong. Far from the others stands a bad trial.",
        draw: amplitude::draw,
    },
    Figure {
        name: "friction",
        title: "Friction against speed, B(v)",
        caption: "B of each leg with the fitted forms; below, what the form that the model takes leaves, with its 95 % band. \
                  Points should scatter about zero there, without a wave. Where the lines of the forms cannot be \
                  told apart within the scatter, the smaller form is enough, and the parameters of the larger one trade off.",
        draw: friction::draw,
    },
    Figure {
        name: "transition",
        title: "Change of friction after a reversal",
        caption: "Share of the change of friction against share of the clearance's travel, measured in the slow reversals; \
                  downward crossings are rotated onto the upward ones. Light dots are samples, heavy ones their medians, but \
                  for the first, which the low-pass blurs. The curve that the model takes is drawn bold. If up and down do not lie on each other, or the medians have not \
                  reached 1 at the right, the clearance or the branches are wrong.",
        draw: transition::draw,
    },
    Figure {
        name: "residual_time",
        title: "Residual against time",
        caption: "Measured less predicted torque, both low-passed, in a few trials: for each protocol the one with a typical \
                  residual and the one with the largest, each to a scale of its own. Peaks after each reversal point to the combination, a slow drift to \
                  temperature or the sensor, a level that differs between directions to friction.",
        draw: residual_time::draw,
    },
    Figure {
        name: "residual_position",
        title: "Residual against position",
        caption: "All trials: samples (dots), median (line) and the range that holds 80 % of them (band) by direction. Both \
                  medians off zero together: the load, its phase or a spring. Apart from each other: friction that changes \
                  with position. A wave: ripple of the torque.",
        draw: residual_cloud::against_position,
    },
    Figure {
        name: "residual_speed",
        title: "Residual against speed",
        caption: "The same against speed, logarithmic away from zero. A median that bends at low speed points to the \
                  Stribeck terms, one that grows with speed to viscous friction; a wide band near zero is the transition \
                  after reversals.",
        draw: residual_cloud::against_speed,
    },
    Figure {
        name: "confidence",
        title: "How well each parameter is known",
        caption: "95 % intervals relative to the value, on an axis that is logarithmic away from zero; arrows run on beyond \
                  it. Only pinned parameters can be read one by one. Wide intervals of a_j, b and c together are the rule: \
                  the two exponentials are nearly exchangeable.",
        draw: confidence::draw,
    },
];

/// Letters, digits, dots and dashes; what else a name holds becomes an underscore.
fn slug(name: &str) -> String {
    let stem = name.strip_suffix(".csv").or_else(|| name.strip_suffix(".parquet")).unwrap_or(name);
    stem.chars().map(|c| if c.is_alphanumeric() || matches!(c, '.' | '-') { c } else { '_' }).collect()
}
