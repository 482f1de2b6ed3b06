//! What happened to each parameter and function of a joint, for programs and as tables.

use super::comparison::cause_json;
use super::fleet::{Cells, told, when};
use super::number::{interval, significant};
use super::wording::Units;
use crate::batch::{Drift, Event, Fleet, Forecast, Foreseen, Happened, Joint, Life, Part, date_of, day};
use serde_json::{Value, json};

pub(super) const LIMITS: &str = "Each history extrapolated at its present slope, with the 95 % interval of the date at which it crosses the \
    limit; no date where the history does not determine one.";
pub(super) const EVENTS: &str = "Values that changed from one campaign to the next, tested on the whole history. Retensionings are declared; all \
    other jumps were detected. What changed compares the last campaign before with the first after; restored compares the values \
    after with those after the previous retensioning, or with the first campaign.";
pub(super) const DRIFTS: &str = "Constant rate of change from the named campaign on, without jumps and temperature. Scatter: the standard \
    deviation between sessions beyond the intervals of the campaigns.";
pub(super) const TEMPERATURE: &str =
    "Removed from everything above. Last column: what would have been found without the recorded temperature.";

/// Days of the span that drift is reported per.
const MONTH_DAYS: f64 = 30.0;
/// Values of one event that are written out.
const WRITTEN: usize = 4;

fn name(fleet: &Fleet, joint: &Joint, session: usize) -> String {
    fleet.rows[joint.rows[session]].entry.name.clone()
}

fn happened_json(fleet: &Fleet, joint: &Joint, of: &Happened) -> Value {
    let (low, high) = (of.size - of.half_width, of.size + of.half_width);
    let name = |session: usize| name(fleet, joint, session);
    match of.part {
        Part::Jump { at, until, retensioned } => json!({
            "kind": if retensioned { "retensioning" } else if until.is_some() { "episode" } else { "jump" },
            "before": name(at - 1), "after": name(at), "until": until.map(name),
            "change": of.size, "low": low, "high": high,
        }),
        Part::Drift { from } => {
            json!({ "kind": "drift", "since": name(from), "change_per_day": of.size, "low": low, "high": high })
        }
        Part::Temperature => json!({ "kind": "temperature", "change_per_k": of.size, "low": low, "high": high }),
    }
}

/// One parameter or function.
pub(super) fn to_json(fleet: &Fleet, joint: &Joint, life: &Life) -> Value {
    let parts = |parts: &Vec<Happened>| parts.iter().map(|of| happened_json(fleet, joint, of)).collect::<Vec<Value>>();
    json!({
        "name": life.name, "unit": life.unit, "campaigns": life.sessions.len(), "session_scatter": life.scatter,
        "happened": parts(&life.parts), "without_temperature": life.without_temperature.as_ref().map(parts),
    })
}

