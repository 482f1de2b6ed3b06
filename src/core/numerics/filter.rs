//! Zero-phase Butterworth low-pass, as SciPy's `butter(..., output="sos")` followed by `sosfiltfilt`.
//!
//! Run forwards and backwards over an odd extension of the signal, started in the steady state of its first sample: the
//! edges then carry no transient of a signal that is locally a straight line.

use super::section::Section;
use biquad::{Coefficients, Hertz, Type};
use std::array::from_fn;
use std::f64::consts::PI;

/// A low-pass for one sample rate.
#[derive(Debug, Clone)]
pub struct LowPass {
    sections: Vec<Section>,
    order: usize,
}

impl LowPass {
    /// The Butterworth low-pass of `order` with -3 dB at `cutoff_hz` in each of its two passes, for samples at `rate_hz`.
    ///
    /// `None` unless `order` >= 1 and 0 < `cutoff_hz` < `rate_hz` / 2.
    pub fn new(order: usize, cutoff_hz: f64, rate_hz: f64) -> Option<Self> {
        if order == 0 || !(cutoff_hz > 0.0 && cutoff_hz < rate_hz / 2.0) {
            return None;
        }
        let (rate, cutoff) = (Hertz::from_hz(rate_hz).ok()?, Hertz::from_hz(cutoff_hz).ok()?);
        let section = |kind: Type<f64>, quality: f64| {
            let Coefficients { a1, a2, b0, b1, b2 } = Coefficients::from_params(kind, rate, cutoff, quality).ok()?;
            Some(Section::new([b0, b1, b2], [1.0, a1, a2]))
        };
        // Poles at equal angles on a half circle: a real one where their number is odd, then pairs, the best damped first.
        let real = (order % 2 == 1).then(|| section(Type::SinglePoleLowPass, 1.0));
        let quality = |pair: usize| 0.5 / (PI * (2 * pair + 1) as f64 / (2 * order) as f64).sin();
        let pairs = (0..order / 2).rev().map(|pair| section(Type::LowPass, quality(pair)));
        let sections: Option<Vec<Section>> = real.into_iter().chain(pairs).collect();
        Some(Self { sections: sections?, order })
    }

    /// Its second-order sections, without memory.
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// How many samples a signal must exceed: SciPy's padding, 3 (2 sections + 1 - the first-order ones).
    pub fn padding(order: usize) -> usize {
        3 * (order + 1)
    }

    /// `signal` forwards and backwards through the filter; unchanged when it is no longer than the padding.
    pub fn zero_phase(&self, signal: &[f64]) -> Vec<f64> {
        let mut filtered = signal.to_vec();
        self.zero_phase_in_place(&mut filtered);
        filtered
    }

    /// The same in place: long signals are not copied.
    pub fn zero_phase_in_place(&self, signal: &mut [f64]) {
        self.zero_phase_together(signal.as_chunks_mut::<1>().0);
    }

    /// The same for `L` signals side by side: each sample waits for the one before, so that four take hardly longer than one.
    pub fn zero_phase_together<const L: usize>(&self, signals: &mut [[f64; L]]) {
        let padding = Self::padding(self.order);
        if signals.len() <= padding {
            return;
        }
        // The odd extension: the signal turned by 180 deg about its first and its last sample.
        let turned = |about: usize, i: usize| from_fn(|l| 2.0 * signals[about][l] - signals[i][l]);
        let last = signals.len() - 1;
        let mut before: Vec<[f64; L]> = (1..=padding).rev().map(|i| turned(0, i)).collect();
        let mut after: Vec<[f64; L]> = (1..=padding).map(|i| turned(last, last - i)).collect();
        let mut forwards = self.resting_at(before[0]);
        run(&mut forwards, before.iter_mut());
        run(&mut forwards, signals.iter_mut());
        run(&mut forwards, after.iter_mut());
        let mut backwards = self.resting_at(after[padding - 1]);
        run(&mut backwards, after.iter_mut().rev());
        run(&mut backwards, signals.iter_mut().rev());
    }

    /// The sections as if the input had been `x` for ever.
    fn resting_at<const L: usize>(&self, mut x: [f64; L]) -> Vec<Section<L>> {
        let rest = |section: &Section| {
            let mut section = section.over();
            x = section.rest(x);
            section
        };
        self.sections.iter().map(rest).collect()
    }
}

/// Replaces each of `samples` by what comes out of `sections` for it.
fn run<'s, const L: usize>(sections: &mut [Section<L>], samples: impl Iterator<Item = &'s mut [f64; L]>) {
    match sections.len() {
        1 => run_in_registers::<1, L>(sections, samples),
        2 => run_in_registers::<2, L>(sections, samples),
        _ => samples.for_each(|x| *x = step(sections, *x)),
    }
}

/// The same of nearly all filters, which have one section or two: of a known number they stay in registers.
fn run_in_registers<'s, const N: usize, const L: usize>(
    sections: &mut [Section<L>],
    samples: impl Iterator<Item = &'s mut [f64; L]>,
) {
    let mut kept: [Section<L>; N] = from_fn(|at| sections[at]);
    samples.for_each(|x| *x = step(&mut kept, *x));
    sections.copy_from_slice(&kept);
}

/// One sample through `sections`.
#[inline(always)]
fn step<const L: usize>(sections: &mut [Section<L>], x: [f64; L]) -> [f64; L] {
    sections.iter_mut().fold(x, |x, section| section.step(x))
}
