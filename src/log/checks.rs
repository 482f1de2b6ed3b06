//! What would make a log useless, found before anything is computed from it.

use super::campaign::{Protocol, Signal};
use super::columns::Wanted;
use super::readings::{Faults, Readings, Rows};
use super::{POSITION, TIME, TORQUE};
use crate::problem::{Problem, Result};
use std::path::Path;

/// A pause between samples longer than this many periods is a hole that no interpolation fills. The last digit
/// leaves room for rounded time stamps.
const GAP_PERIODS: f64 = 3.01;
/// A log must last this many periods of the low-pass's cut-off; in less there is nothing left to filter.
const CUTOFF_PERIODS_MIN: f64 = 2.0;

/// Checks one log's time stamps, length, rate and sensors.
///
/// Errors: every fault, with row and column.
pub(super) fn check(
    file: &Path,
    readings: &Readings,
    wanted: &[Wanted],
    signal: &Signal,
    protocol: Protocol,
) -> Result<()> {
    let mut faults = Faults::of(file);
    let time = &readings.columns[TIME];
    if enough_samples(&mut faults, time.len(), signal) {
        growing(&mut faults, time, &wanted[TIME], &readings.rows);
        if faults.is_empty() {
            gaps(&mut faults, time, &wanted[TIME], &readings.rows);
            rate_and_duration(&mut faults, time, &wanted[TIME], signal);
        }
        alive(&mut faults, &readings.columns[TORQUE], &wanted[TORQUE], "a sensor that lives never reads so");
        if let Protocol::Uniform { .. } = protocol {
            alive(&mut faults, &readings.columns[POSITION], &wanted[POSITION], "a sweep moves the joint");
        }
    }
    faults.unless_any(())
}

/// The median of the steps between time stamps, of which there are two or more, in their unit.
pub(super) fn median_period(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// SciPy's `sosfiltfilt`, whose edges ours equal, mirrors 3 (order + 1) samples at each end and needs one more.
fn enough_samples(faults: &mut Faults<'_>, samples: usize, signal: &Signal) -> bool {
    let padding = 3 * (signal.lowpass_order + 1);
    if samples <= padding {
        faults.add("too few samples", |file| {
            let what = format!(
                "has {samples} samples; a low-pass of order {} needs more than {padding}",
                signal.lowpass_order
            );
            Problem::error(file, what, "record longer, or delete this trial from campaign.toml")
        });
    }
    samples > padding
}

fn growing(faults: &mut Faults<'_>, time: &[f64], want: &Wanted, rows: &Rows) {
    for (index, pair) in time.windows(2).enumerate().filter(|(_, pair)| pair[1] <= pair[0]) {
        faults.add("time that does not grow", |file| {
            let what = format!("{} {unit} comes after {} {unit}", pair[1], pair[0], unit = want.column.unit.name());
            Problem::error(file, what, "time must grow with every row: delete repeated rows, sort the others")
                .at_row(rows.of(index + 1))
                .in_column(&want.column.name)
        });
    }
}

fn gaps(faults: &mut Faults<'_>, time: &[f64], want: &Wanted, rows: &Rows) {
    let period = median_period(time);
    for (index, pair) in time.windows(2).enumerate().filter(|(_, pair)| pair[1] - pair[0] > GAP_PERIODS * period) {
        faults.add("a gap before them", |file| {
            let gap_s = (pair[1] - pair[0]) * want.factor();
            let what =
                format!("a gap of {gap_s:.6} s before this row: {:.1} sample periods", (pair[1] - pair[0]) / period);
            Problem::error(file, what, "split the log here into two trials, or record it without drop-outs")
                .at_row(rows.of(index + 1))
                .in_column(&want.column.name)
        });
    }
}

fn rate_and_duration(faults: &mut Faults<'_>, time: &[f64], want: &Wanted, signal: &Signal) {
    let duration_s = (time[time.len() - 1] - time[0]) * want.factor();
    let rate_hz = (time.len() - 1) as f64 / duration_s;
    let lowpass_hz = signal.lowpass_hz;
    let unit = want.column.unit.name();
    let mut fault = |kind, what: String, cure: String| {
        let cure = format!("in campaign.toml correct the unit of time (now `{unit}`) or lowpass_hz, or {cure}");
        faults.add(kind, |file| Problem::error(file, what, cure).in_column(&want.column.name));
    };
    if lowpass_hz >= rate_hz / 2.0 {
        let what = format!("sampled at {rate_hz:.6} Hz, too slowly for a low-pass at {lowpass_hz} Hz");
        fault("too slow", what, format!("record faster than {} Hz", 2.0 * lowpass_hz));
    }
    let least_s = CUTOFF_PERIODS_MIN / lowpass_hz;
    if duration_s < least_s {
        let what = format!("lasts {duration_s:.6} s, too short for a low-pass at {lowpass_hz} Hz");
        fault("too short", what, format!("record for {least_s:.3} s or longer"));
    }
}

/// A column that never changes comes from a sensor that is not connected.
fn alive(faults: &mut Faults<'_>, column: &[f64], want: &Wanted, why: &str) {
    if column.iter().all(|reading| *reading == column[0]) {
        faults.add("a dead sensor", |file| {
            let what = format!("reads {} {} throughout; {why}", column[0], want.column.unit.name());
            Problem::error(file, what, "check the sensor's plug and the recorder's channel")
                .in_column(&want.column.name)
        });
    }
}
