//! Zero-phase Butterworth low-pass, as SciPy's `butter(..., output="sos")` followed by `sosfiltfilt`.
//!
//! Run forwards and backwards over an odd extension of the signal, started in the steady state of its first sample: the
//! edges then carry no transient of a signal that is locally a straight line.

use super::section::Section;
use biquad::{Coefficients, Hertz, Type};
use std::array::from_fn;
use std::f64::consts::PI;

/// Parts of one signal that are filtered side by side.
const PARTS: usize = 4;
/// What is left of a state once it is forgotten: far below rounding.
const FORGOTTEN: f64 = 1e-20;

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
        let padding = Self::padding(self.order);
        if signal.len() <= padding {
            return;
        }
        let [mut before, mut after] = extension(signal.as_chunks().0, padding);
        let memory = self.memory();
        let mut forwards = self.resting_at(before[0]);
        run(&mut forwards, before.iter_mut());
        self.run_in_parts::<false>(&mut forwards, signal, memory);
        run(&mut forwards, after.iter_mut());
        let mut backwards = self.resting_at(after[padding - 1]);
        run(&mut backwards, after.iter_mut().rev());
        self.run_in_parts::<true>(&mut backwards, signal, memory);
    }

    /// The same for `L` signals side by side: each sample waits for the one before, so that four take hardly longer than one.
    pub fn zero_phase_together<const L: usize>(&self, signals: &mut [[f64; L]]) {
        let padding = Self::padding(self.order);
        if signals.len() <= padding {
            return;
        }
        let [mut before, mut after] = extension(signals, padding);
        let mut forwards = self.resting_at(before[0]);
        run(&mut forwards, before.iter_mut());
        run(&mut forwards, signals.iter_mut());
        run(&mut forwards, after.iter_mut());
        let mut backwards = self.resting_at(after[padding - 1]);
        run(&mut backwards, after.iter_mut().rev());
        run(&mut backwards, signals.iter_mut().rev());
    }

    /// After how many samples nothing of an earlier state is left to rounding.
    fn memory(&self) -> usize {
        let radius = self.sections.iter().map(Section::radius).fold(0.0, f64::max);
        // A section without poles still remembers two samples.
        ((FORGOTTEN.ln() / radius.ln()).ceil() as usize).max(2 * self.sections.len())
    }

    /// `signal` through `sections`, `BACKWARDS` or forwards. Each sample waits for the one before: a long signal is cut into parts that run side by
    /// side, all but the first from so far before their own beginning that their state there is forgotten.
    fn run_in_parts<const BACKWARDS: bool>(&self, sections: &mut [Section], signal: &mut [f64], memory: usize) {
        let n = signal.len();
        let part = n.saturating_sub(memory) / PARTS;
        let at = |i: usize| if BACKWARDS { n - 1 - i } else { i };
        let mut done = 0;
        if part >= memory {
            let rest = self.resting_at(from_fn::<f64, PARTS, _>(|l| signal[at(l * part)]));
            let first = |(rest, first): (&Section<PARTS>, &Section)| rest.with_lane(0, first);
            let mut together: Vec<Section<PARTS>> = rest.iter().zip(sections.iter()).map(first).collect();
            match together.len() {
                1 => side_by_side::<1>(&mut together, signal, at, part, memory),
                2 => side_by_side::<2>(&mut together, signal, at, part, memory),
                _ => return run(sections, in_order::<BACKWARDS>(signal)),
            }
            sections.iter_mut().zip(&together).for_each(|(last, section)| *last = section.lane(PARTS - 1));
            done = PARTS * part + memory;
        }
        let left = if BACKWARDS { &mut signal[..n - done] } else { &mut signal[done..] };
        run(sections, in_order::<BACKWARDS>(left));
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

/// The odd extension of `signals` by `padding` samples: turned by 180 deg about their first and their last sample.
fn extension<const L: usize>(signals: &[[f64; L]], padding: usize) -> [Vec<[f64; L]>; 2] {
    let turned = |about: usize, i: usize| from_fn(|l| 2.0 * signals[about][l] - signals[i][l]);
    let last = signals.len() - 1;
    [(1..=padding).rev().map(|i| turned(0, i)).collect(), (1..=padding).map(|i| turned(last, last - i)).collect()]
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

/// The first `PARTS` `part` + `memory` samples of `signal` in the order of `at`, in parts: each runs over `part` + `memory` samples, of which
/// the first `memory` are another's but for the first part.
fn side_by_side<const N: usize>(
    sections: &mut [Section<PARTS>],
    signal: &mut [f64],
    at: impl Fn(usize) -> usize,
    part: usize,
    memory: usize,
) {
    let mut kept: [Section<PARTS>; N] = from_fn(|at| sections[at]);
    for i in 0..part + memory {
        let y = step(&mut kept, from_fn(|l| signal[at(l * part + i)]));
        let own = if i < memory { 1 } else { PARTS };
        y[..own].iter().enumerate().for_each(|(l, y)| signal[at(l * part + i)] = *y);
    }
    sections.copy_from_slice(&kept);
}

/// The samples of `signal`, the last first if `BACKWARDS`.
fn in_order<const BACKWARDS: bool>(signal: &mut [f64]) -> impl Iterator<Item = &mut [f64; 1]> {
    let n = signal.len();
    let mut samples = signal.as_chunks_mut::<1>().0.iter_mut();
    (0..n).filter_map(move |_| if BACKWARDS { samples.next_back() } else { samples.next() })
}

#[cfg(test)]
mod tests {
    use super::LowPass;

    #[test]
    fn a_long_signal_in_parts_comes_out_as_in_one() {
        for (order, cutoff_hz, samples) in
            [(4, 5.0, 20_003), (4, 20.0, 4_000), (3, 8.0, 9_001), (1, 2.0, 5_000), (5, 9.0, 7_000)]
        {
            let lowpass = LowPass::new(order, cutoff_hz, 200.0).unwrap();
            let signal: Vec<f64> = (0..samples)
                .map(|i| f64::from(i) * 1e-3 + (f64::from(i) * 0.37).sin() + f64::from(i * 7919 % 101) / 50.0)
                .collect();
            let mut in_one: Vec<[f64; 2]> = signal.iter().map(|x| [*x, 0.0]).collect();
            lowpass.zero_phase_together(&mut in_one);
            let in_parts = lowpass.zero_phase(&signal);
            let apart = in_parts.iter().zip(&in_one).map(|(a, [b, _])| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-11, "order {order} at {cutoff_hz} Hz: {apart}");
        }
    }
}
