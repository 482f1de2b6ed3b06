//! The change of friction after a reversal, as in the paper's figure 6, with the curves that describe it.

use crate::identify::{CombinationFit, CurveFit, CurveKind, Identification};
use crate::model::Direction;
use crate::report::chart::{
    Anchor, Axis, Canvas, Drawn, Frame, LABEL_PX, Mark, Panel, Stroke, TEXT_PX, palette, svg, thin,
};
use crate::report::identification::parameter;
use crate::report::number::{counted, r_squared, significant, with_minus};
use crate::report::wording::{Units, moving};
use plotters::style::RGBColor;

/// Samples drawn for each direction.
const DOTS: usize = 900;
/// Medians drawn for each direction.
const MEDIANS: usize = 20;

/// Share of change against share of travel with the curves; `None` without a usable reversal.
pub fn draw(found: &Identification) -> Drawn<Option<String>> {
    let Some(fit) = found.combination.as_ref().filter(|fit| !fit.crossings.is_empty()) else { return Ok(None) };
    let (low, high) = shares(fit);
    svg(860, 470, "Share of the change of friction against share of travel", |canvas| {
        let panel = canvas.panel(
            Frame { left: 78.0, top: 40.0, right: 570.0, bottom: 414.0 },
            Axis::linear("share of the travel through the clearance", 0.0, 1.0),
            Axis::linear("share of the change of friction", low, high),
        )?;
        for direction in Direction::BOTH {
            let points = points(fit, direction);
            let color = palette::direction(direction);
            panel.dots(thin::every(points.len(), DOTS).map(|i| points[i]), 1.4, color, 0.25)?;
        }
        // The bold one first: where another coincides with it, that one's dashes show on it.
        let rest = (0..fit.curves.len()).filter(|at| *at != fit.taken);
        [fit.taken].into_iter().chain(rest).try_for_each(|at| draw_curve(&panel, fit, at, found))?;
        let mut entries = Vec::new();
        for direction in Direction::BOTH {
            let (color, mark) = (palette::direction(direction), Mark::of(direction));
            for bin in thin::bins(&points(fit, direction), (0.0, 1.0), MEDIANS).iter().flatten() {
                // The low-pass blurs the start, where the change is steepest.
                let shade = if bin.from > 0.0 { color } else { palette::lighter(color) };
                panel.mark((bin.middle(), bin.median), mark, shade)?;
            }
            entries.push((mark, color, format!("{}, median", moving(direction))));
        }
        canvas.legend((78.0, 570.0), 20.0, &entries)?;
        list_curves(canvas, fit, &Units::of(found.model.joint.kind))
    })
    .map(Some)
}

/// The curves with their figures, right of the panel.
fn list_curves(canvas: &Canvas, fit: &CombinationFit, units: &Units) -> Drawn {
    let heading = counted(fit.windows, "reversal", "reversals");
    canvas.text((596.0, 50.0), &heading, LABEL_PX, palette::INK, Anchor::Left)?;
    for (at, curve) in fit.curves.iter().enumerate() {
        let top = 84.0 + 80.0 * at as f64;
        let stroke = stroke(fit, at, curve.kind);
        let sample = Mark::Line(stroke.width_px, stroke.dash_px);
        canvas.legend((596.0, 860.0), top, &[(sample, stroke.color, name(fit, at, curve))])?;
        let figures = format!("RMSE {}, R² {}", units.torque(curve.rmse_nm), with_minus(&r_squared(curve.r_squared)));
        canvas.text((626.0, top + 20.0), &figures, TEXT_PX, palette::GREY, Anchor::Left)?;
        if curve.kind != CurveKind::Sign {
            let clearance = format!("clearance {} mm", significant(1e3 * curve.backlash_m, 3));
            canvas.text((626.0, top + 38.0), &clearance, TEXT_PX, palette::GREY, Anchor::Left)?;
        }
    }
    Ok(())
}

fn points(fit: &CombinationFit, direction: Direction) -> Vec<(f64, f64)> {
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
fn draw_curve(panel: &Panel, fit: &CombinationFit, at: usize, found: &Identification) -> Drawn {
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
    panel.line(start.into_iter().chain(travels.map(|t| (t, value(t)))), stroke(fit, at, curve.kind))
}

fn name(fit: &CombinationFit, at: usize, curve: &CurveFit) -> String {
    let parameter = parameter(&curve.curve).map_or(String::new(), |(n, x)| format!(", {n} = {}", significant(x, 4)));
    let note = if at == fit.taken { " (taken)" } else { "" };
    format!("{}{parameter}{note}", curve.kind.name())
}

fn stroke(fit: &CombinationFit, at: usize, kind: CurveKind) -> Stroke {
    let width_px = if at == fit.taken { 4.0 } else { 1.6 };
    let (color, dash_px): (RGBColor, Option<(f64, f64)>) = match kind {
        CurveKind::Sign => (palette::GREY, Some((2.0, 4.0))),
        CurveKind::Linear => (palette::PURPLE, Some((8.0, 4.0))),
        CurveKind::Arctan => (palette::INK, Some((10.0, 3.0))),
        CurveKind::Power => (palette::GREEN, Some((5.0, 4.0))),
    };
    Stroke { color, width_px, dash_px: if at == fit.taken { None } else { dash_px } }
}
