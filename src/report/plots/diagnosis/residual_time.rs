//! The residual over time in each trial, before and after, to one scale.

use super::{CONTACT, ROOM, after_name, reach_nm, residuals};
use crate::diagnose::{Diagnosis, View};
use crate::report::chart::{Axis, Color, Figure, Panel, Point, Stroke, palette, span};
use crate::report::diagnosis::words::kept_together;
use crate::report::wording::Units;
use std::ops::Range;

/// The colour of stretches at the end of the sensor's range.
const CLIPPED: Color = palette::PURPLE;
const SHADE: f64 = 0.3;

const CAPTION: &str = "Measured minus predicted torque, low-pass filtered, by the model as delivered and with the causes found, on one scale. \
                       Pale parts are not scored; shaded stretches are contact events, which are left out of every fit, or the sensor at \
                       the limit of its range.";

/// A figure of each trial by its name, the trial with the largest gap first; those without a sample that counts are left out.
pub(super) fn figures(found: &Diagnosis) -> Vec<(String, Figure)> {
    order(found).into_iter().map(|at| (found.views[at].file.clone(), figure(found, &found.views[at], at))).collect()
}

/// The trials with samples that count, that with the largest gap first.
pub(super) fn order(found: &Diagnosis) -> Vec<usize> {
    let energy: Vec<f64> = found.views.iter().map(|view| residuals(found, view)[0].mean_square()).collect();
    let mut order: Vec<usize> =
        (0..found.views.len()).filter(|at| found.views[*at].judged.iter().any(|judged| *judged)).collect();
    order.sort_by(|a, b| energy[*b].total_cmp(&energy[*a]));
    order
}

/// Position, residual before, residual after.
fn figure(found: &Diagnosis, view: &View, at: usize) -> Figure {
    let units = Units::of(&found.before.joint);
    let reach_nm = reach_nm(found, [view]);
    let (unit, factor) = units.torque_scale(reach_nm);
    let reach = factor * reach_nm * (1.0 + ROOM);
    let (from_s, to_s) = span(view.time_s.iter().copied());
    let time = Axis::linear("time (s)", from_s, to_s);
    let link = format!("time of {}", view.file);
    let positions: Vec<f64> = view.position_rad.iter().map(|x| units.position_factor * x).collect();
    let y = Axis::around(format!("position ({})", units.position), positions.iter().copied(), 0.08).sparse();
    let mut upper = Panel::new(time.clone().without_texts(), y).linked(&link);
    upper.line("", view.time_s.iter().copied().zip(positions), Stroke::solid(palette::INK, 1.2));
    let name = if at == 0 { "residual_time".to_string() } else { format!("residual_time_{:02}", at + 1) };
    let mut figure = Figure::new(name, format!("Residual over time: {}", view.file), CAPTION).row(84.0, vec![upper]);
    let [before, after] = residuals(found, view);
    let panels = [("as delivered", before, palette::VERMILION), (after_name(found), after, palette::BLUE)];
    for (title, residual, color) in panels {
        let time = if color == palette::BLUE { time.clone() } else { time.clone().without_texts() };
        let rms = units.torque(residual.mean_square().sqrt());
        let y = Axis::linear(format!("residual ({unit})"), -reach, reach);
        let mut panel = Panel::new(time, y).titled(kept_together(&format!("{title}: RMS {rms}"))).linked(&link);
        shade(&mut panel, found, view);
        let only = |counts: bool| -> Vec<Point> {
            let value = |i: usize| if residual.counts[i] == counts { factor * residual.nm[i] } else { f64::NAN };
            (0..view.time_s.len()).map(|i| (view.time_s[i], value(i))).collect()
        };
        panel.line("", only(false), Stroke::solid(palette::PALE, 1.0));
        panel.line(format!("residual, {title}"), only(true), Stroke::solid(color, 1.0));
        figure = figure.row(136.0, vec![panel]);
    }
    figure
}

/// Runs of rows for which `holds`.
pub(super) fn runs(rows: usize, holds: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for i in (0..rows).filter(|i| holds(*i)) {
        match found.last_mut() {
            Some(run) if run.end == i => run.end = i + 1,
            _ => found.push(i..i + 1),
        }
    }
    found
}

fn shade(panel: &mut Panel, found: &Diagnosis, view: &View) {
    let (low, high) = panel.y.places;
    let mut band = |name: &str, from: f64, to: f64, color| {
        panel.band(name, [vec![(from, low), (to, low)], vec![(from, high), (to, high)]], color, SHADE);
    };
    for run in runs(view.clipped.len(), |i| view.clipped[i]) {
        band("sensor clips", view.time_s[run.start], view.time_s[run.end - 1], CLIPPED);
    }
    for contact in found.contacts.iter().filter(|contact| contact.file == view.file) {
        band("contact", contact.from_s, contact.to_s, CONTACT);
    }
}
