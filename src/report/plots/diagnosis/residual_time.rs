//! The residual over time in the trial with the largest gap, before and after, to one scale.

use super::{CONTACT, ROOM, Residual, after_name, reach_nm, residuals};
use crate::diagnose::{Diagnosis, View};
use crate::report::chart::{
    Anchor, Axis, Canvas, Drawn, Frame, Mark, Panel, Stroke, TEXT_PX, palette, span, svg, thin,
};
use crate::report::page::Drawing;
use crate::report::wording::Units;
use plotters::style::RGBColor;
use std::ops::Range;

/// Stretches of time of which the lowest and highest point are drawn.
const BUCKETS: usize = 900;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 840.0;
/// The colour of stretches at the end of the sensor's range.
const CLIPPED: RGBColor = palette::PURPLE;
const SHADE: f64 = 0.3;

/// Position, residual before, residual after; `None` without samples.
pub(super) fn draw(found: &Diagnosis) -> Drawn<Option<Drawing>> {
    let energy = |view: &View| residuals(found, view)[0].mean_square();
    let Some(view) = found.views.iter().max_by(|a, b| energy(a).total_cmp(&energy(b))) else { return Ok(None) };
    if view.judged.iter().all(|judged| !judged) {
        return Ok(None);
    }
    let units = Units::of(found.before.joint.kind);
    let (unit, factor) = units.torque_scale(reach_nm(found, [view]));
    let reach = factor * reach_nm(found, [view]) * (1.0 + ROOM);
    let (from_s, to_s) = span(view.time_s.iter().copied());
    let time = Axis::linear("time (s)", from_s, to_s);
    let drawn = svg(860, 560, "Residual over time, before and after", |canvas| {
        legend(canvas, found, view)?;
        position(canvas, view, &units, time.clone().without_texts())?;
        let [before, after] = residuals(found, view);
        let panels =
            [("as delivered", before, 190.0, palette::VERMILION), (after_name(found), after, 368.0, palette::BLUE)];
        for (title, residual, top, color) in panels {
            let time = if color == palette::BLUE { time.clone() } else { time.clone().without_texts() };
            let y = Axis::linear(format!("residual ({unit})"), -reach, reach);
            let panel = canvas.panel(frame(top, 136.0), time, y)?;
            shade(&panel, found, view)?;
            lines(&panel, view, &residual, factor, color)?;
            let rms_nm = residual.mean_square().sqrt();
            let text = format!("{title}: RMS {}", units.torque(rms_nm));
            canvas.text((LEFT, top - 12.0), &text, TEXT_PX, palette::INK, Anchor::Left)?;
        }
        Ok(())
    })?;
    Ok(Some(Drawing {
        name: "residual_time".to_string(),
        title: format!("Residual over time: {}, the trial with the largest gap", view.file),
        caption: "Measured less predicted torque, low-passed, by the model as delivered and with what was found, to one scale. Pale \
                  parts do not count; shaded stretches are contacts, which no fit saw, or the sensor at the end of its range."
            .to_string(),
        svg: drawn,
    }))
}

fn frame(top: f64, height: f64) -> Frame {
    Frame { left: LEFT, top, right: RIGHT, bottom: top + height }
}

fn position(canvas: &Canvas, view: &View, units: &Units, time: Axis) -> Drawn {
    let positions: Vec<f64> = view.position_rad.iter().map(|x| units.position_factor * x).collect();
    let y = Axis::around("", positions.iter().copied(), 0.08).sparse();
    let panel = canvas.panel(frame(62.0, 84.0), time, y)?;
    canvas.text((LEFT, 50.0), &format!("position ({})", units.position), TEXT_PX, palette::INK, Anchor::Left)?;
    let points: Vec<(f64, f64)> = view.time_s.iter().copied().zip(positions).collect();
    panel.line(thin::envelope(&points, BUCKETS), Stroke::solid(palette::INK, 1.2))
}

/// Runs of rows for which `holds`.
fn runs(rows: usize, holds: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for i in (0..rows).filter(|i| holds(*i)) {
        match found.last_mut() {
            Some(run) if run.end == i => run.end = i + 1,
            _ => found.push(i..i + 1),
        }
    }
    found
}

fn shade(panel: &Panel, found: &Diagnosis, view: &View) -> Drawn {
    let (low, high) = panel.y.places;
    let band =
        |from: f64, to: f64, color| panel.band(&[(from, low), (to, low)], &[(from, high), (to, high)], color, SHADE);
    for run in runs(view.clipped.len(), |i| view.clipped[i]) {
        band(view.time_s[run.start], view.time_s[run.end - 1], CLIPPED)?;
    }
    let mut contacts = found.contacts.iter().filter(|contact| contact.file == view.file);
    contacts.try_for_each(|contact| band(contact.from_s, contact.to_s, CONTACT))
}

fn lines(panel: &Panel, view: &View, residual: &Residual, factor: f64, color: RGBColor) -> Drawn {
    for counts in [false, true] {
        for run in runs(view.judged.len(), |i| residual.counts[i] == counts) {
            let points: Vec<(f64, f64)> = run.clone().map(|i| (view.time_s[i], factor * residual.nm[i])).collect();
            let buckets = (BUCKETS * run.len()).div_ceil(view.judged.len().max(1));
            let stroke = Stroke::solid(if counts { color } else { palette::PALE }, 1.0);
            panel.line(thin::envelope(&points, buckets.max(1)), stroke)?;
        }
    }
    Ok(())
}

fn legend(canvas: &Canvas, found: &Diagnosis, view: &View) -> Drawn {
    let mut entries = vec![
        (Mark::Line(1.6, None), palette::VERMILION, "as delivered".to_string()),
        (Mark::Line(1.6, None), palette::BLUE, after_name(found).to_string()),
    ];
    let mut add = |is_there: bool, color, text: &str| {
        if is_there {
            entries.push((Mark::Band, color, text.to_string()));
        }
    };
    add(found.contacts.iter().any(|contact| contact.file == view.file), CONTACT, "contact");
    add(view.clipped.iter().any(|clipped| *clipped), CLIPPED, "sensor clips");
    canvas.legend((LEFT, RIGHT), 18.0, &entries)
}
