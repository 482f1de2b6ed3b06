//! MATLAB `.mat`: vectors and matrices of numbers; of v7.3 also those in structures.
//!
//! A vector is a column called like its variable; a matrix as long as it is wide or longer gives `name(:,1)`, `name(:,2)` and so
//! on. Structures and cells of v5 to v7 are not read: save their fields as variables. Of v7.3, HDF5's checksums of metadata and
//! (where a variable has one) the Fletcher-32 of its data are verified.

use super::{Series, mat5};
use crate::limits::{Budget, HDF5_LINKS, HDF5_READ_BYTES, HDF5_READ_PER_BYTE, MATRIX_COLUMNS, STRUCTURE_DEPTH, shown};
use crate::problem::{Problem, Result};
use hdf5_pure::{DType, Dataset, Error, File, FormatError, Group, Layout, Source};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// What a v7.3 file begins with after MATLAB's own header of 512 bytes; tools that write plain HDF5 have none.
const HDF5: &[u8] = b"\x89HDF\r\n\x1a\n";

pub(super) fn read(file: &Path, bytes: Vec<u8>) -> Result<Vec<Series>> {
    let is_hdf5 = [0, 512].iter().any(|at| bytes.get(*at..).is_some_and(|rest| rest.starts_with(HDF5)));
    if is_hdf5 { read_hdf5(file, bytes) } else { mat5::read(file, &bytes) }
}

fn read_hdf5(file: &Path, bytes: Vec<u8>) -> Result<Vec<Series>> {
    let file_bytes = bytes.len() as u64;
    let mut walk = Walk { budget: Budget::of_file(file_bytes), file_bytes, links: 0, all: Vec::new() };
    let opened = File::from_source(Metered::of(bytes)).map_err(|error| error.to_string());
    match opened.and_then(|opened| walk.fields(&opened.root(), "", STRUCTURE_DEPTH)) {
        Ok(()) => Ok(walk.all),
        Err(error) => {
            let cure = "save it again from MATLAB with `save -v7`, only what the campaign needs";
            Problem::error(file, format!("cannot be read as MATLAB's: {error}"), cure).alone()
        }
    }
}

/// A file's bytes, of which only so many are given: structures that refer to each other could be read without end.
struct Metered {
    bytes: Vec<u8>,
    left: AtomicU64,
}

impl Metered {
    fn of(bytes: Vec<u8>) -> Self {
        let left = HDF5_READ_BYTES.saturating_add(HDF5_READ_PER_BYTE.saturating_mul(bytes.len() as u64));
        Self { bytes, left: AtomicU64::new(left) }
    }
}

impl Source for Metered {
    fn len(&self) -> u64 {
        self.bytes.len() as u64
    }

    fn read_at(&self, offset: u64, buffer: &mut [u8]) -> std::result::Result<(), FormatError> {
        let length = buffer.len() as u64;
        let take = |left: u64| left.checked_sub(length);
        self.left
            .fetch_update(Ordering::Relaxed, Ordering::Relaxed, take)
            .map_err(|_| FormatError::Source("its structures refer to each other without end".to_string()))?;
        let from = usize::try_from(offset).unwrap_or(usize::MAX);
        let found = from.checked_add(buffer.len()).and_then(|to| self.bytes.get(from..to));
        buffer.copy_from_slice(found.ok_or(FormatError::Source("it is cut off".to_string()))?);
        Ok(())
    }
}

/// Going through the structures of a file.
struct Walk {
    budget: Budget,
    file_bytes: u64,
    /// Names looked at so far: hard links can make a group a part of itself.
    links: usize,
    all: Vec<Series>,
}

