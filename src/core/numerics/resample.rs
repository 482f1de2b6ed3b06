//! A series read between its samples.

use super::scalar::Scalar;

/// `values` at `x`, counted in samples from the first, drawn straight between samples and held at its ends; 0 of none.
pub fn between<S: Scalar>(values: &[S], x: S) -> S {
    let Some(last) = values.len().checked_sub(1) else { return S::from(0.0) };
    let x = x.max(S::from(0.0)).min(S::from(last as f64));
    let before = (x.value() as usize).min(last);
    let share = x - before as f64;
    values[before] + share * (values[(before + 1).min(last)] - values[before])
}

/// `values` as they were `delay` samples before, drawn straight between samples; held at its ends.
pub fn shifted<S: Scalar>(values: &[S], delay: S) -> Vec<S> {
    (0..values.len()).map(|i| between(values, S::from(i as f64) - delay)).collect()
}
