//! The residual over position by direction, before and after, to one scale.

use super::{ROOM, after_name, reach_nm, residuals};
use crate::diagnose::Diagnosis;
use crate::model::Direction;
use crate::report::chart::{Axis, Figure, Panel, Point, palette, span, thin};
use crate::report::plots::residual_cloud::add_quantiles;
use crate::report::wording::{Units, moving};

/// Samples drawn for each direction.
const DOTS: usize = 900;
/// Stretches of position of which median and range are drawn.
const BINS: usize = 36;

const CAPTION: &str = "All trials: samples (dots), median (line) and the range of 80 % of them (band) by direction, by the model as delivered \
                       and with the causes found, on one scale. Both medians off zero alike: load, its phase, a spring or an offset; \
                       one above the other: friction; a wave: ripple.";

/// Both clouds; `None` without samples.
pub(super) fn figure(found: &Diagnosis) -> Option<Figure> {
    let units = Units::of(&found.before.joint);
    let reach_nm = reach_nm(found, &found.views);
    let (unit, factor) = units.torque_scale(reach_nm);
    let clouds = [0, 1].map(|which| Direction::BOTH.map(|direction| cloud(found, which, direction, (&units, factor))));
    let (low, high) = span(clouds.iter().flatten().flatten().map(|p| p.0));
    if low >= high {
        return None;
    }
    let reach = (1.0 + ROOM) * factor * reach_nm;
    let panels =
        ["as delivered", after_name(found)].into_iter().zip(&clouds).enumerate().map(|(at, (title, clouds))| {
            let x = Axis::linear(format!("position ({})", units.position), low, high);
            let y = Axis::linear(format!("residual ({unit})"), -reach, reach);
            let mut panel = Panel::new(x, if at == 0 { y } else { y.without_texts() }).titled(title).linked("position");
            Direction::BOTH.into_iter().zip(clouds).for_each(|(d, cloud)| dots(&mut panel, d, cloud));
            for (direction, cloud) in Direction::BOTH.into_iter().zip(clouds) {
                for run in thin::bins(cloud, panel.x.places, BINS) {
                    add_quantiles(&mut panel, direction, |of| thin::along(&run, of));
                }
            }
            panel
        });
    let figure = Figure::new("residual_position", "Residual over position", CAPTION);
    Some(figure.row(268.0, panels.collect()))
}

fn cloud(found: &Diagnosis, which: usize, direction: Direction, (units, factor): (&Units, f64)) -> Vec<Point> {
    let mut points = Vec::new();
    for view in &found.views {
        let residual = &residuals(found, view)[which];
        let moves = |i: &usize| (view.velocity_rad_s[*i] >= 0.0) == (direction == Direction::Up);
        let rows = residual.rows().filter(moves);
        points.extend(rows.map(|i| (units.position_factor * view.position_rad[i], factor * residual.nm[i])));
    }
    points
}

fn dots(panel: &mut Panel, direction: Direction, cloud: &[Point]) {
    let (low, high) = panel.y.places;
    let within: Vec<Point> = cloud.iter().copied().filter(|p| (low..=high).contains(&p.1)).collect();
    let thinned = thin::across(&within, panel.x.places, |x| x, BINS, DOTS);
    panel.dots(format!("sample, {}", moving(direction)), thinned, 1.4, palette::direction(direction), 0.28);
}
