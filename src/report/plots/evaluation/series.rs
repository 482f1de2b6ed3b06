//! One motion from top to bottom: trajectory, torque, error, the prediction's parts; both sides low-passed.

use super::Shown;
use crate::report::chart::{Axis, Color, Figure, Panel, Stroke, palette, span};
use crate::report::number::significant;

const CAPTION: &str = "From above: the joint's trajectory; the torque as measured with the prediction, both through the declared \
                       low-pass; the error, measured minus predicted; and the terms of the prediction. The error should be \
                       noise about zero in stable state; peaks occur at reversals, where friction changes over. Pale parts are \
                       not scored: K_f is not known yet, or the sensor was at its limit.";

/// The four panels.
pub(super) fn figure(shown: &Shown) -> Figure {
    let title = format!("{}: low-passed at {} Hz", shown.trial.entry.file, significant(shown.lowpass_hz, 3));
    Figure::new(format!("{}_series", shown.slug), title, CAPTION)
        .row(96.0, vec![trajectory(shown)])
        .row(190.0, vec![torque(shown)])
        .row(150.0, vec![error(shown)])
        .row(150.0, vec![parts(shown)])
}

fn trajectory(shown: &Shown) -> Panel {
    let units = &shown.units;
    let positions: Vec<f64> = shown.trial.view.position_rad.iter().map(|x| units.position_factor * x).collect();
    let y = Axis::around(format!("position ({})", units.position), positions.iter().copied(), 0.06).sparse();
    let mut panel = shown.panel(false, y);
    panel.line("", shown.over_time(positions), Stroke::solid(palette::INK, 1.4));
    panel
}

fn torque(shown: &Shown) -> Panel {
    let view = &shown.trial.view;
    let all = view.torque_nm.iter().chain(&view.predicted_nm).copied();
    let mut panel = shown.panel(false, Axis::around(format!("torque ({})", shown.units.torque), all, 0.04));
    let lines = [
        ("measured", &view.torque_nm, Stroke::solid(palette::PALE, 3.4)),
        ("predicted", &view.predicted_nm, Stroke::solid(palette::VERMILION, 1.2)),
    ];
    for (name, values, stroke) in lines {
        panel.line(name, shown.over_time(values.iter().copied()), stroke);
    }
    panel
}

/// Name, values, colour and dashes of a line.
type Line<'s> = (&'s str, &'s [f64], Color, Option<(f64, f64)>);

fn parts(shown: &Shown) -> Panel {
    let view = &shown.trial.view;
    let all: [Line<'_>; 5] = [
        ("friction", &view.friction_nm, palette::GREEN, None),
        ("gravity", &view.gravity_nm, palette::BLUE, None),
        ("inertia", &view.inertia_nm, palette::ORANGE, Some((6.0, 2.0))),
        ("Coriolis", &view.coriolis_nm, palette::PURPLE, Some((2.0, 3.0))),
        ("measured load", &view.load_nm, palette::INK, Some((8.0, 3.0))),
    ];
    // A part that is nowhere different from zero would only hide the axis.
    let there: Vec<_> = all.iter().filter(|part| part.1.iter().any(|y| *y != 0.0)).collect();
    let values = there.iter().flat_map(|part| part.1.iter().copied());
    let y = Axis::around(format!("parts ({})", shown.units.torque), values.chain([0.0]), 0.06);
    let mut panel = shown.panel(true, y);
    for (name, values, color, dash_px) in there {
        let stroke = Stroke { color: *color, width_px: 1.4, dash_px: *dash_px };
        panel.line(*name, shown.over_time(values.iter().copied()), stroke);
    }
    panel
}

fn error(shown: &Shown) -> Panel {
    let view = &shown.trial.view;
    let error: Vec<f64> = view.torque_nm.iter().zip(&view.predicted_nm).map(|(y, p)| y - p).collect();
    let (low, high) = span(error.iter().zip(&view.judged).filter(|(_, judged)| **judged).map(|(e, _)| *e));
    let (unit, factor) = shown.units.torque_scale(low.abs().max(high.abs()));
    let y = Axis::around(format!("error ({unit})"), [factor * low, factor * high, 0.0], 0.08);
    let mut panel = shown.panel(false, y);
    let only = |judged: bool| {
        error.iter().zip(&view.judged).map(move |(e, is)| if *is == judged { factor * e } else { f64::NAN })
    };
    panel.line("", shown.over_time(only(false)), Stroke::solid(palette::PALE, 0.9));
    panel.line("error", shown.over_time(only(true)), Stroke::solid(palette::BLUE, 0.9));
    panel
}
