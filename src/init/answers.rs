//! Answers to the questions of a draft.

use super::measure::Measure;
use crate::dynamics::JointKind;
use crate::model::Drive;
use crate::units::Quantity;
use std::collections::BTreeMap;

/// Answers to questions, by key.
#[derive(Debug, Clone, Default)]
pub struct Answers {
    /// The joint's name.
    pub name: Option<String>,
    /// What drives it.
    pub drive: Drive,
    /// Values by their key, as they stand in the file.
    pub values: BTreeMap<String, String>,
    /// Names of columns, by key under `[columns]`.
    pub columns: BTreeMap<String, String>,
}

impl Answers {
    /// Takes `text` as the answer to `key`.
    ///
    /// Errors: it is no value of that kind; says what is expected.
    pub fn set(&mut self, key: &str, text: &str) -> Result<(), String> {
        let text = text.trim();
        let value = match quantity_of(key) {
            Some(quantity) => measure(quantity, text)?.to_string(),
            None => {
                let number = text.replace(',', ".").parse::<f64>().ok().filter(|number| number.is_finite());
                number.ok_or("expected a number")?.to_string()
            }
        };
        self.values.insert(key.to_string(), value);
        Ok(())
    }

    /// What a reading of 1 is, of each column of which that was answered.
    pub fn measures(&self) -> BTreeMap<String, Measure> {
        let of_column = |(key, text): (&String, &String)| {
            Some((key.strip_prefix("columns.")?.to_string(), Measure::written(text)?))
        };
        self.values.iter().filter_map(of_column).collect()
    }

    /// The value given for `key`.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.values.get(key)?.parse().ok()
    }
}

/// The quantity whose unit is the answer to the question `key`.
fn quantity_of(key: &str) -> Option<Quantity> {
    let column = key.strip_prefix("columns.")?;
    Quantity::ASKED.into_iter().find(|quantity| quantity.name() == column)
}

/// What `text` says a reading of 1 of `quantity` is. Errors: it is no unit of that quantity, nor a number of them.
fn measure(quantity: Quantity, text: &str) -> Result<Measure, String> {
    let units = [JointKind::Revolute, JointKind::Prismatic].map(|kind| quantity.units(kind));
    let is_of_it = |measure: &Measure| units.iter().any(|units| units.contains(&measure.unit));
    let mut names: Vec<&str> = units.concat().iter().map(|unit| unit.name()).collect();
    names.dedup();
    let expected = || format!("expected a unit ({}) or a number of them, such as `0.5 {}`", names.join(", "), names[0]);
    Measure::written(text).filter(is_of_it).ok_or_else(expected)
}
