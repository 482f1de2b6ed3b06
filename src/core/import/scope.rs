//! TwinCAT Scope's text export: header lines, then columns in groups, each with its own time.
//!
//! A header line begins each group of columns with its key (`Name`, `SampleTime[ms]`, `Unit` ...): the key stands where the group's
//! times stand below. One group a channel (Timelines: All) or a sample time is alike. Columns are called as `Name` says, the time
//! of each group `time`, in ms from the first row of the file. Tabulators or semicolons go with either point or comma in numbers.
//! Values are taken as they stand: `Offset` and `ScaleFactor` of the header are the display's.
//!
//! There is no checksum. An export with a header tells its end (`Endtime of export`), and its last line is `EOF`: one that has
//! neither its last line nor its last times was cut. A group that was sampled more slowly ends in empty cells, and there alone
//! cells may be empty.

use super::Series;
use crate::limits::{COLUMNS, shown};
use crate::problem::{Problem, Result};
use std::borrow::Cow;
use std::path::Path;

/// Times beyond this are counted in 100 ns since 1601, not in ms since the recording began: it is the year 1604.
const FILE_TIME: f64 = 1e15;
/// Of those in one ms.
const TICKS_PER_MS: f64 = 1e4;
/// Header lines at most: beyond it the file is another's.
const HEADER_MAX: usize = 200;

/// What the header says of the columns.
struct Header {
    /// The first line of numbers, from 0.
    data_from: usize,
    /// How long the export says that it lasts, ms.
    lasts_ms: Option<f64>,
    /// Whether each column is a time, and of which group it is.
    columns: Vec<Column>,
}

struct Column {
    name: String,
    is_time: bool,
    group: usize,
}

/// Whether a file that so begins is an export of the Scope.
pub(super) fn is_export(bytes: &[u8]) -> bool {
    let text = text(bytes);
    text.split(separator(&text)).next().map(unquoted) == Some("Name")
}

fn text(bytes: &[u8]) -> Cow<'_, str> {
    String::from_utf8_lossy(bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes))
}

/// What stands between the cells of the first line.
fn separator(text: &str) -> char {
    let first = text.lines().next().unwrap_or_default();
    ['\t', ';', ','].into_iter().find(|sign| first.contains(*sign)).unwrap_or('\t')
}

/// The channels of `file`.
pub(super) fn read(file: &Path, bytes: &[u8]) -> Result<Vec<Series>> {
    let text = text(bytes);
    let separator = separator(&text);
    if !is_export(bytes) {
        let cure = "its first line begins with `Name`; save another table as .csv with a line of names";
        return Problem::error(file, "is no export of TwinCAT's Scope", cure).alone();
    }
    let lines: Vec<&str> = text.lines().collect();
    let refuse = |what: &str| {
        let cure = "export from Scope View as CSV with its header, Timelines: All or For each sampletime";
        Problem::error(file, what, cure)
    };
    if lines.iter().take(HEADER_MAX).any(|line| line.split(separator).nth(COLUMNS).is_some()) {
        return Err(refuse(&format!("has more than {COLUMNS} columns")).into());
    }
    let Some(header) = Header::read(&lines, separator) else {
        return Err(refuse("begins as TwinCAT Scope's export, and no line of numbers follows a line of names").into());
    };
    let mut all: Vec<Series> = header.columns.iter().map(|column| column.series(header.data_from)).collect();
    let (mut is_whole, mut blank) = (false, None);
    for (row, line) in lines.iter().enumerate().skip(header.data_from) {
        let at = |problem: Problem| problem.at_row(row as u64 + 1);
        if unquoted(line.trim_end_matches(separator)) == "EOF" {
            is_whole = true;
            continue;
        }
        if line.trim().is_empty() {
            blank = Some(row as u64 + 1);
            continue;
        }
        if is_whole || blank.is_some() {
            let what = if is_whole { "goes on behind EOF" } else { "is blank, and numbers follow" };
            return Err(refuse(what).at_row(blank.unwrap_or(row as u64 + 1)).into());
        }
        let mut cells = line.split(separator).map(unquoted);
        for (series, column) in all.iter_mut().zip(&header.columns) {
            let cell = cells.next().unwrap_or_default();
            let value = number(cell, separator).ok_or_else(|| {
                let what = format!("holds `{}`, no number", shown(cell));
                at(refuse(&what)).in_column(&column.name)
            })?;
            series.values.push(value);
        }
        if cells.any(|cell| !cell.is_empty()) {
            return Err(at(refuse("has more numbers than there are names")).into());
        }
    }
    let lasts_ms = header.lasts_ms.filter(|_| !is_whole);
    set_clocks(&mut all, &header.columns, lasts_ms).map_err(|what| refuse(&what))?;
    Ok(all)
}