impl Walk {
    /// The numbers of `group` and of the structures in it, their names beginning with `before`.
    fn fields(&mut self, group: &Group, before: &str, depth: usize) -> std::result::Result<(), String> {
        let told = |error: Error| error.to_string();
        let (mut names, mut groups) = (group.datasets().map_err(told)?, group.groups().map_err(told)?);
        self.links += names.len() + groups.len();
        if self.links > HDF5_LINKS {
            return Err(format!("it links to more than {HDF5_LINKS} variables and structures"));
        }
        names.sort();
        for name in names {
            let called = format!("{before}{name}");
            let data = group.dataset(&name).map_err(|error| format!("`{}`: {error}", shown(&called)))?;
            self.variable(&called, &data).map_err(|what| format!("`{}`: {what}", shown(&called)))?;
        }
        groups.sort();
        // `#refs#` and `#subsystem#` are MATLAB's own.
        for name in groups.iter().filter(|name| depth > 0 && !name.starts_with('#')) {
            let inner = group.group(name).map_err(told)?;
            self.fields(&inner, &format!("{before}{name}."), depth - 1)?;
        }
        Ok(())
    }

    fn variable(&mut self, name: &str, data: &Dataset) -> std::result::Result<(), String> {
        let (Ok(shape), Ok(kind)) = (data.shape(), data.dtype()) else { return Ok(()) };
        // MATLAB's columns are HDF5's rows.
        let (columns, rows) = match shape[..] {
            [columns, rows] => (columns, rows),
            [rows] => (1, rows),
            _ => return Ok(()),
        };
        if !is_number(&kind) {
            return Ok(());
        }
        self.budget.take_numbers(unpacked(data, &shape))?;
        within(data, self.file_bytes)?;
        match data.read_f64() {
            Ok(values) => {
                let size = |side: u64| usize::try_from(side).unwrap_or(0);
                add(&mut self.all, name, values, size(rows), size(columns));
                Ok(())
            }
            // Compressed by a filter that only its writer has: unsupported.
            Err(Error::Format(FormatError::UnsupportedFilter(_) | FormatError::UnsupportedZfp(_))) => Ok(()),
            Err(error) => Err(error.to_string()),
        }
    }
}

/// Numbers that are unpacked on the way to those of a `shape`: of chunks at its edges more than it holds.
fn unpacked(data: &Dataset, shape: &[u64]) -> u64 {
    let chunk = data.chunk_shape().ok().flatten().unwrap_or_default();
    let side = |(at, side): (usize, &u64)| match chunk.get(at) {
        Some(step) if *step > 0 => side.div_ceil(*step).saturating_mul(*step),
        _ => *side,
    };
    shape.iter().enumerate().map(side).fold(1, u64::saturating_mul)
}

/// Errors: stored numbers of which the file's own structures say that they lie beyond its end. The reader makes room for a
/// chunk of the size that is declared, up to 4 GB, before it looks whether the file holds it.
fn within(data: &Dataset, file_bytes: u64) -> std::result::Result<(), String> {
    let told = |error: Error| error.to_string();
    let beyond = |from: u64, size: u64| from.checked_add(size).is_none_or(|end| end > file_bytes);
    let is_cut_off = match data.layout().map_err(told)? {
        Layout::Chunked { .. } => {
            data.chunks().map_err(told)?.iter().any(|chunk| beyond(chunk.address, chunk.storage_size))
        }
        Layout::Contiguous { address: Some(address), size } => beyond(address, size),
        _ => false,
    };
    if is_cut_off { Err("the file declares more of it than it holds".to_string()) } else { Ok(()) }
}

fn is_number(kind: &DType) -> bool {
    use DType::{F32, F64, I8, I16, I32, I64, U8, U16, U32, U64};
    matches!(kind, F32 | F64 | I8 | I16 | I32 | I64 | U8 | U16 | U32 | U64)
}

/// A vector as a column, a matrix as columns; single numbers and pictures are left out.
pub(super) fn add(all: &mut Vec<Series>, name: &str, values: Vec<f64>, rows: usize, columns: usize) {
    let (rows, columns) = if rows == 1 { (columns, 1) } else { (rows, columns) };
    if rows < 2 || columns == 0 || columns > MATRIX_COLUMNS || rows.checked_mul(columns) != Some(values.len()) {
        return;
    }
    // The length is all that a variable says of its clock.
    if columns == 1 {
        return all.push(Series { name: name.to_string(), values, clock: rows, first_row: 1 });
    }
    let of = |(at, column): (usize, &[f64])| Series {
        name: format!("{name}(:,{})", at + 1),
        values: column.to_vec(),
        clock: rows,
        first_row: 1,
    };
    all.extend(values.chunks_exact(rows).enumerate().map(of));
}
