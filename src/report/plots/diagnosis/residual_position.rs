//! The residual over position by direction, before and after, to one scale.

use super::{ROOM, after_name, reach_nm, residuals};
use crate::diagnose::Diagnosis;
use crate::model::Direction;
use crate::report::chart::{Anchor, Axis, Drawn, Frame, LABEL_PX, Mark, Panel, Stroke, palette, span, svg, thin};
use crate::report::page::Drawing;
use crate::report::wording::{Units, moving};
use plotters::style::WHITE;

/// Samples drawn for each direction.
const DOTS: usize = 900;
/// Stretches of position of which median and range are drawn.
const BINS: usize = 36;

/// Points of position and residual.
type Cloud = Vec<(f64, f64)>;

/// Both clouds; `None` without samples.
pub(super) fn draw(found: &Diagnosis) -> Drawn<Option<Drawing>> {
    let units = Units::of(found.before.joint.kind);
    let reach_nm = reach_nm(found, &found.views);
    let (unit, factor) = units.torque_scale(reach_nm);
    let clouds = [0, 1].map(|which| Direction::BOTH.map(|direction| cloud(found, which, direction, (&units, factor))));
    let (low, high) = span(clouds.iter().flatten().flatten().map(|p| p.0));
    if low >= high {
        return Ok(None);
    }
    let reach = (1.0 + ROOM) * factor * reach_nm;
    let drawn = svg(860, 400, "Residual over position, before and after", |canvas| {
        for (at, (title, clouds)) in ["as delivered", after_name(found)].into_iter().zip(&clouds).enumerate() {
            let left = 92.0 + 386.0 * at as f64;
            let frame = Frame { left, top: 72.0, right: left + 362.0, bottom: 340.0 };
            let x = Axis::linear(format!("position ({})", units.position), low, high);
            let y = Axis::linear(format!("residual ({unit})"), -reach, reach);
            let panel = canvas.panel(frame, x, if at == 0 { y } else { y.without_texts() })?;
            canvas.text((left, 56.0), title, LABEL_PX, palette::INK, Anchor::Left)?;
            Direction::BOTH.into_iter().zip(clouds).try_for_each(|(d, cloud)| dots(&panel, d, cloud))?;
            Direction::BOTH.into_iter().zip(clouds).try_for_each(|(d, cloud)| medians(&panel, d, cloud))?;
        }
        let mut entries =
            Direction::BOTH.map(|d| (Mark::Disc(3.0), palette::direction(d), moving(d).to_string())).to_vec();
        entries.push((Mark::Line(2.6, None), palette::GREY, "median".to_string()));
        entries.push((Mark::Band, palette::GREY, "80 % of the samples".to_string()));
        canvas.legend((92.0, 840.0), 20.0, &entries)
    })?;
    Ok(Some(Drawing {
        name: "residual_position".to_string(),
        title: "Residual over position".to_string(),
        caption: "All trials: samples (dots), median (line) and the range that holds 80 % of them (band) by direction, by the model \
                  as delivered and with what was found, to one scale. Medians off zero together: load, its phase, a spring or an \
                  offset; apart from each other: friction; a wave: ripple."
            .to_string(),
        svg: drawn,
    }))
}

fn cloud(found: &Diagnosis, which: usize, direction: Direction, (units, factor): (&Units, f64)) -> Cloud {
    let mut points = Vec::new();
    for view in &found.views {
        let residual = &residuals(found, view)[which];
        let moves = |i: &usize| (view.velocity_rad_s[*i] >= 0.0) == (direction == Direction::Up);
        let rows = residual.rows().filter(moves);
        points.extend(rows.map(|i| (units.position_factor * view.position_rad[i], factor * residual.nm[i])));
    }
    points
}

fn dots(panel: &Panel, direction: Direction, cloud: &Cloud) -> Drawn {
    let (low, high) = panel.y.places;
    let within: Cloud = cloud.iter().copied().filter(|p| (low..=high).contains(&p.1)).collect();
    let thinned = thin::across(&within, panel.x.places, |x| x, BINS, DOTS);
    panel.dots(thinned, 1.4, palette::direction(direction), 0.28)
}

/// Median and the range of 80 %.
fn medians(panel: &Panel, direction: Direction, cloud: &Cloud) -> Drawn {
    let color = palette::direction(direction);
    for run in thin::bins(cloud, panel.x.places, BINS) {
        panel.band(&thin::along(&run, |b| b.low), &thin::along(&run, |b| b.high), color, 0.18)?;
        // A white edge keeps the median readable on its own dots.
        panel.line(thin::along(&run, |b| b.median), Stroke::solid(WHITE, 4.2))?;
        panel.line(thin::along(&run, |b| b.median), Stroke::solid(color, 2.4))?;
    }
    Ok(())
}
