//! How one text log is written: encoding, delimiter, decimal sign, lines before its header.
//!
//! All of it is found from the first lines. A pair of delimiter and decimal sign is judged by how many cells of the sample it makes
//! numbers of: `0,001;1,5` has two with `;` and `,`, and one with `,`. The header is the last row without a number, as wide as
//! the rows of numbers, above the first of these; a row of units between them is passed over, and with it rows of words below it.

use super::csv_file::number;
use super::files::Files;
use crate::units::Unit;
use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use csv::{ReaderBuilder, StringRecord};
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE};
use std::collections::BTreeMap;
use std::fmt;

/// Bytes from which all of it is found.
pub(super) const SAMPLE_BYTES: usize = 1 << 15;
/// Delimiters and decimal signs that are tried; of equals the first.
const PAIRS: [(u8, u8); 8] =
    [(b',', b'.'), (b';', b','), (b';', b'.'), (b'\t', b'.'), (b'\t', b','), (b'|', b'.'), (b' ', b'.'), (b' ', b',')];
/// Lines by which the plain form, commas and points under a header in the first line, is recognised at once.
const PLAIN_LINES: usize = 20;

/// How a text log is written.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dialect {
    pub encoding: &'static Encoding,
    pub delimiter: u8,
    pub decimal: u8,
    /// Lines before the header, or before the numbers where there is none.
    pub skip_rows: usize,
    /// Whether there is a header.
    pub has_header: bool,
    /// Whether a row of units follows the header.
    pub has_units: bool,
    /// Rows of words between the units and the numbers: types, comments.
    pub passed_rows: usize,
    /// Whether any row holds numbers.
    pub has_numbers: bool,
}

impl Dialect {
    /// The dialect of a file that begins with `sample`, as far as `files` does not say it.
    pub fn of(sample: &[u8], files: &Files) -> Self {
        let encoding = files.encoding.unwrap_or_else(|| encoding_of(sample));
        let plain = Self {
            encoding,
            delimiter: b',',
            decimal: b'.',
            skip_rows: 0,
            has_header: true,
            has_units: false,
            passed_rows: 0,
            has_numbers: false,
        };
        let text = plain.decoded(sample);
        let lines = whole_lines(&text, sample.len() >= SAMPLE_BYTES);
        let start: String = lines.lines().take(PLAIN_LINES).fold(String::new(), |text, line| text + line + "\n");
        let (first, numbers) = plain.with(b',', b'.', &start);
        let cells = start.lines().skip(1).map(|line| first.cells(line).len()).sum::<usize>();
        if *files == (Files { rate_hz: files.rate_hz, ..Files::default() }) && numbers == cells && first.is_plain() {
            return first;
        }
        let is_asked = |(delimiter, decimal): &&(u8, u8)| {
            files.delimiter.is_none_or(|set| set == *delimiter) && files.decimal.is_none_or(|set| set == *decimal)
        };
        let mut best = plain.with(files.delimiter.unwrap_or(b','), files.decimal.unwrap_or(b'.'), &lines);
        for (delimiter, decimal) in PAIRS.iter().filter(is_asked) {
            let found = plain.with(*delimiter, *decimal, &lines);
            if found.1 > best.1 {
                best = found;
            }
        }
        let mut dialect = best.0;
        if let Some(rows) = files.skip_rows {
            let under = lines.lines().skip(rows + 1).map(|line| dialect.cells(line)).next();
            (dialect.skip_rows, dialect.has_header, dialect.passed_rows) = (rows, true, 0);
            dialect.has_units = under.is_some_and(|cells| is_units(&cells));
        }
        dialect
    }

    /// This with a delimiter and a decimal sign, its header found, and how many numeric cells `lines` then have.
    fn with(self, delimiter: u8, decimal: u8, lines: &str) -> (Self, usize) {
        let dialect = Self { delimiter, decimal, ..self };
        let rows: Vec<Vec<String>> = lines.lines().map(|line| dialect.cells(line)).collect();
        let numbers: Vec<usize> = rows.iter().map(|cells| dialect.numbers(cells)).collect();
        let mut widths: BTreeMap<usize, usize> = BTreeMap::new();
        for (cells, numbers) in rows.iter().zip(&numbers) {
            *widths.entry(cells.len()).or_default() += numbers;
        }
        let Some((width, count)) = widths.into_iter().max_by_key(|(_, numbers)| *numbers) else { return (dialect, 0) };
        if width < 2 || count == 0 {
            return (dialect, 0);
        }
        let is_wide = |at: &usize| rows[*at].len() == width;
        let usual = median((0..rows.len()).filter(is_wide).map(|at| numbers[at]).filter(|n| *n > 0).collect());
        let Some(first) = (0..rows.len()).filter(is_wide).find(|at| numbers[*at] >= usual) else { return (dialect, 0) };
        // A log has two quantities at least; one number stands in a comment, too.
        if usual < 2 {
            return (dialect, 0);
        }
        let is_named = |at: &usize| rows[*at].iter().any(|cell| !cell.is_empty()) && !is_units(&rows[*at]);
        let above = || (0..first).filter(is_wide).filter(is_named);
        let of_words = || above().rev().filter(|at| numbers[*at] == 0);
        let is_over_units = |at: &usize| rows.get(at + 1).is_some_and(|cells| is_units(cells));
        let over_units = of_words().find(is_over_units);
        let header = over_units.or(of_words().next()).or(above().next().filter(|at| *at == 0));
        let has_units = header.as_ref().is_some_and(is_over_units);
        let is_row = |cells: &&Vec<String>| cells.iter().any(|cell| !cell.is_empty());
        let passed_rows = over_units.map_or(0, |at| rows[(at + 2).min(first)..first].iter().filter(is_row).count());
        let skip_rows = header.or((0..=first).filter(is_wide).find(|at| numbers[*at] > 0)).unwrap_or(0);
        (Self { skip_rows, has_header: header.is_some(), has_units, passed_rows, has_numbers: true, ..dialect }, count)
    }

