//! CSV -> readings: only the wanted columns are parsed, straight into their vectors.

use super::blanks::Squeezed;
use super::columns::Wanted;
use super::dialect::{Dialect, SAMPLE_BYTES};
use super::files::Files;
use super::readings::{Faults, Readings, Rows, check_width, locate};
use super::source::{self, Source};
use super::stamp;
use crate::limits::{LINE_BYTES, shown};
use crate::problem::{Problem, Result};
use csv::{ByteRecord, Reader, ReaderBuilder};
use encoding_rs::UTF_8;
use encoding_rs_io::DecodeReaderBytesBuilder;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::ops::Range;
use std::path::Path;

/// Bytes asked of the disk at a time: large enough that system calls do not count, small enough for the cache.
const BUFFER_BYTES: usize = 1 << 18;
/// Rows after which the rest of the file is estimated.
const ROWS_SEEN: usize = 64;

/// Reads the wanted columns of `file`, written as `files` says, its data `rows` alone where these are given; of one that
/// `broke_off` only whole rows. Missing columns, rows of unequal length, and every field that is no finite number go to
/// `faults`, by row and column.
///
/// Errors: the file cannot be read as a table at all.
pub(super) fn read(
    file: &Path,
    files: &Files,
    rows: Option<&Range<usize>>,
    broke_off: bool,
    wanted: &[Wanted],
    faults: &mut Faults<'_>,
) -> Result<Readings> {
    let Table { mut records, dialect, names, length, .. } = Table::open(file, files, broke_off)?;
    let places = locate(&names, wanted, faults);
    let mut record = ByteRecord::new();
    let mut columns = vec![Vec::new(); wanted.len()];
    let mut in_file = Rows::default();
    let within = rows.cloned().unwrap_or(0..usize::MAX);
    let mut sample = 0;
    while sample < within.end && records.next(file, &mut record)? {
        let row = records.row;
        let at = sample;
        sample += 1;
        if !within.contains(&at) {
            continue;
        }
        let is_ragged = record.len() != names.len();
        if is_ragged {
            faults.add("another number of fields", |file| ragged(file, &record, names.len()).at_row(row));
        }
        for ((column, place), want) in columns.iter_mut().zip(&places).zip(wanted) {
            if want.rate_hz.is_some() {
                column.push(at as f64);
                continue;
            }
            // In a ragged row the fields cannot be assigned to columns.
            let field = place.filter(|_| !is_ragged).map(|place| &record[place]);
            column.push(field.map_or(f64::NAN, |field| {
                number(field, dialect.decimal).or_else(|| stamp::reading(field, want)).unwrap_or_else(|| {
                    faults.add("no number", |file| no_number(file, field, want).at_row(row));
                    f64::NAN
                })
            }));
        }
        in_file.note(at - within.start, row);
        if sample == ROWS_SEEN && rows.is_none() {
            reserve(&mut columns, length, records.bytes());
        }
    }
    Ok(Readings { columns, rows: in_file })
}

/// A table whose header was read.
pub(super) struct Table {
    pub records: Records,
    pub dialect: Dialect,
    /// The columns' names; `column_1`, `column_2`, ... where there is no header.
    pub names: Vec<String>,
    /// What a row of units under the header says of each.
    pub units: Vec<String>,
    /// Bytes of the file.
    pub length: u64,
}

impl Table {
    /// Opens `file`, written as `files` says. Errors: it cannot be read, is empty, or is wider than any log.
    pub fn open(file: &Path, files: &Files, broke_off: bool) -> Result<Self> {
        let (source, length, dialect) = open(file, files, broke_off)?;
        let mut records = Records::new(source, &dialect);
        let mut record = ByteRecord::new();
        if !dialect.has_header {
            let names = numbered(width(file, files, &dialect)?);
            check_width(file, names.len())?;
            return Ok(Self { records, dialect, names, units: Vec::new(), length });
        }
        if !records.next(file, &mut record)? {
            return Problem::error(file, "is empty", "record it again, or delete its trial").alone();
        }
        // Where its columns are wrong, or written in another way, is told row by row.
        if !dialect.has_numbers && length <= SAMPLE_BYTES as u64 {
            return Problem::error(file, "holds no row of numbers", "record it again, or delete its trial").alone();
        }
        check_width(file, record.len())?;
        let names: Vec<String> = record.iter().map(name).collect();
        let mut units = Vec::new();
        if dialect.has_units && records.next(file, &mut record)? {
            units = record.iter().map(name).collect();
        }
        for _ in 0..dialect.passed_rows {
            records.next(file, &mut record)?;
        }
        Ok(Self { records, dialect, names, units, length })
    }
}

