//! B(v): points, the forms fitted to them, the band of the one taken, and what it leaves.

use crate::identify::stribeck::ExponentialFit;
use crate::identify::{FrictionFit, Identification, Route};
use crate::model::Direction;
use crate::report::chart::{Anchor, Axis, Canvas, Drawn, Frame, LABEL_PX, Mark, Stroke, palette, span, svg};
use crate::report::wording::{Units, exponentials, moving};

/// Points along a curve.
const CURVE_POINTS: usize = 120;

/// B against speed, a column for each direction; `None` without legs.
pub fn draw(found: &Identification) -> Drawn<Option<String>> {
    let Route::Sweeps(fits) = &found.route else { return Ok(None) };
    let units = Units::of(found.model.joint.kind);
    let columns = [(fits.of(Direction::Up), 92.0, 420.0), (fits.of(Direction::Down), 518.0, 846.0)];
    svg(860, 540, "Friction B against speed", |canvas| {
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
    let heading = format!("{}: data support {}", moving(fit.direction), exponentials(fit.supported));
    canvas.text((left, 18.0), &heading, LABEL_PX, color, Anchor::Left)?;
    let upper = Frame { left, top: 78.0, right, bottom: 340.0 };
    let y = Axis::around(format!("B ({unit})"), fit.points.b_nm.iter().map(|b| factor * b), 0.08);
    let panel = canvas.panel(upper, x.clone().without_texts(), y)?;
    let mark = if fit.direction == Direction::Up { Mark::Up } else { Mark::Down };
    let mut entries = vec![(mark, color, "legs".to_string())];
    if let Some(profile) = &fit.band {
        let edge = |of: fn(&(f64, f64)) -> f64| -> Vec<(f64, f64)> {
            profile.band_speed_rad_s.iter().zip(&profile.band_nm).map(|(v, b)| (*v, factor * of(b))).collect()
        };
        panel.band(&edge(|b| b.0), &edge(|b| b.1), palette::INK, 0.14)?;
        entries.push((Mark::Band, palette::INK, "95 %".to_string()));
    }
    for (v, b) in fit.points.speed_rad_s.iter().zip(&fit.points.b_nm) {
        panel.mark((*v, factor * b), mark, color)?;
    }
    for form in shown(fit) {
        let stroke = stroke(fit, form);
        panel.line(speeds.iter().map(|v| (*v, factor * form.b_nm(*v))), stroke)?;
        let name = exponentials(form.rates.len()).replace("exponential", "exp.").replace("exp.s", "exp.");
        entries.push((Mark::Line(stroke.width_px, stroke.dash_px), stroke.color, name));
    }
    canvas.legend((left, right), 40.0, &entries)?;
    residuals(canvas, fit, units, Frame { left, top: 366.0, right, bottom: 484.0 }, x)
}

/// The points less the form taken, and the other forms less it.
fn residuals(canvas: &Canvas, fit: &FrictionFit, units: &Units, frame: Frame, x: Axis) -> Drawn {
    let color = palette::direction(fit.direction);
    let points = fit.points.speed_rad_s.iter().zip(&fit.points.b_nm);
    let left: Vec<(f64, f64)> = points.map(|(v, b)| (*v, b - fit.taken.b_nm(*v))).collect();
    let largest = left.iter().fold(0.0, |m: f64, p| m.max(p.1.abs()));
    let (unit, factor) = units.torque_scale(largest);
    let y = Axis::linear(format!("left ({unit})"), -1.15 * factor * largest, 1.15 * factor * largest);
    let (slow, fast) = span(fit.points.speed_rad_s.iter().copied());
    let speeds = x.spread(slow, fast, CURVE_POINTS);
    let panel = canvas.panel(frame, x, y)?;
    let mark = if fit.direction == Direction::Up { Mark::Up } else { Mark::Down };
    for (v, b) in left {
        panel.mark((v, factor * b), mark, color)?;
    }
    for form in shown(fit) {
        let apart = speeds.iter().map(|v| (*v, factor * (form.b_nm(*v) - fit.taken.b_nm(*v))));
        panel.line(apart, stroke(fit, form))?;
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

fn stroke(fit: &FrictionFit, form: &ExponentialFit) -> Stroke {
    match form.rates.len() {
        n if n == fit.taken.rates.len() => Stroke::solid(palette::INK, 2.0),
        0 => Stroke::dashed(palette::PURPLE, 1.8, 2.0, 4.0),
        _ => Stroke::dashed(palette::GREEN, 1.8, 7.0, 4.0),
    }
}
