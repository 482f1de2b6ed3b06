//! What may be mended without inventing data.

use super::Series;
use crate::numerics::statistics::quantile;
use std::ops::Range;

/// A pause longer than this many sample periods is a gap that no interpolation fills.
const GAP_PERIODS: f64 = 3.0;

/// Drops rows that repeat the one before in every column, as recorders write that were late; gives how many. With a name of the
/// `time` column only rows whose time stands still too.
pub fn without_repeated_rows(columns: &mut [Series], time: Option<&str>) -> usize {
    let Some(time) = time.and_then(|name| columns.iter().position(|series| series.name == name)) else { return 0 };
    let rows = columns.iter().map(|series| series.values.len()).min().unwrap_or(0);
    let is_same = |row: &usize| {
        columns[time].values[*row] == columns[time].values[row - 1]
            && columns.iter().all(|series| series.values[*row].to_bits() == series.values[row - 1].to_bits())
    };
    let repeated: Vec<usize> = (1..rows).filter(is_same).collect();
    drop_rows(columns, &repeated);
    repeated.len()
}

/// Drops rows in which a column that `is_wanted` holds no number; gives how many.
pub fn without_missing_rows(columns: &mut [Series], is_wanted: impl Fn(&str) -> bool) -> usize {
    let wanted: Vec<&Series> = columns.iter().filter(|series| is_wanted(&series.name)).collect();
    let rows = wanted.iter().map(|series| series.values.len()).min().unwrap_or(0);
    let is_missing = |row: &usize| wanted.iter().any(|series| !series.values[*row].is_finite());
    let missing: Vec<usize> = (0..rows).filter(is_missing).collect();
    drop_rows(columns, &missing);
    missing.len()
}

/// Drops `rows`, in order, of every column.
fn drop_rows(columns: &mut [Series], rows: &[usize]) {
    for series in columns.iter_mut().filter(|_| !rows.is_empty()) {
        let mut next = rows.iter().copied().peekable();
        let mut row = 0;
        series.values.retain(|_| {
            let is_kept = next.next_if_eq(&row).is_none();
            row += 1;
            is_kept
        });
    }
}

/// The stretches of `time` without gaps, in rows; all of it where it does not grow.
pub fn stretches(time: &[f64]) -> Vec<Range<usize>> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    let period = quantile(&mut steps, 0.5);
    let is_gap = |row: &usize| time[*row] - time[row - 1] > GAP_PERIODS * period;
    let starts = std::iter::once(0).chain((1..time.len()).filter(is_gap));
    let ends = (1..time.len()).filter(is_gap).chain([time.len()]);
    starts.zip(ends).map(|(start, end)| start..end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_rows_go_and_gaps_part() {
        let series =
            |name: &str, values: &[f64]| Series { name: name.into(), values: values.to_vec(), clock: 0, first_row: 2 };
        let mut columns = [series("t", &[0.0, 0.1, 0.1, 0.2, 0.2]), series("q", &[1.0, 2.0, 2.0, 3.0, 4.0])];
        // The last row has another position at the same time: no repetition, and not ours to decide.
        assert_eq!(without_repeated_rows(&mut columns, Some("t")), 1);
        assert_eq!(columns[1].values, [1.0, 2.0, 3.0, 4.0]);
        let mut columns =
            [series("t", &[0.0, 0.1, 0.2]), series("q", &[1.0, f64::NAN, 3.0]), series("note", &[f64::NAN; 3])];
        assert_eq!(without_missing_rows(&mut columns, |name| name != "note"), 1);
        assert_eq!(columns[0].values, [0.0, 0.2]);
        assert_eq!(stretches(&[0.0, 0.1, 0.2, 0.8, 0.9, 1.0]), [0..3, 3..6]);
    }
}
