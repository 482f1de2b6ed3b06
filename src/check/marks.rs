//! What identifies a trial: how it is declared, and a digest of its log.

use super::sketch::Sketch;
use crate::log::{Campaign, Log, TrialEntry, read_trial, refuse_copies};
use crate::problem::{Problems, Result};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// A trial's declaration and digest.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialMark {
    /// Its log, relative to the campaign's folder.
    pub file: String,
    /// Protocol, speed, repeat and trajectory in words.
    pub declared: String,
    /// Samples after reading.
    pub rows: usize,
    /// Their span, s.
    pub duration_s: f64,
    /// A digest of each column, in SI as after reading, so that neither order nor units nor text of the columns matter.
    pub columns: BTreeMap<String, Sketch>,
}

impl TrialMark {
    /// Whether both logs hold the same data, except for rounding.
    pub fn holds_same(&self, other: &Self) -> bool {
        self.rows == other.rows
            && self.columns.len() == other.columns.len()
            && self.columns.iter().all(|(name, one)| other.columns.get(name).is_some_and(|two| one.is_same(two)))
    }

    /// Samples after the low-pass that tell something of their own: two for each period of its cut-off (Nyquist), at least 1.
    pub fn independent(&self, lowpass_hz: f64) -> f64 {
        (2.0 * lowpass_hz * self.duration_s).max(1.0)
    }
}

/// The marks of all trials of `campaign`. Errors: all that is wrong with any log.
pub(super) fn read(campaign: &Campaign) -> Result<Vec<TrialMark>> {
    let one = |index: usize| {
        let mut log = read_trial(campaign, index)?;
        let print = std::mem::take(&mut log.fingerprint);
        Ok((mark(&campaign.trials[index], &log), (index, print)))
    };
    let all: Vec<Result<_>> = (0..campaign.trials.len()).into_par_iter().with_max_len(1).map(one).collect();
    let mut problems = Vec::new();
    let (mut marks, mut prints) = (Vec::with_capacity(all.len()), Vec::with_capacity(all.len()));
    for one in all {
        match one {
            Ok((mark, print)) => {
                marks.push(mark);
                prints.push(print);
            }
            Err(Problems(found)) => problems.extend(found),
        }
    }
    Problems(problems).unless_errors(())?;
    refuse_copies(campaign, &prints)?;
    Ok(marks)
}

fn mark(entry: &TrialEntry, log: &Log) -> TrialMark {
    let mut declared = entry.protocol.name().to_string();
    if let Some(speed_rad_s) = entry.protocol.speed_rad_s() {
        declared += &format!(" {speed_rad_s} rad/s");
    }
    if let Some(trajectory) = &entry.trajectory {
        declared += &format!(" `{trajectory}`");
    }
    declared += &format!(", repeat {}", entry.repeat);
    let (rows, rate_hz) = (log.time_s.len(), log.rate_hz);
    TrialMark { file: entry.file.clone(), declared, rows, duration_s: rows as f64 / rate_hz, columns: columns(log) }
}

fn columns(log: &Log) -> BTreeMap<String, Sketch> {
    let mut all = vec![
        ("time_s".to_string(), &log.time_s),
        ("position_rad".to_string(), &log.position_rad),
        ("torque_nm".to_string(), &log.torque_nm),
    ];
    let optional = [
        ("velocity_rad_s", &log.velocity_rad_s),
        ("load_torque_nm", &log.load_torque_nm),
        ("reference_torque_nm", &log.reference_torque_nm),
        ("current_a", &log.current_a),
        ("temperature_degc", &log.temperature_degc),
    ];
    all.extend(optional.iter().filter_map(|(name, values)| Some((name.to_string(), values.as_ref()?))));
    all.extend(
        log.other_position_rad.iter().enumerate().map(|(k, values)| (format!("other_position_{}", k + 1), values)),
    );
    all.into_iter().map(|(name, values)| (name, Sketch::of(values))).collect()
}
