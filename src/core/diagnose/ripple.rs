//! Lines in the spectrum over position: where a ripple's search begins.

use super::base::BaseModel;
use crate::effects::RIPPLE_NUMBERS;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Fewest and most periods within the range of positions that are looked for.
const PERIODS: (f64, f64) = (1.5, 150.0);
/// Wave numbers are tried at this share of a period over the range: a line is two thirds of a period wide at half its height.
const SPACING: f64 = 0.3;
/// At most this many rows are used: lines are found on few.
const ROWS: usize = 8000;
/// The ripple must be slower than this share of the low-pass, where the joint moves at its speed.
const PASSED: f64 = 0.8;
/// Lines followed up.
const LINES: usize = 2;

/// Parameter sets to begin from: the strongest lines of `residual_nm`, taken with the sign of the motion if `by_direction`.
pub fn starts(base: &BaseModel<'_>, residual_nm: &[f64], by_direction: bool) -> Vec<Vec<f64>> {
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
    let rows: Vec<(f64, f64, f64)> = (0..residual_nm.len())
        .step_by(stride)
        .filter(|i| base.mask.counts(*i))
        .map(|i| {
            let sign = if by_direction { 2.0 * k_tilde[i] - 1.0 } else { 1.0 };
            (motion[i].position, motion[i].velocity.abs(), sign * residual_nm[i])
        })
        .collect();
    let count = ((PERIODS.1 - PERIODS.0) / SPACING) as usize;
    let power = |n: usize| {
        let periods_per_rad = (PERIODS.0 + n as f64 * SPACING) / range_rad;
        let fastest_rad_s = PASSED * base.data().records.lowpass_hz / periods_per_rad;
        (periods_per_rad, line_power(&rows, periods_per_rad, fastest_rad_s))
    };
    let spectrum: Vec<(f64, f64)> = (0..count).into_par_iter().map(power).collect();
    let is_peak = |i: &usize| {
        let at = |j: usize| spectrum.get(j).map_or(0.0, |line| line.1);
        at(*i) > at(i.wrapping_sub(1)) && at(*i) >= at(i + 1)
    };
    let mut peaks: Vec<(f64, f64)> = (0..count).filter(is_peak).map(|i| spectrum[i]).collect();
    peaks.sort_by(|a, b| b.1.total_cmp(&a.1));
    peaks.truncate(LINES);
    peaks.into_iter().map(|(periods, _)| std::iter::once(periods).chain([0.0; RIPPLE_NUMBERS - 1]).collect()).collect()
}

/// Square that a line takes from the rows slow enough for it to be seen, summed.
fn line_power(rows: &[(f64, f64, f64)], periods_per_rad: f64, fastest_rad_s: f64) -> f64 {
    let (mut sin_sum, mut cos_sum, mut count, mut mean, mut sins, mut coss) = (0.0, 0.0, 0usize, 0.0, 0.0, 0.0);
    for (position, _, y) in rows.iter().filter(|row| row.1 < fastest_rad_s) {
        let (sin, cos) = (TAU * periods_per_rad * position).sin_cos();
        sin_sum += sin * y;
        cos_sum += cos * y;
        mean += y;
        sins += sin;
        coss += cos;
        count += 1;
    }
    if count == 0 {
        return 0.0;
    }
    let n = count as f64;
    let (sin_sum, cos_sum) = (sin_sum - sins * mean / n, cos_sum - coss * mean / n);
    2.0 * (sin_sum * sin_sum + cos_sum * cos_sum) / n
}
