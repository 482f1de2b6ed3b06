//! A row for each campaign.

use super::manifest::{Entry, TEMPERATURE};
use super::record::Record;
use super::store::Store;
use crate::compare::parameters_of;
use crate::log::mixed::{Cells, Mixed};
use crate::model::{Direction, Model, Term};
use std::path::Path;

/// Figures, in the order of their columns.
const FIGURES: [&str; 21] = [
    "a_up_nm",
    "a_up_half_width_nm",
    "a_down_nm",
    "a_down_half_width_nm",
    "level_speed_rad_s",
    "level_up_nm",
    "level_up_half_width_nm",
    "level_down_nm",
    "level_down_half_width_nm",
    "rmse_nm",
    "mae_nm",
    "peak_nm",
    "rmse_percent",
    "stable_rmse_nm",
    "transition_rmse_nm",
    "raw_rmse_nm",
    "gap_nm",
    "noise_floor_nm",
    "gap_after_nm",
    "shrink",
    "verdict_confidence",
];

/// Parameters beyond friction, in the order of their columns.
const OTHERS: [&str; 5] =
    ["dynamics.gravity_nm", "dynamics.inertia_kg_m2", "combination.p", "combination.n", "joint.backlash_m"];

/// One campaign with its result.
#[derive(Debug, Clone)]
pub struct Row {
    /// What was to be done.
    pub entry: Entry,
    /// What came of it; its model stands beside it.
    pub record: Record,
    /// Its model, read; `None` of a campaign that failed.
    pub model: Option<Model>,
}

impl Row {
    /// The row of `entry`; a campaign without a result, which another machine may still be at, fails as such.
    pub fn read(entry: &Entry, store: &Store) -> Self {
        let entry = entry.clone();
        let Some(mut record) = store.read(&entry.name) else {
            let failure = Some("there is no result yet".to_string());
            return Self {
                record: Record { name: entry.name.clone(), failure, ..Record::default() },
                entry,
                model: None,
            };
        };
        let text = record.model.take().map(|model| model.to_string());
        let model = text.and_then(|text| Model::parse(Path::new(&entry.name), &text).ok());
        if model.is_none() && record.failure.is_none() {
            record.failure = Some("its result cannot be read back".to_string());
        }
        Self { entry, record, model }
    }

    /// The joint that it is of: as listed, or as its model says.
    pub fn joint(&self) -> &str {
        let own = || self.model.as_ref().map(|model| model.joint.name.as_str());
        self.entry.joint.as_deref().or_else(own).unwrap_or("")
    }

    /// The value of the parameter with this dotted name, where the model has it.
    pub fn value(&self, name: &str) -> Option<f64> {
        let rows = parameters_of(self.model.as_ref()?);
        rows.into_iter().find(|row| row.0 == name).map(|row| row.2)
    }

    /// The temperature at which it was recorded, where the list tells it, degC.
    pub fn temperature_degc(&self) -> Option<f64> {
        self.entry.conditions.get(TEMPERATURE)?.parse().ok()
    }

    /// A figure.
    pub fn figure(&self, name: &str) -> Option<f64> {
        self.record.figures.get(name).copied()
    }
}

/// The dotted names of all parameters, in the order of their columns.
pub(super) fn parameter_names() -> Vec<String> {
    let friction = Direction::BOTH.into_iter().flat_map(|direction| Term::ALL.map(|term| term.dotted(direction)));
    friction.chain(OTHERS.map(String::from)).collect()
}

/// `rows` as columns. All but `duration_s`, the last, are the same however often and wherever the batch ran.
pub fn columns(rows: &[Row]) -> Vec<Mixed> {
    let text = |name: &str, of: &dyn Fn(&Row) -> Option<String>| Mixed {
        name: name.to_string(),
        cells: Cells::Texts(rows.iter().map(of).collect()),
    };
    let number = |name: &str, of: &dyn Fn(&Row) -> Option<f64>| Mixed {
        name: name.to_string(),
        cells: Cells::Numbers(rows.iter().map(|row| of(row).filter(|x| x.is_finite())).collect()),
    };
    let done = |row: &Row| row.record.failure.is_none();
    let mut columns = vec![
        text("name", &|row| Some(row.entry.name.clone())),
        text("joint", &|row| Some(row.joint().to_string()).filter(|joint| !joint.is_empty())),
        text("date", &|row| row.entry.date.clone()),
        text("status", &|row| Some(if done(row) { "done" } else { "failed" }.to_string())),
        text("reason", &|row| row.record.failure.clone()),
        text("route", &|row| Some(row.record.route.clone()).filter(|_| done(row))),
        number("trials", &|row| Some(row.record.trials as f64).filter(|_| done(row))),
        number("rows", &|row| Some(row.record.rows as f64).filter(|_| done(row))),
        text("combination", &|row| row.model.as_ref().map(|model| model.combination.name().to_string())),
    ];
    let values: Vec<_> = rows.iter().map(|row| row.model.as_ref().map(parameters_of).unwrap_or_default()).collect();
    for name in parameter_names() {
        let value = |known: &Vec<(String, &str, f64)>| known.iter().find(|row| row.0 == name).map(|row| row.2);
        let known = |row: &Row| row.model.as_ref().and_then(|model| model.confidence.get(&name)).copied();
        columns.push(Mixed { name: name.clone(), cells: Cells::Numbers(values.iter().map(value).collect()) });
        columns.push(number(&format!("{name}.low"), &|row| known(row).map(|c| c.low)));
        columns.push(number(&format!("{name}.high"), &|row| known(row).map(|c| c.high)));
        columns.push(text(&format!("{name}.status"), &|row| known(row).map(|c| c.status.name().to_string())));
    }
    columns.extend(FIGURES.map(|name| number(name, &|row| row.figure(name))));
    let diagnosed = |row: &Row| row.record.diagnosis.clone();
    columns.extend([
        text("verdict", &|row| diagnosed(row).map(|found| found.verdict)),
        text("against", &|row| diagnosed(row).map(|found| found.against)),
        text("causes", &|row| diagnosed(row).map(|found| found.effects.join(" "))),
        text("warnings", &|row| Some(row.record.warnings.join(" | ")).filter(|text| !text.is_empty())),
        text("inputs", &|row| Some(row.record.inputs.clone())),
        text("tautline", &|row| Some(row.record.tautline.clone())),
        number("duration_s", &|row| Some(row.record.duration_s)),
    ]);
    columns
}
