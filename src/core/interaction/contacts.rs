//! When somebody touches the joint: onset and release.

use super::extract::Extracted;
use super::quiet::Levels;

/// A contact begins once the torque stays above the threshold for this share of the low-pass' period: a single excursion of
/// noise is shorter.
const HOLD_PERIODS: f64 = 0.5;
/// It ends once the torque stays below this share of the threshold for as long.
const RELEASE: f64 = 0.7;

/// One contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// When it begins, s.
    pub onset_s: f64,
    /// When it ends, s; the end of the trial if it does not.
    pub release_s: f64,
    /// The largest torque in it, with its sign, N m.
    pub peak_nm: f64,
    /// Whether it begins while friction changes over, where the model is weak.
    pub at_reversal: bool,
}

/// The contacts in `torque_nm`, one value per sample of `trial`, in order of time.
pub fn contacts(trial: &Extracted, torque_nm: &[f64], levels: &Levels, lowpass_hz: f64) -> Vec<Contact> {
    let mut detector = Detector::new(trial.rate_hz, lowpass_hz);
    let mut found: Vec<(usize, usize)> = Vec::new();
    for (at, y) in torque_nm.iter().enumerate() {
        let threshold_nm = levels.threshold_nm(trial, at);
        match detector.step(*y, threshold_nm) {
            Some(Edge::Onset { before }) => found.push((at.saturating_sub(before), torque_nm.len() - 1)),
            Some(Edge::Release { before }) => {
                if let Some(last) = found.last_mut() {
                    last.1 = at.saturating_sub(before);
                }
            }
            None => {}
        }
    }
    let contact = |(from, to): (usize, usize)| Contact {
        onset_s: trial.time_s[from],
        release_s: trial.time_s[to],
        peak_nm: torque_nm[from..=to].iter().fold(0.0, |peak: f64, y| if y.abs() > peak.abs() { *y } else { peak }),
        at_reversal: trial.weak[from],
    };
    found.into_iter().map(contact).collect()
}

/// What a sample changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// A contact began this many samples ago.
    Onset {
        /// Samples.
        before: usize,
    },
    /// It ended this many samples ago.
    Release {
        /// Samples.
        before: usize,
    },
}

/// Hysteresis in level and time, one sample at a time.
#[derive(Debug, Clone, Copy)]
pub struct Detector {
    hold: usize,
    touched: bool,
    /// Samples since which the other state would hold.
    since: usize,
}

impl Detector {
    /// For samples at `rate_hz` behind a low-pass at `lowpass_hz`.
    pub fn new(rate_hz: f64, lowpass_hz: f64) -> Self {
        Self { hold: (HOLD_PERIODS / lowpass_hz * rate_hz) as usize, touched: false, since: 0 }
    }

    /// How long a torque must stay above the threshold before it counts, samples.
    pub fn hold(&self) -> usize {
        self.hold
    }

    /// Whether there is contact now.
    pub fn touched(&self) -> bool {
        self.touched
    }

    /// The next sample; a threshold that is not finite (nothing is known) never begins a contact.
    pub fn step(&mut self, torque_nm: f64, threshold_nm: f64) -> Option<Edge> {
        let turns = match self.touched {
            false => torque_nm.abs() > threshold_nm,
            true => torque_nm.abs() < RELEASE * threshold_nm,
        };
        self.since = if turns { self.since + 1 } else { 0 };
        if self.since <= self.hold {
            return None;
        }
        let before = std::mem::take(&mut self.since) - 1;
        self.touched = !self.touched;
        Some(if self.touched { Edge::Onset { before } } else { Edge::Release { before } })
    }
}
