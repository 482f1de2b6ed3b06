//! B(v): points, the forms fitted to them, the band of the one taken, and what it leaves.

use crate::identify::stribeck::ExponentialFit;
use crate::identify::stribeck::exponentials;
use crate::identify::{FrictionFit, Identification, Route};
use crate::model::{Both, Direction};
use crate::report::chart::{Axis, Canvas, Drawn, Frame, Mark, Stroke, palette, span, svg};
use crate::report::wording::{Units, moving};
use plotters::style::RGBColor;

/// Points along a curve.
const CURVE_POINTS: usize = 400;
/// The panel of residuals may grow to this many times the largest of them to hold the band.
const BAND_ROOM: f64 = 2.5;

/// B against speed, a column for each direction; `None` without legs.
pub fn draw(found: &Identification) -> Drawn<Option<String>> {
    let Route::Sweeps(fits) = &found.route else { return Ok(None) };
    let units = Units::of(found.model.joint.kind);
    let columns = [(fits.of(Direction::Up), 92.0, 420.0), (fits.of(Direction::Down), 518.0, 846.0)];
    svg(860, 536, "Friction B against speed", |canvas| {
        canvas.legend((92.0, 846.0), 16.0, &legend(fits))?;
        for (fit, left, right) in columns {
            column(canvas, fit, &units, (left, right))?;
        }
        Ok(())
    })
    .map(Some)
}

/// One direction: B above, residuals below, the same speeds.
fn column(canvas: &Canvas, fit: &FrictionFit, units: &Units, (left, right): (f64, f64)) -> Drawn {
    let color = palette::direction(fit.direction);
    let (slow, fast) = span(fit.points.speed_rad_s.iter().copied());
    let x = Axis::log(format!("speed ({})", units.speed), [slow, fast]);
    let (unit, factor) = units.torque_scale(fit.points.b_nm.iter().fold(0.0, |m: f64, b| m.max(b.abs())));
    let speeds = x.spread(slow, fast, CURVE_POINTS);
    let mark = Mark::of(fit.direction);
    let heading = format!("{}: data support {}", moving(fit.direction), exponentials(fit.supported));
    canvas.legend((left, right), 46.0, &[(mark, color, heading)])?;
    let upper = Frame { left, top: 66.0, right, bottom: 334.0 };
    let met = fit.points.speed_rad_s.iter().map(|v| factor * fit.taken.b_nm(*v));
    let y = Axis::around(format!("B ({unit})"), fit.points.b_nm.iter().map(|b| factor * b).chain(met), 0.08);
    let panel = canvas.panel(upper, x.clone().without_texts(), y)?;
    let [lower, upper_edge] = band(fit, factor, |_| 0.0);
    panel.band(&lower, &upper_edge, palette::INK, 0.2)?;
    for (v, b) in fit.points.speed_rad_s.iter().zip(&fit.points.b_nm) {
        panel.mark((*v, factor * b), mark, color)?;
    }
    for form in shown(fit) {
        panel.line(speeds.iter().map(|v| (*v, factor * form.b_nm(*v))), stroke(fit, form))?;
    }
    residuals(canvas, fit, units, Frame { left, top: 358.0, right, bottom: 480.0 }, x)
}

/// The lower and the upper edge of the form's 95 % band, less `level` at each speed; empty where there is none.
fn band(fit: &FrictionFit, factor: f64, level: impl Fn(f64) -> f64) -> [Vec<(f64, f64)>; 2] {
    let profile = fit.profile.as_ref();
    let places = || profile.into_iter().flat_map(|p| p.band_speed_rad_s.iter().copied().zip(p.band_nm.iter().copied()));
    let edge = |of: fn((f64, f64)) -> f64| places().map(|(v, b)| (v, factor * (of(b) - level(v)))).collect();
    [edge(|b| b.0), edge(|b| b.1)]
}

/// What the lines are, for both columns.
fn legend(fits: &Both<FrictionFit>) -> Vec<(Mark, RGBColor, String)> {
    let mut entries = Vec::new();
    for fit in Direction::BOTH.map(|direction| fits.of(direction)) {
        for form in shown(fit) {
            let stroke = stroke(fit, form);
            let mark = Mark::Line(stroke.width_px, stroke.dash_px);
            let text = exponentials(form.rates.len()).to_string();
            entries.push((mark, stroke.color, text));
        }
    }
    entries.sort_by(|a, b| b.2.cmp(&a.2));
    entries.dedup_by(|a, b| a.2 == b.2);
    if fits.up.profile.is_some() || fits.down.profile.is_some() {
        entries.push((Mark::Band, palette::INK, "95 % band of the form taken (bold line)".to_string()));
    }
    entries
}

/// The points less the form taken, its band and the other forms less it.
fn residuals(canvas: &Canvas, fit: &FrictionFit, units: &Units, frame: Frame, x: Axis) -> Drawn {
    let color = palette::direction(fit.direction);
    let points = fit.points.speed_rad_s.iter().zip(&fit.points.b_nm);
    let left: Vec<(f64, f64)> = points.map(|(v, b)| (*v, b - fit.taken.b_nm(*v))).collect();
    let taken = |v: f64| fit.taken.b_nm(v);
    let widest = |values: &[(f64, f64)]| values.iter().fold(0.0, |m: f64, p| m.max(p.1.abs()));
    // The band is shown whole, but not where that would make the points a flat row.
    let spread = widest(&band(fit, 1.0, taken).concat());
    let largest = widest(&left).max(spread.min(BAND_ROOM * widest(&left)));
    let (unit, factor) = units.torque_scale(largest);
    let y = Axis::low(format!("B \u{2212} fit ({unit})"), 1.15 * factor * largest);
    let (slow, fast) = span(fit.points.speed_rad_s.iter().copied());
    let speeds = x.spread(slow, fast, CURVE_POINTS);
    let panel = canvas.panel(frame, x, y)?;
    let [lower, upper] = band(fit, factor, taken);
    panel.band(&lower, &upper, palette::INK, 0.2)?;
    // The form taken is zero here: a thin line, or it would cover its band.
    panel.line([(slow, 0.0), (fast, 0.0)], Stroke::solid(palette::INK, 1.0))?;
    for form in shown(fit).filter(|form| form.rates.len() != fit.taken.rates.len()) {
        let apart: Vec<(f64, f64)> = speeds.iter().map(|v| (*v, factor * (form.b_nm(*v) - taken(*v)))).collect();
        panel.line(apart, stroke(fit, form))?;
    }
    for (v, b) in left {
        panel.mark((v, factor * b), Mark::of(fit.direction), color)?;
    }
    Ok(())
}

/// The forms worth a line: one and two exponentials, and whichever is taken or supported.
fn shown(fit: &FrictionFit) -> impl Iterator<Item = &ExponentialFit> {
    fit.forms.iter().filter(|form| {
        let number = form.rates.len();
        number > 0 || number == fit.taken.rates.len() || number == fit.supported
    })
}

/// Colour and dashes by the number of exponentials, the same in both columns; the form taken is bold.
fn stroke(fit: &FrictionFit, form: &ExponentialFit) -> Stroke {
    let width_px = if form.rates.len() == fit.taken.rates.len() { 2.4 } else { 1.6 };
    match form.rates.len() {
        0 => Stroke::dashed(palette::PURPLE, width_px, 2.0, 4.0),
        1 => Stroke::dashed(palette::GREEN, width_px, 7.0, 4.0),
        _ => Stroke::solid(palette::INK, width_px),
    }
}
