//! How well each parameter is known: intervals relative to the value.

use crate::identify::Identification;
use crate::model::{Confidence, Direction, Status};
use crate::report::chart::{Anchor, Axis, Canvas, Drawn, Frame, LABEL_PX, Mark, Panel, Stroke, TEXT_PX, palette, svg};
use crate::report::number::{significant, with_minus};
use crate::report::parameters::{Parameter, parameters};
use crate::report::wording::{moving, status_word};

/// Height of a row, px.
const ROW_PX: f64 = 23.0;
/// The axis ends at this deviation, percent; what goes on beyond gets an arrow.
const REACH_PERCENT: f64 = 1000.0;
/// The axis is linear below this deviation, percent.
const LINEAR_PERCENT: f64 = 1.0;
const LEFT_PX: f64 = 240.0;
const RIGHT_PX: f64 = 756.0;

/// One row per parameter; `None` when nothing is known of any.
pub fn draw(found: &Identification) -> Drawn<Option<String>> {
    // Nothing is relative to a value of zero.
    let shows = |p: &Parameter| !p.left_out && p.confidence.is_some() && p.value != 0.0;
    let shown: Vec<Parameter> = parameters(&found.model).into_iter().filter(shows).collect();
    if shown.is_empty() {
        return Ok(None);
    }
    let rows = rows(&shown);
    let bottom = 40.0 + ROW_PX * rows.len() as f64 + 6.0;
    svg(860, (bottom + 56.0) as u32, "Confidence of each parameter", |canvas| {
        let x = Axis::signed_log("deviation from the value (%)", -REACH_PERCENT, REACH_PERCENT, LINEAR_PERCENT);
        let mut y = Axis::linear("", 0.0, rows.len() as f64);
        y.ticks.clear();
        let frame = Frame { left: LEFT_PX, top: 40.0, right: RIGHT_PX, bottom };
        let panel = canvas.panel(frame, x, y)?;
        panel.line([(0.0, 0.0), (0.0, rows.len() as f64)], Stroke::solid(palette::GREY, 1.2))?;
        for (i, row) in rows.iter().enumerate() {
            let level = rows.len() as f64 - i as f64 - 0.5;
            let y_px = frame.top + (frame.bottom - frame.top) * (i as f64 + 0.5) / rows.len() as f64;
            match row {
                Row::Heading(text) => canvas.text((14.0, y_px), text, LABEL_PX, palette::INK, Anchor::Left)?,
                Row::Parameter(parameter, confidence) => {
                    label(canvas, parameter, y_px, confidence.status)?;
                    interval(&panel, parameter.value, confidence, level)?;
                }
            }
        }
        let entry = |status: Status| (sign(status), palette::status(status), status_word(status).to_string());
        canvas.legend((LEFT_PX, 860.0), 20.0, &Status::ALL.map(entry))
    })
    .map(Some)
}

enum Row<'a> {
    Heading(&'static str),
    Parameter(&'a Parameter, Confidence),
}

/// The parameters under the headings of their branches.
fn rows(shown: &[Parameter]) -> Vec<Row<'_>> {
    let mut rows = Vec::new();
    let mut last: Option<Option<Direction>> = None;
    for parameter in shown {
        if last != Some(parameter.direction) {
            rows.push(Row::Heading(parameter.direction.map_or("combination", moving)));
            last = Some(parameter.direction);
        }
        rows.extend(parameter.confidence.map(|confidence| Row::Parameter(parameter, confidence)));
    }
    rows
}

fn label(canvas: &Canvas, parameter: &Parameter, y_px: f64, status: Status) -> Drawn {
    let value = format!("{} {}", with_minus(&significant(parameter.value, 4)), parameter.unit);
    canvas.text((28.0, y_px), parameter.name, TEXT_PX, palette::INK, Anchor::Left)?;
    canvas.text((LEFT_PX - 10.0, y_px), value.trim(), TEXT_PX, palette::INK, Anchor::Right)?;
    canvas.text((RIGHT_PX + 12.0, y_px), status_word(status), TEXT_PX, palette::INK, Anchor::Left)
}

/// The interval with its value at zero; an end beyond the axis, or open, as an arrow.
fn interval(panel: &Panel, value: f64, confidence: &Confidence, level: f64) -> Drawn {
    let color = palette::status(confidence.status);
    let percent = |end: f64| 100.0 * (end - value) / value.abs();
    let (low, high) = (percent(confidence.low), percent(confidence.high));
    let clipped = |end: f64| if end.is_nan() { 0.0 } else { end.clamp(-REACH_PERCENT, REACH_PERCENT) };
    panel.line([(clipped(low), level), (clipped(high), level)], Stroke::solid(color, 3.0))?;
    for (end, arrow) in [(low, Mark::Leftwards), (high, Mark::Rightwards)] {
        if end.abs() > REACH_PERCENT {
            panel.mark((clipped(end), level), arrow, color)?;
        } else {
            panel.line([(clipped(end), level - 0.22), (clipped(end), level + 0.22)], Stroke::solid(color, 2.0))?;
        }
    }
    panel.mark((0.0, level), sign(confidence.status), color)
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
