//! The change of friction after a reversal, as in the paper's figure 6, with the curves that describe it.

use crate::identify::{CombinationFit, CurveFit, CurveKind, Identification};
use crate::model::Direction;
use crate::report::chart::{Axis, Color, Figure, Mark, Panel, Point, Stroke, palette, thin};
use crate::report::identification::parameter;
use crate::report::number::{counted, r_squared, significant};
use crate::report::wording::{Units, moving};

/// Samples drawn for each direction.
const DOTS: usize = 900;
/// Medians drawn for each direction.
const MEDIANS: usize = 20;

const CAPTION: &str = "Share of the change of friction against share of the clearance's travel, measured in the slow reversals; \
                       downward crossings are rotated onto the upward ones. Light dots are samples, heavy ones their medians, but \
                       for the first, which the low-pass blurs. The curve that the model takes is drawn bold. If up and down do \
                       not lie on each other, or the medians have not reached 1 at the right, the clearance or the branches are \
                       wrong.";

/// Share of change against share of travel with the curves; `None` without a usable reversal.
pub fn figure(found: &Identification) -> Option<Figure> {
    let fit = found.combination.as_ref().filter(|fit| !fit.crossings.is_empty())?;
    let (low, high) = shares(fit);
    let mut panel = Panel::new(
        Axis::linear("share of the travel through the clearance", 0.0, 1.0),
        Axis::linear("share of the change of friction", low, high),
    )
    .titled(counted(fit.windows, "reversal", "reversals"));
    for direction in Direction::BOTH {
        let points = points(fit, direction);
        let dots = thin::every(points.len(), DOTS).map(|i| points[i]).collect();
        panel.dots(format!("sample, {}", moving(direction)), dots, 1.4, palette::direction(direction), 0.25);
    }
    // The bold one first: where another coincides with it, that one's dashes show on it.
    let units = Units::of(&found.model.joint);
    let rest = (0..fit.curves.len()).filter(|at| *at != fit.taken);
    [fit.taken].into_iter().chain(rest).for_each(|at| add_curve(&mut panel, fit, at, (found, &units)));
    for direction in Direction::BOTH {
        let (color, mark) = (palette::direction(direction), Mark::of(direction));
        let bins = thin::bins(&points(fit, direction), (0.0, 1.0), MEDIANS);
        // The low-pass blurs the start, where the change is steepest.
        let (sharp, blurred): (Vec<&thin::Bin>, Vec<&thin::Bin>) =
            bins.iter().flatten().partition(|bin| bin.from > 0.0);
        let at = |bins: &[&thin::Bin]| -> Vec<Point> { bins.iter().map(|bin| (bin.middle(), bin.median)).collect() };
        panel.marks("", at(&blurred), mark, palette::lighter(color));
        panel.marks(format!("median, {}", moving(direction)), at(&sharp), mark, color);
    }
    Some(Figure::single("transition", "Change of friction after a reversal", CAPTION, 374.0, panel))
}

fn points(fit: &CombinationFit, direction: Direction) -> Vec<Point> {
    let mine = fit.crossings.iter().filter(|c| c.direction == direction);
    mine.map(|c| (c.share_of_travel, c.share_of_change)).collect()
}

/// The shares shown: 0 to 1 and what nearly all samples need, but no more than as much again on either side.
fn shares(fit: &CombinationFit) -> (f64, f64) {
    let mut changes: Vec<f64> = fit.crossings.iter().map(|c| c.share_of_change).filter(|s| s.is_finite()).collect();
    let mut at = |share| crate::numerics::statistics::quantile(&mut changes, share);
    let (low, high) = (at(0.005), at(0.995));
    (low.clamp(-1.0, 0.0) - 0.05, high.clamp(1.0, 2.0) + 0.05)
}

/// A curve over the travel through the model's clearance; one fitted with another clearance is done sooner or later.
fn add_curve(panel: &mut Panel, fit: &CombinationFit, at: usize, (found, units): (&Identification, &Units)) {
    let curve = &fit.curves[at];
    let stretch = match curve.backlash_m > 0.0 {
        true => found.model.joint.backlash_m / curve.backlash_m,
        false => f64::INFINITY,
    };
    let value = |travel: f64| match curve.kind {
        CurveKind::Sign => 1.0,
        _ => curve.curve.share((travel * stretch).clamp(0.0, 1.0)),
    };
    // Steep at the start: finer there.
    let travels = (0..=120).map(|i| (f64::from(i) / 120.0).powi(2));
    let start = (curve.kind == CurveKind::Sign).then_some((0.0, 0.0));
    let line = start.into_iter().chain(travels.map(|t| (t, value(t))));
    panel.line(name(fit, at, curve, units), line, stroke(fit, at, curve.kind));
}

/// "power, n = 0.42 (taken): RMSE 3.1 mN m, R² 0.98".
fn name(fit: &CombinationFit, at: usize, curve: &CurveFit, units: &Units) -> String {
    let parameter = parameter(&curve.curve).map_or(String::new(), |(n, x)| format!(", {n} = {}", significant(x, 4)));
    let note = if at == fit.taken { " (selected)" } else { "" };
    let rmse = units.torque(curve.rmse_nm);
    format!("{}{parameter}{note}: RMSE {rmse}, R² {}", curve.kind.name(), r_squared(curve.r_squared))
}

fn stroke(fit: &CombinationFit, at: usize, kind: CurveKind) -> Stroke {
    let width_px = if at == fit.taken { 4.0 } else { 1.6 };
    let (color, dash_px): (Color, Option<(f64, f64)>) = match kind {
        CurveKind::Sign => (palette::GREY, Some((2.0, 4.0))),
        CurveKind::Linear => (palette::PURPLE, Some((8.0, 4.0))),
        CurveKind::Arctan => (palette::INK, Some((10.0, 3.0))),
        CurveKind::Power => (palette::GREEN, Some((5.0, 4.0))),
    };
    Stroke { color, width_px, dash_px: if at == fit.taken { None } else { dash_px } }
}
