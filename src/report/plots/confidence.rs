//! How well each parameter is known: intervals relative to the value.

use crate::identify::Identification;
use crate::model::{Confidence, Status};
use crate::report::chart::{Axis, Figure, Mark, Panel, Point, Stroke, palette};
use crate::report::number::{significant, with_minus};
use crate::report::parameters::{Parameter, parameters};
use crate::report::wording::{moving, status_word};

/// Height of a row, px.
const ROW_PX: f64 = 23.0;
/// The axis ends at this deviation, percent; what goes on beyond gets an arrow.
const REACH_PERCENT: f64 = 1000.0;
/// The axis is linear below this deviation, percent.
const LINEAR_PERCENT: f64 = 1.0;

const CAPTION: &str = "95 % intervals relative to the value, on an axis that is logarithmic away from zero; arrows run on beyond it. \
                       Only pinned parameters can be read one by one. Wide intervals of a_j, b and c together are the rule: the \
                       two exponentials are nearly exchangeable.";

/// One row per parameter; `None` when nothing is known of any.
pub fn figure(found: &Identification) -> Option<Figure> {
    // Nothing is relative to a value of zero.
    let shows = |p: &Parameter| !p.left_out && p.confidence.is_some() && p.value != 0.0;
    let shown: Vec<Parameter> = parameters(&found.model).into_iter().filter(shows).collect();
    if shown.is_empty() {
        return None;
    }
    let x = Axis::signed_log("deviation from the value (%)", -REACH_PERCENT, REACH_PERCENT, LINEAR_PERCENT);
    let mut panel = Panel::new(x, Axis::names(shown.iter().map(name)));
    panel.line("", [(0.0, 0.0), (0.0, -(shown.len() as f64))], Stroke::solid(palette::GREY, 1.2));
    for (i, parameter) in shown.iter().enumerate() {
        let Some(confidence) = &parameter.confidence else { continue };
        let level = -(i as f64) - 0.5;
        interval(&mut panel, parameter.value, confidence, level);
        panel.beside.push((level, status_word(confidence.status).to_string()));
    }
    let height = ROW_PX * shown.len() as f64;
    Some(Figure::single("confidence", "How well each parameter is known", CAPTION, height, panel))
}

/// "a_j, moving up: 37.5 N".
fn name(parameter: &Parameter) -> String {
    let direction = parameter.direction.map_or(String::new(), |direction| format!(", {}", moving(direction)));
    let value = with_minus(&significant(parameter.value, 4));
    format!("{}{direction}: {value} {}", parameter.name, parameter.unit).trim_end().to_string()
}

/// The interval with its value at zero; an end beyond the axis, or open, as an arrow.
fn interval(panel: &mut Panel, value: f64, confidence: &Confidence, level: f64) {
    let color = palette::status(confidence.status);
    let percent = |end: f64| 100.0 * (end - value) / value.abs();
    let (low, high) = (percent(confidence.low), percent(confidence.high));
    let clipped = |end: f64| if end.is_nan() { 0.0 } else { end.clamp(-REACH_PERCENT, REACH_PERCENT) };
    let at = |x: f64| -> Vec<Point> { vec![(clipped(x), level)] };
    panel.line("", [(clipped(low), level), (clipped(high), level)], Stroke::solid(color, 3.0));
    for (end, arrow) in [(low, Mark::Leftwards), (high, Mark::Rightwards)] {
        match end.abs() > REACH_PERCENT {
            true => panel.marks("", at(end), arrow, color),
            false => {
                let tick = [(clipped(end), level - 0.22), (clipped(end), level + 0.22)];
                panel.line("", tick, Stroke::solid(color, 2.0));
            }
        }
    }
    panel.marks(status_word(confidence.status), vec![(0.0, level)], sign(confidence.status), color);
}

fn sign(status: Status) -> Mark {
    match status {
        Status::Pinned => Mark::Disc(4.5),
        Status::TradeOff => Mark::Diamond,
        Status::Merged => Mark::Up,
        Status::Flat => Mark::Ring,
        Status::AtBound => Mark::Square,
    }
}
