//! The residual that the encoder alone gives a perfect model: its steps and its noise act through velocity, acceleration and reversals that
//! are detected late, and give a residual that repeats with the motion and that causes can fit.
//!
//! The recorded motion, smoothed, is taken as the true one and read again by an encoder with the recorded one's step and noise: the gain of
//! a cause on the residual of a perfect model is then the gain that the encoder's errors alone give it. Errors in the regressors are
//! included: a noisy acceleration alone makes an inertia look smaller than it is.

use crate::log::Campaign;
use crate::numerics::filter::LowPass;
use crate::numerics::statistics::{deviation_by_median, extent, quantile};
use crate::prepare::{Trial, changes_rad};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

/// Where in the encoder's steps the motion is read again, as a share of one: not where it was.
const OFFSET: f64 = 0.382;
/// Order of the low-pass that smooths the motion.
const SMOOTHING_ORDER: usize = 2;
/// Variance of a reading that is uniform within a step, in squared steps ...
const STEP_VARIANCE: f64 = 1.0 / 12.0;
/// ... and what the median of its size would be taken for, (1.4826 / 4)^2.
const STEP_VARIANCE_BY_MEDIAN: f64 = 0.1374;
/// Variance of the fourth difference of white noise of variance 1: 1 + 16 + 36 + 16 + 1.
const FOURTH_DIFFERENCE_VARIANCE: f64 = 70.0;
/// Distances of less than this share of the position's range are rounding of numbers; finer steps are taken for as large, which is still too small to
/// matter.
const ROUNDING: f64 = 1e-6;
/// Share of the distances between readings that may be smaller than a step: a stretch without readings that was filled in has some.
const OFF_STEP: f64 = 0.05;

/// The motion of `trial` without its encoder, and as the encoder would have read it once more, rad.
pub fn motions_rad(campaign: &Campaign, trial: &Trial) -> [Vec<f64>; 2] {
    let smooth_rad = smooth_rad(campaign, trial);
    let again_rad = quantised(&trial.log.position_rad, &smooth_rad, trial.index as u64);
    [smooth_rad, again_rad]
}

/// The motion without the encoder: what of it the torque's low-pass would pass.
fn smooth_rad(campaign: &Campaign, trial: &Trial) -> Vec<f64> {
    match LowPass::new(SMOOTHING_ORDER, campaign.signal.lowpass_hz, trial.log.rate_hz) {
        Some(lowpass) => lowpass.zero_phase(&trial.position_rad),
        None => trial.position_rad.clone(),
    }
}

/// The encoder's step: readings that differ by no more than `rounding_rad` are one. As hardly any distance is smaller between neighbours among all
/// readings (from one sample to the next a quick joint may never go by a single step), but no more than the smallest from one sample to the next
/// (a simulated motion may come to the same few positions again and again). 0 where nothing changes.
fn step_rad(raw_rad: &[f64], rounding_rad: f64) -> f64 {
    let mut sorted_rad = raw_rad.to_vec();
    sorted_rad.sort_unstable_by(f64::total_cmp);
    let between_neighbours_rad = quantile(&mut changes_rad(&sorted_rad, rounding_rad).collect::<Vec<f64>>(), OFF_STEP);
    let step_rad = changes_rad(raw_rad, rounding_rad).fold(between_neighbours_rad, f64::min);
    if step_rad.is_finite() { step_rad } else { 0.0 }
}

