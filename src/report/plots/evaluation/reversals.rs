//! A closer look at some reversals, with every curve of the combination.

use super::Shown;
use crate::evaluate::{Evaluation, Source, View};
use crate::identify::CurveKind;
use crate::report::chart::{Axis, Figure, Panel, Point, Stroke, palette, span};
use crate::report::number::significant;
use std::ops::Range;

/// Panels: two rows of three.
const PANELS: usize = 6;
const ACROSS: usize = 3;
/// Shown before the reversal and after the transition, in lengths of the transition ...
const AROUND: f64 = 0.6;
/// ... and at least this long, s.
const AROUND_LEAST_S: f64 = 0.4;

const CAPTION: &str = "Torque around some reversals, from slow to fast motion, low-passed: measured, and predicted with each curve. \
                       Sign jumps at once; linear goes in proportion to the cable's travel through the clearance; the curve that \
                       the model takes is drawn thick.";

/// The panels; `None` without a transition.
pub(super) fn figure(shown: &Shown, evaluation: &Evaluation) -> Option<Figure> {
    let all = transitions(&shown.trial.view);
    let chosen: Vec<Range<usize>> = spread(&all, PANELS).cloned().collect();
    if chosen.is_empty() {
        return None;
    }
    let title = format!("{}: a closer look at reversals", shown.trial.entry.file);
    let mut figure = Figure::new(format!("{}_reversals", shown.slug), title, CAPTION);
    for row in chosen.chunks(ACROSS) {
        let panels = row.iter().enumerate().map(|(at, range)| panel(shown, evaluation, range, at == 0)).collect();
        figure = figure.row(170.0, panels);
    }
    Some(figure)
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

fn panel(shown: &Shown, evaluation: &Evaluation, range: &Range<usize>, is_first: bool) -> Panel {
    let view = &shown.trial.view;
    let last = view.time_s.len() - 1;
    let (from_s, to_s) = (view.time_s[range.start], view.time_s[range.end.min(last)]);
    let margin_s = (AROUND * (to_s - from_s)).max(AROUND_LEAST_S);
    let inside: Vec<usize> =
        (0..=last).filter(|at| (from_s - margin_s..=to_s + margin_s).contains(&view.time_s[*at])).collect();
    let points =
        |values: &[f64]| -> Vec<Point> { inside.iter().map(|at| (view.time_s[*at] - from_s, values[*at])).collect() };
    let seen = view.rivals_nm.iter().chain([&view.torque_nm]).flat_map(|v| points(v)).map(|p| p.1);
    let label = if is_first { format!("torque ({})", shown.units.torque) } else { String::new() };
    let (first_s, end_s) = span(inside.iter().map(|at| view.time_s[*at] - from_s));
    let speed = inside.iter().map(|at| view.velocity_rad_s[*at].abs()).fold(0.0, f64::max);
    let title = format!("at {} s, up to {} {}", significant(from_s, 3), significant(speed, 2), shown.units.speed);
    let x = Axis::linear("time after the reversal (s)", first_s, end_s);
    let mut panel = Panel::new(x, Axis::around(label, seen, 0.08)).titled(title);
    panel.line("measured", points(&view.torque_nm), Stroke::solid(palette::PALE, 4.0));
    for (rival, values) in evaluation.rivals.iter().zip(&view.rivals_nm) {
        let taken = rival.source == Source::Model;
        let name = if taken { format!("{} (model)", rival.kind.name()) } else { rival.kind.name().to_string() };
        panel.line(name, points(values), stroke(rival.kind, taken));
    }
    panel
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