/// The retensionings of `joint`, or what else changed a level.
pub(super) fn events_json(fleet: &Fleet, joint: &Joint, retensionings: bool) -> Vec<Value> {
    let name = |at: usize| fleet.rows[at].entry.name.as_str();
    let change = |(name, unit, of): &(String, &'static str, Happened)| json!({ "name": name, "unit": unit, "change": of.size, "low": of.size - of.half_width, "high": of.size + of.half_width });
    let event = |event: &Event| {
        json!({
            "date": event.retensioned, "before": name(event.rows[0]), "after": name(event.rows[1]), "until": event.until.map(name),
            "as_after": name(event.reference),
            "differs": event.differs.iter().map(drift_json).collect::<Vec<Value>>(),
            "changes": event.changes.iter().map(change).collect::<Vec<Value>>(),
            "what_changed": event.changed.causes.iter().map(cause_json).collect::<Vec<Value>>(),
        })
    };
    joint.events.iter().filter(|event| event.retensioned.is_some() == retensionings).map(event).collect()
}

/// A value that changed.
pub(super) fn drift_json(d: &Drift) -> Value {
    json!({ "name": d.name, "unit": d.unit, "before": d.before, "after": d.after,
            "change": d.after - d.before, "low": d.low, "high": d.high })
}

/// When a limit of `joint` will be reached.
pub(super) fn foreseen_json(fleet: &Fleet, joint: &Joint, of: &Foreseen) -> Value {
    let bound = if of.limit.is_upper { "at_most" } else { "at_least" };
    let mut json =
        json!({ "what": of.limit.what, "name": of.name, "unit": of.unit, bound: of.limit.value, "reached": false });
    match of.forecast {
        Forecast::Reached => json["reached"] = json!(true),
        Forecast::In { days, low_days, high_days } => {
            for (key, days) in [("date", days), ("low", low_days), ("high", high_days)] {
                json[key] = json!(date_after(fleet, joint, days));
            }
        }
        Forecast::Unknown(why) => json["unknown"] = json!(why.words()),
    }
    json
}

/// The date `days` after the last campaign of `joint`.
fn date_after(fleet: &Fleet, joint: &Joint, days: f64) -> String {
    let last = fleet.rows[joint.last()].entry.date.as_deref().and_then(day);
    last.map_or_else(String::new, |last| date_of(last + days))
}

/// Limits, for readers.
pub(super) fn limits(fleet: &Fleet) -> Cells<4> {
    let row = |joint: &Joint, of: &Foreseen| {
        let bound = if of.limit.is_upper { "at most" } else { "at least" };
        let when = match of.forecast {
            Forecast::Reached => "reached".to_string(),
            Forecast::In { days, low_days, high_days } => {
                let [date, low, high] = [days, low_days, high_days].map(|days| date_after(fleet, joint, days));
                format!("{date}, between {low} and {high}")
            }
            Forecast::Unknown(why) => format!("not known: {}", why.words()),
        };
        [joint.name.clone(), of.name.clone(), format!("{bound} {} {}", significant(of.limit.value, 4), of.unit), when]
    };
    let rows = fleet.joints.iter().flat_map(|joint| joint.limits.iter().map(move |of| row(joint, of)));
    (["joint", "what", "limit", "reached"], rows.collect())
}

/// "B(0.1 rad/s) moving up +0.12 (0.10 to 0.14) N m".
fn change(name: &str, unit: &str, of: &Happened) -> String {
    let ends = interval(of.size, of.size - of.half_width, of.size + of.half_width);
    format!("{name} {}{} ({ends}) {unit}", if of.size > 0.0 { "+" } else { "" }, significant(of.size, 3))
        .trim_end()
        .to_string()
}

/// Retensionings and other changes at one time, for readers.
pub(super) fn events(fleet: &Fleet) -> Cells<5> {
    let row = |joint: &Joint, event: &Event| {
        let kind = fleet.rows[event.rows[1]].model.as_ref().map(|model| model.joint.kind).unwrap_or_default();
        let span = format!("{} to {}", when(fleet, event.rows[0]), when(fleet, event.rows[1]));
        let time = match (&event.retensioned, event.until) {
            (Some(date), _) => format!("retensioned {date}"),
            (None, Some(until)) => format!("{span}, over by {}", when(fleet, until)),
            (None, None) => span,
        };
        let mut changes: Vec<String> =
            event.changes.iter().take(WRITTEN).map(|(name, unit, of)| change(name, unit, of)).collect();
        if event.changes.len() > WRITTEN {
            changes.push(format!("{} more", event.changes.len() - WRITTEN));
        }
        let changes = if changes.is_empty() { "nothing beyond the scatter".to_string() } else { changes.join("; ") };
        let reference = when(fleet, event.reference);
        let restored = match &event.differs[..] {
            _ if event.retensioned.is_none() => "–".to_string(),
            [] => format!("as on {reference}"),
            all => {
                let share = |d: &Drift| format!("{} {:+.1} %", d.name, 100.0 * (d.after / d.before - 1.0));
                let more = if all.len() > WRITTEN { format!("; {} more", all.len() - WRITTEN) } else { String::new() };
                let told: Vec<String> = all.iter().take(WRITTEN).map(share).collect();
                format!("not as on {reference}: {}{more}", told.join("; "))
            }
        };
        [joint.name.clone(), time, told(&event.changed, &Units::of_kind(kind)), changes, restored]
    };
    let rows = fleet.joints.iter().flat_map(|joint| joint.events.iter().map(move |event| row(joint, event)));
    (["joint", "when", "what changed", "change over the whole history", "restored"], rows.collect())
}

/// Drifts, for readers.
pub(super) fn drifts(fleet: &Fleet) -> Cells<5> {
    let row = |joint: &Joint, life: &Life, of: &Happened| {
        let Part::Drift { from } = of.part else { return None };
        let dated = fleet.rows[joint.last()].entry.date.is_some();
        let (span, factor) = if dated { ("30 days", MONTH_DAYS) } else { ("campaign", 1.0) };
        let scaled = Happened { size: of.size * factor, half_width: of.half_width * factor, ..*of };
        Some([
            joint.name.clone(),
            life.name.clone(),
            when(fleet, joint.rows[from]),
            format!("{} per {span}", change("", life.unit, &scaled).trim_start()),
            if life.scatter.is_nan() { "not known".to_string() } else { significant(life.scatter, 2) },
        ])
    };
    let lives = fleet.joints.iter().flat_map(|joint| joint.lives.iter().map(move |life| (joint, life)));
    let parts = lives.flat_map(|(joint, life)| life.parts.iter().map(move |of| (joint, life, of)));
    let rows = parts.filter_map(|(joint, life, of)| row(joint, life, of));
    (["joint", "what", "from", "drift", "scatter"], rows.collect())
}

/// What follows the temperature, for readers.
pub(super) fn temperature(fleet: &Fleet) -> Cells<4> {
    let word = |of: &Happened| match of.part {
        Part::Drift { .. } => "drift",
        Part::Jump { until: Some(_), .. } => "an episode",
        Part::Jump { .. } => "a jump",
        Part::Temperature => "temperature",
    };
    let row = |joint: &Joint, life: &Life| {
        let of = life.parts.iter().find(|of| of.part == Part::Temperature)?;
        let without = match &life.without_temperature {
            None => "the same".to_string(),
            Some(parts) if parts.is_empty() => "nothing".to_string(),
            Some(parts) => parts.iter().map(word).collect::<Vec<_>>().join(", "),
        };
        let slope = change("", life.unit, of);
        Some([joint.name.clone(), life.name.clone(), format!("{} per K", slope.trim_start()), without])
    };
    let rows = fleet.joints.iter().flat_map(|joint| joint.lives.iter().filter_map(move |life| row(joint, life)));
    (["joint", "what", "how much", "without it"], rows.collect())
}
