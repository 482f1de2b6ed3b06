//! The figures of a fleet: what changed in every joint over time.
//!
//! Drawn are changes since the campaign that the joint is held against: a drift of a tenth of the friction, in a panel that held both
//! directions' friction, would be a line's width.

use crate::batch::{Fleet, Joint, Row, day};
use crate::compare::parameters_of;
use crate::model::{Direction, Status, Term};
use crate::report::chart::{Anchor, Axis, Canvas, Drawn, Frame, LABEL_PX, Mark, Panel, Stroke, palette, span, svg};
use crate::report::number::significant;
use crate::report::page::Drawing;
use crate::report::wording::{Units, moving};

/// Joints drawn: those that drifted, then those that changed most.
const DRAWN: usize = 12;
/// Parameters drawn below A and B(v): those that drifted, then those that are known by themselves.
const MORE: usize = 3;
/// Those that may be known by themselves and say something that A and B(v) do not.
const OF_THEIR_OWN: [&str; 3] = ["combination.p", "combination.n", "joint.backlash_m"];
/// Height of a panel with its room, of its heading and of its axis, px.
const STEP_PX: f64 = 205.0;
const HEADING_PX: f64 = 30.0;
const AXIS_PX: f64 = 34.0;

/// A value over time with the ends of its interval, as changes in the panel's unit.
type Series = Vec<(f64, f64, f64, f64)>;

/// A figure for each joint that has two campaigns, the most telling first.
pub fn drawings(fleet: &Fleet) -> Drawn<Vec<Drawing>> {
    let mut joints: Vec<&Joint> = fleet.joints.iter().filter(|joint| joint.rows.len() > 1).collect();
    let key = |joint: &Joint| (!joint.drifts.is_empty(), joint.change_nm.unwrap_or(0.0));
    joints.sort_by(|a, b| {
        let ((x, p), (y, q)) = (key(a), key(b));
        y.cmp(&x).then(q.total_cmp(&p))
    });
    joints.iter().take(DRAWN).enumerate().map(|(at, joint)| History::new(fleet, joint).drawing(at)).collect()
}

/// What a panel shows: one quantity, moving up and moving down, or the same in both.
struct Quantity {
    title: String,
    /// In the table, by direction.
    names: Vec<(Option<Direction>, String)>,
    /// Unit of the values, unit of their changes, and how many of the latter are one of the former.
    unit: &'static str,
    shown: &'static str,
    factor: f64,
}

/// A joint over time.
struct History<'a> {
    fleet: &'a Fleet,
    joint: &'a Joint,
    /// When each campaign was, and what that is measured in: days since the first, or its number.
    times: Vec<f64>,
    label: String,
    /// When the cables were last retensioned.
    retensioned: Option<f64>,
}

impl<'a> History<'a> {
    fn new(fleet: &'a Fleet, joint: &'a Joint) -> Self {
        let date = |at: usize| fleet.rows[at].entry.date.as_deref();
        let days: Option<Vec<f64>> = joint.rows.iter().map(|at| day(date(*at)?)).collect();
        let (times, label, retensioned) = match days.zip(date(joint.rows[0]).and_then(|date| date.get(..10))) {
            Some((days, date)) => {
                let retensioned = joint.retensioned.as_deref().and_then(day).map(|then| then - days[0]);
                (days.iter().map(|d| d - days[0]).collect(), format!("days since {date}"), retensioned)
            }
            None => ((1..=joint.rows.len()).map(|i| i as f64).collect(), "campaign".to_string(), None),
        };
        Self { fleet, joint, times, label, retensioned }
    }

