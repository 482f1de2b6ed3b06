//! Numbers that a formula can be written over: a double, a double with its derivatives, an expression to be printed as code.
//!
//! What a formula does with numbers alone, it does through this trait; then one text of it predicts, differentiates and exports.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number of a formula. Where it meets a [`Scalar::Given`], that stands on the left: `given * number`.
pub trait Scalar:
    Copy
    + Debug
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// What a formula is given and no variable changes, as the motion of a joint: a plain number where derivatives are taken.
    type Given: Scalar<Given = Self::Given>
        + Into<Self>
        + Add<Self, Output = Self>
        + Sub<Self, Output = Self>
        + Mul<Self, Output = Self>
        + Div<Self, Output = Self>;

    /// Its value; NaN of an expression that is no number by itself.
    fn value(self) -> f64;

    /// Whether it is 0 whatever the variables are.
    fn is_zero(self) -> bool;

    /// Sine.
    fn sin(self) -> Self;

    /// Cosine.
    fn cos(self) -> Self;

    /// Hyperbolic tangent.
    fn tanh(self) -> Self;

    /// Arc tangent.
    fn atan(self) -> Self;

    /// e to its power.
    fn exp(self) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self;

    /// Square root; at 0 its derivative is taken as 0.
    fn sqrt(self) -> Self;

    /// Its magnitude; at 0 the derivative is that of its right side.
    fn abs(self) -> Self;

    /// To a power; the derivatives at 0 are 0 where they do not exist.
    fn powf(self, exponent: Self) -> Self;

    /// sqrt(self^2 + other^2); at (0, 0) its derivative is taken as 0.
    fn hypot(self, other: Self) -> Self;

    /// The smaller.
    fn min(self, other: Self) -> Self;

    /// The larger.
    fn max(self, other: Self) -> Self;

    /// `then` where it is above 0, else `otherwise`.
    fn if_positive(self, then: impl FnOnce() -> Self, otherwise: impl FnOnce() -> Self) -> Self;

    /// The same, by this name where it is printed.
    #[inline]
    fn named(self, _name: &'static str) -> Self {
        self
    }

    /// Sine and cosine.
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }

    /// Its square.
    #[inline]
    fn squared(self) -> Self {
        self * self
    }
}

impl Scalar for f64 {
    type Given = Self;

    #[inline]
    fn value(self) -> f64 {
        self
    }

    #[inline]
    fn is_zero(self) -> bool {
        self == 0.0
    }

    #[inline]
    fn sin(self) -> Self {
        self.sin()
    }

    #[inline]
    fn cos(self) -> Self {
        self.cos()
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        self.sin_cos()
    }

    #[inline]
    fn tanh(self) -> Self {
        self.tanh()
    }

    #[inline]
    fn atan(self) -> Self {
        self.atan()
    }

    #[inline]
    fn exp(self) -> Self {
        self.exp()
    }

    #[inline]
    fn ln(self) -> Self {
        self.ln()
    }

    #[inline]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline]
    fn abs(self) -> Self {
        self.abs()
    }

    #[inline]
    fn powf(self, exponent: Self) -> Self {
        self.powf(exponent)
    }

    #[inline]
    fn hypot(self, other: Self) -> Self {
        self.hypot(other)
    }

    #[inline]
    fn min(self, other: Self) -> Self {
        self.min(other)
    }

    #[inline]
    fn max(self, other: Self) -> Self {
        self.max(other)
    }

    #[inline]
    fn if_positive(self, then: impl FnOnce() -> Self, otherwise: impl FnOnce() -> Self) -> Self {
        if self > 0.0 { then() } else { otherwise() }
    }
}
