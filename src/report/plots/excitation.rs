//! Motions to record, one run of each after the other, with the joint's limits.

use crate::excite::{Asked, Limits, RATE_HZ};
use crate::numerics::difference::velocity;
use crate::report::chart::{Anchor, Axis, Drawn, Frame, LABEL_PX, Mark, Stroke, palette, svg, thin};

/// Stretches of time of which the lowest and highest point are drawn.
const BUCKETS: usize = 900;
/// Height of a panel and of the room above it, px.
const TALL_PX: f64 = 170.0;
const ROOM_PX: f64 = 24.0;
/// Samples drawn: of hours of motion every so many.
const SAMPLES: usize = 400_000;

/// One quantity along all motions.
struct Series {
    label: &'static str,
    points: Vec<(f64, f64)>,
    /// The same of other joints, a line each.
    others: Vec<Vec<(f64, f64)>>,
    limits: Vec<f64>,
}

/// Position, speed and, where a model tells it, torque against time.
pub fn draw(asked: &[Asked], limits: &Limits) -> Drawn<String> {
    let series = series(asked, limits);
    let whole_s: f64 = asked.iter().map(|one| one.duration_s).sum();
    let (factor, unit) = if whole_s > 600.0 { (1.0 / 60.0, "min") } else { (1.0, "s") };
    let height = 60.0 + series.len() as f64 * (TALL_PX + ROOM_PX) + 40.0;
    svg(900, height as u32, "motions to record", |canvas| {
        let mut entries = vec![(Mark::Line(1.4, None), palette::BLUE, "asked of the joint".to_string())];
        if series.iter().any(|one| !one.limits.is_empty()) {
            entries.push((Mark::Line(1.6, DASH), palette::VERMILION, "limit".to_string()));
        }
        if series.iter().any(|one| !one.others.is_empty()) {
            entries.push((Mark::Line(1.4, None), palette::GREY, "other joints".to_string()));
        }
        canvas.legend((92.0, 880.0), 22.0, &entries)?;
        for (at, one) in series.iter().enumerate() {
            let top = 44.0 + at as f64 * (TALL_PX + ROOM_PX);
            let frame = Frame { left: 92.0, top, right: 880.0, bottom: top + TALL_PX };
            let y = Axis::around(
                one.label,
                one.points.iter().chain(one.others.iter().flatten()).map(|p| p.1).chain(one.limits.iter().copied()),
                0.06,
            );
            let x = Axis::linear(String::new(), 0.0, factor * whole_s);
            let is_last = at + 1 == series.len();
            let panel = canvas.panel(frame, if is_last { x } else { x.without_texts() }, y)?;
            for limit in &one.limits {
                let line = [(0.0, *limit), (factor * whole_s, *limit)];
                panel.line(line, Stroke { color: palette::VERMILION, width_px: 1.6, dash_px: DASH })?;
            }
            let drawn = |points: &[(f64, f64)], color| {
                let points: Vec<(f64, f64)> = points.iter().map(|(t, y)| (factor * t, *y)).collect();
                panel.line(thin::envelope(&points, BUCKETS), Stroke::solid(color, 1.4))
            };
            one.others.iter().try_for_each(|other| drawn(other, palette::GREY))?;
            drawn(&one.points, palette::BLUE)?;
        }
        let label = format!("time, one run of each motion after the other ({unit})");
        canvas.text((486.0, height - 26.0), &label, LABEL_PX, palette::INK, Anchor::Below)
    })
}

const DASH: Option<(f64, f64)> = Some((7.0, 4.0));

fn series(asked: &[Asked], limits: &Limits) -> Vec<Series> {
    let samples: f64 = asked.iter().map(|one| one.duration_s * RATE_HZ).sum();
    let every = ((samples / SAMPLES as f64).ceil() as usize).max(1);
    let (mut position, mut speed, mut torque) = (Vec::new(), Vec::new(), Vec::new());
    let mut others = Vec::new();
    let mut from_s = 0.0;
    for one in asked {
        let positions_rad = one.trajectory.positions_rad(RATE_HZ);
        let along = |values: &[f64]| -> Vec<(f64, f64)> {
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
        Series { label: "position (rad)", points: position, others, limits: ends },
        Series { label: "speed (rad/s)", points: speed, others: Vec::new(), limits: both(limits.speed_rad_s) },
    ];
    if !torque.is_empty() {
        all.push(Series { label: "torque (N m)", points: torque, others: Vec::new(), limits: both(limits.torque_nm) });
    }
    all
}
