//! Columns of numbers and texts as the bytes of a table, CSV or Parquet; cells may be empty.

use super::table::not_finite;
use crate::problem::{Problem, Result};
use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, ParquetWriter, Series};
use std::borrow::Cow;
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
            Self::Texts(cells) => cells[row].as_deref().map_or_else(String::new, |text| text_cell(text).into_owned()),
        }
    }
}

/// What a cell of text may not begin with: a spreadsheet takes it for a formula and runs it.
const FORMULAS: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];
/// Set before such a text, and before one that begins with itself: spreadsheets show what follows as text.
const AS_TEXT: char = '\'';

/// `text`, from a file's or a joint's name, as a cell of CSV that no spreadsheet runs. Numbers need none of this.
pub fn text_cell(text: &str) -> Cow<'_, str> {
    match text.starts_with(FORMULAS) || text.starts_with(AS_TEXT) {
        true => Cow::Owned(format!("{AS_TEXT}{text}")),
        false => Cow::Borrowed(text),
    }
}

/// The text of which `text_cell` made `cell`.
pub fn cell_text(cell: &str) -> &str {
    let text = cell.strip_prefix(AS_TEXT).unwrap_or(cell);
    if text.starts_with(FORMULAS) || text.starts_with(AS_TEXT) { text } else { cell }
}

/// CSV with a header; texts are written as `text_cell` has them; `file` is named when it cannot be written.
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
    for column in columns {
        let is_none = |cells: &Vec<Option<f64>>| cells.iter().flatten().any(|number| !number.is_finite());
        if matches!(&column.cells, Cells::Numbers(cells) if is_none(cells)) {
            return not_finite(file, &column.name).alone();
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_text_is_a_formula_and_every_text_comes_back() {
        for text in ["=cmd|' /C calc'!A0", "+1", "-1.csv", "@SUM(A1)", "'=1", "'quoted'", "", "sweep_1.csv", "\t=1"] {
            let cell = text_cell(text);
            assert!(!cell.starts_with(FORMULAS), "{cell}");
            assert_eq!(cell_text(&cell), text);
        }
        let numbers = Mixed { name: "b_nm".to_string(), cells: Cells::Numbers(vec![Some(-0.5)]) };
        let files = Mixed { name: "file".to_string(), cells: Cells::Texts(vec![Some("-1.csv".to_string())]) };
        let csv = csv_bytes(Path::new("t.csv"), &[numbers.clone(), files]).unwrap();
        assert_eq!(String::from_utf8(csv).unwrap(), "b_nm,file\n-0.5,'-1.csv\n");
        let overflowed = Mixed { cells: Cells::Numbers(vec![None, Some(f64::INFINITY)]), ..numbers };
        assert!(parquet_bytes(Path::new("t.parquet"), &[overflowed]).is_err());
    }
}
