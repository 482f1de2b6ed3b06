//! Motions to record, one run of each after the other, with the joint's limits.

use crate::excite::{Asked, Limits, RATE_HZ};
use crate::numerics::difference::velocity;
use crate::report::chart::{Axis, Figure, Panel, Point, Stroke, palette};

/// Height of a panel, px.
const TALL_PX: f64 = 170.0;
/// Samples drawn, at most: longer motions are decimated.
const SAMPLES: usize = 400_000;

/// One quantity along all motions.
struct Quantity {
    label: &'static str,
    points: Vec<Point>,
    /// The same of other joints, a line each.
    others: Vec<Vec<Point>>,
    limits: Vec<f64>,
}

/// Position, speed and, where a model tells it, torque against time.
pub fn figure(asked: &[Asked], limits: &Limits) -> Figure {
    let quantities = quantities(asked, limits);
    let whole_s: f64 = asked.iter().map(|one| one.duration_s).sum();
    let (factor, unit) = if whole_s > 600.0 { (1.0 / 60.0, "min") } else { (1.0, "s") };
    let mut figure =
        Figure::new("plan", "Motions to record", "Position, speed and torque of the motions, and the limits.");
    let last = quantities.len() - 1;
    for (at, one) in quantities.iter().enumerate() {
        let ends = one.points.iter().chain(one.others.iter().flatten()).map(|p| p.1).chain(one.limits.iter().copied());
        let y = Axis::around(one.label, ends, 0.06);
        let label = format!("time, one run of each motion after the other ({unit})");
        let x = Axis::linear(label, 0.0, factor * whole_s);
        let mut panel = Panel::new(if at == last { x } else { x.without_texts() }, y).linked("time");
        for limit in &one.limits {
            let line = [(0.0, *limit), (factor * whole_s, *limit)];
            panel.line("limit", line, Stroke::dashed(palette::VERMILION, 1.6, 7.0, 4.0));
        }
        let scaled = |points: &[Point]| -> Vec<Point> { points.iter().map(|(t, y)| (factor * t, *y)).collect() };
        for other in &one.others {
            panel.line("other joints", scaled(other), Stroke::solid(palette::GREY, 1.4));
        }
        panel.line("asked of the joint", scaled(&one.points), Stroke::solid(palette::BLUE, 1.4));
        figure = figure.row(TALL_PX, vec![panel]);
    }
    figure
}

fn quantities(asked: &[Asked], limits: &Limits) -> Vec<Quantity> {
    let samples: f64 = asked.iter().map(|one| one.duration_s * RATE_HZ).sum();
    let every = ((samples / SAMPLES as f64).ceil() as usize).max(1);
    let (mut position, mut speed, mut torque) = (Vec::new(), Vec::new(), Vec::new());
    let mut others = Vec::new();
    let mut from_s = 0.0;
    for one in asked {
        let positions_rad = one.trajectory.positions_rad(RATE_HZ);
        let along = |values: &[f64]| -> Vec<Point> {
            let timed = values.iter().enumerate().step_by(every);
            timed.map(|(i, y)| (from_s + i as f64 / RATE_HZ, *y)).collect()
        };
        others.extend(one.trajectory.others.iter().map(|other| along(&other.positions_rad(RATE_HZ))));
        position.extend(along(&positions_rad));
        speed.extend(along(&velocity(&positions_rad, RATE_HZ)));
        torque.extend(one.torque_nm.as_deref().map_or_else(Vec::new, along));
        from_s += one.duration_s;
    }
    let both = |limit: Option<f64>| limit.map_or_else(Vec::new, |limit| vec![-limit, limit]);
    let ends = limits.low_rad.into_iter().chain(limits.high_rad).collect();
    let mut all = vec![
        Quantity { label: "position (rad)", points: position, others, limits: ends },
        Quantity { label: "speed (rad/s)", points: speed, others: Vec::new(), limits: both(limits.speed_rad_s) },
    ];
    if !torque.is_empty() {
        all.push(Quantity {
            label: "torque (N m)",
            points: torque,
            others: Vec::new(),
            limits: both(limits.torque_nm),
        });
    }
    all
}
