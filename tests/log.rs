//! Reading a recorded campaign: what is accepted, what is refused and in which words.

mod bytes;
mod campaign;
mod clipping;
mod files;
mod grid;
mod health;
mod velocity;

use std::fmt::Write;
use std::path::Path;
use tautline::log::{Campaign, Log, read_trial};
use tautline::problem::{Problem, Result};
use tempfile::TempDir;

/// A campaign of one sweep whose log has the columns t (s), pos (deg) and trq (N m).
const CAMPAIGN: &str = r#"format = "campaign/1"

[joint]
name = "elbow"
kind = "revolute"
winch_radius_m = 0.012
pulley_radius_m = 0.040
backlash_m = 0.0008

[dynamics]
gravity_nm = 0.6916
inertia_kg_m2 = 0.012

[signal]
torque_sign = -1
lowpass_hz = 5.0
lowpass_order = 4

[columns]
time = { name = "t", unit = "s" }
position = { name = "pos", unit = "deg" }
torque = { name = "trq", unit = "N m" }

[[trials]]
file = "a.csv"
protocol = "uniform"
speed_rad_s = 0.5
repeat = 1
"#;

/// Sample rate of the logs made here, Hz.
const RATE_HZ: f64 = 1000.0;

/// A folder with `campaign.toml` and the log `a.csv`.
fn folder(campaign: &str, log: impl AsRef<[u8]>) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("campaign.toml"), campaign).expect("writes");
    std::fs::write(folder.path().join("a.csv"), log).expect("writes");
    folder
}

fn read_first(folder: &Path) -> Result<Log> {
    read_trial(&Campaign::read(folder)?, 0)
}

/// A log of `rows` samples: position in deg and torque in N m by sample.
fn csv(rows: usize, at: impl Fn(usize) -> (f64, f64)) -> String {
    let mut text = "t,pos,trq\n".to_string();
    for row in 0..rows {
        let (position, torque) = at(row);
        writeln!(text, "{:.4},{position},{torque}", row as f64 / RATE_HZ).expect("writes");
    }
    text
}

/// A second of a sweep, good in every respect.
fn sweep() -> String {
    csv(1000, |row| (row as f64 * 0.03, (row as f64 * 0.7).sin()))
}

/// The faults that reading a campaign and its log brings up.
fn faults(campaign: &str, log: impl AsRef<[u8]>) -> Vec<Problem> {
    read_first(folder(campaign, log).path()).err().map_or(Vec::new(), |problems| problems.0)
}

/// `text` with its row `row` (counted from 1) replaced.
fn with_row(text: &str, row: usize, replace: impl Fn(&str) -> String) -> String {
    let one = |(index, line): (usize, &str)| if index + 1 == row { replace(line) } else { format!("{line}\n") };
    text.lines().enumerate().map(one).collect()
}
