//! Time stamps -> an even grid. Filters and derivatives hold only on one.

use super::TIME;
use super::checks::median_period;
use super::columns::Wanted;
use crate::problem::Problem;
use std::path::Path;

/// A stamp further than this many periods off the grid belongs to another sample of it.
const OFF_GRID_PERIODS: f64 = 0.5;
/// A step this close to a whole number of periods is that number; jitter leaves steps anywhere.
const WHOLE_TOLERANCE: f64 = 0.25;
/// Above this share of missing samples it is no longer clear what the period is.
const MISSING_SHARE_MAX: f64 = 0.05;

/// Digits after the first to which a rate follows from its stamps. Further digits come from the rounding of stamps, and no clock is that
/// exact: 49.9999999999 Hz is 50 Hz, or a count of whole samples within a time would be one too low.
const RATE_DIGITS: usize = 8;

/// What a log's time stamps say, in their own unit.
struct Stamps {
    /// Samples that are missing, one or two at a time, between samples that sit on a grid.
    missing: usize,
    /// The furthest a stamp lies off an even grid of as many samples, in periods of that grid.
    worst_periods: f64,
}

/// The columns on an even grid in time, its rate in Hz, and a warning where they had to be moved there.
///
/// Where single samples are missing the others keep their places and the missing are filled in; where stamps jitter,
/// the grid has as many samples as were recorded. In both, readings in between are taken as linear.
pub(super) fn onto_even_grid(file: &Path, columns: Vec<Vec<f64>>, want: &Wanted) -> (Vec<Vec<f64>>, f64, Vec<Problem>) {
    let time = &columns[TIME];
    let duration_s = (time[time.len() - 1] - time[0]) * want.factor();
    let stamps = Stamps::of(time);
    let count = time.len() + stamps.missing;
    let rate_hz = without_last_digits((count - 1) as f64 / duration_s);
    if stamps.missing == 0 && stamps.worst_periods <= OFF_GRID_PERIODS {
        return (columns, rate_hz, Vec::new());
    }
    let warning = stamps.warning(file, want, rate_hz);
    (interpolate(&columns, count), rate_hz, vec![warning])
}

/// `rate_hz` to `RATE_DIGITS`.
fn without_last_digits(rate_hz: f64) -> f64 {
    format!("{rate_hz:.RATE_DIGITS$e}").parse().unwrap_or(rate_hz)
}

impl Stamps {
    fn of(time: &[f64]) -> Self {
        let step = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
        let off = |(index, stamp): (usize, &f64)| (stamp - time[0] - index as f64 * step).abs() / step;
        let worst_periods = time.iter().enumerate().map(off).fold(0.0, f64::max);
        Self { missing: missing(time), worst_periods }
    }

    fn warning(&self, file: &Path, want: &Wanted, rate_hz: f64) -> Problem {
        let missing = match self.missing {
            0 => String::new(),
            1 => "1 sample is missing; ".to_string(),
            many => format!("{many} samples are missing; "),
        };
        let (periods, off_s) = (self.worst_periods, self.worst_periods / rate_hz);
        let what = format!("{missing}time stamps lie up to {off_s:.2e} s ({periods:.2} periods) off an even grid");
        let cure =
            format!("every column was interpolated onto one at {rate_hz:.3} Hz; record at an even rate if you can");
        Problem::warning(file, what, cure).in_column(&want.column.name)
    }
}

/// How many samples are missing, if all steps are whole multiples of one period and nearly all are that period.
fn missing(time: &[f64]) -> usize {
    let steps = || time.windows(2).map(|pair| pair[1] - pair[0]);
    let mean_step = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    // The common case, and the cheap one: no step long enough to hide a sample.
    if steps().all(|step| step < 1.5 * mean_step) {
        return 0;
    }
    // The mean of the common steps, not their median: rounded stamps step by 0.3, 0.3, 0.4.
    let Some(median) = median_period(time) else { return 0 };
    let common = steps().filter(|step| (0.5..1.5).contains(&(step / median)));
    let (sum, count) = common.fold((0.0, 0), |(sum, count), step| (sum + step, count + 1));
    let period = sum / f64::from(count);
    let mut missing = 0;
    for step in steps() {
        let periods = step / period;
        let is_whole = periods >= 0.5 && (periods - periods.round()).abs() <= WHOLE_TOLERANCE;
        if !is_whole {
            return 0;
        }
        missing += periods.round() as usize - 1;
    }
    if missing as f64 > MISSING_SHARE_MAX * time.len() as f64 { 0 } else { missing }
}

/// All columns, time among them, at `count` even steps from the first stamp to the last.
fn interpolate(columns: &[Vec<f64>], count: usize) -> Vec<Vec<f64>> {
    let time = &columns[TIME];
    let (start, end) = (time[0], time[time.len() - 1]);
    let step = (end - start) / (count - 1) as f64;
    let mut even: Vec<Vec<f64>> = columns.iter().map(|_| Vec::with_capacity(count)).collect();
    let mut before = 0;
    for index in 0..count {
        let now = if index + 1 == count { end } else { start + index as f64 * step };
        while before + 2 < time.len() && time[before + 1] <= now {
            before += 1;
        }
        let share = (now - time[before]) / (time[before + 1] - time[before]);
        for (even, column) in even.iter_mut().zip(columns) {
            let (low, high) = (column[before], column[before + 1]);
            // At the right end exactly the last reading, and between equal readings exactly that one.
            even.push(if share >= 1.0 { high } else { low + share * (high - low) });
        }
    }
    even[TIME].iter_mut().enumerate().for_each(|(index, stamp)| *stamp = start + index as f64 * step);
    even
}
