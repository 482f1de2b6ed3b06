//! The same motion with neither side filtered.

use super::Shown;
use super::series::line;
use crate::report::chart::{Anchor, Axis, Drawn, Frame, Mark, Stroke, TEXT_PX, palette, span, svg};
use crate::report::page::Drawing;

/// Torque and error as recorded.
pub(super) fn draw(shown: &Shown) -> Drawn<Drawing> {
    let trial = shown.trials[0];
    let view = &trial.view;
    let (low, high): (Vec<f64>, Vec<f64>) = view.raw_nm.iter().copied().unzip();
    let (error_low, error_high): (Vec<f64>, Vec<f64>) = view.raw_error_nm.iter().copied().unzip();
    let heading = format!("{}; as recorded, nothing filtered", trial.entry.file);
    let svg = svg(860, 520, &heading, |canvas| {
        canvas.text((92.0, 14.0), &heading, TEXT_PX, palette::INK, Anchor::Left)?;
        let time = Axis::linear("time (s)", view.time_s[0], span(view.time_s.iter().copied()).1);
        let all = low.iter().chain(&high).chain(&view.raw_predicted_nm).copied();
        let y = Axis::around(format!("torque ({})", shown.units.torque), all, 0.04);
        let upper = Frame { left: 92.0, top: 54.0, right: 840.0, bottom: 264.0 };
        let panel = canvas.panel(upper, time.clone().without_texts(), y)?;
        let band =
            |values: &[f64]| -> Vec<(f64, f64)> { view.time_s.iter().copied().zip(values.iter().copied()).collect() };
        panel.band(&band(&low), &band(&high), palette::GREY, 0.6)?;
        line(&panel, view, &low, Stroke::solid(palette::GREY, 0.4))?;
        line(&panel, view, &high, Stroke::solid(palette::GREY, 0.4))?;
        line(&panel, view, &view.raw_predicted_nm, Stroke::solid(palette::VERMILION, 1.2))?;
        let entries = [
            (Mark::Band, palette::GREY, "measured, as recorded".to_string()),
            (Mark::Line(1.2, None), palette::VERMILION, "predicted, not filtered".to_string()),
        ];
        canvas.legend((92.0, 840.0), 38.0, &entries)?;
        let y =
            Axis::around(format!("error ({})", shown.units.torque), error_low.iter().chain(&error_high).copied(), 0.06);
        let panel = canvas.panel(Frame { left: 92.0, top: 292.0, right: 840.0, bottom: 462.0 }, time, y)?;
        panel.band(&band(&error_low), &band(&error_high), palette::BLUE, 0.5)?;
        line(&panel, view, &error_low, Stroke::solid(palette::BLUE, 0.4))?;
        line(&panel, view, &error_high, Stroke::solid(palette::BLUE, 0.4))
    })?;
    Ok(Drawing {
        name: format!("{}_raw", shown.slug),
        title: format!("{}: raw", trial.entry.file),
        caption: "Torque as the sensor gave it and the prediction, neither of them filtered; below, their difference. Bands \
                  run from the lowest to the highest reading of each short stretch. Their width is the sensor's noise, which \
                  no model predicts."
            .to_string(),
        svg,
    })
}
