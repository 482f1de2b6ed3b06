//! The figures of a fleet: every joint's load and friction over time.

use crate::batch::{Fleet, Joint, Row, day};
use crate::model::Direction;
use crate::report::chart::{Axis, Canvas, Drawn, Frame, Mark, Panel, Stroke, palette, span, svg};
use crate::report::page::Drawing;
use crate::report::wording::moving;

/// Joints drawn: those that drifted, then those that changed most.
const DRAWN: usize = 12;
/// Parameters that drifted and are drawn below A and B(v).
const MORE: usize = 3;
/// Height of a panel with its room, px.
const STEP_PX: f64 = 190.0;

/// A value over time with the ends of its interval.
type Series = Vec<(f64, f64, f64, f64)>;

/// A figure for each joint that has two campaigns, the most telling first.
pub fn drawings(fleet: &Fleet) -> Drawn<Vec<Drawing>> {
    let mut joints: Vec<&Joint> = fleet.joints.iter().filter(|joint| joint.rows.len() > 1).collect();
    let key = |joint: &Joint| (!joint.drifts.is_empty(), joint.change_nm.unwrap_or(0.0));
    joints.sort_by(|a, b| {
        let ((x, p), (y, q)) = (key(a), key(b));
        y.cmp(&x).then(q.total_cmp(&p))
    });
    joints.iter().take(DRAWN).enumerate().map(|(at, joint)| drawing(fleet, joint, at)).collect()
}

fn drawing(fleet: &Fleet, joint: &Joint, at: usize) -> Drawn<Drawing> {
    let drifted = joint.drifts.iter().map(|drift| drift.name.as_str()).filter(|name| name.contains('.'));
    let mut whats: Vec<String> = Vec::new();
    for name in drifted {
        // Both directions of a parameter share a panel.
        let name = name.strip_prefix("friction.").and_then(|n| n.split_once('.')).map_or(name, |(_, name)| name);
        if !whats.iter().any(|known| known == name) && whats.len() < MORE {
            whats.push(name.to_string());
        }
    }
    let panels = 2 + whats.len();
    let (times, label) = times(fleet, joint);
    let picture = svg(860, (70.0 + STEP_PX * panels as f64) as u32, &format!("{} over time", joint.name), |canvas| {
        let row_of = |i: usize| Frame {
            left: 92.0,
            top: 44.0 + STEP_PX * i as f64,
            right: 840.0,
            bottom: 44.0 + STEP_PX * (i + 1) as f64 - 34.0,
        };
        let figure =
            |name: &'static str| move |d: Direction, row: &Row| bar_of_figure(row, &format!("{name}_{}", d.name()));
        let last = |i: usize| i + 1 == panels;
        let axis = |i: usize| time_axis(&times, &label, last(i));
        panel(
            canvas,
            row_of(0),
            axis(0),
            "A (N m)",
            &series(fleet, joint, &times, figure("a")),
            retension(joint, fleet),
        )?;
        let b = series(fleet, joint, &times, figure("level"));
        panel(canvas, row_of(1), axis(1), "B(v) (N m)", &b, retension(joint, fleet))?;
        for (i, what) in whats.iter().enumerate() {
            let of = |d: Direction, row: &Row| bar_of_parameter(row, what, d);
            let found = series(fleet, joint, &times, of);
            panel(canvas, row_of(i + 2), axis(i + 2), what, &found, retension(joint, fleet))?;
        }
        let mut legend: Vec<_> =
            Direction::BOTH.map(|d| (Mark::of(d), palette::direction(d), moving(d).to_string())).to_vec();
        if retension(joint, fleet).is_some() {
            legend.push((Mark::Line(1.4, Some((5.0, 4.0))), palette::GREY, "retensioned".to_string()));
        }
        canvas.legend((92.0, 840.0), 22.0, &legend)
    })?;
    Ok(Drawing {
        name: format!("joint_{:02}", at + 1),
        title: joint.name.clone(),
        caption: "A: how the torque at the winch grows with gravity's. B(v): friction without load at the middle of the sweeps' \
                  speeds. Bars are each campaign's own 95 % intervals. Both directions shifting alike is a sensor's zero; apart, \
                  friction. Parameters that drifted stand below."
            .to_string(),
        svg: picture,
    })
}

