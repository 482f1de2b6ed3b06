//! A closer look at some reversals, with every curve of the combination.

use super::Shown;
use crate::evaluate::{Evaluation, Source, View};
use crate::identify::CurveKind;
use crate::report::chart::{Anchor, Axis, Canvas, Drawn, Frame, Mark, Stroke, TEXT_PX, palette, span, svg};
use crate::report::number::significant;
use crate::report::page::Drawing;
use std::ops::Range;

/// Panels: two rows of three.
const PANELS: usize = 6;
/// Shown before the reversal and after the transition, in lengths of the transition ...
const AROUND: f64 = 0.6;
/// ... and at least this long, s.
const AROUND_LEAST_S: f64 = 0.4;

/// The panels; `None` without a transition.
pub(super) fn draw(shown: &Shown, evaluation: &Evaluation) -> Drawn<Option<Drawing>> {
    let view = &shown.trials[0].view;
    let all = transitions(view);
    let chosen: Vec<Range<usize>> = spread(&all, PANELS).cloned().collect();
    if chosen.is_empty() {
        return Ok(None);
    }
    let rows = chosen.len().div_ceil(3);
    let height = 70.0 + 250.0 * rows as f64;
    let drawn = svg(860, height as u32, "Reversals", |canvas| {
        legend(canvas, evaluation)?;
        for (i, range) in chosen.iter().enumerate() {
            let (left, top) = (86.0 + 268.0 * (i % 3) as f64, 66.0 + 250.0 * (i / 3) as f64);
            let frame = Frame { left, top, right: left + 206.0, bottom: top + 176.0 };
            panel(canvas, frame, shown, evaluation, range)?;
        }
        Ok(())
    })?;
    Ok(Some(Drawing {
        name: format!("{}_reversals", shown.slug),
        title: format!("{}: a closer look at reversals", shown.title),
        caption: "Torque around some reversals of the first trial, from slow to fast motion, low-passed: measured, and \
                  predicted with each curve. Sign jumps at once; linear goes in proportion to the cable's travel through the \
                  clearance; the curve that the model takes is drawn thick."
            .to_string(),
        svg: drawn,
    }))
}

/// Runs of samples with |K_f| < 1 that are judged.
fn transitions(view: &View) -> Vec<Range<usize>> {
    let inside = |at: usize| view.k_f[at].abs() < 1.0 && view.judged[at];
    let mut runs: Vec<Range<usize>> = Vec::new();
    for at in (0..view.k_f.len()).filter(|at| inside(*at)) {
        match runs.last_mut() {
            Some(run) if run.end == at => run.end = at + 1,
            _ => runs.push(at..at + 1),
        }
    }
    runs
}

/// At most `number` of `all`, spread evenly.
fn spread<T>(all: &[T], number: usize) -> impl Iterator<Item = &T> {
    let count = all.len().min(number);
    (0..count).map(move |i| &all[i * (all.len() - 1) / count.saturating_sub(1).max(1)])
}

fn panel(canvas: &Canvas, frame: Frame, shown: &Shown, evaluation: &Evaluation, range: &Range<usize>) -> Drawn {
    let view = &shown.trials[0].view;
    let last = view.time_s.len() - 1;
    let (from_s, to_s) = (view.time_s[range.start], view.time_s[range.end.min(last)]);
    let margin_s = (AROUND * (to_s - from_s)).max(AROUND_LEAST_S);
    let inside: Vec<usize> =
        (0..=last).filter(|at| (from_s - margin_s..=to_s + margin_s).contains(&view.time_s[*at])).collect();
    let points = |values: &[f64]| -> Vec<(f64, f64)> {
        inside.iter().map(|at| (view.time_s[*at] - from_s, values[*at])).collect()
    };
    let seen = view.rivals_nm.iter().chain([&view.torque_nm]).flat_map(|v| points(v)).map(|p| p.1);
    let y = Axis::around(
        if frame.left < 100.0 { format!("torque ({})", shown.units.torque) } else { String::new() },
        seen,
        0.08,
    );
    let (first_s, end_s) = span(inside.iter().map(|at| view.time_s[*at] - from_s));
    let x = Axis::linear("time after the reversal (s)", first_s, end_s);
    let panel = canvas.panel(frame, x, y)?;
    panel.line(points(&view.torque_nm), Stroke::solid(palette::PALE, 4.0))?;
    for (rival, values) in evaluation.rivals.iter().zip(&view.rivals_nm) {
        panel.line(points(values), stroke(rival.kind, rival.source == Source::Model))?;
    }
    let speed = inside.iter().map(|at| view.velocity_rad_s[*at].abs()).fold(0.0, f64::max);
    let title = format!("at {} s, up to {} {}", significant(from_s, 3), significant(speed, 2), shown.units.speed);
    canvas.text((frame.left, frame.top - 10.0), &title, TEXT_PX, palette::GREY, Anchor::Left)
}

fn legend(canvas: &Canvas, evaluation: &Evaluation) -> Drawn {
    let mut entries = vec![(Mark::Line(4.0, None), palette::PALE, "measured".to_string())];
    for rival in &evaluation.rivals {
        let taken = rival.source == Source::Model;
        let stroke = stroke(rival.kind, taken);
        let name = if taken { format!("{} (model)", rival.kind.name()) } else { rival.kind.name().to_string() };
        entries.push((Mark::Line(stroke.width_px, stroke.dash_px), stroke.color, name));
    }
    canvas.legend((86.0, 840.0), 20.0, &entries)
}

/// How a curve is drawn, the same in every figure; the model's own is whole and thick.
pub(super) fn stroke(kind: CurveKind, taken: bool) -> Stroke {
    let (color, dash_px) = match kind {
        CurveKind::Sign => (palette::VERMILION, (2.0, 3.0)),
        CurveKind::Linear => (palette::PURPLE, (8.0, 3.0)),
        CurveKind::Arctan => (palette::INK, (10.0, 3.0)),
        CurveKind::Power => (palette::GREEN, (5.0, 3.0)),
    };
    match taken {
        true => Stroke::solid(color, 2.0),
        false => Stroke { color, width_px: 1.2, dash_px: Some(dash_px) },
    }
}