    fn row(&self, at: usize) -> &'a Row {
        &self.fleet.rows[at]
    }

    fn drawing(&self, at: usize) -> Drawn<Drawing> {
        let quantities = self.quantities();
        let height = 60.0 + STEP_PX * quantities.len() as f64;
        let picture = svg(860, height as u32, &format!("{} over time", self.joint.name), |canvas| {
            for (i, quantity) in quantities.iter().enumerate() {
                let top = 40.0 + STEP_PX * i as f64;
                let (top, bottom) = (top + HEADING_PX, top + STEP_PX - AXIS_PX);
                let frame = Frame { left: 92.0, top, right: 840.0, bottom };
                let x = Axis::around(self.label.as_str(), self.times.iter().copied().chain(self.retensioned), 0.04);
                let x = if i + 1 == quantities.len() { x } else { x.without_texts() };
                canvas.text((12.0, top - 14.0), &self.heading(quantity), LABEL_PX, palette::INK, Anchor::Left)?;
                self.panel(canvas, frame, x, quantity)?;
            }
            let mut legend: Vec<_> =
                Direction::BOTH.map(|d| (Mark::of(d), palette::direction(d), moving(d).to_string())).to_vec();
            if self.retensioned.is_some() {
                legend.push((Mark::Line(1.4, Some((5.0, 4.0))), palette::GREY, "cables retensioned".to_string()));
            }
            canvas.legend((92.0, 840.0), 22.0, &legend)
        })?;
        let caption = "Changes since the first campaign after the cables were last retensioned, or the first of all; bars are each \
                       campaign's own 95 % intervals. A: how the torque at the winch grows with gravity's. B(v): friction without \
                       load at the middle of the sweeps' speeds. Both directions shifting alike is a sensor's zero; apart, friction. \
                       Parameters that drifted stand below, then those that are known by themselves.";
        let name = format!("joint_{:02}", at + 1);
        Ok(Drawing { name, title: self.joint.name.clone(), caption: caption.to_string(), svg: picture })
    }

    /// A and B(v), what drifted, what is known by itself.
    fn quantities(&self) -> Vec<Quantity> {
        let since = self.row(self.joint.since);
        let units = Units::of(since.model.as_ref().map(|model| model.joint.kind).unwrap_or_default());
        let (unit, shown) = (units.torque, units.milli_torque);
        let of_figure = |name: &str, title: String| {
            let names = Direction::BOTH.map(|d| (Some(d), format!("{name}_{}_nm", d.name()))).to_vec();
            Quantity { title, names, unit, shown, factor: 1e3 }
        };
        let speed = since.figure("level_speed_rad_s").map(|v| format!(" at {} {}", significant(v, 3), units.speed));
        let level = of_figure("level", format!("B(v){}", speed.unwrap_or_default()));
        let mut all = vec![of_figure("a", "A".to_string()), level];
        let known = self.row(self.joint.last()).model.as_ref();
        let is_pinned = |name: &&&str| {
            known.and_then(|model| model.confidence.get(**name)).is_some_and(|c| c.status == Status::Pinned)
        };
        let drifted = self.joint.drifts.iter().map(|drift| drift.name.as_str()).filter(|name| name.contains('.'));
        for name in drifted.chain(OF_THEIR_OWN.iter().filter(is_pinned).copied()) {
            if all.len() < 2 + MORE && !all.iter().any(|q| q.names.iter().any(|(_, known)| known == name)) {
                all.extend(self.parameter(name));
            }
        }
        all
    }

    /// The parameter called `name`; both directions of one share a panel.
    fn parameter(&self, name: &str) -> Option<Quantity> {
        let model = self.row(self.joint.since).model.as_ref()?;
        let (_, unit, _) = parameters_of(model).into_iter().find(|row| row.0 == name)?;
        let of_direction = name.strip_prefix("friction.").and_then(|rest| rest.split_once('.'));
        let (title, names) = match of_direction.filter(|(_, name)| Term::find(name).is_some()) {
            Some((_, name)) => {
                (name, Direction::BOTH.map(|d| (Some(d), format!("friction.{}.{name}", d.name()))).to_vec())
            }
            None => (name, vec![(None, name.to_string())]),
        };
        let (shown, factor) = if unit == "m" { ("mm", 1e3) } else { (unit, 1.0) };
        Some(Quantity { title: title.to_string(), names, unit, shown, factor })
    }

    /// "B(v) at 0.11 rad/s: moving up 0.781 to 0.635 N m, drifted; moving down ...": what the panel's zero is, and where it ended.
    fn heading(&self, quantity: &Quantity) -> String {
        let (since, last) = (self.row(self.joint.since), self.row(self.joint.last()));
        let told = quantity.names.iter().filter_map(|(direction, name)| {
            let (before, after) = (bar(since, name)?.0, bar(last, name)?.0);
            let drifted = self.joint.drifts.iter().any(|drift| drift.name == *name);
            let (before, after) = (significant(before, 4), significant(after, 4));
            let words = [
                direction.map(moving).unwrap_or_default(),
                &format!("{before} to {after}"),
                quantity.unit,
                if drifted { "(drifted)" } else { "" },
            ];
            Some(words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" "))
        });
        format!("{}: {}", quantity.title, told.collect::<Vec<_>>().join("; "))
    }

    fn series(&self, quantity: &Quantity, name: &str) -> Series {
        let Some((zero, ..)) = bar(self.row(self.joint.since), name) else { return Vec::new() };
        let change = |x: f64| (x - zero) * quantity.factor;
        let one = |(at, time): (&usize, &f64)| {
            bar(self.row(*at), name).map(|(y, low, high)| (*time, change(y), change(low), change(high)))
        };
        self.joint.rows.iter().zip(&self.times).filter_map(one).collect()
    }

    fn panel(&self, canvas: &Canvas, frame: Frame, x: Axis, quantity: &Quantity) -> Drawn {
        let look = |direction: &Option<Direction>| match direction {
            Some(direction) => (Mark::of(*direction), palette::direction(*direction)),
            None => (Mark::Disc(4.5), palette::INK),
        };
        let all: Vec<_> =
            quantity.names.iter().map(|(direction, name)| (look(direction), self.series(quantity, name))).collect();
        let points = || all.iter().flat_map(|(_, series)| series);
        // Intervals that are open say nothing of where the values are.
        let (low, high) = span(points().map(|point| point.1));
        let room = 2.0 * (high - low);
        let ends = points().flat_map(|(_, y, low, high)| [*y, *low, *high]);
        let label =
            if quantity.shown.is_empty() { "change".to_string() } else { format!("change ({})", quantity.shown) };
        let y = Axis::around(label, ends.filter(|y| (low - room..=high + room).contains(y)), 0.1);
        let (bottom, top) = (y.value(y.places.0), y.value(y.places.1));
        let (left, right) = (x.value(x.places.0), x.value(x.places.1));
        let panel: Panel = canvas.panel(frame, x, y.sparse())?;
        panel.line([(left, 0.0), (right, 0.0)], Stroke::solid(palette::GREY, 1.0))?;
        if let Some(time) = self.retensioned {
            panel.line([(time, bottom), (time, top)], Stroke::dashed(palette::GREY, 1.4, 5.0, 4.0))?;
        }
        for ((mark, color), series) in &all {
            let color = *color;
            // What happened as the cables were retensioned is no change over time.
            let (before, after): (Vec<_>, Vec<_>) =
                series.iter().map(|p| (p.0, p.1)).partition(|p| self.retensioned.is_some_and(|time| p.0 < time));
            for part in [before, after] {
                panel.line(part, Stroke::solid(palette::lighter(color), 1.2))?;
            }
            for (time, value, low, high) in series {
                panel.line([(*time, low.max(bottom)), (*time, high.min(top))], Stroke::solid(color, 1.4))?;
                panel.mark((*time, *value), *mark, color)?;
            }
        }
        Ok(())
    }
}

/// The figure or parameter of `row` called `name`, with the ends of its interval.
fn bar(row: &Row, name: &str) -> Option<(f64, f64, f64)> {
    if let Some(figure) = name.strip_suffix("_nm").filter(|name| !name.contains('.')) {
        let (value, half) = (row.figure(name)?, row.figure(&format!("{figure}_half_width_nm")).unwrap_or(0.0));
        return Some((value, value - half, value + half));
    }
    let value = row.value(name)?;
    let known = row.model.as_ref()?.confidence.get(name);
    Some((value, known.map_or(value, |c| c.low), known.map_or(value, |c| c.high)))
}
