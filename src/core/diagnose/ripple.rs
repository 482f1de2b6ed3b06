//! Lines in the spectrum over position: where a ripple's search begins.

use super::base::BaseModel;
use crate::effects::PERIODS_MIN;
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::ops::Range;

/// Fewest and most periods within the range of positions that are looked for.
const PERIODS: (f64, f64) = (PERIODS_MIN, 150.0);
/// Wave numbers are tried at this share of a period over the range: a line is two thirds of a period wide at half its height.
const SPACING: f64 = 0.3;
/// At most this many rows are used: lines are found on few.
const ROWS: usize = 8000;
/// The ripple must be slower than this share of the low-pass, where the joint moves at its speed.
const PASSED: f64 = 0.8;
/// Lines whose angles are turned on from the first of them.
const BLOCK: usize = 16;
/// Lines followed up.
const LINES: usize = 2;

/// The strongest lines of `residual_nm`, taken with the sign of the motion if `by_direction`, in periods per radian.
pub fn lines(base: &BaseModel<'_>, residual_nm: &[f64], by_direction: bool) -> Vec<f64> {
    let range_rad = base.data().extent.position_rad.1 - base.data().extent.position_rad.0;
    if range_rad <= 0.0 {
        return Vec::new();
    }
    let motion = base.data().records.rows(|record, i| record.own[i]);
    let k_tilde: Vec<f64> = base
        .data()
        .records
        .all
        .iter()
        .zip(&base.passages)
        .flat_map(|(record, passage)| record.rows.iter().map(|i| passage[*i]).collect::<Vec<f64>>())
        .collect();
    let stride = residual_nm.len().div_ceil(ROWS).max(1);
    let lines = Lines { first: PERIODS.0 / range_rad, spacing: SPACING / range_rad };
    let rows: Vec<Row> = (0..residual_nm.len())
        .step_by(stride)
        .filter(|i| base.mask.counts(*i))
        .map(|i| {
            let sign = if by_direction { 2.0 * k_tilde[i] - 1.0 } else { 1.0 };
            lines.row(motion[i].position, motion[i].velocity.abs(), sign * residual_nm[i])
        })
        .collect();
    let count = ((PERIODS.1 - PERIODS.0) / SPACING) as usize;
    let fastest_rad_s = |periods_per_rad: f64| PASSED * base.data().records.lowpass_hz / periods_per_rad;
    let starts: Vec<usize> = (0..count).step_by(BLOCK).collect();
    let of_block = |from: usize| lines.powers(&rows, from..(from + BLOCK).min(count), fastest_rad_s);
    let spectrum: Vec<(f64, f64)> = starts.into_par_iter().flat_map_iter(of_block).collect();
    let is_peak = |i: &usize| {
        let at = |j: usize| spectrum.get(j).map_or(0.0, |line| line.1);
        at(*i) > at(i.wrapping_sub(1)) && at(*i) >= at(i + 1)
    };
    let mut peaks: Vec<(f64, f64)> = (0..count).filter(is_peak).map(|i| spectrum[i]).collect();
    peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
    peaks.truncate(LINES);
    peaks.into_iter().map(|(periods, _)| periods).collect()
}

/// A row whose spectrum is taken.
struct Row {
    position_rad: f64,
    speed_rad_s: f64,
    y_nm: f64,
    /// Sine and cosine of the angle from one line to the next.
    turn: (f64, f64),
}

/// Evenly spaced lines, in periods per radian.
struct Lines {
    first: f64,
    spacing: f64,
}

/// What a line's power is made of.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    y: f64,
    sin: f64,
    cos: f64,
    sin_y: f64,
    cos_y: f64,
}

impl Lines {
    fn at(&self, n: usize) -> f64 {
        self.first + n as f64 * self.spacing
    }

    fn row(&self, position_rad: f64, speed_rad_s: f64, y_nm: f64) -> Row {
        Row { position_rad, speed_rad_s, y_nm, turn: (TAU * self.spacing * position_rad).sin_cos() }
    }

    /// The lines `numbers`, each with the square that it takes from the rows slow enough for it to be seen, summed. Angles are turned on from
    /// line to line.
    fn powers(
        &self,
        rows: &[Row],
        numbers: Range<usize>,
        fastest_rad_s: impl Fn(f64) -> f64,
    ) -> impl Iterator<Item = (f64, f64)> {
        let lines: Vec<f64> = numbers.map(|n| self.at(n)).collect();
        let fastest: Vec<f64> = lines.iter().map(|line| fastest_rad_s(*line)).collect();
        let mut all = vec![Sums::default(); lines.len()];
        for row in rows {
            let (mut sin, mut cos) = (TAU * lines[0] * row.position_rad).sin_cos();
            // The finer a line, the slower must a row be.
            for (sums, _) in all.iter_mut().zip(&fastest).take_while(|(_, fastest)| row.speed_rad_s < **fastest) {
                sums.count += 1.0;
                sums.y += row.y_nm;
                sums.sin += sin;
                sums.cos += cos;
                sums.sin_y += sin * row.y_nm;
                sums.cos_y += cos * row.y_nm;
                (sin, cos) = (sin * row.turn.1 + cos * row.turn.0, cos * row.turn.1 - sin * row.turn.0);
            }
        }
        lines.into_iter().zip(all).map(|(line, sums)| (line, sums.power()))
    }
}

impl Sums {
    fn power(self) -> f64 {
        if self.count == 0.0 {
            return 0.0;
        }
        let mean = self.y / self.count;
        let (sin, cos) = (self.sin_y - self.sin * mean, self.cos_y - self.cos * mean);
        2.0 * (sin * sin + cos * cos) / self.count
    }
}

#[cfg(test)]
mod tests {
    use super::{BLOCK, Lines};
    use std::f64::consts::TAU;

    #[test]
    fn a_line_takes_from_the_rows_slow_enough_what_its_sine_and_cosine_take() {
        let lines = Lines { first: 0.7, spacing: 0.13 };
        let of = |i: usize| {
            let t = i as f64 * 0.01;
            ((1.3 * t).sin(), (2.1 * t).cos().abs(), (5.0 * t).sin() + 0.3)
        };
        let rows: Vec<_> = (0..700).map(of).map(|(q, speed, y)| lines.row(q, speed, y)).collect();
        let fastest_rad_s = |line: f64| 1.5 / line;
        for (line, power) in lines.powers(&rows, 3..3 + BLOCK, fastest_rad_s) {
            let slow: Vec<_> = (0..700).map(of).filter(|(_, speed, _)| *speed < fastest_rad_s(line)).collect();
            let n = slow.len() as f64;
            let mean = slow.iter().map(|(.., y)| y).sum::<f64>() / n;
            let part = |of: fn(f64) -> f64| slow.iter().map(|(q, _, y)| of(TAU * line * q) * (y - mean)).sum::<f64>();
            let expected = 2.0 * (part(f64::sin).powi(2) + part(f64::cos).powi(2)) / n;
            assert!((power / expected - 1.0).abs() < 1e-9, "line {line}: {power} for {expected}");
        }
    }
}
