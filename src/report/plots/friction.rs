//! B(v): points, the forms fitted to them, the band of the one taken, and what it leaves.

use crate::identify::stribeck::{ExponentialFit, exponentials};
use crate::identify::{FrictionFit, Identification, Route};
use crate::model::Direction;
use crate::report::chart::{Axis, Figure, Mark, Panel, Point, Stroke, palette, span};
use crate::report::wording::{Units, moving};

/// Points along a curve.
const CURVE_POINTS: usize = 240;
/// The panel of residuals may grow to this many times the largest of them to hold the band.
const BAND_ROOM: f64 = 2.5;
const BAND: &str = "95 % band of the selected form (bold line)";

const CAPTION: &str = "B of each leg with the fitted forms; below, the residual of the selected form, with its 95 % band. Points should \
                       scatter about zero there, without a wave. Where the curves differ by less than the scatter, the smaller form is \
                       enough, and the parameters of the larger one are correlated.";

/// B against speed, a column for each direction; `None` without legs.
pub fn figure(found: &Identification) -> Option<Figure> {
    let Route::Sweeps(fits) = &found.route else { return None };
    let units = Units::of(&found.model.joint);
    let columns = Direction::BOTH.map(|direction| column(fits.of(direction), &units));
    let [(upper_up, lower_up), (upper_down, lower_down)] = columns;
    let figure = Figure::new("friction", "Friction against speed, B(v)", CAPTION);
    Some(figure.row(268.0, vec![upper_up, upper_down]).row(122.0, vec![lower_up, lower_down]))
}

/// One direction: B above, residuals below, the same speeds.
fn column(fit: &FrictionFit, units: &Units) -> (Panel, Panel) {
    let color = palette::direction(fit.direction);
    let (slow, fast) = span(fit.points.speed_rad_s.iter().copied());
    let x = Axis::log(format!("speed ({})", units.speed), [slow, fast]);
    let (unit, factor) = units.torque_scale(fit.points.b_nm.iter().fold(0.0, |m: f64, b| m.max(b.abs())));
    let speeds = x.spread(slow, fast, CURVE_POINTS);
    let met = fit.points.speed_rad_s.iter().map(|v| factor * fit.taken.b_nm(*v));
    let y = Axis::around(format!("B ({unit})"), fit.points.b_nm.iter().map(|b| factor * b).chain(met), 0.08);
    let title = format!("{}: data support {}", moving(fit.direction), exponentials(fit.supported));
    let link = format!("speed {}", fit.direction.name());
    let mut panel = Panel::new(x.clone().without_texts(), y).titled(title).linked(&link);
    panel.band(BAND, band(fit, factor, |_| 0.0), palette::INK, 0.2);
    let points = fit.points.speed_rad_s.iter().zip(&fit.points.b_nm).map(|(v, b)| (*v, factor * b)).collect();
    panel.marks(format!("B of a leg, {}", moving(fit.direction)), points, Mark::of(fit.direction), color);
    for form in shown(fit) {
        let line = speeds.iter().map(|v| (*v, factor * form.b_nm(*v)));
        panel.line(exponentials(form.rates.len()), line, stroke(fit, form));
    }
    (panel, residuals(fit, units, x, &speeds).linked(link))
}

/// The lower and the upper edge of the form's 95 % band, less `level` at each speed; empty where there is none.
fn band(fit: &FrictionFit, factor: f64, level: impl Fn(f64) -> f64) -> [Vec<Point>; 2] {
    let profile = fit.profile.as_ref();
    let places = || profile.into_iter().flat_map(|p| p.band_speed_rad_s.iter().copied().zip(p.band_nm.iter().copied()));
    let edge = |of: fn(Point) -> f64| places().map(|(v, b)| (v, factor * (of(b) - level(v)))).collect();
    [edge(|b| b.0), edge(|b| b.1)]
}

/// The points less the form taken, its band and the other forms less it.
fn residuals(fit: &FrictionFit, units: &Units, x: Axis, speeds: &[f64]) -> Panel {
    let color = palette::direction(fit.direction);
    let points = fit.points.speed_rad_s.iter().zip(&fit.points.b_nm);
    let left: Vec<Point> = points.map(|(v, b)| (*v, b - fit.taken.b_nm(*v))).collect();
    let taken = |v: f64| fit.taken.b_nm(v);
    let widest = |values: &[Point]| values.iter().fold(0.0, |m: f64, p| m.max(p.1.abs()));
    // The band is shown whole, but not where that would make the points a flat row.
    let band_nm = band(fit, 1.0, taken).iter().map(|edge| widest(edge)).fold(0.0, f64::max);
    let reach_nm = widest(&left).max(band_nm.min(BAND_ROOM * widest(&left)));
    let (unit, factor) = units.torque_scale(reach_nm);
    let y = Axis::low(format!("B \u{2212} fit ({unit})"), 1.15 * factor * reach_nm);
    let mut panel = Panel::new(x, y);
    panel.band(BAND, band(fit, factor, taken), palette::INK, 0.2);
    // The form taken is zero here: a thin line, or it would cover its band.
    let ends = [speeds.first(), speeds.last()];
    panel.line("", ends.into_iter().flatten().map(|v| (*v, 0.0)), Stroke::solid(palette::INK, 1.0));
    for form in shown(fit).filter(|form| form.rates.len() != fit.taken.rates.len()) {
        let apart = speeds.iter().map(|v| (*v, factor * (form.b_nm(*v) - taken(*v))));
        panel.line(exponentials(form.rates.len()), apart, stroke(fit, form));
    }
    let points = left.iter().map(|(v, b)| (*v, factor * b)).collect();
    panel.marks(format!("B of a leg, {}", moving(fit.direction)), points, Mark::of(fit.direction), color);
    panel
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
