//! Residuals of all trials against position and against speed.

use crate::identify::{Identification, Residual};
use crate::model::Direction;
use crate::numerics::statistics::quantile;
use crate::report::chart::{Axis, Color, Figure, Panel, Point, Stroke, palette, span, thin};
use crate::report::number::percent;
use crate::report::wording::{Units, moving};

/// Samples drawn for each direction.
const DOTS: usize = 1100;
/// Samples looked at: over a thousand for each stretch.
const SAMPLES: usize = 100_000;
/// Stretches of position of which median and range are drawn.
const POSITION_BINS: usize = 45;
/// Stretches of speed, for each direction.
const SPEED_BINS: usize = 22;
/// The axis of residuals holds all but this share of the samples at either end, and a margin of this share of that.
const BEYOND: f64 = 0.005;
const MARGIN: f64 = 0.12;
/// Speeds below this share of the fastest gather about zero.
const SLOW: f64 = 0.005;

const POSITION: &str = "All trials: samples (dots), median (line) and the range that holds 80 % of them (band) by direction. Both medians \
                        off zero together: the load, its phase or a spring. Apart from each other: friction that changes with \
                        position. A wave: ripple of the torque.";
const SPEED: &str = "The same against speed, logarithmic away from zero. A median that bends at low speed points to the Stribeck \
                     terms, one that grows with speed to viscous friction; a wide band near zero is the transition after \
                     reversals.";

/// Against position; `None` without residuals.
pub fn against_position(found: &Identification) -> Option<Figure> {
    let units = Units::of(&found.model.joint);
    let of = |r: &Residual, i: usize| units.position_factor * r.position_rad[i];
    let clouds = Direction::BOTH.map(|direction| cloud(&found.residuals, direction, of));
    let (low, high) = span(clouds.iter().flatten().map(|p| p.0));
    let x = Axis::linear(format!("position ({})", units.position), low, high);
    let panel = panel(found, x, clouds, POSITION_BINS)?;
    Some(Figure::single("residual_position", "Residual against position", POSITION, 324.0, panel))
}

/// Against speed, with its sign; `None` without residuals.
pub fn against_speed(found: &Identification) -> Option<Figure> {
    let units = Units::of(&found.model.joint);
    let clouds = Direction::BOTH.map(|direction| cloud(&found.residuals, direction, |r, i| r.velocity_rad_s[i]));
    let (low, high) = span(clouds.iter().flatten().map(|p| p.0));
    let from = SLOW * low.abs().max(high.abs());
    let x = Axis::signed_log(format!("speed ({})", units.speed), low, high, from.max(f64::MIN_POSITIVE));
    let panel = panel(found, x, clouds, SPEED_BINS)?;
    Some(Figure::single("residual_speed", "Residual against speed", SPEED, 324.0, panel))
}

/// The samples of one direction, evenly thinned where there are more than quantiles need.
fn cloud(residuals: &[Residual], direction: Direction, x: impl Fn(&Residual, usize) -> f64) -> Vec<Point> {
    let mut points = Vec::new();
    let step = residuals.iter().map(|r| r.residual_nm.len()).sum::<usize>().div_ceil(SAMPLES).max(1);
    for residual in residuals {
        let moves = |i: &usize| (residual.velocity_rad_s[*i] >= 0.0) == (direction == Direction::Up);
        points.extend(
            (0..residual.residual_nm.len())
                .step_by(step)
                .filter(moves)
                .map(|i| (x(residual, i), residual.residual_nm[i])),
        );
    }
    points
}

fn panel(found: &Identification, x: Axis, mut clouds: [Vec<Point>; 2], bins: usize) -> Option<Panel> {
    if clouds.iter().all(Vec::is_empty) {
        return None;
    }
    let units = Units::of(&found.model.joint);
    let (low, high) = usual(&clouds);
    let (unit, factor) = units.torque_scale(low.abs().max(high.abs()));
    clouds.iter_mut().flatten().for_each(|p| p.1 *= factor);
    let quantiles = clouds.each_ref().map(|points| quantiles(&x, points, bins));
    let ranges = quantiles.iter().flatten().flatten().flat_map(|bin| [bin.low, bin.high]);
    let y = Axis::around(format!("residual ({unit})"), ranges.chain([0.0, factor * low, factor * high]), MARGIN);
    let outside = take_outside(&mut clouds, y.places);
    let mut panel = Panel::new(x.clone(), y);
    if outside > 0.0 {
        panel.title = format!("{} of the samples lie beyond the frame", percent(outside));
    }
    for (direction, points) in Direction::BOTH.into_iter().zip(&clouds) {
        let ends = span(points.iter().map(|p| x.place(p.0)));
        let dots = thin::across(points, ends, |value| x.place(value), bins, DOTS);
        panel.dots(format!("sample, {}", moving(direction)), dots, 1.5, palette::direction(direction), 0.28);
    }
    for (direction, runs) in Direction::BOTH.into_iter().zip(&quantiles) {
        let placed = |run: &[thin::Bin], of: fn(&thin::Bin) -> f64| -> Vec<Point> {
            thin::along(run, of).into_iter().map(|(place, y)| (x.value(place), y)).collect()
        };
        runs.iter().for_each(|run| add_quantiles(&mut panel, direction, |of| placed(run, of)));
    }
    Some(panel)
}

/// The range of nearly all residuals: a few samples must not flatten the rest.
fn usual(clouds: &[Vec<Point>; 2]) -> (f64, f64) {
    let mut all: Vec<f64> = clouds.iter().flatten().map(|p| p.1).filter(|y| y.is_finite()).collect();
    (quantile(&mut all, BEYOND), quantile(&mut all, 1.0 - BEYOND))
}

/// Drops the samples beyond `low` to `high` and gives their share.
fn take_outside(clouds: &mut [Vec<Point>; 2], (low, high): (f64, f64)) -> f64 {
    let total = clouds.iter().flatten().count();
    clouds.iter_mut().for_each(|points| points.retain(|p| (low..=high).contains(&p.1)));
    1.0 - clouds.iter().flatten().count() as f64 / total as f64
}

/// Quantiles of `points` in stretches that are equally wide as drawn on `x`, in runs without a gap.
fn quantiles(x: &Axis, points: &[(f64, f64)], number: usize) -> Vec<Vec<thin::Bin>> {
    let placed: Vec<Point> = points.iter().map(|p| (x.place(p.0), p.1)).collect();
    thin::bins(&placed, span(placed.iter().map(|p| p.0)), number)
}

/// Adds the median and the range of 80 % of a run of stretches, whose points `along` tells.
pub fn add_quantiles(panel: &mut Panel, direction: Direction, along: impl Fn(fn(&thin::Bin) -> f64) -> Vec<Point>) {
    let color: Color = palette::direction(direction);
    let name = moving(direction);
    panel.band(format!("80 % of the samples, {name}"), [along(|b| b.low), along(|b| b.high)], color, 0.18);
    // A pale edge keeps the median readable on its own dots.
    panel.line("", along(|b| b.median), Stroke::solid(palette::PAPER, 4.6));
    panel.line(format!("median, {name}"), along(|b| b.median), Stroke::solid(color, 2.6));
}