fn unquoted(cell: &str) -> &str {
    cell.trim().trim_matches('"')
}

/// A number; NaN of an empty cell. A comma is the point where it does not separate cells.
fn number(cell: &str, separator: char) -> Option<f64> {
    match cell {
        "" => Some(f64::NAN),
        "TRUE" | "True" | "true" => Some(1.0),
        "FALSE" | "False" | "false" => Some(0.0),
        _ if separator == ',' => fast_float2::parse(cell).ok(),
        _ => fast_float2::parse(cell.replace(',', ".")).ok(),
    }
}

impl Header {
    fn read(lines: &[&str], separator: char) -> Option<Self> {
        let cells = |line: &str| -> Vec<String> { line.split(separator).map(|c| unquoted(c).to_string()).collect() };
        let is_data = |line: &&str| {
            let first = line.split(separator).next().map_or("", unquoted);
            !first.is_empty() && number(first, separator).is_some()
        };
        let data_from = lines.iter().take(HEADER_MAX).position(is_data)?;
        let names = lines[..data_from].iter().rev().map(|line| cells(line)).find(|cells| cells[0] == "Name")?;
        let (mut group, mut columns) = (0, Vec::new());
        let last = names.iter().rposition(|name| !name.is_empty())?;
        for (at, name) in names[..=last].iter().enumerate() {
            let is_time = name == "Name";
            group += usize::from(is_time && at > 0);
            let name = if is_time { "time".to_string() } else { name.clone() };
            columns.push(Column { name, is_time, group });
        }
        let stamp = |key: &str| -> Option<f64> {
            let line = lines[..data_from].iter().map(|line| cells(line)).find(|cells| cells[0] == key)?;
            number(line.get(1)?, separator)
        };
        let lasts = stamp("Endtime of export").zip(stamp("Starttime of export"));
        let lasts_ms = lasts.map(|(end, start)| (end - start) / TICKS_PER_MS);
        (columns.iter().any(|column| !column.is_time)).then_some(Self { data_from, lasts_ms, columns })
    }
}

impl Column {
    /// The column without its values, which stand below line `data_from`, counted from 0.
    fn series(&self, data_from: usize) -> Series {
        Series { name: self.name.clone(), values: Vec::new(), clock: self.group, first_row: data_from as u64 + 1 }
    }
}

/// Times in ms from the first of the file on, and each group as long as its times.
///
/// Errors: readings beyond the times of their group; all of it ends before it has lasted `lasts_ms`.
fn set_clocks(all: &mut [Series], columns: &[Column], lasts_ms: Option<f64>) -> std::result::Result<(), String> {
    let stamps = |series: &Series| series.values.first().copied().unwrap_or(0.0);
    let times = || columns.iter().enumerate().filter(|(_, column)| column.is_time);
    let start = times().map(|(at, _)| stamps(&all[at])).fold(f64::INFINITY, f64::min);
    let (mut end_ms, mut step_ms) = (0.0f64, 0.0f64);
    for (at, column) in times() {
        // What was recorded more slowly ends in empty cells.
        let rows = all[at].values.iter().rposition(|time| time.is_finite()).map_or(0, |last| last + 1);
        let in_ms = if start > FILE_TIME { 1.0 / TICKS_PER_MS } else { 1.0 };
        all[at].values.iter_mut().for_each(|time| *time = (*time - start) * in_ms);
        let last = all[at].values[..rows].last().copied().unwrap_or(0.0);
        end_ms = end_ms.max(last);
        step_ms = step_ms.max(last / rows.saturating_sub(1).max(1) as f64);
        for series in all.iter_mut().filter(|series| series.clock == column.group) {
            if series.values[rows..].iter().any(|value| value.is_finite()) {
                return Err(format!(
                    "`{}` goes on where its times have ended, in line {}",
                    shown(&series.name),
                    series.first_row + rows as u64
                ));
            }
            series.values.truncate(rows);
        }
    }
    match lasts_ms {
        // The end is that of the last sample, or one sample later.
        Some(lasts_ms) if end_ms + 2.0 * step_ms < lasts_ms => {
            Err(format!("ends after {end_ms} ms of {lasts_ms} ms, without its last line `EOF`: it was cut"))
        }
        _ => Ok(()),
    }
}
