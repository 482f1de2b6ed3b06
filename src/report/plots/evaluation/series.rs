//! One motion from top to bottom: trajectory, torque, its parts, error; both sides low-passed.

use super::Shown;
use crate::evaluate::View;
use crate::report::chart::{
    Anchor, Axis, Canvas, Drawn, Frame, Mark, Panel, Stroke, TEXT_PX, palette, span, svg, thin,
};
use crate::report::number::significant;
use crate::report::page::Drawing;
use plotters::style::RGBColor;

/// Stretches of time of which the lowest and highest point are drawn.
const BUCKETS: usize = 900;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 840.0;

/// A line's name, values, colour and dashes.
type Part<'a> = (&'static str, &'a [f64], RGBColor, Option<(f64, f64)>);

/// The four panels.
pub(super) fn draw(shown: &Shown) -> Drawn<Drawing> {
    let first = &shown.trials[0].view;
    let svg = svg(860, 900, &shown.title, |canvas| {
        canvas.text(
            (LEFT, 14.0),
            &format!("{}; low-passed at {} Hz", shown.title, significant(shown.lowpass_hz, 3)),
            TEXT_PX,
            palette::INK,
            Anchor::Left,
        )?;
        let time = |last: bool| {
            let axis = Axis::linear("time (s)", first.time_s[0], span(first.time_s.iter().copied()).1);
            if last { axis } else { axis.without_texts() }
        };
        trajectory(canvas, shown, time(false))?;
        torque(canvas, shown, time(false))?;
        parts(canvas, shown, time(false))?;
        error(canvas, shown, time(true))
    })?;
    Ok(Drawing {
        name: format!("{}_series", shown.slug),
        title: format!("{}: prediction and measurement, low-passed", shown.title),
        caption: "From above: the joint's trajectory; the torque of every trial as measured with the prediction, both through \
                  the declared low-pass; what the prediction is made of; and the error, measured less predicted. The error \
                  should be noise about zero in stable state; peaks stand at reversals, where friction changes over. Pale \
                  parts are in no figure: K_f is not known yet, or the sensor was at its limit."
            .to_string(),
        svg,
    })
}

fn frame(top: f64, height: f64) -> Frame {
    Frame { left: LEFT, top, right: RIGHT, bottom: top + height }
}

fn trajectory(canvas: &Canvas, shown: &Shown, time: Axis) -> Drawn {
    let (view, units) = (&shown.trials[0].view, &shown.units);
    let positions: Vec<f64> = view.position_rad.iter().map(|x| units.position_factor * x).collect();
    let y = Axis::around(format!("position ({})", units.position), positions.iter().copied(), 0.06);
    line(&canvas.panel(frame(34.0, 120.0), time, y)?, view, &positions, Stroke::solid(palette::INK, 1.4))
}

fn torque(canvas: &Canvas, shown: &Shown, time: Axis) -> Drawn {
    let first = &shown.trials[0].view;
    let all = shown.trials.iter().flat_map(|t| t.view.torque_nm.iter().copied());
    let y =
        Axis::around(format!("torque ({})", shown.units.torque), all.chain(first.predicted_nm.iter().copied()), 0.04);
    let panel = canvas.panel(frame(190.0, 210.0), time, y)?;
    for trial in &shown.trials {
        line(&panel, &trial.view, &trial.view.torque_nm, Stroke::solid(palette::PALE, 3.4))?;
    }
    line(&panel, first, &first.predicted_nm, Stroke::solid(palette::VERMILION, 1.2))?;
    let entries = [
        (Mark::Line(3.4, None), palette::PALE, "measured".to_string()),
        (Mark::Line(1.2, None), palette::VERMILION, "predicted".to_string()),
    ];
    canvas.legend((LEFT, RIGHT), 174.0, &entries)
}

fn parts(canvas: &Canvas, shown: &Shown, time: Axis) -> Drawn {
    let view = &shown.trials[0].view;
    let all: [Part; 5] = [
        ("friction", &view.friction_nm, palette::GREEN, None),
        ("gravity", &view.gravity_nm, palette::BLUE, None),
        ("inertia", &view.inertia_nm, palette::ORANGE, Some((6.0, 2.0))),
        ("Coriolis", &view.coriolis_nm, palette::PURPLE, Some((2.0, 3.0))),
        ("measured load", &view.load_nm, palette::INK, Some((8.0, 3.0))),
    ];
    // A part that is nowhere different from zero would only hide the axis.
    let there: Vec<&Part> = all.iter().filter(|part| part.1.iter().any(|y| *y != 0.0)).collect();
    let values = there.iter().flat_map(|part| part.1.iter().copied());
    let y = Axis::around(format!("parts ({})", shown.units.torque), values.chain([0.0]), 0.06);
    let panel = canvas.panel(frame(440.0, 180.0), time, y)?;
    let mut entries = Vec::new();
    for (name, values, color, dash_px) in there {
        line(&panel, view, values, Stroke { color: *color, width_px: 1.4, dash_px: *dash_px })?;
        entries.push((Mark::Line(1.6, *dash_px), *color, (*name).to_string()));
    }
    canvas.legend((LEFT, RIGHT), 424.0, &entries)
}

fn error(canvas: &Canvas, shown: &Shown, time: Axis) -> Drawn {
    let errors: Vec<Vec<f64>> =
        shown.trials.iter().map(|t| difference(&t.view.torque_nm, &t.view.predicted_nm)).collect();
    let judged = errors.iter().zip(&shown.trials).flat_map(|(e, t)| e.iter().zip(&t.view.judged).filter(|(_, j)| **j));
    let (low, high) = span(judged.map(|(e, _)| *e));
    let (unit, factor) = shown.units.torque_scale(low.abs().max(high.abs()));
    let y = Axis::around(format!("error ({unit})"), [factor * low, factor * high, 0.0], 0.08);
    let panel = canvas.panel(frame(660.0, 180.0), time, y)?;
    let colors = [palette::BLUE, palette::GREEN, palette::PURPLE];
    let mut entries = Vec::new();
    for ((error, trial), color) in errors.iter().zip(&shown.trials).zip(colors.iter().cycle()) {
        let scaled: Vec<f64> = error.iter().map(|e| factor * e).collect();
        line(&panel, &trial.view, &scaled, Stroke::solid(palette::PALE, 0.9))?;
        let shown: Vec<f64> =
            scaled.iter().zip(&trial.view.judged).map(|(e, j)| if *j { *e } else { f64::NAN }).collect();
        line(&panel, &trial.view, &shown, Stroke::solid(*color, 0.9))?;
        if entries.len() < 4 {
            entries.push((Mark::Line(1.6, None), *color, trial.entry.file.clone()));
        }
    }
    canvas.legend((LEFT, RIGHT), 644.0, &entries)
}

fn difference(measured: &[f64], predicted: &[f64]) -> Vec<f64> {
    measured.iter().zip(predicted).map(|(y, p)| y - p).collect()
}

/// `values` over the view's time, in runs without what is not a number, no peak lost.
pub(super) fn line(panel: &Panel, view: &View, values: &[f64], stroke: Stroke) -> Drawn {
    let points: Vec<(f64, f64)> = view.time_s.iter().copied().zip(values.iter().copied()).collect();
    for run in points.split(|p| !p.1.is_finite()).filter(|run| !run.is_empty()) {
        let buckets = (BUCKETS * run.len()).div_ceil(points.len());
        panel.line(thin::envelope(run, buckets), stroke)?;
    }
    Ok(())
}
