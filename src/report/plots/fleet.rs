//! The figures of a fleet: what changed in every joint over time.
//!
//! Changes are drawn relative to the campaign that the joint is compared with: in a panel that showed the friction of both directions in
//! full, a drift by a tenth of it would be as thin as a line.

use crate::batch::{Fleet, Joint, Life, Part, day};
use crate::model::{Direction, Term};
use crate::numerics::statistics::quantile;
use crate::report::chart::{Axis, Figure, Mark, Panel, Point, Stroke, palette, span};
use crate::report::number::significant;
use crate::report::wording::{Units, moving};

/// Joints drawn: those that drifted, then those that changed most.
const DRAWN: usize = 12;
/// Panels of a joint, at most.
const PANELS: usize = 5;
/// Parameters that A and B(v) do not depend on.
const OF_THEIR_OWN: [&str; 3] = ["combination.p", "combination.n", "joint.backlash_m"];
/// Height of a panel, px.
const TALL_PX: f64 = 141.0;

/// A figure for each joint that has two campaigns, the most telling first.
pub fn figures(fleet: &Fleet) -> Vec<(&Joint, Figure)> {
    let mut joints: Vec<&Joint> = fleet.joints.iter().filter(|joint| joint.rows.len() > 1).collect();
    let key = |joint: &Joint| (joint.drifted(), joint.change_nm.unwrap_or(0.0));
    joints.sort_by(|a, b| {
        let ((x, p), (y, q)) = (key(a), key(b));
        y.cmp(&x).then(q.total_cmp(&p))
    });
    let drawn = joints.into_iter().take(DRAWN).enumerate();
    drawn.map(|(at, joint)| (joint, History::new(fleet, joint).figure(at))).collect()
}

/// What a panel shows: one quantity, moving up and moving down, or the same in both.
struct Shown<'a> {
    title: String,
    lives: Vec<(Option<Direction>, &'a Life)>,
    /// Unit of their changes, and how many of those are one of the values'.
    unit: &'static str,
    factor: f64,
}

/// A joint over time.
struct History<'a> {
    joint: &'a Joint,
    units: Units,
    /// When each campaign was: days since the first, or its number.
    times: Vec<f64>,
    /// The axis of these times.
    axis: Axis,
    /// When the cables were retensioned.
    retensioned: Vec<f64>,
}

impl<'a> History<'a> {
    fn new(fleet: &'a Fleet, joint: &'a Joint) -> Self {
        let date = |at: usize| fleet.rows[at].entry.date.as_deref();
        let days: Option<Vec<f64>> = joint.rows.iter().map(|at| day(date(*at)?)).collect();
        let (times, axis, retensioned) = match days.zip(date(joint.rows[0]).and_then(|date| date.get(..10))) {
            Some((days, date)) => {
                let then = joint.events.iter().filter_map(|event| day(event.retensioned.as_deref()?));
                let retensioned: Vec<f64> = then.map(|then| then - days[0]).collect();
                let times: Vec<f64> = days.iter().map(|d| d - days[0]).collect();
                let all = times.iter().chain(&retensioned).copied();
                let axis = Axis::around(format!("days since {date}"), all, 0.04);
                (times, axis, retensioned)
            }
            None => {
                let times = (1..=joint.rows.len()).map(|i| i as f64).collect();
                (times, Axis::numbered("campaign", joint.rows.len()), Vec::new())
            }
        };
        let kind = fleet.rows[joint.since].model.as_ref().map(|model| model.joint.kind).unwrap_or_default();
        Self { joint, units: Units::of_kind(kind), times, axis, retensioned }
    }

