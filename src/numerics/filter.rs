//! Zero-phase Butterworth low-pass, as SciPy's `butter(..., output="sos")` followed by `sosfiltfilt`.
//!
//! Run forwards and backwards over an odd extension of the signal, started in the steady state of its first sample: the
//! edges then carry no transient of a signal that is locally a straight line.

use sci_rs::signal::filter::design::{DigitalFilter, FilterBandType, FilterOutputType, Sos, butter_dyn};
use sci_rs::signal::filter::sosfilt_zi_dyn;
use std::array::from_fn;

/// A low-pass for one sample rate.
#[derive(Debug, Clone)]
pub struct LowPass {
    /// In the steady state of an input of 1.
    sections: Vec<Sos<f64>>,
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
        let design = butter_dyn(
            order,
            vec![cutoff_hz],
            Some(FilterBandType::Lowpass),
            Some(false),
            Some(FilterOutputType::Sos),
            Some(rate_hz),
        );
        match design {
            DigitalFilter::Sos(mut sos) => {
                sosfilt_zi_dyn::<_, _, Sos<f64>>(sos.sos.iter_mut());
                Some(Self { sections: sos.sos, order })
            }
            _ => None,
        }
    }

    /// Numerator and denominator of its second-order sections.
    pub fn sections(&self) -> impl Iterator<Item = ([f64; 3], [f64; 3])> {
        self.sections.iter().map(|section| (section.b, section.a))
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
    fn resting_at<const L: usize>(&self, x: [f64; L]) -> Vec<Section<L>> {
        let rest = |sos: &Sos<f64>| Section { b: sos.b, a: sos.a, z: [x.map(|x| sos.zi0 * x), x.map(|x| sos.zi1 * x)] };
        self.sections.iter().map(rest).collect()
    }
}

/// A second-order section with its memory of `L` signals.
#[derive(Debug, Clone, Copy)]
struct Section<const L: usize> {
    b: [f64; 3],
    a: [f64; 3],
    z: [[f64; L]; 2],
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

/// One sample through `sections` in transposed direct form II: y = b0 x + z0, z0 = b1 x - a1 y + z1, z1 = b2 x - a2 y.
#[inline(always)]
fn step<const L: usize>(sections: &mut [Section<L>], x: [f64; L]) -> [f64; L] {
    sections.iter_mut().fold(x, |x, Section { b, a, z }| {
        let y: [f64; L] = from_fn(|l| b[0] * x[l] + z[0][l]);
        z[0] = from_fn(|l| b[1] * x[l] - a[1] * y[l] + z[1][l]);
        z[1] = from_fn(|l| b[2] * x[l] - a[2] * y[l]);
        y
    })
}
