//! Zero-phase Butterworth low-pass, as SciPy's `butter(..., output="sos")` followed by `sosfiltfilt`.
//!
//! Run forwards and backwards over an odd extension of the signal, started in the steady state of its first sample: the
//! edges then carry no transient of a signal that is locally a straight line.

use sci_rs::signal::filter::design::{DigitalFilter, FilterBandType, FilterOutputType, Sos, butter_dyn};
use sci_rs::signal::filter::sosfiltfilt_dyn;

/// A low-pass for one sample rate.
#[derive(Debug, Clone)]
pub struct LowPass {
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
            DigitalFilter::Sos(sos) => Some(Self { sections: sos.sos, order }),
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
        if signal.len() <= Self::padding(self.order) {
            return signal.to_vec();
        }
        sosfiltfilt_dyn(signal.iter(), &self.sections)
    }
}
