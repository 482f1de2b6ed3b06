//! MATLAB `.mat`: vectors and matrices of numbers; of v7.3 also those in structures.
//!
//! A vector is a column called like its variable; a matrix as long as it is wide or longer gives `name(:,1)`, `name(:,2)` and so
//! on. Structures and cells of v5 to v7 are not read by the `matfile` crate: save their fields as variables.

use super::Series;
use crate::problem::{Problem, Result};
use hdf5_pure::{DType, File, Group};
use matfile::{MatFile, NumericData};
use std::path::Path;

/// What a v7.3 file begins with after MATLAB's own header of 512 bytes; tools that write plain HDF5 have none.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";
/// Numbers that a byte of the file can hold at most: deflate packs a thousand to one. More are damage, and must not be allocated.
const NUMBERS_PER_BYTE: u64 = 1100;
/// Structures within structures that are looked into.
const DEPTH: usize = 4;
/// More columns than this are a picture or a field, no log.
const COLUMNS_MAX: usize = 512;

pub(super) fn read(file: &Path, bytes: Vec<u8>) -> Result<Vec<Series>> {
    let is_hdf5 = [0, 512].iter().any(|at| bytes.get(*at..).is_some_and(|rest| rest.starts_with(HDF5)));
    if is_hdf5 { read_hdf5(file, bytes) } else { read_v5(file, &bytes) }
}

fn damaged<T>(file: &Path, error: impl std::fmt::Display) -> Result<T> {
    Problem::error(file, format!("cannot be read as MATLAB's: {error}"), "save it again from MATLAB with `save -v7`")
        .alone()
}

fn read_v5(file: &Path, bytes: &[u8]) -> Result<Vec<Series>> {
    if !bytes.starts_with(b"MATLAB 5.0") {
        let cure = "save it from MATLAB with `save -v7`; v4 is not read";
        return Problem::error(file, "does not begin as a .mat of version 5 or 7", cure).alone();
    }
    let read = match MatFile::parse(bytes) {
        Ok(read) => read,
        Err(error) => return damaged(file, error),
    };
    let mut all = Vec::new();
    for array in read.arrays() {
        let size: Vec<usize> = array.size().clone();
        if let [rows, columns] = size[..] {
            add(&mut all, array.name(), numbers(array.data()), rows, columns);
        }
    }
    Ok(all)
}

/// Real parts as numbers.
fn numbers(data: &NumericData) -> Vec<f64> {
    match data {
        NumericData::Int8 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt8 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int16 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt16 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int32 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::UInt32 { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Int64 { real, .. } => real.iter().map(|x| *x as f64).collect(),
        NumericData::UInt64 { real, .. } => real.iter().map(|x| *x as f64).collect(),
        NumericData::Single { real, .. } => real.iter().map(|x| f64::from(*x)).collect(),
        NumericData::Double { real, .. } => real.clone(),
    }
}

fn read_hdf5(file: &Path, bytes: Vec<u8>) -> Result<Vec<Series>> {
    let most = NUMBERS_PER_BYTE * bytes.len() as u64;
    let opened = match File::from_bytes(bytes) {
        Ok(opened) => opened,
        Err(error) => return damaged(file, error),
    };
    let mut all = Vec::new();
    match fields(&opened.root(), "", DEPTH, most, &mut all) {
        Ok(()) => Ok(all),
        Err(error) => damaged(file, error),
    }
}

/// The numbers of `group` and of the structures in it, their names beginning with `before`.
fn fields(
    group: &Group,
    before: &str,
    depth: usize,
    most: u64,
    all: &mut Vec<Series>,
) -> std::result::Result<(), hdf5_pure::Error> {
    let mut names = group.datasets()?;
    names.sort();
    for name in names {
        let data = group.dataset(&name)?;
        let (Ok(shape), Ok(kind)) = (data.shape(), data.dtype()) else { continue };
        let count = shape.iter().try_fold(1u64, |count, side| count.checked_mul(*side)).unwrap_or(u64::MAX);
        if !is_number(&kind) || count > most {
            continue;
        }
        // MATLAB's columns are HDF5's rows.
        let Ok(values) = data.read_f64() else { continue };
        if let [columns, rows] = shape[..] {
            let (Ok(rows), Ok(columns)) = (usize::try_from(rows), usize::try_from(columns)) else { continue };
            add(all, &format!("{before}{name}"), values, rows, columns);
        } else if let [rows] = shape[..] {
            add(all, &format!("{before}{name}"), values, usize::try_from(rows).unwrap_or(0), 1);
        }
    }
    let mut groups = group.groups()?;
    groups.sort();
    // `#refs#` and `#subsystem#` are MATLAB's own.
    for name in groups.iter().filter(|name| depth > 0 && !name.starts_with('#')) {
        fields(&group.group(name)?, &format!("{before}{name}."), depth - 1, most, all)?;
    }
    Ok(())
}

fn is_number(kind: &DType) -> bool {
    use DType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    matches!(kind, F32 | F64 | I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64)
}

/// A vector as a column, a matrix as columns; single numbers and pictures are left out.
fn add(all: &mut Vec<Series>, name: &str, values: Vec<f64>, rows: usize, columns: usize) {
    let (rows, columns) = if rows == 1 { (columns, 1) } else { (rows, columns) };
    if rows < 2 || columns == 0 || columns > COLUMNS_MAX || rows.checked_mul(columns) != Some(values.len()) {
        return;
    }
    // The length is all that a variable says of its clock.
    if columns == 1 {
        return all.push(Series { name: name.to_string(), values, clock: rows });
    }
    let of = |(at, column): (usize, &[f64])| Series {
        name: format!("{name}(:,{})", at + 1),
        values: column.to_vec(),
        clock: rows,
    };
    all.extend(values.chunks_exact(rows).enumerate().map(of));
}
