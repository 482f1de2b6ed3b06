//! The figures of a comparison: friction, combination, prediction.

use crate::compare::Comparison;
use crate::model::{Direction, Model};
use crate::report::chart::{Axis, Color, Figure, Panel, Point, Stroke, palette, span};
use crate::report::wording::{Units, moving};

/// Slowest and fastest speed drawn, rad/s: a decade beyond neither end of the paper's sweeps.
const SPEEDS_RAD_S: (f64, f64) = (0.01, 0.8);
/// Before is dashed, in every figure.
const DASH_PX: (f64, f64) = (7.0, 4.0);

/// All figures.
pub fn figures(found: &Comparison) -> Vec<Figure> {
    vec![friction(found), combination(found), prediction(found)]
}

fn strokes(color: Color) -> [(&'static str, Stroke); 2] {
    [("before", Stroke::dashed(color, 1.4, DASH_PX.0, DASH_PX.1)), ("after", Stroke::solid(color, 2.0))]
}

fn friction(found: &Comparison) -> Figure {
    let units = Units::of(&found.before.joint);
    let x = Axis::log(format!("speed ({})", units.speed), [SPEEDS_RAD_S.0, SPEEDS_RAD_S.1]);
    let curve = |model: &Model, direction| -> Vec<Point> {
        x.spread(SPEEDS_RAD_S.0, SPEEDS_RAD_S.1, 200).into_iter().map(|v| (v, model.b_nm(direction, v))).collect()
    };
    let models = [&found.before, &found.after];
    let all = Direction::BOTH.into_iter().flat_map(|d| models.map(|m| curve(m, d))).flatten().map(|p| p.1);
    let y = Axis::around(format!("B(v) ({})", units.torque), all, 0.08);
    let mut panel = Panel::new(x.clone(), y);
    for direction in Direction::BOTH {
        for (model, (name, stroke)) in models.iter().zip(strokes(palette::direction(direction))) {
            panel.line(format!("{}, {name}", moving(direction)), curve(model, direction), stroke);
        }
    }
    Figure::single(
        "friction",
        "Friction without load against speed",
        "B(v) of both models. A shift that is the same at all speeds is Coulomb friction, or a sensor's zero that moved (then both \
         directions shift alike); one that grows with speed is viscous; one at low speed, Stribeck.",
        320.0,
        panel,
    )
}

fn combination(found: &Comparison) -> Figure {
    let longest_m = found.before.joint.backlash_m.max(found.after.joint.backlash_m).max(f64::MIN_POSITIVE);
    let curve = |model: &Model| -> Vec<Point> {
        let travel = (0..=200).map(|i| f64::from(i) / 200.0 * 1.2 * longest_m);
        let share = |m: f64| (m / model.joint.backlash_m.max(1e-12)).min(1.0);
        travel.map(|m| (1e3 * m, model.combination.share(share(m)))).collect()
    };
    let x = Axis::linear("cable travel after a reversal (mm)", 0.0, 1.2e3 * longest_m);
    let mut panel = Panel::new(x, Axis::linear("share of the change of friction", 0.0, 1.05));
    for (model, (name, stroke)) in [&found.before, &found.after].into_iter().zip(strokes(palette::INK)) {
        panel.line(name, curve(model), stroke);
    }
    Figure::single(
        "combination",
        "Change of friction after a reversal",
        "How friction passes from one branch to the other, over the cable's travel: clearance and curve together.",
        280.0,
        panel,
    )
}

fn prediction(found: &Comparison) -> Figure {
    let units = Units::of(&found.before.joint);
    let effect = &found.effect;
    let over_time =
        |values: &[f64]| -> Vec<Point> { effect.time_s.iter().copied().zip(values.iter().copied()).collect() };
    let (unit, factor) = units.torque_scale(effect.peak_nm);
    let (from_s, to_s) = span(effect.time_s.iter().copied());
    let time = Axis::linear("time (s)", from_s, to_s);
    let both = effect.before_nm.iter().chain(&effect.after_nm).copied();
    let y = Axis::around(format!("torque ({})", units.torque), both, 0.06);
    let mut upper = Panel::new(time.clone().without_texts(), y).linked("time");
    for (values, (name, stroke)) in [&effect.before_nm, &effect.after_nm].into_iter().zip(strokes(palette::INK)) {
        upper.line(name, over_time(values), stroke);
    }
    let change: Vec<f64> = effect.after_nm.iter().zip(&effect.before_nm).map(|(b, a)| factor * (b - a)).collect();
    let y = Axis::around(format!("change ({unit})"), change.iter().copied().chain([0.0]), 0.08);
    let mut lower = Panel::new(time, y).linked("time");
    lower.line("after less before", over_time(&change), Stroke::solid(palette::VERMILION, 1.2));
    let figure = Figure::new(
        "prediction",
        "What it does to the predicted torque",
        "Torque that both models predict along the paper's cosine cascade, and after less before.",
    );
    figure.row(200.0, vec![upper]).row(168.0, vec![lower])
}
