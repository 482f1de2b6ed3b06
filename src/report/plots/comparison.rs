//! The figures of a comparison: friction, combination, prediction.

use crate::compare::Comparison;
use crate::model::{Direction, Model};
use crate::report::chart::{Axis, Drawn, Frame, Mark, Stroke, palette, span, svg, thin};
use crate::report::page::Drawing;
use crate::report::wording::{Units, moving};

/// Slowest and fastest speed drawn, rad/s: a decade beyond neither end of the paper's sweeps.
const SPEEDS_RAD_S: (f64, f64) = (0.01, 0.8);
/// Stretches of time of which the lowest and highest point are drawn.
const BUCKETS: usize = 900;
/// Before is dashed, in every figure.
const DASH_PX: (f64, f64) = (7.0, 4.0);

/// All figures.
pub fn drawings(found: &Comparison) -> Drawn<Vec<Drawing>> {
    Ok(vec![friction(found)?, combination(found)?, prediction(found)?])
}

fn entries() -> Vec<(Mark, plotters::style::RGBColor, String)> {
    vec![
        (Mark::Line(1.4, Some(DASH_PX)), palette::GREY, "before".to_string()),
        (Mark::Line(2.0, None), palette::GREY, "after".to_string()),
    ]
}

fn strokes(color: plotters::style::RGBColor) -> [Stroke; 2] {
    [Stroke::dashed(color, 1.4, DASH_PX.0, DASH_PX.1), Stroke::solid(color, 2.0)]
}

fn friction(found: &Comparison) -> Drawn<Drawing> {
    let units = Units::of(found.before.joint.kind);
    let x = Axis::log(format!("speed ({})", units.speed), [SPEEDS_RAD_S.0, SPEEDS_RAD_S.1]);
    let curve = |model: &Model, direction| -> Vec<(f64, f64)> {
        x.spread(SPEEDS_RAD_S.0, SPEEDS_RAD_S.1, 200).into_iter().map(|v| (v, model.b_nm(direction, v))).collect()
    };
    let models = [&found.before, &found.after];
    let all = Direction::BOTH.into_iter().flat_map(|d| models.map(|m| curve(m, d))).flatten().map(|p| p.1);
    let y = Axis::around(format!("B(v) ({})", units.torque), all, 0.08);
    let drawn = svg(860, 420, "Friction before and after", |canvas| {
        let panel = canvas.panel(Frame { left: 92.0, top: 44.0, right: 840.0, bottom: 364.0 }, x.clone(), y)?;
        let mut legend = entries();
        for direction in Direction::BOTH {
            let color = palette::direction(direction);
            for (model, stroke) in models.iter().zip(strokes(color)) {
                panel.line(curve(model, direction), stroke)?;
            }
            legend.push((Mark::Line(2.0, None), color, moving(direction).to_string()));
        }
        canvas.legend((92.0, 840.0), 22.0, &legend)
    })?;
    Ok(Drawing {
        name: "friction".to_string(),
        title: "Friction without load against speed".to_string(),
        caption: "B(v) of both models. A shift that is the same at all speeds is Coulomb friction, or a sensor's zero that moved \
                  (then both directions shift alike); one that grows with speed is viscous; one at low speed, Stribeck."
            .to_string(),
        svg: drawn,
    })
}

fn combination(found: &Comparison) -> Drawn<Drawing> {
    let longest_m = found.before.joint.backlash_m.max(found.after.joint.backlash_m).max(f64::MIN_POSITIVE);
    let curve = |model: &Model| -> Vec<(f64, f64)> {
        let travel = (0..=200).map(|i| f64::from(i) / 200.0 * 1.2 * longest_m);
        let share = |m: f64| (m / model.joint.backlash_m.max(1e-12)).min(1.0);
        travel.map(|m| (1e3 * m, model.combination.share(share(m)))).collect()
    };
    let drawn = svg(860, 380, "Change of friction after a reversal", |canvas| {
        let x = Axis::linear("cable travel after a reversal (mm)", 0.0, 1.2e3 * longest_m);
        let y = Axis::linear("share of the change of friction", 0.0, 1.05);
        let panel = canvas.panel(Frame { left: 92.0, top: 44.0, right: 840.0, bottom: 324.0 }, x, y)?;
        for (model, stroke) in [&found.before, &found.after].into_iter().zip(strokes(palette::INK)) {
            panel.line(curve(model), stroke)?;
        }
        canvas.legend((92.0, 840.0), 22.0, &entries())
    })?;
    Ok(Drawing {
        name: "combination".to_string(),
        title: "Change of friction after a reversal".to_string(),
        caption:
            "How friction passes from one branch to the other, over the cable's travel: clearance and curve together."
                .to_string(),
        svg: drawn,
    })
}

fn prediction(found: &Comparison) -> Drawn<Drawing> {
    let units = Units::of(found.before.joint.kind);
    let effect = &found.effect;
    let over_time = |values: Vec<f64>| -> Vec<(f64, f64)> {
        thin::envelope(&effect.time_s.iter().copied().zip(values).collect::<Vec<_>>(), BUCKETS)
    };
    let difference: Vec<f64> = effect.after_nm.iter().zip(&effect.before_nm).map(|(b, a)| b - a).collect();
    let (unit, factor) = units.torque_scale(effect.peak_nm);
    let drawn = svg(860, 500, "Prediction before and after", |canvas| {
        let (from_s, to_s) = span(effect.time_s.iter().copied());
        let time = Axis::linear("time (s)", from_s, to_s);
        let both = effect.before_nm.iter().chain(&effect.after_nm).copied();
        let y = Axis::around(format!("torque ({})", units.torque), both, 0.06);
        let upper = Frame { left: 92.0, top: 44.0, right: 840.0, bottom: 244.0 };
        let panel = canvas.panel(upper, time.clone().without_texts(), y)?;
        for (values, stroke) in [&effect.before_nm, &effect.after_nm].into_iter().zip(strokes(palette::INK)) {
            panel.line(over_time(values.clone()), stroke)?;
        }
        canvas.legend((92.0, 840.0), 22.0, &entries())?;
        let scaled: Vec<f64> = difference.iter().map(|y| factor * y).collect();
        let y = Axis::around(format!("change ({unit})"), scaled.iter().copied().chain([0.0]), 0.08);
        let panel = canvas.panel(Frame { left: 92.0, top: 276.0, right: 840.0, bottom: 444.0 }, time, y)?;
        panel.line(over_time(scaled), Stroke::solid(palette::VERMILION, 1.2))
    })?;
    Ok(Drawing {
        name: "prediction".to_string(),
        title: "What it does to the predicted torque".to_string(),
        caption: "Torque that both models predict along the paper's cosine cascade, and after less before.".to_string(),
        svg: drawn,
    })
}
