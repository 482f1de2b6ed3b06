//! Smooth random motion: what a controller misses its command by, and how other joints move along.

use crate::numerics::statistics::{extent, root_mean_square};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Waves in the travel from which an error is made, in one range of the motion: friction and gear decide it, so that it changes
/// with the way and not with the time, and a slow motion does not turn round for it.
const ERROR_WAVES_IN_RANGE: (f64, f64) = (0.3, 3.0);
/// Frequencies at which another joint moves along, Hz.
const OTHER_HZ: (f64, f64) = (0.02, 0.2);
/// The farthest that each wave of another joint's motion goes, rad: about 60 deg in all.
const OTHER_RAD: f64 = 0.35;
/// Waves in an error and in a motion: enough that no period shows.
const ERROR_WAVES: usize = 16;
const OTHER_WAVES: usize = 3;

/// A smooth error along `positions_rad`, whose root mean square is `rms_rad`, rad.
pub(super) fn error_rad(positions_rad: &[f64], rms_rad: f64, seed: u64) -> Vec<f64> {
    let (low, high) = extent(positions_rad);
    let range_rad = if high > low { high - low } else { 1.0 };
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let numbers = spread(&mut random, ERROR_WAVES_IN_RANGE, ERROR_WAVES);
    let waves: Vec<(f64, f64)> = numbers.into_iter().map(|n| (n / range_rad, random.random_range(0.0..TAU))).collect();
    let at = |travel_rad: f64| waves.iter().map(|(n, phase)| (TAU * n * travel_rad + phase).sin()).sum::<f64>();
    let travels = positions_rad.iter().scan((0.0, None), |(travel_rad, before), x| {
        *travel_rad += before.map_or(0.0, |before: f64| (x - before).abs());
        *before = Some(*x);
        Some(*travel_rad)
    });
    let mut error: Vec<f64> = travels.map(at).collect();
    let rms = root_mean_square(&error);
    if rms > 0.0 {
        error.iter_mut().for_each(|x| *x *= rms_rad / rms);
    }
    error
}

/// A smooth motion from rest at 0, rad.
pub(super) fn motion_rad(samples: usize, rate_hz: f64, seed: u64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let frequencies_hz = spread(&mut random, OTHER_HZ, OTHER_WAVES);
    let waves: Vec<(f64, f64)> =
        frequencies_hz.into_iter().map(|f| (f, random.random_range(OTHER_RAD / 2.0..OTHER_RAD))).collect();
    let at = |t: f64| waves.iter().map(|(f, far_rad)| far_rad * (1.0 - (TAU * f * t).cos()) / 2.0).sum();
    (0..samples).map(|i| at(i as f64 / rate_hz)).collect()
}

/// One value in each of `count` equal shares of `band`, shares of its logarithm.
fn spread(random: &mut ChaCha8Rng, band: (f64, f64), count: usize) -> Vec<f64> {
    let ratio = band.1 / band.0;
    (0..count).map(|i| band.0 * ratio.powf((i as f64 + random.random::<f64>()) / count as f64)).collect()
}
