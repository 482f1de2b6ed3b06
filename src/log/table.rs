//! Columns of numbers as the bytes of a log, CSV or Parquet.

use crate::problem::{Problem, Result};
use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, ParquetWriter, Series};
use std::io::Write;
use std::path::Path;

/// One column to write.
#[derive(Debug, Clone, Copy)]
pub struct Numbers<'a> {
    /// Its name in the header.
    pub name: &'a str,
    /// Its values, all columns alike in number.
    pub values: &'a [f64],
    /// Digits kept after the point: what the sensor resolves.
    pub decimals: usize,
}

impl Numbers<'_> {
    fn rounded(&self) -> impl Iterator<Item = f64> + '_ {
        let scale = 10f64.powi(self.decimals as i32);
        self.values.iter().map(move |x| (x * scale).round() / scale)
    }
}

/// CSV with a header.
pub fn csv_bytes(columns: &[Numbers]) -> Vec<u8> {
    let rows = columns.iter().map(|c| c.values.len()).min().unwrap_or(0);
    let mut bytes = Vec::with_capacity(rows * columns.len() * 10 + 64);
    let names: Vec<&str> = columns.iter().map(|c| c.name).collect();
    // Writing to memory cannot fail.
    let _ = writeln!(bytes, "{}", names.join(","));
    for i in 0..rows {
        for (k, column) in columns.iter().enumerate() {
            let comma = if k == 0 { "" } else { "," };
            let _ = write!(bytes, "{comma}{:.*}", column.decimals, column.values[i]);
        }
        bytes.push(b'\n');
    }
    bytes
}

/// `column` of `file`, to be written, holds what is no number.
pub(super) fn not_finite(file: &Path, column: &str) -> Problem {
    let what = "not written: it holds values that are not finite numbers, because of a numerical overflow";
    let cure = "check the data and the model's parameters for values that no joint has";
    Problem::error(file, what, cure).in_column(column)
}

/// Parquet; `file` is named when the columns cannot be written.
pub fn parquet_bytes(file: &Path, columns: &[Numbers]) -> Result<Vec<u8>> {
    let unwritable = |error: polars::prelude::PolarsError| {
        Problem::error(file, format!("cannot be written as Parquet: {error}"), "write CSV instead")
    };
    if let Some(column) = columns.iter().find(|c| c.rounded().any(|number| !number.is_finite())) {
        return not_finite(file, column.name).alone();
    }
    let column =
        |c: &Numbers| -> Column { Series::new(c.name.into(), c.rounded().collect::<Vec<f64>>()).into_column() };
    let rows = columns.first().map_or(0, |c| c.values.len());
    let mut frame = DataFrame::new(rows, columns.iter().map(column).collect()).map_err(unwritable)?;
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut frame).map_err(unwritable)?;
    Ok(bytes)
}
