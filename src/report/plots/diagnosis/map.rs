//! Where the residual lies: its RMS over position and speed, before and after.

use super::{after_name, residuals};
use crate::diagnose::Diagnosis;
use crate::numerics::statistics::quantile;
use crate::report::chart::{Anchor, Axis, Canvas, Colors, Drawn, Frame, LABEL_PX, palette, span, svg};
use crate::report::page::Drawing;
use crate::report::wording::Units;

/// Cells across and upwards; an odd number upwards, so that one row holds what hardly moves.
const ACROSS: usize = 28;
const UPWARDS: usize = 21;
/// Samples that a cell needs before its RMS means anything.
const SAMPLES_MIN: usize = 3;
/// Slower than this share of the fastest, speeds gather about zero.
const SLOW: f64 = 0.04;
/// The scale reaches this many times the floor at least: noise alone does not look dark.
const FLOORS: f64 = 3.0;
/// The scale ends where this share of the cells lie below: one cell must not bleach the others.
const SHOWN: f64 = 0.98;

/// RMS of the cells, row by row, before and after; NaN where there are too few samples.
struct Map {
    x: Axis,
    y: Axis,
    rms_nm: [Vec<f64>; 2],
}

/// Both maps; `None` without samples.
pub(super) fn draw(found: &Diagnosis) -> Drawn<Option<Drawing>> {
    let units = Units::of(found.before.joint.kind);
    let map = map(found, &units);
    let mut all: Vec<f64> = map.rms_nm.iter().flatten().copied().filter(|rms| rms.is_finite()).collect();
    if all.is_empty() {
        return Ok(None);
    }
    let (top, most) = (quantile(&mut all, SHOWN), span(all.iter().copied()).1);
    let floor_nm = found.gap.floor.rms_nm;
    let top = top.max(FLOORS * floor_nm);
    let (unit, factor) = units.torque_scale(top);
    let axis = Axis::linear(format!("RMS of the residual ({unit})"), 0.0, factor * top);
    let colors = Colors { goes_on: factor * most > 1.001 * axis.places.1, axis };
    let drawn = svg(860, 400, "Where the residual lies", |canvas| {
        let titles = ["as delivered", after_name(found)];
        for (at, (title, rms_nm)) in titles.into_iter().zip(&map.rms_nm).enumerate() {
            let left = 86.0 + 344.0 * at as f64;
            let frame = Frame { left, top: 44.0, right: left + 308.0, bottom: 340.0 };
            let y = if at == 0 { map.y.clone() } else { map.y.clone().without_texts() };
            canvas.text((left, 24.0), title, LABEL_PX, palette::INK, Anchor::Left)?;
            cells(canvas, frame, (map.x.clone(), y), rms_nm, (&colors, factor))?;
        }
        let bar = Frame { left: 764.0, top: 44.0, right: 780.0, bottom: 340.0 };
        canvas.color_bar(bar, &colors, (factor * floor_nm, "floor"))
    })?;
    Ok(Some(Drawing {
        name: "map".to_string(),
        title: "Where the gap lies: position and speed".to_string(),
        caption: "RMS of the residual in cells of position and signed speed, over all trials, by the model as delivered and with \
                  what was found; one scale for both, the triangle at the floor. White cells hold hardly any samples. Columns that stand out: the gap goes \
                  with position; rows: with speed; the ends of the travel near zero speed: after reversals; above and below \
                  alike, but apart from the middle: with the direction."
            .to_string(),
        svg: drawn,
    }))
}

fn map(found: &Diagnosis, units: &Units) -> Map {
    let place = |position_rad: f64| units.position_factor * position_rad;
    let rows = || {
        found.views.iter().flat_map(|view| (0..view.judged.len()).filter(|i| view.judged[*i]).map(move |i| (view, i)))
    };
    let (low, high) = span(rows().map(|(view, i)| place(view.position_rad[i])));
    let fastest = rows().map(|(view, i)| view.velocity_rad_s[i].abs()).fold(0.0, f64::max).max(f64::MIN_POSITIVE);
    let x = Axis::linear(format!("position ({})", units.position), low, high);
    let y = Axis::signed_log(format!("speed ({})", units.speed), -fastest, fastest, SLOW * fastest);
    let mut sums = [(); 2].map(|()| vec![(0.0, 0usize); ACROSS * UPWARDS]);
    for view in &found.views {
        for (sums, residual) in sums.iter_mut().zip(residuals(found, view)) {
            for i in residual.rows() {
                let column = cell(x.place_within(place(view.position_rad[i])), x.places, ACROSS);
                let row = cell(y.place_within(view.velocity_rad_s[i]), y.places, UPWARDS);
                let (sum, count) = &mut sums[row * ACROSS + column];
                (*sum, *count) = (*sum + residual.nm[i] * residual.nm[i], *count + 1);
            }
        }
    }
    let rms = |(sum, count): &(f64, usize)| {
        if *count >= SAMPLES_MIN { (sum / *count as f64).sqrt() } else { f64::NAN }
    };
    Map { rms_nm: sums.map(|sums| sums.iter().map(rms).collect()), x, y }
}

/// Which of `number` stretches of `low` to `high` holds `place`.
fn cell(place: f64, (low, high): (f64, f64), number: usize) -> usize {
    (((place - low) / (high - low) * number as f64) as usize).min(number - 1)
}

fn cells(
    canvas: &Canvas,
    frame: Frame,
    (x, y): (Axis, Axis),
    rms_nm: &[f64],
    (colors, factor): (&Colors, f64),
) -> Drawn {
    let panel = canvas.panel(frame, x, y)?;
    let edge = |at: usize, number: usize, (low, high): (f64, f64)| low + (high - low) * at as f64 / number as f64;
    let corner = |column: usize, row: usize| {
        (panel.x.value(edge(column, ACROSS, panel.x.places)), panel.y.value(edge(row, UPWARDS, panel.y.places)))
    };
    for (at, rms) in rms_nm.iter().enumerate().filter(|(_, rms)| rms.is_finite()) {
        let (row, column) = (at / ACROSS, at % ACROSS);
        canvas.cell(&panel, corner(column, row), corner(column + 1, row + 1), factor * rms, colors)?;
    }
    Ok(())
}
