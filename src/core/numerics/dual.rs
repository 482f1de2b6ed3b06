//! Numbers that carry their derivatives by several variables: forward differentiation, exact to rounding (Griewank and Walther,
//! Evaluating Derivatives, 2008, section 3.1).
//!
//! Of our own because the formulas need values and derivatives at 0, where a power's general rule gives no number.

use super::scalar::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// Variables that are differentiated by at once: two vector registers' worth, as many columns as a low-pass takes side by side.
pub const VARIABLES: usize = 4;

/// `of` each variable. A loop, not `from_fn`: compilers turn it into vector instructions wherever it is inlined.
#[inline(always)]
fn each(of: impl Fn(usize) -> f64) -> [f64; VARIABLES] {
    let mut slopes = [0.0; VARIABLES];
    for (at, slope) in slopes.iter_mut().enumerate() {
        *slope = of(at);
    }
    slopes
}

/// A value and its derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dual {
    /// The value.
    pub value: f64,
    /// Its derivative by each variable.
    pub slopes: [f64; VARIABLES],
}

impl Dual {
    /// Variable number `at`, where it is `value`.
    #[inline]
    pub fn variable(value: f64, at: usize) -> Self {
        Self { value, slopes: each(|i| f64::from(u8::from(i == at))) }
    }

    /// A function of it, whose value and derivative are these.
    #[inline]
    fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, slopes: each(|i| self.slopes[i] * slope) }
    }

    /// A function of two, whose value and derivatives are these.
    #[inline]
    fn join(self, other: Self, value: f64, by_self: f64, by_other: f64) -> Self {
        Self { value, slopes: each(|i| by_self * self.slopes[i] + by_other * other.slopes[i]) }
    }
}

impl From<f64> for Dual {
    #[inline]
    fn from(value: f64) -> Self {
        Self { value, slopes: [0.0; VARIABLES] }
    }
}

impl Neg for Dual {
    type Output = Self;

    #[inline]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl Add for Dual {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, slopes: each(|i| self.slopes[i] + other.slopes[i]) }
    }
}

impl Sub for Dual {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, slopes: each(|i| self.slopes[i] - other.slopes[i]) }
    }
}

impl Mul for Dual {
    type Output = Self;

    #[inline]
    fn mul(self, other: Self) -> Self {
        self.join(other, self.value * other.value, other.value, self.value)
    }
}

impl Div for Dual {
    type Output = Self;

    #[inline]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        self.join(other, value, 1.0 / other.value, -value / other.value)
    }
}

impl Add<f64> for Dual {
    type Output = Self;

    #[inline]
    fn add(self, other: f64) -> Self {
        Self { value: self.value + other, ..self }
    }
}

impl Sub<f64> for Dual {
    type Output = Self;

    #[inline]
    fn sub(self, other: f64) -> Self {
        Self { value: self.value - other, ..self }
    }
}

impl Mul<f64> for Dual {
    type Output = Self;

    #[inline]
    fn mul(self, other: f64) -> Self {
        self.chain(self.value * other, other)
    }
}

impl Div<f64> for Dual {
    type Output = Self;

    #[inline]
    fn div(self, other: f64) -> Self {
        self.chain(self.value / other, 1.0 / other)
    }
}

impl Add<Dual> for f64 {
    type Output = Dual;

    #[inline]
    fn add(self, other: Dual) -> Dual {
        other + self
    }
}

impl Sub<Dual> for f64 {
    type Output = Dual;

    #[inline]
    fn sub(self, other: Dual) -> Dual {
        other.chain(self - other.value, -1.0)
    }
}

impl Mul<Dual> for f64 {
    type Output = Dual;

    #[inline]
    fn mul(self, other: Dual) -> Dual {
        other * self
    }
}

impl Div<Dual> for f64 {
    type Output = Dual;

    #[inline]
    fn div(self, other: Dual) -> Dual {
        let value = self / other.value;
        other.chain(value, -value / other.value)
    }
}

impl AddAssign for Dual {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Dual {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Dual {
    #[inline]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

/// `slope`, or 0 where there is none.
fn or_zero(slope: f64) -> f64 {
    if slope.is_finite() { slope } else { 0.0 }
}

impl Scalar for Dual {
    type Given = f64;

    #[inline]
    fn value(self) -> f64 {
        self.value
    }

    #[inline]
    fn is_zero(self) -> bool {
        self == Self::from(0.0)
    }

    #[inline]
    fn sin(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(sin, cos)
    }

    #[inline]
    fn cos(self) -> Self {
        let (sin, cos) = self.value.sin_cos();
        self.chain(cos, -sin)
    }

    #[inline]
    fn tanh(self) -> Self {
        let value = self.value.tanh();
        self.chain(value, 1.0 - value * value)
    }

    #[inline]
    fn atan(self) -> Self {
        self.chain(self.value.atan(), 1.0 / (1.0 + self.value * self.value))
    }

    #[inline]
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.chain(value, value)
    }

    #[inline]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), 1.0 / self.value)
    }

    #[inline]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        self.chain(value, or_zero(0.5 / value))
    }

    #[inline]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }

    #[inline]
    fn powf(self, exponent: Self) -> Self {
        if self.value <= 0.0 {
            let value = self.value.powf(exponent.value);
            return self.join(exponent, value, or_zero(exponent.value * self.value.powf(exponent.value - 1.0)), 0.0);
        }
        // The logarithm is needed for the derivative; e to the product is then faster than the power, and as exact to a few roundings.
        let ln = self.value.ln();
        let value = (exponent.value * ln).exp();
        self.join(exponent, value, exponent.value * value / self.value, or_zero(value * ln))
    }

    #[inline]
    fn hypot(self, other: Self) -> Self {
        let value = self.value.hypot(other.value);
        self.join(other, value, or_zero(self.value / value), or_zero(other.value / value))
    }

    #[inline]
    fn min(self, other: Self) -> Self {
        if other.value < self.value { other } else { self }
    }

    #[inline]
    fn max(self, other: Self) -> Self {
        if other.value > self.value { other } else { self }
    }

    #[inline]
    fn if_positive(self, then: impl FnOnce() -> Self, otherwise: impl FnOnce() -> Self) -> Self {
        if self.value > 0.0 { then() } else { otherwise() }
    }
}
