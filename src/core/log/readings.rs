//! What a reader of one file format hands over, and how it complains.

use super::columns::Wanted;
use crate::document::nearest;
use crate::limits::{COLUMNS, FAULTS_LISTED, listed};
use crate::problem::{Problem, Result};
use std::path::Path;

/// The wanted columns of one log, as recorded: in the file's units.
#[derive(Debug)]
pub(super) struct Readings {
    /// One per wanted column, in that order, all of one length. NaN where the file holds no number, which was reported;
    /// NaN throughout where it has no such column.
    pub columns: Vec<Vec<f64>>,
    /// Where each sample stands in the file.
    pub rows: Rows,
}

impl Readings {
    /// Draws a straight line across the cells that hold no number; false where a column holds none at all.
    pub fn bridge_holes(&mut self) -> bool {
        self.columns.iter_mut().all(|column| bridge(column))
    }
}

fn bridge(column: &mut [f64]) -> bool {
    let known: Vec<usize> = (0..column.len()).filter(|sample| column[*sample].is_finite()).collect();
    let (Some(first), Some(last)) = (known.first(), known.last()) else { return false };
    let (start, end) = (column[*first], column[*last]);
    column[..*first].fill(start);
    column[*last..].fill(end);
    for pair in known.windows(2) {
        let (low, step) = (column[pair[0]], (column[pair[1]] - column[pair[0]]) / (pair[1] - pair[0]) as f64);
        (pair[0] + 1..pair[1]).for_each(|sample| column[sample] = low + step * (sample - pair[0]) as f64);
    }
    true
}

/// Turns a sample's place in its column into its row in the file, without storing a number per sample.
#[derive(Debug, Default)]
pub(super) struct Rows {
    /// From this sample on, a row is the sample plus this. Blank rows make a new entry.
    shifts: Vec<(usize, u64)>,
}

impl Rows {
    /// A table without blank rows, under a header in row 1, from its data row `start` on.
    pub fn from(start: usize) -> Self {
        Self { shifts: vec![(0, 2 + start as u64)] }
    }

    /// Notes that `sample` stands in `row`; samples come in order.
    pub fn note(&mut self, sample: usize, row: u64) {
        let shift = row - sample as u64;
        if self.shifts.last().is_none_or(|(_, last)| *last != shift) {
            self.shifts.push((sample, shift));
        }
    }

    /// The row of `sample`.
    pub fn of(&self, sample: usize) -> u64 {
        let after = self.shifts.partition_point(|(first, _)| *first <= sample);
        sample as u64 + after.checked_sub(1).map_or(0, |index| self.shifts[index].1)
    }
}

/// The faults of one file.
pub(super) struct Faults<'a> {
    file: &'a Path,
    problems: Vec<Problem>,
    counts: Vec<(&'static str, usize)>,
}

impl<'a> Faults<'a> {
    pub fn of(file: &'a Path) -> Self {
        Self { file, problems: Vec::new(), counts: Vec::new() }
    }

    /// Adds a fault: `kind` groups its like and finishes the sentence "and 7 more rows with ...".
    pub fn add(&mut self, kind: &'static str, fault: impl FnOnce(&Path) -> Problem) {
        let count = match self.counts.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, count)) => count,
            None => {
                self.counts.push((kind, 0));
                let last = self.counts.len() - 1;
                &mut self.counts[last].1
            }
        };
        *count += 1;
        if *count <= FAULTS_LISTED {
            self.problems.push(fault(self.file));
        }
    }

    /// How many were found so far.
    pub fn count(&self) -> usize {
        self.counts.iter().map(|(_, count)| count).sum()
    }

    /// Everything that was found.
    pub fn into_problems(mut self) -> Vec<Problem> {
        for (kind, count) in self.counts.iter().filter(|(_, count)| *count > FAULTS_LISTED) {
            let what = format!("and {} more rows with {kind}", count - FAULTS_LISTED);
            self.problems.push(Problem::error(self.file, what, ""));
        }
        self.problems
    }
}

/// Errors: more columns than any log has.
pub(super) fn check_width(file: &Path, columns: usize) -> Result<()> {
    if columns <= COLUMNS {
        return Ok(());
    }
    let what = format!("has {columns} columns, more than the {COLUMNS} that a table may have");
    Problem::error(file, what, "export the columns that the campaign names").at_row(1).alone()
}

/// Where each of the `wanted` columns stands in a file with these `names`; none where it is missing, or there twice.
pub(super) fn locate(names: &[String], wanted: &[Wanted], faults: &mut Faults<'_>) -> Vec<Option<usize>> {
    let mut place = |want: &Wanted| {
        if want.rate_hz.is_some() {
            return None;
        }
        let name = &want.column.name;
        let mut found = names.iter().enumerate().filter(|(_, other)| *other == name).map(|(place, _)| place);
        match (found.next(), found.next()) {
            (Some(place), None) => return Some(place),
            (Some(_), Some(_)) => faults.add("a column twice", |file| {
                Problem::error(file, "this column is there twice", "rename one of the two").at_row(1).in_column(name)
            }),
            (None, _) => faults.add("a missing column", |file| missing(file, names, want)),
        }
        None
    };
    wanted.iter().map(&mut place).collect()
}

fn missing(file: &Path, names: &[String], want: &Wanted) -> Problem {
    let name = &want.column.name;
    let is_numbered = |(at, name): (usize, &String)| *name == format!("column_{}", at + 1);
    let cure = if !names.is_empty() && names.iter().enumerate().all(is_numbered) {
        let last = names.len();
        format!(
            "the first row holds numbers: add a header with the columns' names, or call them column_1 to column_{last}"
        )
    } else {
        let all = names.iter().map(String::as_str);
        let hint = match nearest(name, all.clone()) {
            Some(near) => format!("did you mean `{near}`? The file holds: {}", listed(all)),
            None => format!("the file holds: {}", listed(all)),
        };
        format!("{hint}; correct columns.{} in campaign.toml", want.key)
    };
    Problem::error(file, format!("there is no such column, wanted as {}", want.key), cure).at_row(1).in_column(name)
}
