//! Of a file's columns, those that a campaign names, on one clock.

use super::Series;
use crate::document::suggest;
use crate::problem::{Problem, Problems, Result};
use std::path::Path;

/// Two clocks are one where their stamps differ by less than this share of the last.
const SAME_CLOCK: f64 = 1e-9;

/// The columns of `names` among `all` of `file`, `names[0]` being the time; rows in which one of them is missing are left out.
///
/// Errors: a column that the file does not have, or has twice; columns on different clocks; no row that has them all.
pub fn picked(file: &Path, all: &[Series], names: &[&str]) -> Result<Vec<Vec<f64>>> {
    let mut problems = Vec::new();
    let mut found: Vec<&Series> = Vec::new();
    for name in names {
        // A name that several clocks share (`time`) is the one of the columns found with it.
        let mut of_name = all.iter().filter(|series| series.name == *name);
        match of_name.next() {
            Some(series) => found.push(series),
            None => problems.push(lacking(file, name, all)),
        }
    }
    Problems(problems).unless_errors(())?;
    let clock = found.get(1).map_or(0, |position| position.clock);
    if let Some(time) = all.iter().find(|series| series.clock == clock && Some(&series.name.as_str()) == names.first())
    {
        found[0] = time;
    }
    on_one_clock(file, all, &found)?;
    let rows = found[0].values.len();
    let is_whole = |row: &usize| found.iter().all(|series| series.values[*row].is_finite());
    let whole: Vec<usize> = (0..rows).filter(is_whole).collect();
    if whole.len() < 2 {
        let what = format!("{} of its {rows} rows hold all of {}", whole.len(), names.join(", "));
        return Problem::error(file, what, "name columns that were recorded together").alone();
    }
    Ok(found.iter().map(|series| whole.iter().map(|row| series.values[*row]).collect()).collect())
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
    Problem::error(file, format!("has no column `{name}`"), cure)
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
