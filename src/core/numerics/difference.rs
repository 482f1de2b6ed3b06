//! Velocity and acceleration from equally spaced samples: central differences, one-sided at the two ends.

/// First derivative at sample `at` of `samples` taken at `rate_hz`, per second; 0 of a single sample.
pub fn velocity_at(samples: &[f64], rate_hz: f64, at: usize) -> f64 {
    let last = samples.len() - 1;
    match at {
        _ if last == 0 => 0.0,
        0 => (samples[1] - samples[0]) * rate_hz,
        _ if at == last => (samples[last] - samples[last - 1]) * rate_hz,
        _ => (samples[at + 1] - samples[at - 1]) * (0.5 * rate_hz),
    }
}

/// Second derivative at sample `at` of `samples` taken at `rate_hz`, per second squared; held at the two ends, 0 of fewer than
/// three samples.
pub fn acceleration_at(samples: &[f64], rate_hz: f64, at: usize) -> f64 {
    if samples.len() < 3 {
        return 0.0;
    }
    let middle = at.clamp(1, samples.len() - 2);
    (samples[middle + 1] - 2.0 * samples[middle] + samples[middle - 1]) * rate_hz * rate_hz
}

/// First derivative of all `samples` taken at `rate_hz`, per second.
pub fn velocity(samples: &[f64], rate_hz: f64) -> Vec<f64> {
    (0..samples.len()).map(|at| velocity_at(samples, rate_hz, at)).collect()
}

/// Second derivative of all `samples` taken at `rate_hz`, per second squared.
pub fn acceleration(samples: &[f64], rate_hz: f64) -> Vec<f64> {
    (0..samples.len()).map(|at| acceleration_at(samples, rate_hz, at)).collect()
}
