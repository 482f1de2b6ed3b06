//! A campaign as it was understood: each trial, and the speeds of its sweeps.

use crate::identify::{Understood, UnderstoodTrial};
use crate::model::Direction;
use crate::report::chart::{Axis, Figure, Mark, Panel, Point, Stroke, palette, span};
use crate::report::validation::{POSITION, SPEED, TORQUE, plain};
use crate::report::wording::{Units, moving};

/// Heights of panels, px.
const OVER_TIME_PX: f64 = 110.0;
const HYSTERESIS_PX: f64 = 230.0;
/// Points drawn of a trial.
const POINTS: usize = 4000;
/// Below this share of its fastest speed a trial rests.
const MOVING: f64 = 0.02;

const TRIAL: &str = "Position and low-passed torque against time, and torque against position: moving up should lie above moving \
                     down (friction takes), and their middle should follow gravity.";
const SPEEDS: &str = "Speeds of the sweeps as found against the speeds declared; they should lie on the line.";

/// Speeds found against speeds declared; `None` without sweeps.
pub fn speeds(understood: &Understood) -> Option<Figure> {
    let (_, unit, factor) = plain(understood);
    let points: Vec<Point> = understood.sweeps().map(|(declared, found)| (factor * declared, factor * found)).collect();
    let (low, high) = (!points.is_empty()).then(|| span(points.iter().flat_map(|p| [p.0, p.1])))?;
    let axis = |name: &str| Axis::log(format!("{name} ({unit})"), [low, high]);
    let mut panel = Panel::new(axis("speed declared"), axis("speed found"));
    panel.line("as declared", [(low, low), (high, high)], Stroke::dashed(palette::GREY, 1.2, 6.0, 4.0));
    panel.marks("sweep", points, Mark::Ring, palette::BLUE);
    Some(Figure::single("speeds", "Speeds found and declared", SPEEDS, 220.0, panel))
}

/// One trial, the `at`th.
pub fn trial(understood: &Understood, at: usize, trial: &UnderstoodTrial) -> Figure {
    let (angle, _, factor) = plain(understood);
    let torque = Units::of(&understood.joint).torque;
    let step = trial.series[0].len().div_ceil(POINTS).max(1);
    let picked: Vec<usize> = (0..trial.series[0].len()).step_by(step).collect();
    let (from_s, to_s) = span(trial.series[0].iter().copied());
    let values = |of: usize, factor: f64| picked.iter().map(move |i| factor * trial.series[of][*i]);
    let axis = |name: &str, unit: &str, of: usize, factor: f64| {
        Axis::around(format!("{name} ({unit})"), values(of, factor), 0.05)
    };
    let over_time = |name: &str, unit: &str, of: usize, factor: f64, is_last: bool| {
        let x = Axis::linear("time (s)", from_s, to_s);
        let y = axis(name, unit, of, factor);
        let mut panel = Panel::new(if is_last { x } else { x.without_texts() }, y).linked(format!("time{at}"));
        let points: Vec<Point> = values(0, 1.0).zip(values(of, factor)).collect();
        panel.line(name, points, Stroke::solid(palette::INK, 1.1));
        panel
    };
    let mut hysteresis = Panel::new(axis("position", angle, POSITION, factor), axis("torque", torque, TORQUE, 1.0));
    let fastest = values(SPEED, 1.0).fold(0.0, |most: f64, v| most.max(v.abs()));
    for direction in Direction::BOTH {
        let point = |i: &usize| {
            let goes = trial.series[SPEED][*i] * direction.sign() > MOVING * fastest;
            let y = if goes { trial.series[TORQUE][*i] } else { f64::NAN };
            (factor * trial.series[POSITION][*i], y)
        };
        let points: Vec<Point> = picked.iter().map(point).collect();
        hysteresis.line(moving(direction), points, Stroke::solid(palette::direction(direction), 1.2));
    }
    Figure::new(format!("trial_{at}"), format!("{}, {}", trial.file, trial.protocol.name()), TRIAL)
        .row(OVER_TIME_PX, vec![over_time("position", angle, POSITION, factor, false)])
        .row(OVER_TIME_PX, vec![over_time("torque", torque, TORQUE, 1.0, true)])
        .row(HYSTERESIS_PX, vec![hysteresis])
}
