//! Error with and without the combination coefficient, in stable state and in transition: the paper's figure 8.

use super::reversals::stroke;
use crate::evaluate::{Evaluation, Figures, Source, Split, Spread};
use crate::report::chart::{Anchor, Axis, Canvas, Drawn, Frame, LABEL_PX, Panel, TEXT_PX, palette, svg};
use crate::report::number::significant;
use crate::report::page::Drawing;
use crate::report::wording::Units;

/// A bar's half width, in places of the axis, where each curve takes one.
const HALF: f64 = 0.32;

/// How to get the figures of a part of the samples.
type Part = fn(&Split) -> Figures;

/// The parts, by name.
const PARTS: [(&str, Part); 3] =
    [("all samples", |s| s.all), ("stable state", |s| s.stable), ("transition", |s| s.transition)];

/// Mean absolute error and peak by curve.
pub(super) fn draw(evaluation: &Evaluation) -> Drawn<Drawing> {
    let units = Units::of(evaluation.model.joint.kind);
    let drawn = svg(860, 560, "Error with and without the combination coefficient", |canvas| {
        row(canvas, evaluation, &units, 50.0, "MAE", |f| f.mae_nm)?;
        row(canvas, evaluation, &units, 310.0, "peak", |f| f.peak_nm)
    })?;
    Ok(Drawing {
        name: "combinations".to_string(),
        title: "Error with and without the combination coefficient".to_string(),
        caption: "Mean absolute error (above) and largest error (below) of each curve, low-passed: mean over trials, with one \
                  standard deviation. Sign is the model without any coefficient. The curves differ in transitions, \
                  of which the low-pass carries a little into stable state, and with the sign curve wherever the speed's \
                  sign is not K_f's; the rest there is the branches' own error and the sensor's noise."
            .to_string(),
        svg: drawn,
    })
}

fn row(
    canvas: &Canvas,
    evaluation: &Evaluation,
    units: &Units,
    top: f64,
    name: &str,
    of: fn(&Figures) -> f64,
) -> Drawn {
    let spread =
        |part: fn(&Split) -> Figures, at: usize| Spread::of(evaluation.trials.iter().map(|t| of(&part(&t.rivals[at]))));
    let numbers = 0..evaluation.rivals.len();
    let ends = |s: Spread| s.mean + if s.sd.is_finite() { s.sd } else { 0.0 };
    for (i, (title, part)) in PARTS.iter().enumerate() {
        let values: Vec<Spread> = numbers.clone().map(|at| spread(*part, at)).collect();
        // Each to a scale of its own: the stable state's bars would vanish beside the transition's.
        let highest = values.iter().map(|s| ends(*s)).filter(|x| x.is_finite()).fold(0.0, f64::max);
        let (unit, factor) = units.torque_scale(highest);
        let left = 86.0 + 268.0 * i as f64;
        let frame = Frame { left, top, right: left + 206.0, bottom: top + 176.0 };
        let y = Axis::linear(format!("{name} ({unit})"), 0.0, 1.16 * factor * highest);
        let x = Axis::linear("", -0.6, numbers.len() as f64 - 0.4).without_ticks();
        let panel = canvas.panel(frame, x, y)?;
        canvas.text((left, top - 14.0), title, LABEL_PX, palette::INK, Anchor::Left)?;
        for (at, value) in values.iter().enumerate().filter(|(_, value)| value.mean.is_finite()) {
            bar(canvas, &panel, frame, evaluation, at, (factor * value.mean, factor * value.sd))?;
        }
    }
    Ok(())
}

fn bar(
    canvas: &Canvas,
    panel: &Panel,
    frame: Frame,
    evaluation: &Evaluation,
    at: usize,
    (mean, sd): (f64, f64),
) -> Drawn {
    let rival = &evaluation.rivals[at];
    let taken = rival.source == Source::Model;
    let color = stroke(rival.kind, taken).color;
    let x = at as f64;
    panel.band(
        &[(x - HALF, 0.0), (x + HALF, 0.0)],
        &[(x - HALF, mean), (x + HALF, mean)],
        color,
        if taken { 0.9 } else { 0.45 },
    )?;
    if sd.is_finite() {
        let ink = crate::report::chart::Stroke::solid(palette::INK, 1.4);
        panel.line([(x, mean - sd), (x, mean + sd)], ink)?;
        for end in [mean - sd, mean + sd] {
            panel.line([(x - 0.08, end), (x + 0.08, end)], ink)?;
        }
    }
    let across = |place: f64| {
        frame.left + (frame.right - frame.left) * (place - panel.x.places.0) / (panel.x.places.1 - panel.x.places.0)
    };
    let up = |y: f64| frame.bottom - (frame.bottom - frame.top) * y / panel.y.places.1;
    let above = mean + if sd.is_finite() { sd } else { 0.0 };
    canvas.text((across(x), up(above) - 10.0), &significant(mean, 3), TEXT_PX - 1.0, palette::INK, Anchor::Middle)?;
    let name = if taken { format!("{}*", rival.kind.name()) } else { rival.kind.name().to_string() };
    canvas.text((across(x), frame.bottom + 8.0), &name, TEXT_PX, palette::INK, Anchor::Below)
}
