//! Columns of numbers and texts as the bytes of a table, CSV or Parquet; cells may be empty.

use crate::problem::{Problem, Result};
use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, ParquetWriter, Series};
use std::path::Path;

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Mixed {
    /// Its name in the header.
    pub name: String,
    /// What stands in it, all columns alike in number.
    pub cells: Cells,
}

/// What stands in a column.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Numbers.
    Numbers(Vec<Option<f64>>),
    /// Texts.
    Texts(Vec<Option<String>>),
}

impl Cells {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(cells) => cells.len(),
            Self::Texts(cells) => cells.len(),
        }
    }

    /// The cell in `row` as text: a number with as many digits as it needs to be read back bit for bit.
    fn text(&self, row: usize) -> String {
        match self {
            Self::Numbers(cells) => cells[row].map_or(String::new(), |number| number.to_string()),
            Self::Texts(cells) => cells[row].clone().unwrap_or_default(),
        }
    }
}

/// CSV with a header; `file` is named when it cannot be written.
pub fn csv_bytes(file: &Path, columns: &[Mixed]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let rows = columns.first().map_or(0, |column| column.cells.len());
    let written = writer.write_record(columns.iter().map(|column| &column.name)).and_then(|()| {
        (0..rows).try_for_each(|row| writer.write_record(columns.iter().map(|column| column.cells.text(row))))
    });
    let written = written.map_err(|error| error.to_string());
    written
        .and_then(|()| writer.into_inner().map_err(|error| error.to_string()))
        .or_else(|error| Problem::error(file, format!("cannot be written as CSV: {error}"), "report this").alone())
}

/// Parquet; `file` is named when it cannot be written.
pub fn parquet_bytes(file: &Path, columns: &[Mixed]) -> Result<Vec<u8>> {
    let unwritable = |error: polars::prelude::PolarsError| {
        Problem::error(file, format!("cannot be written as Parquet: {error}"), "report this")
    };
    let column = |column: &Mixed| -> Column {
        let name = column.name.as_str().into();
        match &column.cells {
            Cells::Numbers(cells) => Series::new(name, cells).into_column(),
            Cells::Texts(cells) => Series::new(name, cells).into_column(),
        }
    };
    let rows = columns.first().map_or(0, |column| column.cells.len());
    let mut frame = DataFrame::new(rows, columns.iter().map(column).collect()).map_err(unwritable)?;
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut frame).map_err(unwritable)?;
    Ok(bytes)
}
