//! A series read between its samples.

/// `values` as they were `delay` samples before, drawn straight between samples; held at its ends.
pub fn shifted(values: &[f64], delay: f64) -> Vec<f64> {
    let Some(last) = values.len().checked_sub(1) else { return Vec::new() };
    let at = |i: usize| {
        let x = (i as f64 - delay).clamp(0.0, last as f64);
        let before = (x as usize).min(last);
        let share = x - before as f64;
        values[before] + share * (values[(before + 1).min(last)] - values[before])
    };
    (0..values.len()).map(at).collect()
}
