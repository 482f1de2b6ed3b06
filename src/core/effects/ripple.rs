//! A function of position that repeats: its fundamental and harmonics.

use super::{Extent, Parameter, Sample};
use crate::numerics::scalar::Scalar;
use std::f64::consts::TAU;

/// Harmonics of a ripple: a sawtooth, the sharpest one met, has 93 % of its energy in five of them.
pub const HARMONICS: usize = 5;
/// Numbers of a ripple.
pub(super) const NUMBERS: usize = 3 + 2 * HARMONICS;

/// A ripple's parameters: periods in a radian (or metre), sine and cosine of each harmonic, and of one in proportion to what the
/// cable carries, by the names `sin` and `cos`.
pub(super) const fn parameters(sin: &'static str, cos: &'static str) -> [Parameter; NUMBERS] {
    [
        Parameter::shape("periods_per_rad", 1e-3, 1e5),
        Parameter::strength("sin_1_nm"),
        Parameter::strength("cos_1_nm"),
        Parameter::strength("sin_2_nm"),
        Parameter::strength("cos_2_nm"),
        Parameter::strength("sin_3_nm"),
        Parameter::strength("cos_3_nm"),
        Parameter::strength("sin_4_nm"),
        Parameter::strength("cos_4_nm"),
        Parameter::strength("sin_5_nm"),
        Parameter::strength("cos_5_nm"),
        Parameter::strength(sin),
        Parameter::strength(cos),
    ]
}

/// At least this many periods within the range: fewer are hardly told from any other function of position.
pub const PERIODS_MIN: f64 = 1.2;

/// The ripple at `sample`, N m: what is always there, and what there is of it in each N m that the cable carries.
pub(super) fn ripple_nm<S: Scalar>(p: &[S], sample: &Sample<'_, S::Given>) -> (S, S) {
    let (sin, cos) = (sample.own.position * (p[0] * TAU)).sin_cos();
    // The angle of each harmonic is the one before turned on by the fundamental.
    let (mut s, mut c, mut sum) = (sin, cos, S::from(0.0));
    let (always, by_load) = p[1..].split_at(2 * HARMONICS);
    let pairs = always.chunks_exact(2);
    let used = pairs.clone().rposition(|pair| !(pair[0].is_zero() && pair[1].is_zero())).map_or(0, |at| at + 1);
    for (at, pair) in pairs.take(used).enumerate() {
        if at > 0 {
            (s, c) = (s * cos + c * sin, c * cos - s * sin);
        }
        sum += pair[0] * s + pair[1] * c;
    }
    (sum, by_load[0] * sin + by_load[1] * cos)
}

/// Whether the range shows enough of its periods for them to be told from any other function of position.
pub(super) fn repeats(p: &[f64], extent: &Extent) -> bool {
    p[0] * (extent.position_rad.1 - extent.position_rad.0) >= PERIODS_MIN
}