/// The names of `count` columns without a header.
fn numbered(count: usize) -> Vec<String> {
    (1..=count).map(|number| format!("column_{number}")).collect()
}

/// How many columns the first row of numbers has.
fn width(file: &Path, files: &Files, dialect: &Dialect) -> Result<usize> {
    let (source, ..) = open(file, files, false)?;
    let mut record = ByteRecord::new();
    Records::new(source, dialect).next(file, &mut record)?;
    Ok(record.len())
}

/// The text of `file` from its header on, how long the file is, and how it is written.
fn open(file: &Path, files: &Files, broke_off: bool) -> Result<(Box<dyn Read>, u64, Dialect)> {
    let opened = || -> io::Result<(Box<dyn Read>, u64, Dialect)> {
        let mut source = File::open(file)?;
        let length = if broke_off { whole_rows(&mut source)? } else { source.metadata()?.len() };
        let mut sample = Vec::with_capacity(SAMPLE_BYTES);
        (&source).take(length.min(SAMPLE_BYTES as u64)).read_to_end(&mut sample)?;
        source.rewind()?;
        let dialect = Dialect::of(&sample, files);
        // A log that grows while it is read is read as long as it was.
        let source = source.take(length);
        let text: Box<dyn Read> = match dialect.encoding {
            encoding if encoding == UTF_8 => Box::new(source),
            other => Box::new(DecodeReaderBytesBuilder::new().encoding(Some(other)).build(source)),
        };
        Ok((beyond(text, &dialect)?, length, dialect))
    };
    match opened() {
        Ok(opened) => Ok(opened),
        Err(error) => unreadable(file, &error),
    }
}

/// `text` beyond the lines before the header, and beyond a sign of comment before it.
fn beyond(text: Box<dyn Read>, dialect: &Dialect) -> io::Result<Box<dyn Read>> {
    if dialect.skip_rows == 0 && dialect.delimiter != b' ' {
        return Ok(text);
    }
    let mut text = BufReader::with_capacity(BUFFER_BYTES, text);
    let mut line = Vec::new();
    for _ in 0..dialect.skip_rows {
        line.clear();
        (&mut text).take(LINE_BYTES as u64).read_until(b'\n', &mut line)?;
    }
    // Of a header of `# time position` the sign would be a column.
    while dialect.has_header && text.fill_buf()?.first().is_some_and(|byte| b"#% ".contains(byte)) {
        text.consume(1);
    }
    match dialect.delimiter {
        b' ' => Ok(Box::new(Squeezed::new(text))),
        _ => Ok(Box::new(text)),
    }
}

/// Bytes up to the end of the last whole row: a recorder that was killed leaves part of one, a power cut zeros.
fn whole_rows(source: &mut File) -> io::Result<u64> {
    let mut bytes = Vec::new();
    source.read_to_end(&mut bytes)?;
    source.rewind()?;
    let written = bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len());
    Ok(bytes[..written].iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last as u64 + 1))
}

fn unreadable<T>(file: &Path, error: &dyn std::error::Error) -> Result<T> {
    Problem::error(file, format!("cannot be read: {error}"), "check the path and its permissions").alone()
}

/// The records of a file, with the row at which each begins: the csv crate's own count stands before blank rows.
pub(super) struct Records {
    reader: Reader<Source<Box<dyn Read>>>,
    /// Row of the last record, counted from 1.
    pub row: u64,
    /// Line breaks inside quotes of the last record, which belong to its row.
    inside: u64,
}

impl Records {
    fn new(source: Box<dyn Read>, dialect: &Dialect) -> Self {
        // Flexible, so that ragged rows are ours to report, all of them.
        let mut builder = ReaderBuilder::new();
        builder.delimiter(dialect.delimiter);
        let reader = builder.has_headers(false).flexible(true).buffer_capacity(BUFFER_BYTES);
        let reader = reader.from_reader(Source::new(source));
        Self { reader, row: dialect.skip_rows as u64, inside: 0 }
    }

    /// Reads the next record, if there is one.
    pub fn next(&mut self, file: &Path, record: &mut ByteRecord) -> Result<bool> {
        let before = self.reader.position().line();
        match self.reader.read_byte_record(record) {
            Ok(false) => return Ok(false),
            Ok(true) => {}
            Err(error) => return source::problem(file, &error, self.row + self.inside + 1).alone(),
        }
        self.reader.get_ref().row_ends();
        self.row += 1 + self.inside;
        self.inside = 0;
        // A plain record passes one line break at most: its own, or (where rows end in two bytes) the one before.
        let passed = self.reader.position().line() - before;
        if passed > 1 {
            self.inside = record.as_slice().iter().filter(|&&byte| byte == b'\n').count() as u64;
            self.row += (passed - 1).saturating_sub(self.inside);
        }
        Ok(true)
    }

