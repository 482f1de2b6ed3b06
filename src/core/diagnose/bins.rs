//! A series at a log's full rate, summed over what each thinned sample stands for: many samples at a time where their sum is known.

use crate::numerics::scalar::Scalar;
use std::ops::Range;

/// Sums over the samples of a log that each thinned sample stands for.
pub struct Bins<S> {
    /// One for each thinned sample.
    pub sums: Vec<S>,
    step: usize,
    /// How many samples before its own each one begins.
    early: usize,
    /// Samples of the log.
    samples: usize,
    /// Where the samples to come belong, and where that ends.
    at: usize,
    until: usize,
}

impl<S: Scalar> Bins<S> {
    /// Of a log of `samples`, of which every `step`th is one of `count` thinned ones, which stands for what begins `early` samples before it.
    pub fn new(count: usize, step: usize, early: usize, samples: usize) -> Self {
        let mut bins = Self { sums: vec![S::from(0.0); count], step, early, samples, at: 0, until: 0 };
        bins.until = bins.end(0);
        bins
    }

    /// Where number `at` ends; the last holds all that is left.
    fn end(&self, at: usize) -> usize {
        if at + 1 == self.sums.len() { self.samples } else { (at + 1) * self.step - self.early }
    }

    /// How many samples number `at` stands for.
    pub fn samples(&self, at: usize) -> usize {
        self.end(at) - at.checked_sub(1).map_or(0, |before| self.end(before))
    }

    /// Adds a series over `samples`, which follow those before; `sum` gives its sum over any range of them.
    pub fn add(&mut self, samples: Range<usize>, sum: impl Fn(Range<usize>) -> S) {
        let mut from = samples.start;
        while from < samples.end {
            let to = samples.end.min(self.until);
            self.sums[self.at] += sum(from..to);
            from = to;
            if to == self.until && to < self.samples {
                self.at += 1;
                self.until = self.end(self.at);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Bins;

    #[test]
    fn every_sample_belongs_to_one_thinned_sample() {
        for (samples, step, early) in [(20, 5, 2), (23, 5, 2), (21, 4, 1), (24, 4, 2), (7, 1, 0), (3, 8, 4)] {
            let count = usize::div_ceil(samples, step);
            let mut bins = Bins::<f64>::new(count, step, early, samples);
            let values: Vec<f64> = (0..samples).map(|i| ((i / 3) % 4) as f64).collect();
            values.chunk_by(|a, b| a == b).fold(0, |from, run| {
                bins.add(from..from + run.len(), |range| run[0] * range.len() as f64);
                from + run.len()
            });
            assert_eq!((0..count).map(|at| bins.samples(at)).sum::<usize>(), samples);
            for at in 0..count {
                let from = (at * step).saturating_sub(early);
                let to = if at + 1 == count { samples } else { (at + 1) * step - early };
                assert_eq!(bins.sums[at], values[from..to].iter().sum::<f64>(), "{samples} by {step}: {at}");
            }
        }
    }
}
