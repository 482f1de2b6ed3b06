//! Zero-phase Butterworth low-pass, as SciPy's `butter(..., output="sos")` followed by `sosfiltfilt`.
//!
//! Run forwards and backwards over an odd extension of the signal, started in the steady state of its first sample: the
//! edges then carry no transient of a signal that is locally a straight line.

use sci_rs::signal::filter::design::{DigitalFilter, FilterBandType, FilterOutputType, Sos, butter_dyn};
use sci_rs::signal::filter::sosfilt_zi_dyn;

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
        let padding = Self::padding(self.order);
        if signal.len() <= padding {
            return;
        }
        // The odd extension: the signal turned by 180 deg about its first and its last sample.
        let last = signal.len() - 1;
        let before: Vec<f64> = (1..=padding).rev().map(|i| 2.0 * signal[0] - signal[i]).collect();
        let mut after: Vec<f64> = (1..=padding).map(|i| 2.0 * signal[last] - signal[last - i]).collect();
        let mut forwards = self.resting_at(before[0]);
        before.iter().for_each(|x| {
            step(&mut forwards, *x);
        });
        run(&mut forwards, signal.iter_mut());
        run(&mut forwards, after.iter_mut());
        let mut backwards = self.resting_at(after[padding - 1]);
        run(&mut backwards, after.iter_mut().rev());
        run(&mut backwards, signal.iter_mut().rev());
    }

    /// The sections as if the input had been `x` for ever.
    fn resting_at(&self, x: f64) -> Vec<Sos<f64>> {
        let rest = |section: &Sos<f64>| Sos { zi0: section.zi0 * x, zi1: section.zi1 * x, ..*section };
        self.sections.iter().map(rest).collect()
    }
}

/// Replaces each of `samples` by what comes out of `sections` for it.
fn run<'s>(sections: &mut [Sos<f64>], samples: impl Iterator<Item = &'s mut f64>) {
    // Nearly all filters have two sections; of a known number they stay in registers.
    match <&mut [Sos<f64>; 2]>::try_from(&mut *sections) {
        Ok(two) => samples.for_each(|x| *x = step(two, *x)),
        Err(_) => samples.for_each(|x| *x = step(sections, *x)),
    }
}

/// One sample through `sections` in transposed direct form II: y = b0 x + z0, z0 = b1 x - a1 y + z1, z1 = b2 x - a2 y.
#[inline(always)]
fn step(sections: &mut [Sos<f64>], x: f64) -> f64 {
    sections.iter_mut().fold(x, |x, section| {
        let y = section.b[0] * x + section.zi0;
        section.zi0 = section.b[1] * x - section.a[1] * y + section.zi1;
        section.zi1 = section.b[2] * x - section.a[2] * y;
        y
    })
}
