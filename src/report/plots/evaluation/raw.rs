//! The same motion with neither side filtered.

use super::Shown;
use crate::report::chart::{Axis, Figure, Stroke, palette};

const CAPTION: &str = "Torque as the sensor gave it and the prediction, neither of them filtered; below, their difference. Bands run \
                       from the lowest to the highest reading of each short stretch. Their width is the sensor's noise, which no \
                       model predicts.";

/// Torque and error as recorded.
pub(super) fn figure(shown: &Shown) -> Figure {
    let view = &shown.trial.view;
    let edges = |values: &[(f64, f64)]| {
        [shown.over_time(values.iter().map(|v| v.0)), shown.over_time(values.iter().map(|v| v.1))]
    };
    let readings = view.raw_nm.iter().flat_map(|(low, high)| [*low, *high]);
    let y = Axis::around(
        format!("torque ({})", shown.units.torque),
        readings.chain(view.raw_predicted_nm.iter().copied()),
        0.04,
    );
    let mut upper = shown.panel(false, y);
    upper.band("measured, as recorded", edges(&view.raw_nm), palette::GREY, 0.6);
    let predicted = shown.over_time(view.raw_predicted_nm.iter().copied());
    upper.line("predicted, not filtered", predicted, Stroke::solid(palette::VERMILION, 1.2));
    let errors = view.raw_error_nm.iter().flat_map(|(low, high)| [*low, *high]);
    let y = Axis::around(format!("error ({})", shown.units.torque), errors, 0.06);
    let mut lower = shown.panel(true, y);
    lower.band("error", edges(&view.raw_error_nm), palette::BLUE, 0.5);
    Figure::new(
        format!("{}_raw", shown.slug),
        format!("{}: as recorded, nothing filtered", shown.trial.entry.file),
        CAPTION,
    )
    .row(190.0, vec![upper])
    .row(150.0, vec![lower])
}