    fn is_plain(&self) -> bool {
        self.skip_rows == 0 && self.has_header && !self.has_units
    }

    /// The sample as text.
    fn decoded(&self, sample: &[u8]) -> String {
        self.encoding.decode(sample).0.into_owned()
    }

    /// The cells of one line, blanks around them and a sign of comment before the first left out.
    fn cells(&self, line: &str) -> Vec<String> {
        let line = line.trim_start_matches(['#', '%']);
        if self.delimiter == b' ' {
            return line.split_whitespace().map(str::to_string).collect();
        }
        if !line.contains('"') {
            return line.split(char::from(self.delimiter)).map(|cell| cell.trim().to_string()).collect();
        }
        let mut reader = ReaderBuilder::new().has_headers(false).delimiter(self.delimiter).from_reader(line.as_bytes());
        let mut record = StringRecord::new();
        match reader.read_record(&mut record) {
            Ok(true) => record.iter().map(|cell| cell.trim().to_string()).collect(),
            _ => Vec::new(),
        }
    }

    fn numbers(&self, cells: &[String]) -> usize {
        cells.iter().filter(|cell| number(cell.as_bytes(), self.decimal).is_some()).count()
    }
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let delimiter = match self.delimiter {
            b'\t' => "tabs".to_string(),
            b' ' => "blanks".to_string(),
            sign => format!("`{}`", char::from(sign)),
        };
        write!(
            f,
            "text, {delimiter} between fields, decimal {}",
            if self.decimal == b',' { "comma" } else { "point" }
        )?;
        if self.encoding != UTF_8 {
            write!(f, ", {}", self.encoding.name())?;
        }
        match (self.has_header, self.skip_rows) {
            (false, _) => write!(f, ", no header"),
            (true, 0) => Ok(()),
            (true, rows) => write!(f, ", header in row {}", rows + 1),
        }
    }
}

/// What a byte order mark, or the bytes themselves, say: UTF-8 where they are, else what their letters are likeliest in.
fn encoding_of(sample: &[u8]) -> &'static Encoding {
    if let Some((encoding, _)) = Encoding::for_bom(sample) {
        return encoding;
    }
    let zeros = |from: usize| sample.iter().skip(from).step_by(2).take(64).filter(|byte| **byte == 0).count();
    match std::str::from_utf8(sample) {
        _ if sample.len() > 128 && zeros(1) == 64 => UTF_16LE,
        _ if sample.len() > 128 && zeros(0) == 64 => UTF_16BE,
        Ok(_) => UTF_8,
        // The sample may end within a character.
        Err(error) if error.error_len().is_none() => UTF_8,
        Err(_) => {
            let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
            detector.feed(sample, false);
            detector.guess(None, Utf8Detection::Deny)
        }
    }
}

/// `text` up to the end of its last whole line, where it may be cut.
fn whole_lines(text: &str, is_cut: bool) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    match text.rfind('\n').filter(|_| is_cut) {
        Some(end) => text[..end].to_string(),
        None => text.to_string(),
    }
}

/// Whether a row holds units and nothing else, each as it is or in brackets; in brackets a word may stand before them: `Unit;[s];[N m]`.
fn is_units(cells: &[String]) -> bool {
    let told: Vec<&String> = cells.iter().filter(|cell| !cell.is_empty() && cell.as_str() != "-").collect();
    let are_units = |cells: &[&String]| !cells.is_empty() && cells.iter().all(|cell| unit_of_cell(cell).is_some());
    let is_bracketed = |cell: &&String| cell.starts_with(['[', '(']);
    are_units(&told) || told.len() > 2 && told[1..].iter().all(is_bracketed) && are_units(&told[1..])
}

/// The unit that a cell of a row of units names.
pub(super) fn unit_of_cell(cell: &str) -> Option<Unit> {
    Unit::written(cell.trim().trim_matches(['[', ']', '(', ')']))
}

fn median(mut counts: Vec<usize>) -> usize {
    counts.sort_unstable();
    counts.get(counts.len() / 2).copied().unwrap_or(0)
}
