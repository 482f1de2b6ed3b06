//! Residuals of all trials against position and against speed.

use crate::identify::{Identification, Residual};
use crate::model::Direction;
use crate::numerics::statistics::quantile;
use crate::report::chart::{Anchor, Axis, Drawn, Frame, Mark, Panel, Stroke, TEXT_PX, palette, span, svg, thin};
use crate::report::number::percent;
use crate::report::wording::{Units, moving};
use plotters::style::{RGBColor, WHITE};

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

const FRAME: Frame = Frame { left: 92.0, top: 40.0, right: 840.0, bottom: 364.0 };

/// Against position; `None` without residuals.
pub fn against_position(found: &Identification) -> Drawn<Option<String>> {
    let units = Units::of(found.model.joint.kind);
    let of = |r: &Residual, i: usize| units.position_factor * r.position_rad[i];
    let clouds = Direction::BOTH.map(|direction| cloud(&found.residuals, direction, of));
    let (low, high) = span(clouds.iter().flatten().map(|p| p.0));
    let x = Axis::linear(format!("position ({})", units.position), low, high);
    draw(found, "Residual against position", x, clouds, POSITION_BINS)
}

/// Against speed, with its sign; `None` without residuals.
pub fn against_speed(found: &Identification) -> Drawn<Option<String>> {
    let units = Units::of(found.model.joint.kind);
    let clouds = Direction::BOTH.map(|direction| cloud(&found.residuals, direction, |r, i| r.velocity_rad_s[i]));
    let (low, high) = span(clouds.iter().flatten().map(|p| p.0));
    let from = SLOW * low.abs().max(high.abs());
    let x = Axis::signed_log(format!("speed ({})", units.speed), low, high, from.max(f64::MIN_POSITIVE));
    draw(found, "Residual against speed", x, clouds, SPEED_BINS)
}

/// The samples of one direction, evenly thinned where there are more than quantiles need.
fn cloud(residuals: &[Residual], direction: Direction, x: impl Fn(&Residual, usize) -> f64) -> Vec<(f64, f64)> {
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

fn draw(
    found: &Identification,
    title: &str,
    x: Axis,
    mut clouds: [Vec<(f64, f64)>; 2],
    bins: usize,
) -> Drawn<Option<String>> {
    if clouds.iter().all(Vec::is_empty) {
        return Ok(None);
    }
    let units = Units::of(found.model.joint.kind);
    let (low, high) = usual(&clouds);
    let (unit, factor) = units.torque_scale(low.abs().max(high.abs()));
    clouds.iter_mut().flatten().for_each(|p| p.1 *= factor);
    let quantiles = clouds.each_ref().map(|points| quantiles(&x, points, bins));
    let ranges = quantiles.iter().flatten().flatten().flat_map(|bin| [bin.low, bin.high]);
    let y = Axis::around(format!("residual ({unit})"), ranges.chain([0.0, factor * low, factor * high]), MARGIN);
    let outside = take_outside(&mut clouds, y.places);
    svg(860, 420, title, |canvas| {
        let panel = canvas.panel(FRAME, x, y)?;
        let mut entries = Vec::new();
        for (direction, points) in Direction::BOTH.into_iter().zip(&clouds) {
            let color = palette::direction(direction);
            let ends = span(points.iter().map(|p| panel.x.place(p.0)));
            panel.dots(thin::across(points, ends, |x| panel.x.place(x), bins, DOTS), 1.5, color, 0.28)?;
            entries.push((Mark::Disc(3.0), color, moving(direction).to_string()));
        }
        for (direction, runs) in Direction::BOTH.into_iter().zip(&quantiles) {
            runs.iter().try_for_each(|run| draw_quantiles(&panel, run, palette::direction(direction)))?;
        }
        entries.push((Mark::Line(2.6, None), palette::GREY, "median".to_string()));
        entries.push((Mark::Band, palette::GREY, "80 % of the samples".to_string()));
        canvas.legend((92.0, 840.0), 20.0, &entries)?;
        if outside > 0.0 {
            let text = format!("{} of them beyond the frame", percent(outside));
            canvas.text((840.0, 20.0), &text, TEXT_PX, palette::INK, Anchor::Right)?;
        }
        Ok(())
    })
    .map(Some)
}

/// The range of nearly all residuals: a few samples must not flatten the rest.
fn usual(clouds: &[Vec<(f64, f64)>; 2]) -> (f64, f64) {
    let mut all: Vec<f64> = clouds.iter().flatten().map(|p| p.1).filter(|y| y.is_finite()).collect();
    (quantile(&mut all, BEYOND), quantile(&mut all, 1.0 - BEYOND))
}

/// Drops the samples beyond `low` to `high` and gives their share.
fn take_outside(clouds: &mut [Vec<(f64, f64)>; 2], (low, high): (f64, f64)) -> f64 {
    let total = clouds.iter().flatten().count();
    clouds.iter_mut().for_each(|points| points.retain(|p| (low..=high).contains(&p.1)));
    1.0 - clouds.iter().flatten().count() as f64 / total as f64
}

/// Quantiles of `points` in stretches that are equally wide as drawn on `x`, in runs without a gap.
fn quantiles(x: &Axis, points: &[(f64, f64)], number: usize) -> Vec<Vec<thin::Bin>> {
    let placed: Vec<(f64, f64)> = points.iter().map(|p| (x.place(p.0), p.1)).collect();
    thin::bins(&placed, span(placed.iter().map(|p| p.0)), number)
}

/// Median and the range of 80 %.
fn draw_quantiles(panel: &Panel, run: &[thin::Bin], color: RGBColor) -> Drawn {
    let along = |of: fn(&thin::Bin) -> f64| -> Vec<(f64, f64)> {
        thin::along(run, of).into_iter().map(|(place, y)| (panel.x.value(place), y)).collect()
    };
    panel.band(&along(|b| b.low), &along(|b| b.high), color, 0.18)?;
    // A white edge keeps the median readable on its own dots.
    panel.line(along(|b| b.median), Stroke::solid(WHITE, 4.6))?;
    panel.line(along(|b| b.median), Stroke::solid(color, 2.6))
}
