//! The figures of a comparison: friction, combination, prediction.

use crate::compare::Comparison;
use crate::model::{Direction, Model, shared_speeds};
use crate::report::chart::{Axis, Color, Figure, Panel, Point, Stroke, palette, span};
use crate::report::wording::{Units, moving};

/// Slowest and fastest speed drawn where the models do not say which speeds their data cover, rad/s: those of the paper's sweeps, twice as far.
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

/// B(v) of both models over the speeds that their data cover: beyond them the parameters only extrapolate.
fn friction(found: &Comparison) -> Figure {
    let units = Units::of(&found.before.joint);
    let models = [&found.before, &found.after];
    let ((slowest, fastest), covered) = speeds_rad_s(models);
    let x = Axis::log(format!("speed ({})", units.speed), [slowest, fastest]);
    let curve = |model: &Model, direction| -> Vec<Point> {
        x.spread(slowest, fastest, 200).into_iter().map(|v| (v, model.b_nm(direction, v))).collect()
    };
    let all = Direction::BOTH.into_iter().flat_map(|d| models.map(|m| curve(m, d))).flatten().map(|p| p.1);
    let y = Axis::around(format!("B(v) ({})", units.torque), all, 0.08);
    let mut panel = Panel::new(x.clone(), y);
    for direction in Direction::BOTH {
        for (model, (name, stroke)) in models.iter().zip(strokes(palette::direction(direction))) {
            panel.line(format!("{}, {name}", moving(direction)), curve(model, direction), stroke);
        }
    }
    let caption = format!(
        "B(v) of both models{covered}. A shift that is the same at all speeds is Coulomb friction, or an offset of the torque sensor (then \
         both directions shift alike); one that grows with speed is viscous friction; one at low speed only is Stribeck friction."
    );
    Figure::single("friction", "Friction without load against speed", &caption, 320.0, panel)
}

/// The slowest and the fastest speed that the data of both of `models` cover, or all that are usual where these do not say, and how the
/// caption says which.
fn speeds_rad_s(models: [&Model; 2]) -> ((f64, f64), &'static str) {
    let known = models.map(|model| !model.functions.is_empty());
    let branches =
        models.into_iter().flat_map(|model| Direction::BOTH.map(|d| model.functions.branches.of(d).as_ref()));
    match (known, shared_speeds(branches.flatten())) {
        ([true, true], Some(speeds)) => (speeds, ", over the speeds that the data of both cover"),
        ([true, false], Some(speeds)) => (
            speeds,
            ", over the speeds that the data of the model before cover (the model after does not say which its own cover)",
        ),
        ([false, true], Some(speeds)) => (
            speeds,
            ", over the speeds that the data of the model after cover (the model before does not say which its own cover)",
        ),
        ([false, false], _) => {
            (SPEEDS_RAD_S, " (neither says which speeds its data cover: parts of the curves may be extrapolated)")
        }
        (_, None) => (
            SPEEDS_RAD_S,
            " (their data have no range of speeds in common: everywhere at least one of the curves is extrapolated)",
        ),
    }
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
        "How friction passes from that of one direction to that of the other over the cable's travel: clearance and change-over curve \
         together.",
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
    lower.line("after minus before", over_time(&change), Stroke::solid(palette::VERMILION, 1.2));
    let figure = Figure::new(
        "prediction",
        "Effect on the predicted torque",
        "Torque that both models predict along the paper's cosine cascade, and its change, after minus before.",
    );
    figure.row(200.0, vec![upper]).row(168.0, vec![lower])
}
