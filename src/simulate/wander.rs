//! Smooth random motion: what a controller misses its command by, and how other joints move along.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Frequencies that a controller leaves of its error, Hz: slower ones it corrects, faster ones the joint's inertia.
const ERROR_HZ: (f64, f64) = (0.1, 1.0);
/// Frequencies at which another joint moves along, Hz.
const OTHER_HZ: (f64, f64) = (0.02, 0.2);
/// The farthest that each wave of another joint's motion goes, rad: about 60 deg in all.
const OTHER_RAD: f64 = 0.35;
/// Waves in an error and in a motion: so many that no period shows.
const ERROR_WAVES: usize = 16;
const OTHER_WAVES: usize = 3;

/// A smooth error whose root mean square is `rms_rad`, rad.
pub(super) fn error_rad(samples: usize, rate_hz: f64, rms_rad: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let waves = frequencies_hz(&mut random, ERROR_HZ, ERROR_WAVES);
    let waves: Vec<(f64, f64)> = waves.into_iter().map(|f| (f, random.random_range(0.0..TAU))).collect();
    let at = |t: f64| waves.iter().map(|(f, phase)| (TAU * f * t + phase).sin()).sum::<f64>();
    let mut error: Vec<f64> = (0..samples).map(|i| at(i as f64 / rate_hz)).collect();
    let rms = (error.iter().map(|x| x * x).sum::<f64>() / samples.max(1) as f64).sqrt();
    error.iter_mut().for_each(|x| *x *= rms_rad / rms);
    error
}

/// A smooth motion from rest at 0, rad.
pub(super) fn motion_rad(samples: usize, rate_hz: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let frequencies_hz = frequencies_hz(&mut random, OTHER_HZ, OTHER_WAVES);
    let waves: Vec<(f64, f64)> =
        frequencies_hz.into_iter().map(|f| (f, random.random_range(OTHER_RAD / 2.0..OTHER_RAD))).collect();
    let at = |t: f64| waves.iter().map(|(f, far_rad)| far_rad * (1.0 - (TAU * f * t).cos()) / 2.0).sum();
    (0..samples).map(|i| at(i as f64 / rate_hz)).collect()
}

/// One frequency in each of `count` equal shares of `band_hz`, shares of its logarithm.
fn frequencies_hz(random: &mut ChaCha8Rng, band_hz: (f64, f64), count: usize) -> Vec<f64> {
    let ratio = band_hz.1 / band_hz.0;
    (0..count).map(|i| band_hz.0 * ratio.powf((i as f64 + random.random::<f64>()) / count as f64)).collect()
}