/// When each campaign of `joint` was, and what that is measured in: days since the first, or its number.
fn times(fleet: &Fleet, joint: &Joint) -> (Vec<f64>, String) {
    let days: Option<Vec<f64>> = joint.rows.iter().map(|at| day(fleet.rows[*at].entry.date.as_deref()?)).collect();
    let date = fleet.rows[joint.rows[0]].entry.date.as_deref().and_then(|date| date.get(..10));
    match days.zip(date) {
        Some((days, date)) => (days.iter().map(|d| d - days[0]).collect(), format!("days since {date}")),
        None => ((1..=joint.rows.len()).map(|i| i as f64).collect(), "campaign".to_string()),
    }
}

/// Days from the first campaign to the last retensioning.
fn retension(joint: &Joint, fleet: &Fleet) -> Option<f64> {
    let first = day(fleet.rows[joint.rows[0]].entry.date.as_deref()?)?;
    Some(day(joint.retensioned.as_deref()?)? - first)
}

fn time_axis(times: &[f64], label: &str, labelled: bool) -> Axis {
    let axis = Axis::around(label, times.iter().copied(), 0.04);
    if labelled { axis } else { axis.without_texts() }
}

fn series(
    fleet: &Fleet,
    joint: &Joint,
    times: &[f64],
    of: impl Fn(Direction, &Row) -> Option<(f64, f64, f64)>,
) -> [Series; 2] {
    Direction::BOTH.map(|direction| {
        let one =
            |(at, time): (&usize, &f64)| of(direction, &fleet.rows[*at]).map(|(y, low, high)| (*time, y, low, high));
        joint.rows.iter().zip(times).filter_map(one).collect()
    })
}

fn bar_of_figure(row: &Row, name: &str) -> Option<(f64, f64, f64)> {
    let value = row.figure(&format!("{name}_nm"))?;
    let half = row.figure(&format!("{name}_half_width_nm")).unwrap_or(0.0);
    Some((value, value - half, value + half))
}

/// The parameter called `what` of `direction`; one that has none is drawn as up.
fn bar_of_parameter(row: &Row, what: &str, direction: Direction) -> Option<(f64, f64, f64)> {
    let of_direction = format!("friction.{}.{what}", direction.name());
    let name = if what.contains('.') { what.to_string() } else { of_direction };
    if what.contains('.') && direction == Direction::Down {
        return None;
    }
    let value = row.value(&name)?;
    let known = row.model.as_ref()?.confidence.get(&name);
    Some((value, known.map_or(value, |c| c.low), known.map_or(value, |c| c.high)))
}

fn panel(canvas: &Canvas, frame: Frame, x: Axis, label: &str, series: &[Series; 2], retensioned: Option<f64>) -> Drawn {
    // Intervals that are open say nothing of where the values are.
    let all = series.iter().flatten().flat_map(|(_, y, low, high)| [*y, *low, *high]);
    let (low, high) = span(series.iter().flatten().map(|point| point.1));
    let room = 2.0 * (high - low).max(1e-3 * high.abs());
    let y = Axis::around(label, all.filter(|y| (low - room..=high + room).contains(y)), 0.1);
    let (bottom, top) = (y.value(y.places.0), y.value(y.places.1));
    let panel: Panel = canvas.panel(frame, x, y.sparse())?;
    if let Some(time) = retensioned {
        panel.line([(time, bottom), (time, top)], Stroke::dashed(palette::GREY, 1.4, 5.0, 4.0))?;
    }
    for (direction, points) in Direction::BOTH.into_iter().zip(series) {
        let color = palette::direction(direction);
        panel.line(points.iter().map(|p| (p.0, p.1)), Stroke::solid(palette::lighter(color), 1.2))?;
        for (time, value, low, high) in points {
            panel.line([(*time, low.max(bottom)), (*time, high.min(top))], Stroke::solid(color, 1.4))?;
            panel.mark((*time, *value), Mark::of(direction), color)?;
        }
    }
    Ok(())
}
