//! The fleet by joint, over time: what happened to each, when limits will be reached, and what stands out.

use super::calendar::day;
use super::events::{Drift, Event, differences, events};
use super::life::{Forecast, Life, Limit, Refusal, Scatters, Sessions};
use super::manifest::Batch;
use super::outliers::{Outlier, outliers};
use super::quantities::{self, Quantity};
use super::table::Row;
use crate::compare::{Attribution, compare_among};
use crate::document::suggest;
use crate::model::{Direction, Model};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A fleet.
#[derive(Debug, Clone)]
pub struct Fleet {
    /// Every campaign.
    pub rows: Vec<Row>,
    /// Every joint of which a campaign was identified, by name.
    pub joints: Vec<Joint>,
    /// Values that stand out, farthest first.
    pub outliers: Vec<Outlier>,
    /// Parameters and functions followed over time.
    pub compared: usize,
    /// What of the retensionings and limits could not be used.
    pub warnings: Vec<String>,
}

/// One joint over time.
#[derive(Debug, Clone)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Places of its campaigns in `Fleet::rows`, in time.
    pub rows: Vec<usize>,
    /// When its cables were last retensioned, before its last campaign, where that is told.
    pub retensioned: Option<String>,
    /// Place in `Fleet::rows` of the first campaign since then.
    pub since: usize,
    /// What happened to each parameter and function.
    pub lives: Vec<Life>,
    /// What changed from the first campaign since retensioning to the last.
    pub drifts: Vec<Drift>,
    /// The same, decided on A and B(v) and told by its cause.
    pub changed: Attribution,
    /// Retensionings, and what else changed its level, in time.
    pub events: Vec<Event>,
    /// When the limits that concern it will be reached.
    pub limits: Vec<Foreseen>,
    /// RMS of the predicted torque's change along the paper's cosine cascade, N m.
    pub change_nm: Option<f64>,
    /// Why its campaigns cannot be compared, where that is so.
    pub incomparable: Option<String>,
}

/// A limit and when it will be reached.
#[derive(Debug, Clone, PartialEq)]
pub struct Foreseen {
    /// The limit.
    pub limit: Limit,
    /// The quantity that it is of.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// When.
    pub forecast: Forecast,
}

impl Joint {
    /// Place in `Fleet::rows` of its last campaign.
    pub fn last(&self) -> usize {
        self.rows.last().copied().unwrap_or(self.since)
    }

    /// Whether it changed since the cables were last retensioned.
    pub fn drifted(&self) -> bool {
        !self.drifts.is_empty() || self.changed.differs()
    }
}

impl Fleet {
    /// `rows` of `batch`, by joint and over time.
    pub fn new(batch: &Batch, rows: Vec<Row>) -> Self {
        let mut of_joint: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (at, row) in rows.iter().enumerate().filter(|(_, row)| row.model.is_some()) {
            of_joint.entry(row.joint().to_string()).or_default().push(at);
        }
        let histories: Vec<History> =
            of_joint.into_iter().map(|(name, of)| History::new(batch, &rows, name, of)).collect();
        let compared = histories.iter().flat_map(|history| &history.quantities).filter(|q| is_followed(q)).count();
        let count = histories.len();
        let alone: Vec<Vec<Life>> = histories.par_iter().map(|history| history.lives(compared)).collect();
        let scatters = Scatters::new(&alone);
        let joint = |(at, (history, alone)): (usize, (History, Vec<Life>))| {
            let informed = |life: Life| {
                let alike = scatters.of_others(at, &life);
                life.informed(alike, &history.sessions, compared)
            };
            let lives = alone.into_iter().map(informed).collect();
            history.joint(&rows, lives, [compared, count])
        };
        let joints: Vec<Joint> = histories.into_par_iter().zip(alone).enumerate().map(joint).collect();
        let (outliers, warnings) = (outliers(&rows), unused(batch, &rows, &joints));
        Self { rows, joints, outliers, compared, warnings }
    }

    /// Joints of which anything changed since their cables were last retensioned.
    pub fn drifted(&self) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(|joint| joint.drifted())
    }

    /// Campaigns without a result.
    pub fn failed(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.record.failure.is_some())
    }
}

/// Whether two campaigns show it.
fn is_followed(quantity: &Quantity) -> bool {
    quantity.values.iter().flatten().nth(1).is_some()
}

/// What is known of a joint over time.
struct History {
    name: String,
    /// Places of its campaigns in the fleet's rows, in time.
    of: Vec<usize>,
    /// Dates at which its cables were retensioned; none where a campaign has no date.
    dates: Vec<String>,
    sessions: Sessions,
    quantities: Vec<Quantity>,
    /// Limits, each with the names of what they are of.
    limits: Vec<(Limit, Vec<String>)>,
}

impl History {
    fn new(batch: &Batch, rows: &[Row], name: String, mut of: Vec<usize>) -> Self {
        let date = |at: usize| rows[at].entry.date.as_deref();
        // Without a date for each, time goes as they are listed.
        let dated = of.iter().all(|at| date(*at).is_some());
        if dated {
            of.sort_by_key(|at| date(*at));
        }
        let dates = batch.retensioned.get(&name).filter(|_| dated).cloned().unwrap_or_default();
        let days: Option<Vec<f64>> = of.iter().map(|at| day(date(*at)?)).collect();
        let first_since = |date: &String| of.iter().position(|at| rows[*at].entry.date.as_ref() >= Some(date));
        let sessions = Sessions {
            dated: days.is_some(),
            days: days.unwrap_or_else(|| (0..of.len()).map(|i| i as f64).collect()),
            temperatures_degc: of.iter().map(|at| rows[*at].temperature_degc()).collect(),
            retensioned: dates.iter().filter_map(first_since).filter(|at| *at > 0).collect(),
        };
        let (all, models): (Vec<&Row>, Vec<&Model>) =
            of.iter().filter_map(|at| Some((&rows[*at], rows[*at].model.as_ref()?))).unzip();
        let unit = models.first().map_or("", |model| model.joint.kind.torque_unit());
        let mut quantities = quantities::of(&models);
        quantities.push(quantities::figure(&all, "rmse_nm", unit));
        let concerns = |limit: &&Limit| limit.joint.as_ref().is_none_or(|joint| *joint == name);
        let limited = |limit: &Limit| (limit.clone(), meant(limit, &models, &mut quantities));
        let limits = batch.limits.iter().filter(concerns).map(limited).collect();
        Self { name, of, dates, sessions, quantities, limits }
    }

