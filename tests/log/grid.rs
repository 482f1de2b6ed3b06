//! Uneven time stamps: put on an even grid, and told.

use super::{CAMPAIGN, folder, read_first};
use std::fmt::Write;
use tautline::log::Log;

/// A sweep of 10 deg/s whose torque is the cosine of time, read at these `times`, s.
fn log_at(times: impl Iterator<Item = f64>) -> Log {
    let mut text = "t,pos,trq\n".to_string();
    for time in times {
        writeln!(text, "{time:.7},{},{}", 10.0 * time, time.cos()).expect("writes");
    }
    read_first(folder(CAMPAIGN, text).path()).expect("reads")
}

/// Interpolating a cosine linearly over 2 ms is off by at most (2 ms)^2 / 8, besides rounding of the stamps.
const TOLERANCE: f64 = 1e-6;

fn assert_even(log: &Log, rate_hz: f64) {
    assert!((log.rate_hz / rate_hz - 1.0).abs() < 1e-5, "{}", log.rate_hz);
    for (index, time_s) in log.time_s.iter().enumerate() {
        assert!((time_s - index as f64 / log.rate_hz).abs() < TOLERANCE);
        assert!((log.position_rad[index].to_degrees() - 10.0 * time_s).abs() < 10.0 * TOLERANCE);
        assert!((log.torque_nm[index] + time_s.cos()).abs() < TOLERANCE);
    }
}

#[test]
fn single_missing_samples_are_filled_in() {
    let log =
        log_at((0..2000).filter(|index| ![700, 900, 901, 1500].contains(index)).map(|index| f64::from(index) * 1e-3));
    assert_eq!(log.time_s.len(), 2000);
    assert_even(&log, 1000.0);
    let warning = log.warnings[0].to_string();
    assert!(warning.contains("4 samples are missing"), "{warning}");
    // What was recorded stays as it was.
    assert_eq!(log.torque_nm[1000], -1.0_f64.cos());
}

#[test]
fn jitter_is_taken_out() {
    let log = log_at((0..2000).map(|index| (f64::from(index) + 0.9 * (f64::from(index) * 0.37).sin().powi(5)) * 1e-3));
    assert_eq!(log.time_s.len(), 2000);
    assert!(log.warnings[0].to_string().contains("interpolated"), "{}", log.warnings[0]);
    let step = |index: usize| log.time_s[index + 1] - log.time_s[index];
    assert!((0..1999).all(|index| (step(index) - 1.0 / log.rate_hz).abs() < 1e-9));
    let off = |index: usize| (log.torque_nm[index] + log.time_s[index].cos()).abs();
    assert!((0..2000).all(|index| off(index) < TOLERANCE));
}

#[test]
fn rounded_stamps_are_even_enough() {
    let log = log_at((0..2000).map(|index| (f64::from(index) / 0.3).round() * 1e-4));
    assert!(log.warnings.is_empty(), "{:?}", log.warnings);
    assert!((log.rate_hz - 3000.0).abs() < 1.0, "{}", log.rate_hz);
}

/// 49.999999999999 Hz would count one sample less in whatever counts whole samples of a time.
#[test]
fn the_last_digit_of_a_stamp_is_not_in_the_rate() {
    for rows in 1000..1040 {
        assert_eq!(log_at((0..rows).map(|row| 0.3 + 0.02 * f64::from(row))).rate_hz, 50.0);
    }
}
