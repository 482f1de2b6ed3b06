//! Error by change-over curve, in stable state and in transition: the paper's figure 8.

use super::reversals::stroke;
use crate::evaluate::{Evaluation, Figures, Source, Split, Spread};
use crate::report::chart::{Anchor, Axis, Figure, Panel, Stroke, palette};
use crate::report::number::significant;
use crate::report::wording::Units;

/// A bar's half width, in places of the axis, where each curve takes one.
const HALF: f64 = 0.32;

/// How to get the figures of a part of the samples.
type Part = fn(&Split) -> Figures;

/// The parts, by name.
const PARTS: [(&str, Part); 3] =
    [("all samples", |s| s.all), ("stable state", |s| s.stable), ("transition", |s| s.transition)];

const CAPTION: &str = "Mean absolute error (above) and largest error (below) by change-over curve, which describes how friction passes from \
                       that of one direction to that of the other after a reversal (the paper's combination coefficient); low-passed, \
                       mean over trials with one standard deviation; * is the model's own. The curves differ in transitions, which the \
                       low-pass spreads slightly into the stable state, and the sign curve, which switches at once, also wherever the \
                       direction differs from the sign of K_f. Any other error is that of the branches and the sensor's noise.";

/// Mean absolute error and peak by curve.
pub(super) fn figure(evaluation: &Evaluation) -> Figure {
    let row = |name: &str, of: fn(&Figures) -> f64| -> Vec<Panel> {
        PARTS.iter().map(|(title, part)| panel(evaluation, name, title, *part, of)).collect()
    };
    Figure::new("combinations", "Error by change-over curve", CAPTION)
        .row(150.0, row("MAE", |f| f.mae_nm))
        .row(150.0, row("peak", |f| f.peak_nm))
}

fn panel(evaluation: &Evaluation, name: &str, title: &str, part: Part, of: fn(&Figures) -> f64) -> Panel {
    let units = Units::of(&evaluation.model.joint);
    let spread = |at: usize| Spread::of(evaluation.trials.iter().map(|t| of(&part(&t.rivals[at]))));
    let values: Vec<Spread> = (0..evaluation.rivals.len()).map(spread).collect();
    let end = |s: &Spread| s.mean + if s.sd.is_finite() { s.sd } else { 0.0 };
    // Each to a scale of its own: the stable state's bars would vanish beside the transition's.
    let highest = values.iter().map(end).filter(|x| x.is_finite()).fold(0.0, f64::max);
    let (unit, factor) = units.torque_scale(highest);
    let y = Axis::linear(format!("{name} ({unit})"), 0.0, 1.16 * factor * highest);
    let names = evaluation.rivals.iter().map(|rival| match rival.source {
        Source::Model => format!("{}*", rival.kind.name()),
        _ => rival.kind.name().to_string(),
    });
    let mut panel = Panel::new(Axis::columns(names), y).titled(title);
    for (at, value) in values.iter().enumerate().filter(|(_, value)| value.mean.is_finite()) {
        let rival = &evaluation.rivals[at];
        let color = stroke(rival.kind, true).color;
        let color = if rival.source == Source::Model { color } else { palette::lighter(color) };
        let (x, mean, sd) = (at as f64, factor * value.mean, factor * value.sd);
        panel.bar("", (x - HALF, x + HALF), (0.0, mean), color);
        if sd.is_finite() {
            let gap = (f64::NAN, f64::NAN);
            let ends = [mean - sd, mean + sd].map(|end| [(x - 0.08, end), (x + 0.08, end), gap]);
            let bar = [(x, mean - sd), (x, mean + sd), gap];
            panel.line("", bar.into_iter().chain(ends.concat()), Stroke::solid(palette::INK, 1.4));
        }
        let above = factor * end(value) + 0.06 * panel.y.places.1;
        panel.texts(vec![((x, above), significant(mean, 3))], Anchor::Middle, palette::INK);
    }
    panel
}
