//! The campaign's own time: what drifts or warms up goes on from trial to trial.

use super::{Campaign, Log, read_trial};
use crate::problem::Result;
use rayon::prelude::*;

impl Campaign {
    /// When trial `index` began, s since the campaign did; 0 where the clock was not read.
    pub fn began_s(&self, index: usize) -> f64 {
        self.clock_s.get(index).copied().unwrap_or(0.0)
    }

    /// The same campaign with its clock read from all of its logs.
    ///
    /// Errors: a log that cannot be read.
    pub fn with_clock(mut self) -> Result<Self> {
        let span = |index: usize| read_trial(&self, index).map(|log| span_s(&log));
        let spans: Vec<(f64, f64)> =
            (0..self.trials.len()).into_par_iter().with_max_len(1).map(span).collect::<Result<_>>()?;
        self.clock_s = clock_s(&spans);
        Ok(self)
    }
}

/// First and last time stamp, s.
pub fn span_s(log: &Log) -> (f64, f64) {
    (log.time_s.first().copied().unwrap_or(0.0), log.time_s.last().copied().unwrap_or(0.0))
}

/// A trial that begins within this share of the length of the one before after its end goes on with it.
const PAUSE: f64 = 0.02;

/// Trials with these first and last time stamps, the earliest first.
fn in_time(spans_s: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut spans_s = spans_s.to_vec();
    spans_s.sort_by(|a, b| a.0.total_cmp(&b.0));
    spans_s
}

/// Whether trials with these first and last time stamps are pieces of one recording, cut, in whatever order they are listed.
pub fn is_one_recording(spans_s: &[(f64, f64)]) -> bool {
    let goes_on = |pair: &[(f64, f64)]| {
        let pause_s = pair[1].0 - pair[0].1;
        pause_s >= 0.0 && pause_s <= PAUSE * (pair[0].1 - pair[0].0)
    };
    in_time(spans_s).windows(2).all(goes_on)
}

/// When trials with these first and last time stamps began, s since the first of them did: by the stamps where no two trials overlap, in
/// whatever order they are listed, else as if they had been recorded one right after the other.
pub fn clock_s(spans_s: &[(f64, f64)]) -> Vec<f64> {
    let in_time = in_time(spans_s);
    if in_time.len() > 1 && in_time.windows(2).all(|pair| pair[1].0 >= pair[0].1) {
        return spans_s.iter().map(|(first, _)| first - in_time[0].0).collect();
    }
    spans_s
        .iter()
        .scan(0.0, |began_s, (first, last)| {
            let this_s = *began_s;
            *began_s += last - first;
            Some(this_s)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::{clock_s, is_one_recording};

    #[test]
    fn a_recording_cut_in_pieces_is_told_from_trials_of_their_own() {
        assert!(is_one_recording(&[(0.21, 6.449), (6.45, 12.689), (12.69, 18.9)]));
        assert!(is_one_recording(&[(6.0, 12.0), (0.0, 5.99)]));
        // A pause, a clock that starts anew, trials that overlap.
        assert!(!is_one_recording(&[(0.0, 6.0), (7.0, 13.0)]));
        assert!(!is_one_recording(&[(0.0, 6.0), (0.0, 6.0)]));
        assert!(!is_one_recording(&[(6.0, 12.0), (0.0, 6.01)]));
        assert!(is_one_recording(&[(0.0, 6.0)]));
    }

    #[test]
    fn trials_on_one_clock_may_be_listed_in_any_order() {
        assert_eq!(clock_s(&[(52.0, 60.0), (12.0, 20.0), (21.0, 29.0)]), [40.0, 0.0, 9.0]);
        assert_eq!(clock_s(&[(20.0, 30.0), (10.0, 20.0)]), [10.0, 0.0]);
        // Clocks that start anew, or two trials that overlap: the order of the list.
        assert_eq!(clock_s(&[(52.0, 60.0), (12.0, 22.0), (21.0, 29.0)]), [0.0, 8.0, 18.0]);
        assert_eq!(clock_s(&[(0.0, 8.0), (0.0, 9.0), (0.5, 7.0)]), [0.0, 8.0, 17.0]);
        assert_eq!(clock_s(&[(3.0, 8.0)]), [0.0]);
    }
}