/// `smooth_rad` as the encoder that read `raw_rad` would read it.
fn quantised(raw_rad: &[f64], smooth_rad: &[f64], seed: u64) -> Vec<f64> {
    let (low, high) = extent(raw_rad);
    let step_rad = step_rad(raw_rad, ROUNDING * (high - low));
    // Motion beyond the low-pass is in the first, noise that is not white is missing in the second.
    let mut off: Vec<f64> = raw_rad.iter().zip(smooth_rad).step_by(7).map(|(r, s)| (r - s).abs()).collect();
    let about_smooth_rad = deviation_by_median(&mut off);
    let fourth = |q: &[f64]| (q[4] - 4.0 * q[3] + 6.0 * q[2] - 4.0 * q[1] + q[0]).abs();
    let mut fourths: Vec<f64> = raw_rad.windows(5).map(fourth).collect();
    let of_differences_rad = deviation_by_median(&mut fourths) / FOURTH_DIFFERENCE_VARIANCE.sqrt();
    // A fourth difference mixes five readings and is nearly normal.
    let beyond_steps = |sigma_rad: f64, variance: f64| sigma_rad.powi(2) - variance * step_rad.powi(2);
    let noise_square = beyond_steps(about_smooth_rad, STEP_VARIANCE_BY_MEDIAN);
    let noise_rad = noise_square.min(beyond_steps(of_differences_rad, STEP_VARIANCE)).max(0.0).sqrt();
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
    use super::{ChaCha8Rng, Distribution, SeedableRng, StandardNormal, quantised, step_rad};

    #[test]
    fn a_motion_is_read_again_with_its_own_steps_and_noise() {
        let smooth: Vec<f64> = (0..4000).map(|i| (f64::from(i) * 2e-3).sin()).collect();
        let step = 1e-2;
        let raw = read(&smooth, step);
        let again = quantised(&raw, &smooth, 1);
        let off: f64 = again.iter().zip(&smooth).map(|(a, s)| (a - s).powi(2)).sum::<f64>() / smooth.len() as f64;
        assert!((off.sqrt() / (step / 12f64.sqrt()) - 1.0).abs() < 0.3, "{}", off.sqrt());
        assert!(again.iter().zip(&raw).any(|(a, r)| (a - r).abs() > 0.1 * step), "read elsewhere within a step");
    }

    fn read(rad: &[f64], step: f64) -> Vec<f64> {
        rad.iter().map(|q| (q / step).round() * step).collect()
    }

    #[test]
    fn steps_are_found_where_no_sample_goes_by_one() {
        // Moves of 4.3 steps a sample, with a jump back between them.
        let step = 1e-3;
        let moves: Vec<f64> = (0..2000).map(|i| (4.3137 * f64::from(i) * step) % 0.7).collect();
        let mut raw = read(&moves, step);
        assert!(raw.windows(2).all(|pair| (pair[1] - pair[0]).abs() > 3.5 * step));
        assert!((step_rad(&raw, 1e-9) / step - 1.0).abs() < 1e-6);
        // A gap of some samples filled in by a line.
        (1..8).for_each(|i| raw[700 + i] = raw[700] + 4.2371 * i as f64 * step);
        assert!((step_rad(&raw, 1e-9) / step - 1.0).abs() < 1e-6);
        let free: Vec<f64> = (0..2000).map(|i| 0.35 * (0.0137 * f64::from(i)).sin()).collect();
        assert!(step_rad(&free, 1e-9) < 0.1 * step, "no steps, but {}", step_rad(&free, 1e-9));
        let periodic: Vec<f64> = (0..2000).map(|i| (f64::from(i % 70) / 70.0 * std::f64::consts::TAU).cos()).collect();
        assert!(step_rad(&periodic, 1e-9) < 5e-3, "{}", step_rad(&periodic, 1e-9));
        assert_eq!(step_rad(&[0.3; 9], 1e-9), 0.0);
    }

    #[test]
    fn an_encoder_is_read_again_with_as_much_noise_as_it_has() {
        let (step, mut random) = (1e-2, ChaCha8Rng::seed_from_u64(5));
        // At these speeds the fourth differences of steps alone have a median of more than the steps' variance.
        for steps_a_sample in [2.0, 5.0, 9.0] {
            let smooth: Vec<f64> =
                (0..4000).map(|i| 5.0 * (f64::from(i) * steps_a_sample * step / 5.0).sin()).collect();
            let mut off_by = |noise: f64| {
                let mut noisy = |q: &f64| {
                    let of_one: f64 = StandardNormal.sample(&mut random);
                    q + noise * step * of_one
                };
                let raw = read(&smooth.iter().map(&mut noisy).collect::<Vec<f64>>(), step);
                let again = quantised(&raw, &smooth, 1);
                let square: f64 = again.iter().zip(&smooth).map(|(a, q)| (a - q).powi(2)).sum::<f64>() / 4000.0;
                square.sqrt() / step
            };
            let (none, some, much) = (off_by(0.0), off_by(0.5), off_by(2.0));
            assert!(none < 0.3, "{none}");
            assert!((0.45..0.75).contains(&some) && (1.6..2.4).contains(&much), "{some}, {much}");
        }
    }
}
