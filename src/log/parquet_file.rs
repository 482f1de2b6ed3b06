//! Parquet -> readings, through Polars.

use super::columns::Wanted;
use super::readings::{Faults, Readings, Rows, locate};
use crate::problem::{Problem, Result};
use polars::prelude::{Column, DataFrame, DataType, ParallelStrategy, ParquetReader, PolarsError, SerReader};
use std::cell::Cell;
use std::fmt::Display;
use std::fs::File;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::Once;

/// Reads the wanted columns of `file`. A row is counted as if a header stood in row 1. Missing columns, columns of another
/// type than numbers, nulls, and numbers that are not finite go to `faults`.
///
/// Errors: the file cannot be read as Parquet at all.
pub(super) fn read(file: &Path, wanted: &[Wanted], faults: &mut Faults<'_>) -> Result<Readings> {
    let frame = match File::open(file) {
        Ok(source) => guarded(file, || frame(file, source, wanted, faults))?,
        Err(error) => return unreadable(file, &error),
    };
    // A column that was not found is not in the frame, and was reported.
    let column = |want: &Wanted| {
        let numbers = frame.column(&want.column.name).ok().and_then(|column| numbers(column, want, faults));
        numbers.unwrap_or_else(|| vec![f64::NAN; frame.height()])
    };
    Ok(Readings { columns: wanted.iter().map(column).collect(), rows: Rows::plain() })
}

fn unreadable<T>(file: &Path, why: &dyn Display) -> Result<T> {
    Problem::error(file, format!("cannot be read as Parquet: {why}"), "write the log again, as Parquet or CSV").alone()
}

thread_local! {
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Runs `read`, and makes an error of a panic: Polars believes what a damaged file says of itself, and then stumbles.
fn guarded<T>(file: &Path, read: impl FnOnce() -> Result<T>) -> Result<T> {
    static HUSH: Once = Once::new();
    HUSH.call_once(|| {
        let hook = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if !IS_GUARDED.get() {
                hook(info);
            }
        }));
    });
    IS_GUARDED.set(true);
    let read = panic::catch_unwind(AssertUnwindSafe(read));
    IS_GUARDED.set(false);
    read.unwrap_or_else(|_| unreadable(file, &"it is damaged"))
}

/// The wanted columns only: a log may hold many more.
fn frame(file: &Path, source: File, wanted: &[Wanted], faults: &mut Faults<'_>) -> Result<DataFrame> {
    let mut reader = ParquetReader::new(source);
    let names: Vec<String> = match reader.schema() {
        Ok(schema) => schema.iter_names().map(|name| name.to_string()).collect(),
        Err(error) => return unreadable(file, &error),
    };
    let found = locate(&names, wanted, faults);
    let only = wanted.iter().zip(found).filter_map(|(want, place)| place.map(|_| want.column.name.clone())).collect();
    // In this thread: trials are read side by side, and the guard sees no other thread.
    let reader = reader.with_columns(Some(only)).read_parallel(ParallelStrategy::None);
    reader.finish().or_else(|error| unreadable(file, &error))
}

/// The numbers of one column, NaN where there is none, which is then a fault; `None` of a column of another type.
fn numbers(column: &Column, want: &Wanted, faults: &mut Faults<'_>) -> Option<Vec<f64>> {
    let name = &want.column.name;
    let expected = format!("expected numbers in {}", want.column.unit.name());
    let kind = column.dtype();
    if !kind.is_primitive_numeric() {
        faults.add("another type", |file| {
            Problem::error(file, format!("holds {kind}"), expected.clone()).in_column(name)
        });
        return None;
    }
    let read = || -> std::result::Result<Vec<f64>, PolarsError> {
        let column = column.cast(&DataType::Float64)?;
        Ok(column.f64()?.iter().map(|number| number.unwrap_or(f64::NAN)).collect())
    };
    let fault = |error: PolarsError| {
        faults.add("another type", |file| Problem::error(file, error.to_string(), expected.clone()).in_column(name));
    };
    let numbers = read().map_err(fault).ok()?;
    for (sample, number) in numbers.iter().enumerate().filter(|(_, number)| !number.is_finite()) {
        faults.add("no number", |file| {
            let cure = format!("expected a number in {}; repair or delete the row", want.column.unit.name());
            let what = if number.is_nan() { "holds null or NaN".to_string() } else { format!("holds {number}") };
            Problem::error(file, what, cure).at_row(Rows::plain().of(sample)).in_column(name)
        });
    }
    Some(numbers)
}
