//! The tables of a fleet: what changed, outliers, failures, joints.

use super::units;
use crate::batch::{Drift, Fleet, Joint, Outlier, Row};
use crate::compare::{Attribution, parameters_of};
use crate::model::Direction;
use crate::report::comparison::told_cause;
use crate::report::life;
use crate::report::number::{counted, interval, significant};
use crate::report::page::{Table, cells};
use crate::report::wording::{Units, moving};

/// Rows of a table on the page; the files hold all.
const ON_THE_PAGE: usize = 200;

/// The heads of a table with its rows.
pub type Cells<const N: usize> = ([&'static str; N], Vec<[String; N]>);

/// A drift's or outlier's name as a reader understands it, of the campaign `row`.
pub(super) fn words(name: &str, row: &Row) -> String {
    let direction = Direction::BOTH.into_iter().find(|d| name.contains(&format!("_{}", d.name())));
    match (name.split('_').next(), direction) {
        (Some("a"), Some(direction)) => format!("A, {}", moving(direction)),
        (Some("level"), Some(direction)) => {
            let units = Units::of_kind(row.model.as_ref().map(|model| model.joint.kind).unwrap_or_default());
            let speed = row.figure("level_speed_rad_s").map_or_else(String::new, |v| significant(v, 3));
            format!("B(v) at {speed} {}, {}", units.speed, moving(direction))
        }
        (Some("rmse"), None) => "RMSE".to_string(),
        _ => name.to_string(),
    }
}

/// The same with the unit of its values; a figure's is a torque.
fn words_with_unit(name: &str, row: &Row) -> String {
    let of_figure = || row.model.as_ref().map_or("", |model| model.joint.kind.torque_unit());
    let parameters = row.model.as_ref().map(parameters_of).unwrap_or_default();
    let unit = parameters.into_iter().find(|parameter| parameter.0 == name).map_or_else(of_figure, |found| found.1);
    match unit {
        "" => words(name, row),
        unit => format!("{} ({unit})", words(name, row)),
    }
}

pub(super) fn drifts(fleet: &Fleet) -> Cells<7> {
    let row = |joint: &Joint, d: &Drift| {
        let span = format!("{} to {}", when(fleet, joint.since), when(fleet, joint.last()));
        let change = d.after - d.before;
        [
            joint.name.clone(),
            span,
            words_with_unit(&d.name, &fleet.rows[joint.since]),
            significant(d.before, 4),
            significant(d.after, 4),
            significant(change, 3),
            interval(change, d.low, d.high),
        ]
    };
    let rows = fleet.drifted().flat_map(|joint| joint.drifts.iter().map(move |d| row(joint, d)));
    (["joint", "campaigns", "quantity", "before", "after", "change", "95 % interval"], rows.collect())
}

/// What changed, as A and B(v) show it, in a technician's words.
pub fn told(changed: &Attribution, units: &Units) -> String {
    let causes: Vec<String> = changed.causes.iter().map(|cause| told_cause(cause, units)).collect();
    match (changed.is_known(), causes.is_empty()) {
        (false, _) => "not known: one of the models has no A and B(v)".to_string(),
        (true, false) => causes.join("; "),
        (true, true) if changed.differs() => "A and B(v) changed, but no single cause explains how".to_string(),
        (true, true) => "nothing beyond the intervals".to_string(),
    }
}

pub(super) fn changes(fleet: &Fleet) -> Cells<3> {
    let row = |joint: &Joint| {
        let span = format!("{} to {}", when(fleet, joint.since), when(fleet, joint.last()));
        [joint.name.clone(), span, told(&joint.changed, &units(fleet, joint))]
    };
    (["joint", "campaigns", "what changed"], fleet.joints.iter().filter(|j| j.changed.differs()).map(row).collect())
}

pub(super) fn outliers(fleet: &Fleet) -> Cells<5> {
    let row = |o: &Outlier| {
        [
            fleet.rows[o.row].entry.name.clone(),
            words_with_unit(&o.name, &fleet.rows[o.row]),
            significant(o.value, 4),
            significant(o.median, 4),
            format!("{:.1} SD", o.deviations),
        ]
    };
    (["campaign", "quantity", "value", "fleet's median", "distance"], fleet.outliers.iter().map(row).collect())
}

pub(super) fn failures(fleet: &Fleet) -> Cells<2> {
    let row = |row: &Row| [row.entry.name.clone(), row.record.failure.clone().unwrap_or_default()];
    (["campaign", "reason"], fleet.failed().map(row).collect())
}

fn joints(fleet: &Fleet) -> Cells<7> {
    let row = |joint: &Joint| {
        let last = &fleet.rows[joint.last()];
        let figure = |name: &str| last.figure(name).map_or("–".to_string(), |x| significant(x, 3));
        let drifted = match (&joint.incomparable, joint.since == joint.last()) {
            (Some(why), _) => why.clone(),
            (None, true) => "one campaign since".to_string(),
            (None, false) if joint.drifts.is_empty() => if joint.changed.differs() { "yes" } else { "no" }.to_string(),
            _ => joint.drifts.iter().map(|d| words(&d.name, &fleet.rows[joint.since])).collect::<Vec<_>>().join("; "),
        };
        let diagnosis = last.record.diagnosis.as_ref();
        [
            joint.name.clone(),
            joint.rows.len().to_string(),
            when(fleet, joint.last()),
            figure("rmse_nm"),
            diagnosis.map_or("–".to_string(), |found| format!("{} {}", found.verdict, found.effects.join(", "))),
            joint.change_nm.map_or("–".to_string(), |x| significant(x, 3)),
            drifted,
        ]
    };
    (
        ["joint", "campaigns", "last", "RMSE (N m)", "verdict", "prediction's change (N m)", "changed"],
        fleet.joints.iter().map(row).collect(),
    )
}

/// The day of the campaign at `at`, or its name.
pub fn when(fleet: &Fleet, at: usize) -> String {
    let entry = &fleet.rows[at].entry;
    entry.date.clone().unwrap_or_else(|| entry.name.clone())
}

fn table<const N: usize>(title: &str, intro: &str, (heads, mut rows): Cells<N>) -> Option<Table> {
    let more = match rows.len() {
        0 => return None,
        n if n > ON_THE_PAGE => format!(" The first {ON_THE_PAGE} of {n}; fleet.json and table.csv hold all."),
        _ => String::new(),
    };
    rows.truncate(ON_THE_PAGE);
    Some(Table {
        title: title.to_string(),
        intro: format!("{intro}{more}"),
        heads: heads.map(String::from).to_vec(),
        rows: rows.into_iter().map(Vec::from).map(cells).collect(),
    })
}

/// The tables of the page that have rows, each with its title.
pub(super) fn tables(fleet: &Fleet) -> Vec<Table> {
    let drift_intro = format!(
        "The first campaign since the last retensioning (or the first of all) against the last, both from the fit to the whole history. {} \
         are tracked, with simultaneous 95 % intervals; with five campaigns or more these include the scatter between sessions, with \
         fewer only each campaign's own interval. A and B(v) are determined even where single parameters are correlated.",
        counted(fleet.compared, "parameter or function", "parameters and functions")
    );
    let all = [
        table(
            "What changed since the cables were last retensioned",
            "From A and B(v) of the first campaign since then and of the last, with the intervals of both.",
            changes(fleet),
        ),
        table("When limits will be reached", life::LIMITS, life::limits(fleet)),
        table("Retensionings and other jumps", life::EVENTS, life::events(fleet)),
        table("Slow drift", life::DRIFTS, life::drifts(fleet)),
        table("Temperature dependence", life::TEMPERATURE, life::temperature(fleet)),
        table("Quantities that changed since then", &drift_intro, drifts(fleet)),
        table("Campaigns that failed", "The others are complete.", failures(fleet)),
        table(
            "Outliers",
            "More than six standard deviations from the fleet's median (deviation estimated robustly from the middle of the fleet); only pinned \
             parameters.",
            outliers(fleet),
        ),
        table("Joints", "RMSE and verdict are of the last campaign.", joints(fleet)),
    ];
    all.into_iter().flatten().collect()
}
