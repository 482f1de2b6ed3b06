//! Velocity and acceleration from equally spaced samples: central differences, one-sided at the two ends.

/// First derivative of `samples` taken at `rate_hz`, per second.
pub fn velocity(samples: &[f64], rate_hz: f64) -> Vec<f64> {
    let n = samples.len();
    if n < 2 {
        return vec![0.0; n];
    }
    let mut out = Vec::with_capacity(n);
    out.push((samples[1] - samples[0]) * rate_hz);
    out.extend(samples.windows(3).map(|w| (w[2] - w[0]) * (0.5 * rate_hz)));
    out.push((samples[n - 1] - samples[n - 2]) * rate_hz);
    out
}

/// Second derivative of `samples` taken at `rate_hz`, per second squared; held at the two ends.
pub fn acceleration(samples: &[f64], rate_hz: f64) -> Vec<f64> {
    let n = samples.len();
    if n < 3 {
        return vec![0.0; n];
    }
    let mut out = Vec::with_capacity(n);
    out.push(0.0);
    out.extend(samples.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]) * rate_hz * rate_hz));
    out.push(out[n - 2]);
    out[0] = out[1];
    out
}
