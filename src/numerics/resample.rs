//! A series read between its samples.

/// `values` at `x`, counted in samples from the first, drawn straight between samples and held at its ends; 0 of none.
pub fn between(values: &[f64], x: f64) -> f64 {
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    let x = x.clamp(0.0, last as f64);
    let before = (x as usize).min(last);
    let share = x - before as f64;
    values[before] + share * (values[(before + 1).min(last)] - values[before])
}

/// `values` as they were `delay` samples before, drawn straight between samples; held at its ends.
pub fn shifted(values: &[f64], delay: f64) -> Vec<f64> {
    (0..values.len()).map(|i| between(values, i as f64 - delay)).collect()
}
