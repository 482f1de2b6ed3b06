//! Filters that run one sample at a time, for torque as it comes.
//!
//! All start in the steady state of their first sample, so that a signal at rest carries no transient.

use super::filter::LowPass;
use super::scalar::Scalar;
use super::section::Section;
use std::collections::VecDeque;
use std::f64::consts::TAU;

/// Holds a signal back by a number of samples, not always whole; in between it is drawn straight.
#[derive(Debug, Clone)]
pub struct Delay {
    samples: f64,
    /// The newest last.
    kept: VecDeque<f64>,
}

impl Delay {
    /// Delay by `samples` samples, 0 or more.
    pub fn new(samples: f64) -> Self {
        Self { samples, kept: VecDeque::new() }
    }

    /// How late it is, samples.
    pub fn samples(&self) -> f64 {
        self.samples
    }

    /// The same, with nothing kept.
    pub fn fresh(&self) -> Self {
        Self::new(self.samples)
    }

    /// The next sample; before the first the signal rested there.
    pub fn step(&mut self, x: f64) -> f64 {
        let (whole, share) = (self.samples as usize, self.samples.fract());
        self.kept.push_back(x);
        while self.kept.len() > whole + 2 {
            self.kept.pop_front();
        }
        let back = |n: usize| self.kept[(self.kept.len() - 1).saturating_sub(n)];
        back(whole) + share * (back(whole + 1) - back(whole))
    }
}

/// A first-order lag, exact for a signal drawn straight between its samples.
///
/// With e = exp(-1/lag): y' = e y + (1 - g) x' + (g - e) x, g = lag (1 - e).
#[derive(Debug, Clone, Copy)]
pub struct Lag<S = f64> {
    samples: S,
    /// The last sample, and what came out.
    last: Option<(S, S)>,
}

impl<S: Scalar> Lag<S> {
    /// With a time constant of `samples` samples, 0 or more; at rest before its first sample.
    pub fn new(samples: S) -> Self {
        Self { samples, last: None }
    }

    /// The same with a time constant of `samples` samples from the next one on: for samples that come at other intervals.
    pub fn lasting(self, samples: S) -> Self {
        Self { samples, ..self }
    }

    /// The weights of its last output, of the sample and of the one before, where its time constant is above 0.
    pub fn weights(&self) -> [S; 3] {
        let kept = (S::from(-1.0) / self.samples).exp();
        let share = self.samples * (S::from(1.0) - kept);
        [kept, S::from(1.0) - share, share - kept]
    }

    /// The next sample.
    pub fn step(&mut self, x: S) -> S {
        let (x_before, y_before) = self.last.unwrap_or((x, x));
        let y = if self.samples.value() > 0.0 {
            let [kept, now, before] = self.weights();
            kept * y_before + now * x + before * x_before
        } else {
            x
        };
        self.last = Some((x, y));
        y
    }
}

/// A low-pass, run forwards only.
#[derive(Debug, Clone)]
pub struct CausalLowPass {
    sections: Vec<Section>,
    started: bool,
}

impl CausalLowPass {
    /// The sections of `filter`.
    pub fn new(filter: &LowPass) -> Self {
        Self { sections: filter.sections().to_vec(), started: false }
    }

    /// The next sample, filtered.
    pub fn step(&mut self, x: f64) -> f64 {
        let first = !std::mem::replace(&mut self.started, true);
        let next = |x, section: &mut Section| if first { section.rest(x) } else { section.step(x) };
        let [y] = self.sections.iter_mut().fold([x], next);
        y
    }

    /// The same, before its first sample.
    pub fn fresh(&self) -> Self {
        Self { started: false, ..self.clone() }
    }

    /// How late it passes slow signals on, samples.
    pub fn delay(&self) -> f64 {
        self.sections.iter().map(Section::delay).sum()
    }
}

/// Position, speed and acceleration of a signal, all equally late: the critically damped low-pass w^2 / (s + w)^2 and the same
/// times s and s^2, by the bilinear transform. Critically damped, so that a corner leaves no ringing behind.
#[derive(Debug, Clone, Copy)]
pub struct Follower {
    sections: [Section; 3],
    started: bool,
}

impl Follower {
    /// With w = 2 pi `cutoff_hz`, for samples at `rate_hz`.
    pub fn new(cutoff_hz: f64, rate_hz: f64) -> Self {
        let (w, k) = (TAU * cutoff_hz, 2.0 * rate_hz);
        // (s + w)^2 with s = k (1 - z^-1) / (1 + z^-1), times (1 + z^-1)^2.
        let a = [(k + w).powi(2), 2.0 * (w * w - k * k), (k - w).powi(2)];
        let place = [w * w, 2.0 * w * w, w * w];
        let speed = [k * w * w, 0.0, -k * w * w];
        let acceleration = [k * k * w * w, -2.0 * k * k * w * w, k * k * w * w];
        Self { sections: [place, speed, acceleration].map(|b| Section::new(b, a)), started: false }
    }

    /// The next sample's value, first and second derivative per second.
    pub fn step(&mut self, x: f64) -> [f64; 3] {
        let first = !std::mem::replace(&mut self.started, true);
        self.sections.each_mut().map(|section| if first { section.rest([x]) } else { section.step([x]) }).map(|[y]| y)
    }

    /// The same, before its first sample.
    pub fn fresh(&self) -> Self {
        Self { started: false, ..*self }
    }

    /// How late it is, samples.
    pub fn delay(&self) -> f64 {
        self.sections[0].delay()
    }
}