    /// Bytes read so far.
    fn bytes(&self) -> u64 {
        self.reader.position().byte()
    }
}

/// Makes room for the rest of a file of `length` bytes, judging by the first `bytes` of it.
fn reserve(columns: &mut [Vec<f64>], length: u64, bytes: u64) {
    let rows_per_byte = ROWS_SEEN as f64 / bytes.max(1) as f64;
    // Rows grow shorter or longer along a file, by a digit or a sign.
    let more = (1.05 * rows_per_byte * length as f64) as usize;
    columns.iter_mut().for_each(|column| column.reserve(more));
}

/// The text of a field of a header.
pub(super) fn name(field: &[u8]) -> String {
    String::from_utf8_lossy(field).trim().trim_start_matches(['#', '%']).trim().to_string()
}

/// The finite number in `field`, blanks around it allowed, its decimal sign a point or a comma.
#[inline(always)]
pub(super) fn number(field: &[u8], decimal: u8) -> Option<f64> {
    if decimal == b'.' { point_number(field) } else { comma_number(field) }
}

/// Longest number that is read with a decimal comma.
const COMMA_DIGITS: usize = 64;

fn comma_number(field: &[u8]) -> Option<f64> {
    let mut text = [0; COMMA_DIGITS];
    let text = text.get_mut(..field.len())?;
    text.copy_from_slice(field);
    // A point would be a separator of thousands, which nobody writes into logs on purpose.
    if text.contains(&b'.') {
        return None;
    }
    text.iter_mut().filter(|byte| **byte == b',').for_each(|byte| *byte = b'.');
    point_number(text)
}

#[inline(always)]
fn point_number(field: &[u8]) -> Option<f64> {
    if let Some(number) = plain_decimal(field) {
        return Some(number);
    }
    let parsed: Option<f64> = match fast_float2::parse(field) {
        Ok(number) => Some(number),
        Err(_) => fast_float2::parse(field.trim_ascii()).ok(),
    };
    parsed.filter(|number| number.is_finite())
}

/// The number in a field like `-12.345678`, the common case, at half the time of the general parser.
///
/// With at most 15 digits both the digits and the power of ten are exact as f64, so that one division rounds correctly
/// (Clinger, How to read floating point numbers accurately, 1990). `None` leaves the field to the general parser.
#[inline(always)]
fn plain_decimal(field: &[u8]) -> Option<f64> {
    const POWERS: [f64; 16] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    let (negative, text) = match field.split_first() {
        Some((b'-', rest)) => (true, rest),
        _ => (false, field),
    };
    // A point between digits, 15 of them at most.
    if text.len() > 16 {
        return None;
    }
    let (whole, rest) = digits_of(0, text);
    let (digits, end) = digits_of(whole, rest.strip_prefix(b".")?);
    let decimals = rest.len() - 1;
    let has_both = rest.len() < text.len() && decimals > 0 && end.is_empty();
    let magnitude = digits as f64 / POWERS.get(decimals).filter(|_| has_both)?;
    Some(if negative { -magnitude } else { magnitude })
}

/// The number `before` with the digits that `text` begins with behind it, and the rest of `text`.
#[inline(always)]
fn digits_of(mut before: u64, mut text: &[u8]) -> (u64, &[u8]) {
    while let [digit @ b'0'..=b'9', rest @ ..] = text {
        before = 10 * before + u64::from(digit - b'0');
        text = rest;
    }
    (before, text)
}

pub(super) fn ragged(file: &Path, record: &ByteRecord, expected: usize) -> Problem {
    let cure = "repair or delete the row; a last row cut short means that recording broke off";
    let what = match record.as_slice().contains(&b'\n') {
        true => "a quote opens here and is not closed in this row".to_string(),
        false => format!("{} fields where the header has {expected}", record.len()),
    };
    Problem::error(file, what, cure)
}

pub(super) fn no_number(file: &Path, field: &[u8], want: &Wanted) -> Problem {
    let text = String::from_utf8_lossy(field);
    let what = match text.trim() {
        "" => "is empty".to_string(),
        found => format!("holds `{}`", shown(found).escape_debug()),
    };
    let cure = format!("expected a number in {}; repair or delete the row", want.column.unit.name());
    Problem::error(file, what, cure).in_column(&want.column.name)
}
