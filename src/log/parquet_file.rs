//! Parquet -> readings.

use super::arrays;
use super::columns::Wanted;
use super::parquet_pages::Pages;
use super::readings::{Faults, Readings, Rows, check_width, locate};
use super::stamp;
use crate::limits::Budget;
use crate::problem::{Problem, Result};
use polars_arrow::datatypes::ArrowSchema;
use polars_parquet::read::{FileMetadata, infer_schema, read_metadata};
use std::cell::Cell;
use std::fmt::Display;
use std::fs::File;
use std::ops::Range;
use std::panic::{self, AssertUnwindSafe};
use std::path::Path;
use std::sync::Once;

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
    let outline = guarded(file, None, || Outline::of(file))?;
    let names = outline.names();
    check_width(file, names.len())?;
    let places = locate(&names, wanted, faults);
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
        let held = match place {
            Some(_) => Some(guarded(file, Some(want), || outline.column(file, want))?),
            None => None,
        };
        let numbers = held.and_then(|held| numbers(held, &within, want, faults));
        let numbers = numbers.map(|numbers| in_unit(numbers, want, &outline.metadata));
        columns.push(numbers.unwrap_or_else(|| vec![f64::NAN; within.len()]));
    }
    Ok(Readings { columns, rows: Rows::from(within.start) })
}

/// The names of all columns of `file`. Errors: it cannot be read as Parquet.
pub(super) fn names(file: &Path) -> Result<Vec<String>> {
    let names = guarded(file, None, || Outline::of(file))?.names();
    check_width(file, names.len())?;
    Ok(names)
}

/// The numbers of a column, NaN where there is none; `None` of a column of another type.
///
/// Errors: its pages are damaged.
pub(super) fn any_numbers(file: &Path, want: &Wanted) -> Result<Option<Vec<f64>>> {
    let outline = guarded(file, None, || Outline::of(file))?;
    check_pages(file, &outline.metadata, std::iter::once(want))?;
    let held = guarded(file, Some(want), || outline.column(file, want))?;
    let found = numbers(held, &(0..outline.rows), want, &mut Faults::of(file));
    Ok(found.map(|numbers| in_unit(numbers, want, &outline.metadata)))
}

/// `numbers` of a column of dates or times in the unit of `want`; others as they are.
fn in_unit(mut numbers: Vec<f64>, want: &Wanted, metadata: &FileMetadata) -> Vec<f64> {
    if let Some((count_s, origin_s)) = stamp::counted_in_s(metadata, &want.column.name) {
        numbers.iter_mut().for_each(|count| *count = (*count * count_s - origin_s) / want.column.unit.factor());
    }
    numbers
}

/// What the file says of itself.
struct Outline {
    /// Its columns, dates and times as the whole numbers that they are stored as.
    schema: ArrowSchema,
    rows: usize,
    metadata: FileMetadata,
}

/// What a column holds.
enum Held {
    Numbers(Vec<f64>),
    /// Something else, in words.
    Other(String),
}

impl Outline {
    fn of(file: &Path) -> Result<Self> {
        let mut source = File::open(file).or_else(|error| unreadable(file, &error))?;
        let metadata = read_metadata(&mut source).or_else(|error| unreadable(file, &error))?;
        let schema = infer_schema(&stamp::as_counts(&metadata)).or_else(|error| unreadable(file, &error))?;
        let rows = metadata.row_groups.iter().fold(0usize, |rows, group| rows.saturating_add(group.num_rows()));
        Ok(Self { schema, rows, metadata })
    }

    fn names(&self) -> Vec<String> {
        self.schema.iter_names().map(|name| name.to_string()).collect()
    }

    /// One column alone: a log may hold many more, and the memory of one is enough.
    fn column(&self, file: &Path, want: &Wanted) -> Result<Held> {
        let Some(field) = self.schema.get(want.column.name.as_str()) else {
            return Ok(Held::Other("nothing of that name".to_string()));
        };
        if !arrays::is_numeric(&field.dtype) {
            return Ok(Held::Other(arrays::kind(&field.dtype)));
        }
        let read = File::open(file).map_err(|error| error.to_string());
        let read = read.and_then(|mut source| arrays::read(&mut source, &self.metadata, field));
        let read = read.or_else(|error| damaged(file, Some(want), &error))?;
        Ok(Held::Numbers(read.iter().filter_map(|array| arrays::numbers(array.as_ref())).flatten().collect()))
    }
}

/// Checks what the `wanted` columns would unpack to, and their pages.
fn check_pages<'a>(file: &Path, metadata: &FileMetadata, wanted: impl Iterator<Item = &'a Wanted>) -> Result<()> {
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

/// Runs `read`, and makes an error of a panic: the reader of pages believes what a damaged file says of itself, and then stumbles.
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

/// The numbers of what a column holds in `rows` of its file, NaN where there is none, which is then a fault; `None` of a column of
/// another type.
fn numbers(held: Held, rows: &Range<usize>, want: &Wanted, faults: &mut Faults<'_>) -> Option<Vec<f64>> {
    let name = &want.column.name;
    let mut numbers = match held {
        Held::Numbers(numbers) => numbers,
        Held::Other(kind) => {
            let expected = format!("expected numbers in {}", want.column.unit.name());
            faults.add("another type", |file| {
                Problem::error(file, format!("holds {kind}"), expected.clone()).in_column(name)
            });
            return None;
        }
    };
    numbers.truncate(rows.end);
    numbers.drain(..rows.start.min(numbers.len()));
    for (sample, number) in numbers.iter().enumerate().filter(|(_, number)| !number.is_finite()) {
        faults.add("no number", |file| {
            let cure = format!("expected a number in {}; repair or delete the row", want.column.unit.name());
            let what = if number.is_nan() { "holds null or NaN".to_string() } else { format!("holds {number}") };
            Problem::error(file, what, cure).at_row(Rows::from(rows.start).of(sample)).in_column(name)
        });
    }
    Some(numbers)
}
