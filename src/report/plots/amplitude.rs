//! A(v): the load amplitude of every leg, its mean and spread.

use crate::identify::{Amplitude, Identification, LegFit, Route};
use crate::model::Direction;
use crate::report::chart::{Axis, Figure, Mark, Panel, Stroke, palette, span};
use crate::report::wording::{Units, moving};

/// Legs whose speeds differ by no more than this share repeat one speed.
const SAME_SPEED: f64 = 0.01;
/// Repeats stand this share of their speed apart, all of them within `REPEATS_WITHIN` of it.
const REPEATS_APART: f64 = 0.025;
const REPEATS_WITHIN: f64 = 0.06;

const CAPTION: &str = "A of each leg with its standard error, the mean over legs (line) and ± one standard deviation (band). A \
                       should not depend on speed: with a slope or a bend load and friction are not separated, and then μ_c, \
                       which comes from the mean of A, is wrong. A leg far from the others is a bad trial.";

/// A against speed, a panel for each direction, both to the same scale; `None` without legs.
pub fn figure(found: &Identification) -> Option<Figure> {
    let Route::Sweeps(fits) = &found.route else { return None };
    if found.legs.is_empty() {
        return None;
    }
    let units = Units::of(&found.model.joint);
    let legs = Direction::BOTH.map(|d| found.legs.iter().filter(|leg| leg.direction == d).collect::<Vec<&LegFit>>());
    let reach = [0, 1].map(|i| reach(&legs[i], fits.of(Direction::BOTH[i]).a)).into_iter().fold(0.0, f64::max);
    let x = Axis::log(format!("speed ({})", units.speed), found.legs.iter().map(|leg| leg.speed_rad_s));
    let mut figure = Figure::new("amplitude", "Load amplitude A of every leg", CAPTION);
    for (i, direction) in Direction::BOTH.into_iter().enumerate() {
        let a = fits.of(direction).a;
        let y = Axis::linear(format!("A ({})", units.torque), a.a_nm - reach, a.a_nm + reach);
        let x = if i == 0 { x.clone().without_texts() } else { x.clone() };
        let title = format!("{}: {}", moving(direction), units.amplitude(&a));
        let mut panel = Panel::new(x, y).titled(title).linked("speed");
        fill(&mut panel, &legs[i], direction, a);
        figure = figure.row(166.0, vec![panel]);
    }
    Some(figure)
}

/// How far from the mean the axis must go for points, their bars and the band.
fn reach(legs: &[&LegFit], a: Amplitude) -> f64 {
    let ends = |middle: f64, half: f64| [middle - half, middle, middle + half];
    let bars = legs.iter().flat_map(|leg| ends(leg.a_nm, leg.a_se_nm));
    let (low, high) = span(bars.chain(ends(a.a_nm, a.sd_nm)));
    1.06 * (high - a.a_nm).max(a.a_nm - low)
}

/// Mean, band and points; a point's bar is its standard error.
fn fill(panel: &mut Panel, legs: &[&LegFit], direction: Direction, a: Amplitude) {
    let color = palette::direction(direction);
    let (low, high) = (panel.x.value(panel.x.places.0), panel.x.value(panel.x.places.1));
    let level = |at: f64| vec![(low, at), (high, at)];
    if a.sd_nm.is_finite() {
        panel.band("", [level(a.a_nm - a.sd_nm), level(a.a_nm + a.sd_nm)], color, 0.14);
    }
    panel.line("", level(a.a_nm), Stroke::solid(color, 1.8));
    let placed = side_by_side(legs);
    let gap = (f64::NAN, f64::NAN);
    let bars = placed.iter().flat_map(|(v, leg)| [(*v, leg.a_nm - leg.a_se_nm), (*v, leg.a_nm + leg.a_se_nm), gap]);
    panel.line("", bars, Stroke::solid(color, 1.0));
    let points = placed.iter().map(|(v, leg)| (*v, leg.a_nm)).collect();
    panel.marks(format!("A of a leg, {}", moving(direction)), points, Mark::of(direction), color);
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
