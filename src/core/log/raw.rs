//! All columns of numbers of a CSV or Parquet file, by name, before anybody knows which is which.

use super::columns::{Column, Wanted};
use super::csv_file::{Table, number};
use super::files::Files;
use super::parquet_file;
use super::stamp;
use crate::import::Series;
use crate::problem::Result;
use crate::units::{Quantity, Unit};
use csv::ByteRecord;
use std::path::Path;

/// A column with fewer numbers than this share of its cells holds something else.
const NUMBERS_SHARE: f64 = 0.5;

/// A file's columns of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Raw {
    /// Each column; NaN where a cell holds no number.
    pub columns: Vec<Series>,
    /// What a row of units under the header says of each column; empty without one.
    pub units: Vec<String>,
    /// How the file is written, for people.
    pub form: String,
}

/// Reads every column of numbers of `file`, a CSV or Parquet table written as `files` says.
///
/// Errors: it cannot be read as a table.
pub fn raw(file: &Path, files: &Files) -> Result<Raw> {
    let extension = file.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    match extension.eq_ignore_ascii_case("parquet") {
        true => of_parquet(file),
        false => of_text(file, files),
    }
}

fn of_text(file: &Path, files: &Files) -> Result<Raw> {
    let Table { mut records, dialect, names, units, .. } = Table::open(file, files, false)?;
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    let mut record = ByteRecord::new();
    let mut first_row = None;
    while records.next(file, &mut record)? {
        first_row = first_row.or(Some(records.row));
        for (place, column) in values.iter_mut().enumerate() {
            let value = |field: &[u8]| number(field, dialect.decimal).or_else(|| stamp::seconds(field));
            column.push(record.get(place).and_then(value).unwrap_or(f64::NAN));
        }
    }
    let first_row = first_row.unwrap_or(1);
    let all = names.into_iter().zip(values).enumerate();
    let (columns, units) = all
        .filter(|(_, (_, values))| is_of_numbers(values))
        .map(|(at, (name, values))| {
            (Series { name, values, clock: 0, first_row }, units.get(at).cloned().unwrap_or_default())
        })
        .unzip();
    Ok(Raw { columns, units, form: dialect.to_string() })
}

fn of_parquet(file: &Path) -> Result<Raw> {
    let mut columns = Vec::new();
    for name in parquet_file::names(file)? {
        let wanted = Wanted::new(Quantity::Time, &Column::new(name.clone(), Unit::Second));
        if let Some(values) = parquet_file::any_numbers(file, &wanted)?.filter(|values| is_of_numbers(values)) {
            columns.push(Series { name, values, clock: 0, first_row: 2 });
        }
    }
    let units = vec![String::new(); columns.len()];
    Ok(Raw { columns, units, form: "Parquet".to_string() })
}

fn is_of_numbers(values: &[f64]) -> bool {
    let numbers = values.iter().filter(|value| value.is_finite()).count();
    numbers > 0 && numbers as f64 >= NUMBERS_SHARE * values.len() as f64
}
