//! Columns of numbers as the bytes of a log, CSV or Parquet.

use crate::problem::{Problem, Result};
use polars::prelude::{Column, DataFrame, IntoColumn, NamedFrom, ParquetWriter, Series};
use std::io::Write;
use std::path::Path;

/// One column to write.
#[derive(Debug, Clone, Copy)]
pub struct Numbers<'a> {
    /// Its name in the header.
    pub name: &'a str,
    /// Its values, all columns alike in number.
    pub values: &'a [f64],
    /// Digits kept after the point: what the sensor resolves.
    pub decimals: usize,
}

impl Numbers<'_> {
    fn rounded(&self) -> impl Iterator<Item = f64> + '_ {
        let scale = 10f64.powi(self.decimals as i32);
        self.values.iter().map(move |x| (x * scale).round() / scale)
    }
}

/// CSV with a header.
pub fn csv_bytes(columns: &[Numbers]) -> Vec<u8> {
    let rows = columns.iter().map(|c| c.values.len()).min().unwrap_or(0);
    let mut bytes = Vec::with_capacity(rows * columns.len() * 10 + 64);
    let names: Vec<&str> = columns.iter().map(|c| c.name).collect();
    bytes.extend_from_slice(names.join(",").as_bytes());
    bytes.push(b'\n');
    for i in 0..rows {
        for (k, column) in columns.iter().enumerate() {
            if k > 0 {
                bytes.push(b',');
            }
            write_fixed(&mut bytes, column.values[i], column.decimals);
        }
        bytes.push(b'\n');
    }
    bytes
}

/// Writes `x` with `decimals`, as `{:.decimals}` does, at a fraction of the time of the general formatter: logs are mostly numbers.
fn write_fixed(bytes: &mut Vec<u8>, x: f64, decimals: usize) {
    /// Below this a count of last digits is exact as f64.
    const COUNT_MAX: f64 = 9e15;
    /// Digits of the largest count, or of as many decimals.
    const DIGITS: usize = 16;
    /// Closer to halfway between two counts, the general formatter decides.
    const HALFWAY: f64 = 0.499;
    let scale = 10f64.powi(decimals as i32);
    let count = (x * scale).round();
    // The product rounds, the fused one does not: by how much `x` differs from the count, in last digits.
    let off = x.mul_add(scale, -count).abs();
    if decimals >= DIGITS || !(count.abs() < COUNT_MAX && off < HALFWAY) {
        // Writing to memory cannot fail.
        let _ = write!(bytes, "{x:.decimals$}");
        return;
    }
    if x.is_sign_negative() {
        bytes.push(b'-');
    }
    let (mut text, mut at, mut left) = ([0; 2 * DIGITS], 2 * DIGITS, count.abs() as u64);
    let mut before = |byte| {
        at -= 1;
        text[at] = byte;
    };
    for _ in 0..decimals {
        before(b'0' + (left % 10) as u8);
        left /= 10;
    }
    if decimals > 0 {
        before(b'.');
    }
    loop {
        before(b'0' + (left % 10) as u8);
        left /= 10;
        if left == 0 {
            break;
        }
    }
    bytes.extend_from_slice(&text[at..]);
}

/// `column` of `file`, to be written, holds what is no number.
pub(super) fn not_finite(file: &Path, column: &str) -> Problem {
    let what = "not written: it holds values that are not finite numbers, because of a numerical overflow";
    let cure = "check the data and the model's parameters for values that no joint has";
    Problem::error(file, what, cure).in_column(column)
}

/// Parquet; `file` is named when the columns cannot be written.
pub fn parquet_bytes(file: &Path, columns: &[Numbers]) -> Result<Vec<u8>> {
    let unwritable = |error: polars::prelude::PolarsError| {
        Problem::error(file, format!("cannot be written as Parquet: {error}"), "write CSV instead")
    };
    if let Some(column) = columns.iter().find(|c| c.rounded().any(|number| !number.is_finite())) {
        return not_finite(file, column.name).alone();
    }
    let column =
        |c: &Numbers| -> Column { Series::new(c.name.into(), c.rounded().collect::<Vec<f64>>()).into_column() };
    let rows = columns.first().map_or(0, |c| c.values.len());
    let mut frame = DataFrame::new(rows, columns.iter().map(column).collect()).map_err(unwritable)?;
    let mut bytes = Vec::new();
    ParquetWriter::new(&mut bytes).finish(&mut frame).map_err(unwritable)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn numbers_are_written_as_the_general_formatter_does(x in any::<f64>(), near in -1e7..1e7f64, decimals in 0usize..18) {
            let halfway = (near.trunc() + 0.5) / 10f64.powi(decimals as i32);
            for x in [x, near, near / 1e6, halfway, near.round(), -0.0, 0.0, -1e-12, f64::NAN, f64::NEG_INFINITY, 9e15, -9.5] {
                let mut bytes = Vec::new();
                write_fixed(&mut bytes, x, decimals);
                prop_assert_eq!(String::from_utf8(bytes).unwrap(), format!("{x:.decimals$}"));
            }
        }
    }
}
