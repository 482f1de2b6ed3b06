//! The fleet by joint, over time: what drifted since the cables were last retensioned, and what stands out.

use super::manifest::Batch;
use super::table::{Row, parameter_names};
use crate::compare::{Attribution, Verdict, compare_among};
use crate::document::suggest;
use crate::model::Status;
use crate::numerics::statistics::{quantile, together};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Standard deviations, from the median's absolute deviation, beyond which a campaign stands out.
const FAR: f64 = 6.0;
/// The median absolute deviation of a normal distribution, in standard deviations.
const MAD_OF_NORMAL: f64 = 0.6745;
/// With fewer campaigns nothing can be said to stand out.
const FEW: usize = 8;
/// Figures that drift beside the parameters: what these amount to, known well even where they are known only together.
pub const LEVELS: [(&str, &str); 4] = [
    ("a_up_nm", "a_up_half_width_nm"),
    ("a_down_nm", "a_down_half_width_nm"),
    ("level_up_nm", "level_up_half_width_nm"),
    ("level_down_nm", "level_down_half_width_nm"),
];

/// A fleet.
#[derive(Debug, Clone)]
pub struct Fleet {
    /// Every campaign.
    pub rows: Vec<Row>,
    /// Every joint of which a campaign was identified, by name.
    pub joints: Vec<Joint>,
    /// Values that stand out, farthest first.
    pub outliers: Vec<Outlier>,
    /// Values compared over time.
    pub compared: usize,
    /// What of the retensionings could not be used.
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
    /// What changed since, beyond its confidence.
    pub drifts: Vec<Drift>,
    /// What changed since, decided on A and B(v).
    pub changed: Attribution,
    /// What each retensioning changed.
    pub retensionings: Vec<Retensioning>,
    /// RMS of the predicted torque's change along the paper's cosine cascade, N m.
    pub change_nm: Option<f64>,
    /// Why its campaigns cannot be compared, where that is so.
    pub incomparable: Option<String>,
}

/// What retensioning the cables changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Retensioning {
    /// When.
    pub date: String,
    /// Places in `Fleet::rows` of the last campaign before and the first since.
    pub rows: [usize; 2],
    /// What changed from one to the other.
    pub changed: Attribution,
}

impl Joint {
    /// Place in `Fleet::rows` of its last campaign.
    pub fn last(&self) -> usize {
        self.rows.last().copied().unwrap_or(self.since)
    }
}

/// A value that changed beyond its confidence.
#[derive(Debug, Clone, PartialEq)]
pub struct Drift {
    /// The parameter's dotted name, or the figure's.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// In the first campaign since retensioning.
    pub before: f64,
    /// In the last.
    pub after: f64,
    /// The change's interval, 95 % over all that is compared in the fleet.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

/// A value that stands out from the fleet's.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlier {
    /// Place of the campaign in `Fleet::rows`.
    pub row: usize,
    /// The parameter's dotted name, or the figure's.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// The fleet's median.
    pub median: f64,
    /// How far it is from there, in standard deviations of the fleet's middle.
    pub deviations: f64,
}

impl Fleet {
    /// `rows` of `batch`, by joint and over time.
    pub fn new(batch: &Batch, rows: Vec<Row>) -> Self {
        let mut of_joint: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (at, row) in rows.iter().enumerate().filter(|(_, row)| row.model.is_some()) {
            of_joint.entry(row.joint().to_string()).or_default().push(at);
        }
        let count = of_joint.len();
        let mut joints: Vec<Joint> =
            of_joint.into_par_iter().map(|(name, of)| history(batch, &rows, name, of, count)).collect();
        // Among thousands of intervals of 95 % many miss by chance: all are widened to hold together.
        let compared: usize = joints.iter().map(|joint| joint.drifts.len()).sum();
        let wider = together(compared);
        for joint in &mut joints {
            joint.drifts =
                std::mem::take(&mut joint.drifts).into_iter().filter_map(|drift| drift.beyond(wider)).collect();
        }
        let (outliers, warnings) = (outliers(&rows), unused(batch, &rows, &joints));
        Self { rows, joints, outliers, compared, warnings }
    }

    /// Joints of which anything drifted.
    pub fn drifted(&self) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(|joint| !joint.drifts.is_empty() || joint.changed.differs())
    }

    /// Campaigns without a result.
    pub fn failed(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| row.record.failure.is_some())
    }
}

impl Drift {
    /// With its interval `wider` times as wide, if the change is beyond that.
    fn beyond(self, wider: f64) -> Option<Self> {
        let change = self.after - self.before;
        let (low, high) = (change - wider * (change - self.low), change + wider * (self.high - change));
        (low > 0.0 || high < 0.0).then_some(Self { low, high, ..self })
    }
}

