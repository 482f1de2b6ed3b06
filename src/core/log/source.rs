//! The bytes of a table on their way to the CSV parser: a row that never ends and NUL bytes stop here.

use crate::limits::LINE_BYTES;
use crate::problem::Problem;
use std::cell::Cell;
use std::fmt;
use std::io::{self, Read};
use std::path::Path;

/// A stream that gives no row longer than [`LINE_BYTES`] and no NUL byte: either ends it with [`Damage`].
pub(super) struct Source<R> {
    stream: R,
    /// Bytes given since the parser began its row; it reads ahead by no more than its buffer.
    in_row: Cell<usize>,
    is_over: bool,
}

/// Why a stream ends early.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Damage {
    Nul,
    Endless,
}

impl<R> Source<R> {
    pub fn new(stream: R) -> Self {
        Self { stream, in_row: Cell::new(0), is_over: false }
    }

    /// Notes that the parser has a row whole.
    pub fn row_ends(&self) {
        self.in_row.set(0);
    }
}

impl<R: Read> Read for Source<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.is_over {
            return Err(io::Error::other(Damage::Nul));
        }
        let given = self.stream.read(buffer)?;
        let in_row = self.in_row.get() + given;
        self.in_row.set(in_row);
        if let Some(before) = memchr::memchr(0, &buffer[..given]) {
            // What stands before it is whole, and is read first.
            self.is_over = true;
            return if before == 0 { Err(io::Error::other(Damage::Nul)) } else { Ok(before) };
        }
        if in_row > LINE_BYTES + buffer.len() {
            return Err(io::Error::other(Damage::Endless));
        }
        Ok(given)
    }
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nul => write!(f, "NUL bytes begin here, which no text holds"),
            Self::Endless => write!(f, "the row is longer than {} MB", LINE_BYTES >> 20),
        }
    }
}

impl std::error::Error for Damage {}

/// The problem that the parser's `error` is, in the `row` after the last whole one.
pub(super) fn problem(file: &Path, error: &csv::Error, row: u64) -> Problem {
    let damage = match error.kind() {
        csv::ErrorKind::Io(error) => error.get_ref().and_then(|error| error.downcast_ref::<Damage>()),
        _ => None,
    };
    let cure = match damage {
        Some(Damage::Nul) if row == 1 => {
            "a power cut leaves such files: record again; UTF-16 (Excel's `Unicode text`) is to be saved as CSV UTF-8"
        }
        Some(Damage::Nul) => "a power cut leaves such files: delete everything from this row on, or record again",
        Some(Damage::Endless) => "put each sample on a line of its own, and close every quote",
        None => {
            let what = format!("cannot be read: {error}");
            return Problem::error(file, what, "check the path and its permissions");
        }
    };
    Problem::error(file, damage.map(ToString::to_string).unwrap_or_default(), cure).at_row(row)
}
