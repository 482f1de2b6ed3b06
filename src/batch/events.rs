//! Retensionings and other times at which something changed its level: what changed, and whether it is as it was before.

use super::life::{Happened, Life, Part};
use super::table::Row;
use crate::compare::{Attribution, attribution_among};
use crate::numerics::statistics::together;

/// A retensioning, or another time at which something changed its level.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// When the cables were retensioned; `None` of another event.
    pub retensioned: Option<String>,
    /// Places in `Fleet::rows` of the last campaign before and the first since.
    pub rows: [usize; 2],
    /// Place of the first campaign in which it was over again.
    pub until: Option<usize>,
    /// What changed, judged by the whole history.
    pub changes: Vec<(String, &'static str, Happened)>,
    /// What changed from the one campaign to the other, told by its cause.
    pub changed: Attribution,
    /// Place of the campaign after the retensioning before, or of the first of all.
    pub reference: usize,
    /// What is not as in that campaign: nothing where a retensioning did what it should.
    pub differs: Vec<Drift>,
}

/// A value that changed beyond its confidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Drift {
    /// The parameter's dotted name, or the function's.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// In the earlier campaign, as the whole history has it.
    pub before: f64,
    /// In the later.
    pub after: f64,
    /// The change's interval, 95 % over all that is compared in the fleet.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

/// When a level changed, in a joint's sessions: the first after, the first in which it was over again, when the cables were retensioned.
type Time = (usize, Option<usize>, Option<String>);

/// The retensionings at `dates`, and at what other times a level of `lives` changed; of `compared` quantities and `joints` in the
/// fleet.
pub(super) fn events(
    rows: &[Row],
    of: &[usize],
    dates: &[String],
    lives: &[Life],
    [compared, joints]: [usize; 2],
) -> Vec<Event> {
    let times = times(rows, of, dates, lives);
    let event = |(place, (at, until, retensioned)): (usize, &Time)| {
        let is_then = |happened: &&Happened| match happened.part {
            Part::Jump { at: then, until: end, .. } => (then, end) == (*at, *until),
            _ => false,
        };
        let pair = [of[at - 1], of[*at]];
        let [before, after] = pair.map(|at| rows[at].model.as_ref());
        let changes = lives.iter().flat_map(|life| {
            life.parts.iter().filter(is_then).map(|happened| (life.name.clone(), life.unit, *happened))
        });
        let reference = times[..place].iter().rev().find(|time| time.2.is_some()).map_or(0, |time| time.0);
        Some(Event {
            changes: changes.collect(),
            changed: attribution_among(before?, after?, joints).ok()?,
            retensioned: retensioned.clone(),
            rows: pair,
            until: until.map(|until| of[until]),
            reference: of[reference],
            differs: differences(lives, reference, *at, compared),
        })
    };
    times.iter().enumerate().filter_map(event).collect()
}

fn times(rows: &[Row], of: &[usize], dates: &[String], lives: &[Life]) -> Vec<Time> {
    let first_since = |date: &String| of.iter().position(|at| rows[*at].entry.date.as_ref() >= Some(date));
    let known = dates.iter().filter_map(|date| Some((first_since(date)?, None, Some(date.clone()))));
    let mut times: Vec<Time> = known.filter(|time| time.0 > 0).collect();
    for happened in lives.iter().flat_map(|life| &life.parts) {
        if let Part::Jump { at, until, retensioned: false } = happened.part
            && !times.iter().any(|time| (time.0, time.1) == (at, until))
        {
            times.push((at, until, None));
        }
    }
    times.sort_by_key(|time| time.0);
    times
}

/// What changed from session `from` to session `to`, with intervals that hold together over `compared` quantities.
pub(super) fn differences(lives: &[Life], from: usize, to: usize, compared: usize) -> Vec<Drift> {
    let wider = together(compared);
    let one = |life: &Life| {
        // Not every session shows every parameter.
        let shown = || life.sessions.iter().copied().filter(|session| (from..=to).contains(session));
        let found = life.between(shown().next()?, shown().next_back()?)?;
        let (change, reach) = (found.after - found.before, wider * found.half_width);
        let (low, high) = (change - reach, change + reach);
        let drift =
            Drift { name: life.name.clone(), unit: life.unit, before: found.before, after: found.after, low, high };
        (low > 0.0 || high < 0.0).then_some(drift)
    };
    lives.iter().filter_map(one).collect()
}