/// The joint called `name`, one of `joints`, over its campaigns `of`; `drifts` holds all that is compared yet.
fn history(batch: &Batch, rows: &[Row], name: String, mut of: Vec<usize>, joints: usize) -> Joint {
    let date = |at: usize| rows[at].entry.date.as_deref();
    // Without a date for each, time goes as they are listed.
    let dated = of.iter().all(|at| date(*at).is_some());
    if dated {
        of.sort_by_key(|at| date(*at));
    }
    let (first, last) = (of[0], of[of.len() - 1]);
    let dates = batch.retensioned.get(&name).filter(|_| dated);
    let retensioned = dates.and_then(|dates| dates.iter().rev().find(|at| date(last) >= Some(at.as_str()))).cloned();
    let since = of.iter().copied().find(|at| retensioned.as_deref() <= date(*at)).unwrap_or(first);
    let retensionings = dates.iter().flat_map(|dates| dates.iter());
    let retensionings = retensionings.filter_map(|at| retensioning(rows, &of, at, joints)).collect();
    let mut joint = Joint {
        name,
        rows: of,
        retensioned,
        since,
        drifts: Vec::new(),
        changed: Attribution::default(),
        retensionings,
        change_nm: None,
        incomparable: None,
    };
    if since == last {
        return joint;
    }
    let (Some(before), Some(after)) = (&rows[since].model, &rows[last].model) else { return joint };
    match compare_among(before, after, joints) {
        Ok(found) => {
            joint.changed = found.attribution.clone();
            joint.change_nm = Some(found.effect.rms_nm);
            let judged = found.changes.into_iter().filter(|c| matches!(c.verdict, Verdict::Changed | Verdict::Within));
            joint.drifts.extend(judged.filter_map(|c| {
                let known = before.confidence.contains_key(&c.name) && after.confidence.contains_key(&c.name);
                let (a, b) = c.before.zip(c.after).filter(|_| known)?;
                Some(Drift { name: c.name, unit: c.unit, before: a, after: b, low: c.low, high: c.high })
            }));
            joint.drifts.extend(LEVELS.iter().filter_map(|names| level(&rows[since], &rows[last], *names)));
        }
        Err(problems) => joint.incomparable = Some(problems.to_string()),
    }
    joint
}

/// What retensioning on `date` changed, from the last of the campaigns `of` before it to the first since.
fn retensioning(rows: &[Row], of: &[usize], date: &str, joints: usize) -> Option<Retensioning> {
    let first = of.iter().position(|at| rows[*at].entry.date.as_deref() >= Some(date))?;
    let pair = [of[first.checked_sub(1)?], of[first]];
    let [before, after] = pair.map(|at| rows[at].model.as_ref());
    let changed = compare_among(before?, after?, joints).ok()?.attribution;
    Some(Retensioning { date: date.to_string(), rows: pair, changed })
}

/// The retensionings that tell nothing: of joints that no campaign is of, or whose campaigns have no dates.
fn unused(batch: &Batch, rows: &[Row], joints: &[Joint]) -> Vec<String> {
    let one = |name: &String| match joints.iter().find(|joint| joint.name == *name) {
        None => Some(format!(
            "`{name}` was retensioned, and no campaign that was identified is of it: {}",
            suggest(name, "they are of", joints.iter().map(|joint| joint.name.as_str()))
        )),
        Some(joint) if joint.rows.iter().any(|at| rows[*at].entry.date.is_none()) => {
            Some(format!("`{name}` was retensioned, and not all of its campaigns have a `date`: that is left out"))
        }
        Some(_) => None,
    };
    batch.retensioned.keys().filter_map(one).collect()
}

/// How a figure with a half width changed; a level belongs to a speed, which must be the same.
fn level(before: &Row, after: &Row, (name, half_width): (&str, &str)) -> Option<Drift> {
    let speed = |row: &Row| row.figure("level_speed_rad_s");
    let same_speed = speed(before).zip(speed(after)).is_some_and(|(a, b)| (a / b - 1.0).abs() < 1e-6);
    if name.starts_with("level") && !same_speed {
        return None;
    }
    let (a, b) = (before.figure(name)?, after.figure(name)?);
    let reach = before.figure(half_width)?.hypot(after.figure(half_width)?);
    let unit = before.model.as_ref()?.joint.kind.torque_unit();
    Some(Drift { name: name.into(), unit, before: a, after: b, low: b - a - reach, high: b - a + reach })
}

/// What lies far from the middle of the fleet: parameters that are known by themselves, levels, and how well models predict.
fn outliers(rows: &[Row]) -> Vec<Outlier> {
    let pinned = |row: &Row, name: &str| {
        let known = row.model.as_ref()?.confidence.get(name)?;
        row.value(name).filter(|_| known.status == Status::Pinned)
    };
    let figures = LEVELS.iter().map(|names| names.0).chain(["rmse_nm"]);
    let figures = figures.map(|name| (name.to_string(), rows.iter().map(|row| row.figure(name)).collect()));
    let parameters = parameter_names().into_iter().map(|name| {
        let values = rows.iter().map(|row| pinned(row, &name)).collect();
        (name, values)
    });
    let mut found: Vec<Outlier> = figures.chain(parameters).flat_map(|(name, values)| far(&name, values)).collect();
    found.sort_by(|a, b| b.deviations.abs().total_cmp(&a.deviations.abs()));
    found
}

fn far(name: &str, values: Vec<Option<f64>>) -> Vec<Outlier> {
    let mut known: Vec<f64> = values.iter().flatten().copied().collect();
    if known.len() < FEW {
        return Vec::new();
    }
    let median = quantile(&mut known, 0.5);
    known.iter_mut().for_each(|value| *value = (*value - median).abs());
    let deviation = quantile(&mut known, 0.5) / MAD_OF_NORMAL;
    let one = |(row, value): (usize, Option<f64>)| {
        let value = value?;
        let deviations = (value - median) / deviation;
        (deviation > 0.0 && deviations.abs() > FAR).then(|| Outlier {
            row,
            name: name.to_string(),
            value,
            median,
            deviations,
        })
    };
    values.into_iter().enumerate().filter_map(one).collect()
}