    fn figure(&self, at: usize) -> Figure {
        let panels = self.panels();
        let caption = "Change relative to the first campaign after the last retensioning, or to the first of all. Bars: 95 % interval of each \
                       campaign; lines: the fitted levels, jumps and drift. A: load amplitude; B(v): friction without load. Both directions \
                       shifting by the same amount is an offset of the torque sensor or a constant load; apart from each other, friction. \
                       Other parameters that changed are shown below.";
        let mut figure = Figure::new(format!("joint_{:02}", at + 1), self.joint.name.clone(), caption);
        for (i, shown) in panels.iter().enumerate() {
            let x = if i + 1 == panels.len() { self.axis.clone() } else { self.axis.clone().without_texts() };
            figure = figure.row(TALL_PX, vec![self.panel(x, shown)]);
        }
        figure
    }

    /// A, B(v) at the middle speed, quantities that changed, and those of `OF_THEIR_OWN`: A first, then B(v), then the others, each in the
    /// history's order.
    fn panels(&self) -> Vec<Shown<'a>> {
        let mut all: Vec<Shown> = Vec::new();
        for life in &self.joint.lives {
            let (title, direction) = title(&life.name);
            match all.iter_mut().find(|shown| shown.title == title) {
                Some(shown) => shown.lives.push((direction, life)),
                None => all.push(self.shown(title, direction, life)),
            }
        }
        let levels: Vec<String> =
            all.iter().map(|of| of.title.clone()).filter(|title| title.starts_with("B(")).collect();
        let middle = levels.get(levels.len() / 2);
        let rank = |shown: &Shown| match shown.title.as_str() {
            "A" => 0,
            title if middle.is_some_and(|middle| middle == title) => 1,
            _ if shown.lives.iter().any(|(_, life)| !life.parts.is_empty()) => 2,
            title if OF_THEIR_OWN.contains(&title) => 3,
            _ => 4,
        };
        let mut ranked: Vec<(usize, Shown)> =
            all.into_iter().enumerate().filter(|(_, shown)| rank(shown) < 4).collect();
        ranked.sort_by_key(|(_, shown)| rank(shown));
        ranked.truncate(PANELS);
        let kind = |shown: &Shown| if shown.title == "A" { 0 } else { 2 - usize::from(shown.title.starts_with("B(")) };
        ranked.sort_by_key(|(at, shown)| (kind(shown), *at));
        ranked.into_iter().map(|(_, shown)| shown).collect()
    }

    fn shown(&self, title: String, direction: Option<Direction>, life: &'a Life) -> Shown<'a> {
        let (unit, factor) = match life.unit {
            unit if unit == self.units.torque => (self.units.milli_torque, 1e3),
            "m" => ("mm", 1e3),
            unit => (unit, 1.0),
        };
        Shown { title, lives: vec![(direction, life)], unit, factor }
    }

    /// Where `life` of the joint begins to be held against: its session since retensioning, or the first since that shows it.
    fn since(&self, life: &Life) -> usize {
        let since = self.joint.rows.iter().position(|at| *at == self.joint.since).unwrap_or(0);
        life.sessions.iter().position(|session| *session >= since).unwrap_or(0)
    }

    /// "B(0.110 rad/s): moving up 0.781 to 0.635 N m (changed); moving down ...": what the panel's zero is, and where it ended.
    fn heading(&self, shown: &Shown) -> String {
        let told = shown.lives.iter().filter_map(|(direction, life)| {
            let values: Vec<f64> = life.claimed().map(|claimed| claimed.0).collect();
            let (before, after) = (significant(values[self.since(life)], 4), significant(*values.last()?, 4));
            let changed = self.joint.drifts.iter().any(|drift| drift.name == life.name);
            let words = [
                direction.map(moving).unwrap_or_default(),
                &format!("{before} to {after}"),
                life.unit,
                if changed { "(changed)" } else { "" },
            ];
            Some(words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(" "))
        });
        format!("{}: {}", shown.title, told.collect::<Vec<_>>().join("; "))
    }

    fn panel(&self, x: Axis, shown: &Shown) -> Panel {
        let points = |life: &Life| {
            let claimed: Vec<(f64, f64)> = life.claimed().collect();
            let zero = claimed[self.since(life)].0;
            let change = move |value: f64| (value - zero) * shown.factor;
            let one = move |((session, (value, half)), fitted): ((&usize, (f64, f64)), f64)| {
                let [y, low, high, fitted] = [value, value - half, value + half, fitted].map(change);
                (*session, y, low, high, fitted)
            };
            life.sessions.iter().zip(claimed).zip(life.fitted()).map(one).collect::<Vec<_>>()
        };
        let all: Vec<_> = shown.lives.iter().map(|(direction, life)| (*direction, *life, points(life))).collect();
        let every = || all.iter().flat_map(|(.., points)| points);
        // An interval that is open, or much wider than the others, says nothing of where the values are.
        let (low, high) = span(every().map(|point| point.1));
        let mut halves: Vec<f64> = every().map(|(_, y, low, ..)| y - low).filter(|half| half.is_finite()).collect();
        let usual = if halves.is_empty() { 0.0 } else { quantile(&mut halves, 0.5) };
        let room = (2.0 * (high - low)).max(2.0 * usual);
        let ends = every().flat_map(|(_, y, low, high, _)| [*y, *low, *high]);
        let label = if shown.unit.is_empty() { "change".to_string() } else { format!("change ({})", shown.unit) };
        let y = Axis::around(label, ends.filter(|y| (low - room..=high + room).contains(y)), 0.1);
        let (bottom, top) = (y.value(y.places.0), y.value(y.places.1));
        let (left, right) = (x.value(x.places.0), x.value(x.places.1));
        let mut panel =
            Panel::new(x, y.sparse()).titled(self.heading(shown)).linked(format!("days {}", self.joint.name));
        panel.line("", [(left, 0.0), (right, 0.0)], Stroke::solid(palette::GREY, 1.0));
        for time in &self.retensioned {
            let line = [(*time, bottom), (*time, top)];
            panel.line("cables retensioned", line, Stroke::dashed(palette::GREY, 1.4, 5.0, 4.0));
        }
        for (direction, life, points) in &all {
            let (mark, color, name) = match direction {
                Some(direction) => (Mark::of(*direction), palette::direction(*direction), moving(*direction)),
                None => (Mark::Disc(4.5), palette::INK, "both directions"),
            };
            let breaks = breaks(life);
            // What happened at once is no line from one session to the next.
            for part in points.chunk_by(|a, b| !breaks.iter().any(|at| a.0 < *at && *at <= b.0)) {
                let line = part.iter().map(|point| (self.times[point.0], point.4));
                panel.line("", line, Stroke::solid(palette::lighter(color), 1.4));
            }
            let gap = (f64::NAN, f64::NAN);
            let time = |point: &(usize, f64, f64, f64, f64)| self.times[point.0];
            let bar = |p: &(usize, f64, f64, f64, f64)| [(time(p), p.2.max(bottom)), (time(p), p.3.min(top)), gap];
            panel.line("", points.iter().flat_map(bar), Stroke::solid(color, 1.4));
            let marks: Vec<Point> = points.iter().map(|p| (time(p), p.1)).collect();
            panel.marks(name, marks, mark, color);
        }
        panel
    }
}

/// The sessions at which the level of `life` changed at once.
fn breaks(life: &Life) -> Vec<usize> {
    let ends = |part: Part| match part {
        Part::Jump { at, until, .. } => [Some(at), until],
        _ => [None, None],
    };
    life.parts.iter().flat_map(|happened| ends(happened.part)).flatten().collect()
}

/// What a panel with the quantity called `name` is called, both directions in one, and the direction.
fn title(name: &str) -> (String, Option<Direction>) {
    for direction in Direction::BOTH {
        if let Some(title) = name.strip_suffix(&format!(" moving {}", direction.name())) {
            return (title.to_string(), Some(direction));
        }
        let of = name.strip_prefix(&format!("friction.{}.", direction.name()));
        if let Some(title) = of.filter(|title| Term::find(title).is_some()) {
            return (title.to_string(), Some(direction));
        }
    }
    (name.to_string(), None)
}
