//! A(v): the load amplitude of every leg, its mean and spread.

use crate::identify::{Identification, LegFit, Route};
use crate::model::Direction;
use crate::report::chart::{Axis, Drawn, Frame, Mark, Stroke, palette, svg};
use crate::report::number::with_spread;
use crate::report::wording::{Units, moving};

/// A against speed, both directions; `None` without legs.
pub fn draw(found: &Identification) -> Drawn<Option<String>> {
    let Route::Sweeps(fits) = &found.route else { return Ok(None) };
    if found.legs.is_empty() {
        return Ok(None);
    }
    let units = Units::of(found.model.joint.kind);
    let legs = |direction: Direction| found.legs.iter().filter(move |leg| leg.direction == direction);
    let speeds = found.legs.iter().map(|leg| leg.speed_rad_s);
    let bands = Direction::BOTH.into_iter().flat_map(|d| {
        let a = fits.of(d).a;
        [a.a_nm - a.sd_nm, a.a_nm + a.sd_nm]
    });
    let x = Axis::log(format!("speed ({})", units.speed), speeds.clone());
    let y = Axis::around(format!("A ({})", units.torque), found.legs.iter().map(|leg| leg.a_nm).chain(bands), 0.06);
    let ends = x.spread(speeds.clone().fold(f64::MAX, f64::min) / 1.1, speeds.fold(0.0, f64::max) * 1.1, 2);
    svg(860, 420, "Load amplitude A against speed", |canvas| {
        let panel = canvas.panel(Frame { left: 92.0, top: 40.0, right: 840.0, bottom: 364.0 }, x, y)?;
        let mut entries = Vec::new();
        for direction in Direction::BOTH {
            let (a, color) = (fits.of(direction).a, palette::direction(direction));
            let level = |at: f64| ends.iter().map(|v| (*v, at)).collect::<Vec<(f64, f64)>>();
            if a.sd_nm.is_finite() {
                panel.band(&level(a.a_nm - a.sd_nm), &level(a.a_nm + a.sd_nm), color, 0.14)?;
            }
            panel.line(level(a.a_nm), Stroke::solid(color, 1.8))?;
            let mark = if direction == Direction::Up { Mark::Up } else { Mark::Down };
            entries.push((
                mark,
                color,
                format!("{}: {} {}", moving(direction), with_spread(a.a_nm, a.sd_nm), units.torque),
            ));
        }
        for direction in Direction::BOTH {
            let mark = entries[usize::from(direction == Direction::Down)].0;
            legs(direction).try_for_each(|leg| point(&panel, leg, mark))?;
        }
        canvas.legend((92.0, 840.0), 20.0, &entries)
    })
    .map(Some)
}

/// A leg's A with its standard error; both directions of one speed stand a little apart.
fn point(panel: &crate::report::chart::Panel, leg: &LegFit, mark: Mark) -> Drawn {
    let at = leg.speed_rad_s * if leg.direction == Direction::Up { 0.99 } else { 1.01 };
    let color = palette::direction(leg.direction);
    if leg.a_se_nm.is_finite() {
        panel.line([(at, leg.a_nm - leg.a_se_nm), (at, leg.a_nm + leg.a_se_nm)], Stroke::solid(color, 1.0))?;
    }
    panel.mark((at, leg.a_nm), mark, color)
}
