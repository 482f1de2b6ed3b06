//! A clipped torque is told; what merely looks like one is not.

use super::{CAMPAIGN, csv, folder, read_first};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal};
use tautline::log::{Kind, Log};

/// Samples of one leg, of the rest after it, and of the whole log: back and forth over 100 deg, twice.
const LEG: usize = 4000;
const REST: usize = 500;
const SAMPLES: usize = 4 * (LEG + REST);

/// Position, deg, and direction at a sample; rests at the ends.
fn motion(sample: usize) -> (f64, f64) {
    let (leg, within) = (sample / (LEG + REST), sample % (LEG + REST));
    let way = 100.0 * within.min(LEG) as f64 / LEG as f64;
    if leg.is_multiple_of(2) { (10.0 + way, 1.0) } else { (110.0 - way, -1.0) }
}

/// Gravity and Coulomb friction, N m, without noise.
fn torque(sample: usize) -> f64 {
    let (position, direction) = motion(sample);
    0.3 * position.to_radians().sin() + 0.1 * direction
}

fn noise(sd: f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let normal = Normal::new(0.0, sd).expect("a spread");
    (0..SAMPLES).map(|_| normal.sample(&mut random)).collect()
}

fn log(at: impl Fn(usize) -> f64) -> Log {
    let text = csv(SAMPLES, |sample| (motion(sample).0, at(sample)));
    read_first(folder(&CAMPAIGN.replace("torque_sign = -1", "torque_sign = 1"), text).path()).expect("reads")
}

fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

#[track_caller]
fn assert_clean(log: &Log) {
    let others = log.findings.iter().filter(|finding| finding.kind != Kind::Quantised);
    assert!(log.clipped.is_empty() && others.count() == 0, "{:?}", log.warnings);
}

#[test]
fn a_clipped_sensor_is_told_with_its_samples() {
    let noise = noise(0.005);
    for step in [1e-6, 1e-4, 1e-3] {
        let read = |sample: usize| rounded(torque(sample) + noise[sample], step).min(rounded(0.36, step));
        let log = log(read);
        let marked: usize = log.clipped.iter().map(|run| run.len()).sum();
        let clipped = (0..SAMPLES).filter(|sample| read(*sample) == rounded(0.36, step)).count();
        assert_eq!(marked, clipped);
        assert!(log.clipped.iter().all(|run| log.torque_nm[run.clone()].iter().all(|y| *y == rounded(0.36, step))));
        let warning = log.warnings[0].to_string();
        assert!(warning.contains(&format!("{marked} samples")) && warning.contains("0.36"), "{warning}");
        assert!(warning.contains("% of the log") && warning.contains("left out"), "{warning}");
    }
}

#[test]
fn both_ends_may_clip_and_for_most_of_the_time() {
    let noise = noise(0.005);
    let log = log(|sample| (torque(sample) + noise[sample]).clamp(0.0, 0.2));
    assert_eq!(log.warnings.len(), 2);
    assert!(log.clipped.is_sorted_by_key(|run| run.start));
}

#[test]
fn a_clipped_simulation_without_noise_is_told() {
    assert_eq!(log(|sample| torque(sample).min(0.36)).warnings.len(), 1);
}

#[test]
fn noise_free_torque_at_rest_is_no_clipping() {
    // Its greatest reading is held while the joint rests at the end of travel.
    assert_clean(&log(|sample| 0.3 * (motion(sample).0 * 0.8).to_radians().sin() + 0.1));
}

#[test]
fn noise_free_constant_friction_is_no_clipping() {
    assert_clean(&log(|sample| 0.1 * motion(sample).1));
    // ... nor with a smooth passage from one direction to the other.
    assert_clean(&log(|sample| {
        let (position, direction) = motion(sample);
        let way = if direction > 0.0 { position - 10.0 } else { 110.0 - position };
        0.1 * direction * (way / 10.0).min(1.0)
    }));
}

#[test]
fn a_smooth_peak_of_a_rounded_signal_is_no_clipping() {
    for step in [1e-5, 1e-4, 1e-3, 1e-2, 0.05] {
        assert_clean(&log(|sample| rounded(torque(sample), step)));
    }
}

#[test]
fn a_coarse_sensor_is_no_clipping() {
    for (sd, step) in [(0.02, 0.05), (0.005, 0.02), (0.002, 0.02), (0.001, 0.01), (0.02, 1e-3)] {
        let noise = noise(sd);
        assert_clean(&log(|sample| rounded(torque(sample) + noise[sample], step)));
    }
}

/// A reading of noise, renewed every `hold` samples, that once stays for `stay` samples at its greatest value.
fn held(hold: usize, stay: usize) -> Log {
    let noise = noise(0.02);
    let greatest = noise.iter().copied().fold(0.0, f64::max);
    let stays = 1000..1000 + stay;
    log(|sample| if stays.contains(&sample) { greatest } else { noise[sample / hold] })
}

#[test]
fn a_sensor_slower_than_its_log_is_no_clipping() {
    // Its readings repeat ten times anyway, so a hundred once in 18,000 samples are no proof ...
    assert_clean(&held(10, 100));
    // ... and thirty-six of a reading that repeats twice are, but over less than a hundredth of the way.
    assert_clean(&held(2, 36));
    assert_eq!(held(2, 60).warnings.len(), 1);
}
