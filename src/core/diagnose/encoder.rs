//! The residual that the encoder alone gives a perfect model: its steps and its noise act through velocity, acceleration and reversals that
//! are detected late, and give a residual that repeats with the motion and that causes can fit.
//!
//! The recorded motion, smoothed, is taken as the true one and read again by an encoder with the recorded one's step and noise: the gain of
//! a cause on the residual of a perfect model is then the gain that the encoder's errors alone give it. Errors in the regressors are
//! included: a noisy acceleration alone makes an inertia look smaller than it is.

use crate::log::Campaign;
use crate::numerics::filter::LowPass;
use crate::numerics::statistics::{deviation_by_median, extent};
use crate::prepare::{Trial, smallest_change_rad};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Where in the encoder's steps the motion is read again, as a share of one: not where it was.
const OFFSET: f64 = 0.382;
/// Order of the low-pass that smooths the motion.
const SMOOTHING_ORDER: usize = 2;
/// Variance of a reading that is uniform within a step, in squared steps.
const STEP_VARIANCE: f64 = 1.0 / 12.0;
/// Variance of the fourth difference of white noise of variance 1: 1 + 16 + 36 + 16 + 1.
const FOURTH_DIFFERENCE_VARIANCE: f64 = 70.0;
/// Changes of less than this share of the position's range are rounding of numbers, not steps.
const ROUNDING: f64 = 1e-9;

/// The motion of `trial` without its encoder, and as the encoder would have read it once more, rad.
pub fn motions_rad(campaign: &Campaign, trial: &Trial) -> [Vec<f64>; 2] {
    let smooth_rad = smooth_rad(campaign, trial);
    let again_rad = quantised(&trial.log.position_rad, &smooth_rad, trial.index as u64);
    [smooth_rad, again_rad]
}

/// The motion without the encoder: what of it the torque's low-pass would pass.
fn smooth_rad(campaign: &Campaign, trial: &Trial) -> Vec<f64> {
    match LowPass::new(SMOOTHING_ORDER, campaign.signal.lowpass_hz, trial.log.rate_hz) {
        Some(lowpass) => lowpass.zero_phase(trial.followed_rad()),
        None => trial.position_rad.clone(),
    }
}

/// `smooth_rad` as the encoder that read `raw_rad` would read it.
fn quantised(raw_rad: &[f64], smooth_rad: &[f64], seed: u64) -> Vec<f64> {
    let (low, high) = extent(raw_rad);
    let step_rad = smallest_change_rad(raw_rad, ROUNDING * (high - low)).unwrap_or(0.0);
    // Motion beyond the low-pass is in the first, noise that is not white is missing in the second.
    let mut off: Vec<f64> = raw_rad.iter().zip(smooth_rad).step_by(7).map(|(r, s)| (r - s).abs()).collect();
    let about_smooth_rad = deviation_by_median(&mut off);
    let fourth = |q: &[f64]| (q[4] - 4.0 * q[3] + 6.0 * q[2] - 4.0 * q[1] + q[0]).abs();
    let mut fourths: Vec<f64> = raw_rad.windows(5).map(fourth).collect();
    let of_differences_rad = deviation_by_median(&mut fourths) / FOURTH_DIFFERENCE_VARIANCE.sqrt();
    let sigma_rad = about_smooth_rad.min(of_differences_rad);
    let noise_rad = (sigma_rad * sigma_rad - STEP_VARIANCE * step_rad * step_rad).max(0.0).sqrt();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let read = |q: &f64| {
        let noise: f64 = StandardNormal.sample(&mut random);
        let q = q + noise_rad * noise;
        if step_rad > 0.0 { ((q / step_rad + OFFSET).round() - OFFSET) * step_rad } else { q }
    };
    smooth_rad.iter().map(read).collect()
}

#[cfg(test)]
mod tests {
    use super::quantised;

    #[test]
    fn a_motion_is_read_again_with_its_own_steps_and_noise() {
        let smooth: Vec<f64> = (0..4000).map(|i| (f64::from(i) * 2e-3).sin()).collect();
        let step = 1e-2;
        let raw: Vec<f64> = smooth.iter().map(|q| (q / step).round() * step).collect();
        let again = quantised(&raw, &smooth, 1);
        let off: f64 = again.iter().zip(&smooth).map(|(a, s)| (a - s).powi(2)).sum::<f64>() / smooth.len() as f64;
        assert!((off.sqrt() / (step / 12f64.sqrt()) - 1.0).abs() < 0.3, "{}", off.sqrt());
        assert!(again.iter().zip(&raw).any(|(a, r)| (a - r).abs() > 0.1 * step), "read elsewhere within a step");
    }
}
