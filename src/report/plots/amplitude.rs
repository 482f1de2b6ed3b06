//! A(v): the load amplitude of every leg, its mean and spread.

use crate::identify::{Amplitude, Identification, LegFit, Route};
use crate::model::Direction;
use crate::report::chart::{Axis, Canvas, Drawn, Frame, Mark, Panel, Stroke, palette, span, svg};
use crate::report::wording::{Units, moving};

/// Legs whose speeds differ by no more than this share repeat one speed.
const SAME_SPEED: f64 = 0.01;
/// Repeats stand this share of their speed apart, all of them within `REPEATS_WITHIN` of it.
const REPEATS_APART: f64 = 0.025;
const REPEATS_WITHIN: f64 = 0.06;

/// A against speed, a panel for each direction, both to the same scale; `None` without legs.
pub fn draw(found: &Identification) -> Drawn<Option<String>> {
    let Route::Sweeps(fits) = &found.route else { return Ok(None) };
    if found.legs.is_empty() {
        return Ok(None);
    }
    let units = Units::of(found.model.joint.kind);
    let legs = Direction::BOTH.map(|d| found.legs.iter().filter(|leg| leg.direction == d).collect::<Vec<&LegFit>>());
    let reach = [0, 1].map(|i| reach(&legs[i], fits.of(Direction::BOTH[i]).a)).into_iter().fold(0.0, f64::max);
    let x = Axis::log(format!("speed ({})", units.speed), found.legs.iter().map(|leg| leg.speed_rad_s));
    svg(860, 474, "Load amplitude A against speed", |canvas| {
        for (i, direction) in Direction::BOTH.into_iter().enumerate() {
            let a = fits.of(direction).a;
            let top = 40.0 + 214.0 * i as f64;
            let frame = Frame { left: 104.0, top, right: 840.0, bottom: top + 166.0 };
            let y = Axis::linear(format!("A ({})", units.torque), a.a_nm - reach, a.a_nm + reach);
            let x = if i == 0 { x.clone().without_texts() } else { x.clone() };
            let panel = canvas.panel(frame, x, y)?;
            heading(canvas, frame, direction, a, &units)?;
            fill(&panel, &legs[i], direction, a)?;
        }
        Ok(())
    })
    .map(Some)
}

/// How far from the mean the axis must go for points, their bars and the band.
fn reach(legs: &[&LegFit], a: Amplitude) -> f64 {
    let ends = |middle: f64, half: f64| [middle - half, middle, middle + half];
    let bars = legs.iter().flat_map(|leg| ends(leg.a_nm, leg.a_se_nm));
    let (low, high) = span(bars.chain(ends(a.a_nm, a.sd_nm)));
    1.06 * (high - a.a_nm).max(a.a_nm - low)
}

fn heading(canvas: &Canvas, frame: Frame, direction: Direction, a: Amplitude, units: &Units) -> Drawn {
    let (color, mark) = (palette::direction(direction), Mark::of(direction));
    let text = format!("{}: {}", moving(direction), units.amplitude(&a));
    canvas.legend((frame.left, frame.right), frame.top - 20.0, &[(mark, color, text)])
}

/// Mean, band and points; a point's bar is its standard error.
fn fill(panel: &Panel, legs: &[&LegFit], direction: Direction, a: Amplitude) -> Drawn {
    let color = palette::direction(direction);
    let (low, high) = panel.x.places;
    let level = |at: f64| [(panel.x.value(low), at), (panel.x.value(high), at)];
    if a.sd_nm.is_finite() {
        panel.band(&level(a.a_nm - a.sd_nm), &level(a.a_nm + a.sd_nm), color, 0.14)?;
    }
    panel.line(level(a.a_nm), Stroke::solid(color, 1.8))?;
    for (v, leg) in side_by_side(legs) {
        let se = leg.a_se_nm;
        panel.line([(v, leg.a_nm - se), (v, leg.a_nm + se)], Stroke::solid(color, 1.0))?;
        panel.mark((v, leg.a_nm), Mark::of(direction), color)?;
    }
    Ok(())
}

/// The legs by speed, each with the speed at which it is drawn: repeats of one speed a little apart, or they would lie on
/// each other.
fn side_by_side<'a>(legs: &[&'a LegFit]) -> Vec<(f64, &'a LegFit)> {
    let mut legs = legs.to_vec();
    legs.sort_by(|a, b| a.speed_rad_s.total_cmp(&b.speed_rad_s));
    let repeats = legs.chunk_by(|a, b| b.speed_rad_s <= (1.0 + SAME_SPEED) * a.speed_rad_s);
    let placed = repeats.flat_map(|mine| {
        let last = (mine.len() - 1) as f64;
        let apart = REPEATS_APART.min(REPEATS_WITHIN / last.max(1.0));
        mine.iter().enumerate().map(move |(i, leg)| (leg.speed_rad_s * (apart * (i as f64 - last / 2.0)).exp(), *leg))
    });
    placed.collect()
}
