//! Parquet -> readings, through Polars.

use super::columns::Wanted;
use super::parquet_pages::Pages;
use super::readings::{Faults, Readings, Rows, check_width, locate};
use super::stamp;
use crate::limits::Budget;
use crate::problem::{Problem, Result};
use polars::io::parquet::metadata::FileMetadataRef;
use polars::prelude::{Column, DataType, ParallelStrategy, ParquetReader, PolarsError, SerReader};
use std::cell::Cell;
use std::fmt::Display;
use std::fs::File;
use std::ops::Range;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::{Arc, Once};

/// Reads the wanted columns of `file`, its data `rows` alone where these are given. A row is counted as if a header stood in row 1. Missing columns, columns of another
/// type than numbers, nulls, and numbers that are not finite go to `faults`.
///
/// Errors: the file cannot be read as Parquet at all, is damaged, or would unpack to more than any log does.
pub(super) fn read(
    file: &Path,
    rows: Option<&Range<usize>>,
    wanted: &[Wanted],
    faults: &mut Faults<'_>,
) -> Result<Readings> {
    let outline = guarded(file, None, || outline(file))?;
    check_width(file, outline.names.len())?;
    let places = locate(&outline.names, wanted, faults);
    let found = || wanted.iter().zip(&places).filter(|(_, place)| place.is_some()).map(|(want, _)| want);
    check_pages(file, &outline.metadata, found())?;
    let within = rows.map_or(0..outline.rows, |rows| rows.start.min(outline.rows)..rows.end.min(outline.rows));
    let mut columns = Vec::with_capacity(wanted.len());
    for (want, place) in wanted.iter().zip(&places) {
        if want.rate_hz.is_some() {
            columns.push(within.clone().map(|row| row as f64).collect());
            continue;
        }
        // A column that was not found was reported.
        let column = match place {
            Some(_) => guarded(file, Some(want), || column(file, want, &outline.metadata))?,
            None => None,
        };
        let column = column.map(|column| column.slice(within.start as i64, within.len()));
        let numbers = column.and_then(|column| numbers(&column, within.start, want, faults));
        let numbers = numbers.map(|numbers| in_unit(numbers, want, &outline.metadata));
        columns.push(numbers.unwrap_or_else(|| vec![f64::NAN; within.len()]));
    }
    Ok(Readings { columns, rows: Rows::from(within.start) })
}

/// The names of all columns of `file`. Errors: it cannot be read as Parquet.
pub(super) fn names(file: &Path) -> Result<Vec<String>> {
    let outline = guarded(file, None, || outline(file))?;
    check_width(file, outline.names.len())?;
    Ok(outline.names)
}

/// The numbers of a column, NaN where there is none; `None` of a column of another type.
///
/// Errors: its pages are damaged.
pub(super) fn any_numbers(file: &Path, want: &Wanted) -> Result<Option<Vec<f64>>> {
    let outline = guarded(file, None, || outline(file))?;
    check_pages(file, &outline.metadata, std::iter::once(want))?;
    let column = guarded(file, Some(want), || column(file, want, &outline.metadata))?;
    let found = column.and_then(|column| numbers(&column, 0, want, &mut Faults::of(file)));
    Ok(found.map(|numbers| in_unit(numbers, want, &outline.metadata)))
}

/// `numbers` of a column of dates or times in the unit of `want`; others as they are.
fn in_unit(mut numbers: Vec<f64>, want: &Wanted, metadata: &FileMetadataRef) -> Vec<f64> {
    if let Some((count_s, origin_s)) = stamp::counted_in_s(metadata, &want.column.name) {
        numbers.iter_mut().for_each(|count| *count = (*count * count_s - origin_s) / want.column.unit.factor());
    }
    numbers
}

/// What the file says of itself.
struct Outline {
    names: Vec<String>,
    rows: usize,
    metadata: FileMetadataRef,
}

fn outline(file: &Path) -> Result<Outline> {
    let mut reader = open(file)?;
    let metadata = reader.get_metadata().map(Arc::clone).or_else(|error| unreadable(file, &error))?;
    let schema = reader.schema().or_else(|error| unreadable(file, &error))?;
    let rows = metadata.row_groups.iter().fold(0usize, |rows, group| rows.saturating_add(group.num_rows()));
    Ok(Outline { names: schema.iter_names().map(|name| name.to_string()).collect(), rows, metadata })
}

fn open(file: &Path) -> Result<ParquetReader<File>> {
    File::open(file).map(ParquetReader::new).or_else(|error| unreadable(file, &error))
}

/// Checks what the `wanted` columns would unpack to, and their pages.
fn check_pages<'a>(file: &Path, metadata: &FileMetadataRef, wanted: impl Iterator<Item = &'a Wanted>) -> Result<()> {
    let mut pages = File::open(file).and_then(Pages::of).or_else(|error| unreadable(file, &error))?;
    let mut numbers = Budget::of_file(std::fs::metadata(file).map_or(0, |about| about.len()));
    for want in wanted {
        let name = &want.column.name;
        for group in &metadata.row_groups {
            let chunks = group.columns_under_root_iter(name).into_iter().flatten();
            let checked = numbers.take_numbers(group.num_rows() as u64).and_then(|()| {
                chunks.map(|chunk| chunk.byte_range()).try_for_each(|range| pages.check(range, group.num_rows()))
            });
            checked.or_else(|what| damaged(file, Some(want), &what))?;
        }
    }
    Ok(())
}

fn damaged<T>(file: &Path, want: Option<&Wanted>, what: &str) -> Result<T> {
    let problem = Problem::error(file, format!("is damaged: {what}"), "copy it again from where it was recorded");
    want.map_or(problem.clone(), |want| problem.in_column(&want.column.name)).alone()
}

fn unreadable<T>(file: &Path, why: &dyn Display) -> Result<T> {
    Problem::error(file, format!("cannot be read as Parquet: {why}"), "write the log again, as Parquet or CSV").alone()
}

thread_local! {
    static IS_GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// Runs `read`, and turns a panic into an error: Polars trusts the metadata of a damaged file, and then panics.
fn guarded<T>(file: &Path, want: Option<&Wanted>, read: impl FnOnce() -> Result<T>) -> Result<T> {
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
    read.unwrap_or_else(|_| damaged(file, want, "its pages do not hold what its footer says"))
}

/// One column alone: a log may hold many more, and the memory of one is enough.
fn column(file: &Path, want: &Wanted, metadata: &FileMetadataRef) -> Result<Option<Column>> {
    let name = &want.column.name;
    let mut reader = open(file)?;
    reader.set_metadata(stamp::as_counts(metadata));
    // In this thread: trials are read side by side, and the guard sees no other thread.
    let reader = reader.with_columns(Some(vec![name.clone()])).read_parallel(ParallelStrategy::None);
    let frame = reader.finish().or_else(|error| damaged(file, Some(want), &error.to_string()))?;
    Ok(frame.column(name).ok().cloned())
}

/// The numbers of one column from row `start` of its file on, NaN where there is none, which is then a fault; `None` of a column
/// of another type.
fn numbers(column: &Column, start: usize, want: &Wanted, faults: &mut Faults<'_>) -> Option<Vec<f64>> {
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
            Problem::error(file, what, cure).at_row(Rows::from(start).of(sample)).in_column(name)
        });
    }
    Some(numbers)
}
