//! Of a file's columns, those that a campaign names, on one clock.

use super::Series;
use crate::document::suggest;
use crate::limits::{FAULTS_LISTED, listed, shown};
use crate::problem::{Problem, Problems, Result};
use std::path::Path;

/// Two clocks are one where their stamps differ by less than this share of the last.
const SAME_CLOCK: f64 = 1e-9;

/// The columns that were asked for, all of one length, every reading finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Picked {
    /// One for each name, in their order.
    pub columns: Vec<Vec<f64>>,
    /// What was left out, and why.
    pub warnings: Vec<Problem>,
}

/// The columns of `names` among `all` of `file`, `names[0]` being the time. Rows at the end that hold no reading at all, as
/// MATLAB and Scope fill up what was recorded more briefly, are left out, which is a warning.
///
/// Errors: a column that the file does not have, or has twice; columns on different clocks; a reading that is missing or not
/// finite, by row and column; no two rows.
pub fn picked(file: &Path, all: &[Series], names: &[&str]) -> Result<Picked> {
    let mut problems = Vec::new();
    let mut found: Vec<&Series> = Vec::new();
    for name in names {
        // A name that several clocks share (`time`) is the one of the columns found with it.
        let mut of_name = all.iter().filter(|series| series.name == *name);
        match of_name.next() {
            Some(series) if of_name.any(|other| other.clock == series.clock) => {
                let what = "this column is there twice";
                problems
                    .push(Problem::error(file, what, "rename one of the two where it was recorded").in_column(*name));
            }
            Some(series) => found.push(series),
            None => problems.push(lacking(file, name, all)),
        }
    }
    Problems(problems).unless_errors(())?;
    if found.is_empty() {
        return Problem::error(file, "no column of it is named", "name time, position and torque").alone();
    }
    let clock = found.get(1).map_or(0, |position| position.clock);
    if let Some(time) = all.iter().find(|series| series.clock == clock && Some(&series.name.as_str()) == names.first())
    {
        found[0] = time;
    }
    on_one_clock(file, all, &found)?;
    let rows = found[0].values.len();
    let holds_reading = |row: &usize| found[1..].iter().any(|series| !series.values[*row].is_nan());
    let end = (0..rows).rev().find(holds_reading).map_or(0, |last| last + 1);
    Problems(found.iter().flat_map(|series| holes(file, series, end)).collect()).unless_errors(())?;
    if end < 2 {
        let what = format!("{end} of its {rows} rows hold all of {}", listed(names.iter().copied()));
        return Problem::error(file, what, "name columns that were recorded together").alone();
    }
    let columns = found.iter().map(|series| series.values[..end].to_vec()).collect();
    Ok(Picked { columns, warnings: (end < rows).then(|| left_out(file, found[0], end)).into_iter().collect() })
}

/// The readings before `end` that are missing or not finite, by row.
fn holes(file: &Path, series: &Series, end: usize) -> Vec<Problem> {
    let mut holes = series.values[..end].iter().enumerate().filter(|(_, value)| !value.is_finite());
    let one = |(row, value): (usize, &f64)| {
        let what = if value.is_nan() { "holds no number (empty or NaN)".to_string() } else { format!("holds {value}") };
        let cure = "mend or cut the recording there: only rows without any reading, at its end, are left out";
        Problem::error(file, what, cure).at_row(series.first_row + row as u64).in_column(shown(&series.name))
    };
    let mut problems: Vec<Problem> = holes.by_ref().take(FAULTS_LISTED).map(one).collect();
    match holes.count() {
        0 => {}
        more => {
            let what = format!("and {more} more rows with no number");
            problems.push(Problem::error(file, what, "").in_column(shown(&series.name)));
        }
    }
    problems
}

fn left_out(file: &Path, time: &Series, end: usize) -> Problem {
    let rows = time.values.len();
    let what = format!("the last {} of {rows} rows hold no reading", rows - end);
    let cure = "they are left out; check that the recording was not cut short";
    Problem::warning(file, what, cure).at_row(time.first_row + end as u64)
}

fn lacking(file: &Path, name: &str, all: &[Series]) -> Problem {
    let names = all.iter().map(|series| series.name.as_str());
    let cure = match all.len() {
        0 => "it holds no column of numbers".to_string(),
        1..=20 => suggest(name, "it has", names),
        _ => match crate::document::nearest(name, names) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("it has {} others; `tautline import --list` shows them", all.len()),
        },
    };
    Problem::error(file, format!("has no column `{}`", shown(name)), cure)
}

/// Errors: columns that were not sampled together.
fn on_one_clock(file: &Path, all: &[Series], found: &[&Series]) -> Result<()> {
    let time = found[0];
    let stamps = |clock: usize| all.iter().find(|series| series.clock == clock && series.name == time.name);
    let same = |series: &&Series| {
        series.values.len() == time.values.len()
            && (series.clock == time.clock
                || stamps(series.clock).is_some_and(|other| {
                    let within = SAME_CLOCK * time.values.last().copied().unwrap_or(0.0).abs();
                    other.values.iter().zip(&time.values).all(|(a, b)| (a - b).abs() <= within)
                }))
    };
    match found.iter().find(|series| !same(series)) {
        None => Ok(()),
        Some(other) => {
            let what = format!(
                "`{}` has {} rows of another clock than `{}` with {}",
                other.name,
                other.values.len(),
                time.name,
                time.values.len()
            );
            Problem::error(file, what, "export the columns with one common sample time").alone()
        }
    }
}