    /// What happened to each quantity by what this joint alone tells, one of `compared` in the fleet.
    fn lives(&self, compared: usize) -> Vec<Life> {
        self.quantities.iter().filter_map(|q| Life::new(q, &self.sessions, compared)).collect()
    }

    /// One joint of `joints` with its `lives`, among `compared` quantities of the fleet.
    fn joint(self, rows: &[Row], lives: Vec<Life>, [compared, joints]: [usize; 2]) -> Joint {
        let Self { name, of, dates, sessions, limits, .. } = self;
        let (first, last) = (of[0], of[of.len() - 1]);
        let date = |at: usize| rows[at].entry.date.as_deref();
        let retensioned = dates.iter().rev().find(|at| date(last) >= Some(at.as_str())).cloned();
        let since = of.iter().copied().find(|at| retensioned.as_deref() <= date(*at)).unwrap_or(first);
        let place = of.iter().position(|at| *at == since).unwrap_or(0);
        let mut joint = Joint {
            events: events(rows, &of, &dates, &lives, [compared, joints]),
            limits: limits.iter().flat_map(|(limit, names)| foreseen(limit, names, &lives, &sessions)).collect(),
            drifts: differences(&lives, place, of.len() - 1, compared),
            name,
            rows: of,
            retensioned,
            since,
            lives,
            changed: Attribution::default(),
            change_nm: None,
            incomparable: None,
        };
        if since != last
            && let (Some(before), Some(after)) = (&rows[since].model, &rows[last].model)
        {
            match compare_among(before, after, joints) {
                Ok(found) => {
                    joint.change_nm = Some(found.effect.rms_nm);
                    // Where the scatter between sessions is known, two of them alone do not decide.
                    let is_decided = joint.lives.iter().any(|life| !life.scatter.is_nan()) && joint.drifts.is_empty();
                    joint.changed = if is_decided { Attribution::default() } else { found.attribution };
                }
                Err(problems) => joint.incomparable = Some(problems.to_string()),
            }
        }
        joint
    }
}

/// When `limit` on the quantities called `names` will be reached.
fn foreseen(limit: &Limit, names: &[String], lives: &[Life], sessions: &Sessions) -> Vec<Foreseen> {
    let one = |name: &String| {
        let life = lives.iter().find(|life| life.name == *name);
        let forecast = life.map_or(Forecast::Unknown(Refusal::NotIdentified), |life| match life.forecast(limit) {
            Forecast::In { .. } | Forecast::Unknown(_) if !sessions.dated => Forecast::Unknown(Refusal::Undated),
            forecast => forecast,
        });
        let unit = life.map_or("", |life| life.unit);
        Foreseen { limit: limit.clone(), name: name.clone(), unit, forecast }
    };
    names.iter().map(one).collect()
}

/// The names of the quantities that `limit` is of; friction at a speed that nobody looked at yet is added to `quantities`.
fn meant(limit: &Limit, models: &[&Model], quantities: &mut Vec<Quantity>) -> Vec<String> {
    match limit.what.as_str() {
        "friction_nm" => {
            let of = |direction: Direction| {
                let (slowest, fastest) = quantities::speeds(models, direction)?;
                let speed_rad_s = limit.speed_rad_s.unwrap_or((slowest * fastest).sqrt());
                Some(quantities::friction(models, direction, speed_rad_s))
            };
            let found: Vec<Quantity> = Direction::BOTH.into_iter().filter_map(of).collect();
            let names = found.iter().map(|quantity| quantity.name.clone()).collect();
            for quantity in found {
                if !quantities.iter().any(|known| known.name == quantity.name) {
                    quantities.push(quantity);
                }
            }
            names
        }
        "backlash_m" => vec!["joint.backlash_m".to_string()],
        "change_over_m" => vec![quantities::CHANGE_OVER.to_string()],
        name => vec![name.to_string()],
    }
}

/// The retensionings and limits that tell nothing: of joints that no campaign is of, or whose campaigns have no dates.
fn unused(batch: &Batch, rows: &[Row], joints: &[Joint]) -> Vec<String> {
    let unknown = |name: &String| {
        let is_known = joints.iter().any(|joint| joint.name == *name);
        (!is_known).then(|| suggest(name, "they are of", joints.iter().map(|joint| joint.name.as_str())))
    };
    let retensioned = |name: &String| match unknown(name) {
        Some(others) => {
            Some(format!("`{name}` was retensioned, and no campaign that was identified is of it: {others}"))
        }
        None if joints.iter().any(|j| j.name == *name && j.rows.iter().any(|at| rows[*at].entry.date.is_none())) => {
            Some(format!("`{name}` was retensioned, and not all of its campaigns have a `date`: that is left out"))
        }
        None => None,
    };
    let limited = |limit: &Limit| {
        let name = limit.joint.as_ref()?;
        Some(format!("a limit is of `{name}`, and no campaign that was identified is of it: {}", unknown(name)?))
    };
    batch.retensioned.keys().filter_map(retensioned).chain(batch.limits.iter().filter_map(limited)).collect()
}
