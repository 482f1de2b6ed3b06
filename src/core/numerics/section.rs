//! A second-order section of a digital filter with its memory.

use std::array::from_fn;

/// A section over `L` signals side by side, in transposed direct form II: y = b0 x + z0, z0 = b1 x - a1 y + z1, z1 = b2 x - a2 y.
#[derive(Debug, Clone, Copy)]
pub struct Section<const L: usize = 1> {
    b: [f64; 3],
    /// a1 and a2; a0 is 1.
    a: [f64; 2],
    z: [[f64; L]; 2],
}

impl<const L: usize> Section<L> {
    /// Of the numerator `b` and the denominator `a`, in powers of 1/z; its input was 0 before.
    pub fn new(b: [f64; 3], a: [f64; 3]) -> Self {
        let [a0, a1, a2] = a;
        Self { b: b.map(|b| b / a0), a: [a1 / a0, a2 / a0], z: [[0.0; L]; 2] }
    }

    /// The same section for `M` signals, without memory.
    pub fn over<const M: usize>(&self) -> Section<M> {
        Section { b: self.b, a: self.a, z: [[0.0; M]; 2] }
    }

    /// The same section with the memory of `other` in the place of that of signal `l`.
    pub fn with_lane(&self, l: usize, other: &Section) -> Self {
        let mut with = *self;
        with.z.iter_mut().zip(&other.z).for_each(|(own, [other])| own[l] = *other);
        with
    }

    /// The section of signal `l` alone.
    pub fn lane(&self, l: usize) -> Section {
        Section { b: self.b, a: self.a, z: self.z.map(|z| [z[l]]) }
    }

    /// Magnitude of its slower pole: what is left of its memory after a sample.
    pub fn radius(&self) -> f64 {
        let [a1, a2] = self.a;
        let discriminant = a1 * a1 / 4.0 - a2;
        if discriminant < 0.0 { a2.sqrt() } else { a1.abs() / 2.0 + discriminant.sqrt() }
    }

    /// Gain for a signal that rests.
    fn gain(&self) -> f64 {
        self.b.iter().sum::<f64>() / (1.0 + self.a[0] + self.a[1])
    }

    /// As if the input had rested at `x` for ever; returns the output.
    pub fn rest(&mut self, x: [f64; L]) -> [f64; L] {
        let (b, a, gain) = (self.b, self.a, self.gain());
        self.z[1] = x.map(|x| (b[2] - a[1] * gain) * x);
        self.z[0] = from_fn(|l| (b[1] - a[0] * gain) * x[l] + self.z[1][l]);
        x.map(|x| gain * x)
    }

    /// The next sample of each signal.
    #[inline(always)]
    pub fn step(&mut self, x: [f64; L]) -> [f64; L] {
        let Self { b, a, z } = self;
        let y: [f64; L] = from_fn(|l| b[0] * x[l] + z[0][l]);
        z[0] = from_fn(|l| b[1] * x[l] - a[0] * y[l] + z[1][l]);
        z[1] = from_fn(|l| b[2] * x[l] - a[1] * y[l]);
        y
    }

    /// How late it passes slow signals on, samples: the group delay at rest.
    pub fn delay(&self) -> f64 {
        let slope = |c: [f64; 3]| (c[1] + 2.0 * c[2]) / c.iter().sum::<f64>();
        slope(self.b) - slope([1.0, self.a[0], self.a[1]])
    }
}
