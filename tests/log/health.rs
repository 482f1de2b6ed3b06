//! Each check of a signal's health finds what it is for, in noise of many kinds, and nothing in what merely looks like it.

use super::{CAMPAIGN, csv, folder, read_first};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, Normal, StudentT};
use tautline::log::{Consequence, Finding, Kind, Log};
use tautline::problem::Result;

/// Back and forth over 100 deg, with rests: samples of a leg, of a rest, of all.
const LEG: usize = 3000;
const REST: usize = 300;
const SAMPLES: usize = 2 * (LEG + REST);

fn position_deg(sample: usize) -> f64 {
    let within = (sample % (LEG + REST)).min(LEG) as f64 / LEG as f64;
    if sample < LEG + REST { 10.0 + 100.0 * within } else { 110.0 - 100.0 * within }
}

/// Gravity, friction and a jump of friction where the motion turns, N m.
fn torque_nm(sample: usize) -> f64 {
    let direction = if sample < LEG + REST { 1.0 } else { -1.0 };
    0.3 * position_deg(sample).to_radians().sin() + 0.1 * direction
}

fn read(torque: impl Fn(usize) -> f64) -> Result<Log> {
    moved(position_deg, torque)
}

fn moved(position: impl Fn(usize) -> f64, torque: impl Fn(usize) -> f64) -> Result<Log> {
    let text = csv(SAMPLES, |sample| (position(sample), torque(sample)));
    read_first(folder(&CAMPAIGN.replace("torque_sign = -1", "torque_sign = 1"), text).path())
}

fn findings(torque: impl Fn(usize) -> f64) -> Vec<Finding> {
    read(torque).expect("reads").findings
}

fn noise(seed: u64, sd: f64) -> Vec<f64> {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let normal = Normal::new(0.0, sd).expect("a spread");
    (0..SAMPLES).map(|_| normal.sample(&mut random)).collect()
}

#[test]
fn a_glitch_is_found_where_it_is_and_replaced() {
    for seed in 0..20 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let noise = noise(seed, 0.01);
        let (at, width) = (random.random_range(10..SAMPLES - 10), random.random_range(1..=4));
        let height = 0.15 * 10f64.powf(random.random_range(0.0..6.0)) * if seed % 2 == 0 { 1.0 } else { -1.0 };
        let glitch = |sample: usize| if (at..at + width).contains(&sample) { height } else { 0.0 };
        let log = read(|sample| torque_nm(sample) + noise[sample] + glitch(sample)).expect("reads");
        let [found] = &log.findings[..] else { panic!("seed {seed}: {:?}", log.findings) };
        assert_eq!((found.kind, found.consequence), (Kind::Glitch, Consequence::Bridge));
        assert_eq!((found.row, found.samples), (at as u64 + 2, width), "seed {seed}: {found:?}");
        assert!((found.size / height.abs() - 1.0).abs() < 0.4, "seed {seed}: {found:?} of {height}");
        let worst = (at..at + width).map(|i| (log.torque_nm[i] - torque_nm(i)).abs()).fold(0.0, f64::max);
        assert!(worst < 0.25, "seed {seed}: {worst}");
    }
}

#[test]
fn glitches_side_by_side_and_at_both_ends_are_found() {
    let noise = noise(1, 0.01);
    let spoilt = [0, 1000, 1002, 1004, SAMPLES - 1];
    let found = findings(|sample| torque_nm(sample) + noise[sample] + if spoilt.contains(&sample) { 2.0 } else { 0.0 });
    assert_eq!((found.len(), found[0].samples), (1, spoilt.len()), "{found:?}");
}

#[test]
fn no_noise_and_no_event_is_a_glitch() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let heavy = StudentT::new(10.0).expect("degrees of freedom");
    let heavy: Vec<f64> = (0..SAMPLES).map(|_| 0.01 * heavy.sample(&mut random)).collect();
    for seed in 0..10 {
        let noise = noise(seed, 0.01);
        let at = |sample: usize| sample as f64 / 1000.0;
        let kinds: [&dyn Fn(usize) -> f64; 9] = [
            &|sample| torque_nm(sample / 3 * 3) + noise[sample / 3 * 3],
            &|sample| torque_nm(sample) + noise[sample],
            &|sample| torque_nm(sample) + heavy[sample],
            &|sample| torque_nm(sample),
            &|sample| (200.0 * (torque_nm(sample) + noise[sample])).round() / 200.0,
            &|sample| torque_nm(sample) + 0.1 * (2.0 * std::f64::consts::PI * 120.0 * at(sample)).sin(),
            // Noise ten times as large while the joint moves, and for a tenth of a second only.
            &|sample| torque_nm(sample) + noise[sample] * if sample % (LEG + REST) < LEG { 1.0 } else { 0.1 },
            &|sample| torque_nm(sample) + noise[sample] * if (500..600).contains(&sample) { 10.0 } else { 1.0 },
            // A tap of 30 ms.
            &|sample| torque_nm(sample) + noise[sample] + if (500..530).contains(&sample) { 2.0 } else { 0.0 },
        ];
        for (index, kind) in kinds.iter().enumerate() {
            let found = findings(kind);
            assert!(found.is_empty(), "seed {seed}, kind {index}: {found:?}");
        }
    }
}

#[test]
fn a_coarse_encoder_glitches_only_by_many_counts() {
    let noise = noise(3, 0.01);
    let counts = |deg: f64| (deg * 4096.0 / 360.0).round() * 360.0 / 4096.0;
    let read = |glitch_deg: f64| {
        let position = |sample: usize| counts(position_deg(sample)) + if sample == 1234 { glitch_deg } else { 0.0 };
        moved(position, |sample| torque_nm(sample) + noise[sample]).expect("reads")
    };
    assert!(read(0.0).findings.is_empty());
    let log = read(5.0);
    let [found] = &log.findings[..] else { panic!("{:?}", log.findings) };
    assert_eq!((found.kind, found.column.as_str(), found.row), (Kind::Glitch, "pos", 1236));
    assert!((log.position_rad[1234].to_degrees() - position_deg(1234)).abs() < 0.1);
}

#[test]
fn drop_outs_are_found_even_within_the_noise() {
    let noise = noise(4, 0.05);
    let drops = |sample: usize| sample.is_multiple_of(53);
    let log = read(|sample| if drops(sample) { 0.0 } else { torque_nm(sample) + noise[sample] }).expect("reads");
    let [found] = &log.findings[..] else { panic!("{:?}", log.findings) };
    assert_eq!((found.kind, found.size), (Kind::Dropout, 0.0));
    assert!(found.samples >= SAMPLES / 53 - 1, "{found:?}");
    assert!(read(|sample| if sample.is_multiple_of(10) { 0.0 } else { torque_nm(sample) + noise[sample] }).is_err());
}

#[test]
fn a_stuck_torque_is_set_aside_and_a_lost_frame_replaced() {
    let noise = noise(5, 0.01);
    let sound = |sample: usize| torque_nm(sample) + noise[sample];
    let stuck =
        |range: std::ops::Range<usize>| move |sample: usize| if range.contains(&sample) { range.start } else { sample };
    let long = stuck(1000..1400);
    let log = read(|sample| sound(long(sample))).expect("reads");
    let [set_aside] = &log.set_aside[..] else { panic!("{:?}", log.set_aside) };
    assert_eq!((log.findings[0].kind, set_aside), (Kind::Stuck, &(1000..1400)));
    assert!(log.clipped.is_empty());
    let short = stuck(1000..1015);
    let log = read(|sample| sound(short(sample))).expect("reads");
    assert_eq!((log.findings[0].kind, log.set_aside.len()), (Kind::Stuck, 0));
    // At rest a torque may stay, and a sensor slower than its log repeats each reading.
    let rests = stuck(LEG..LEG + REST);
    assert!(findings(|sample| sound(rests(sample))).is_empty());
    assert!(findings(|sample| sound(sample / 10 * 10)).is_empty());
}

#[test]
fn coarse_steps_are_told_where_noise_does_not_blur_them() {
    let of = |step: f64, sd: f64| {
        let noise = noise(6, sd);
        findings(|sample| step * ((torque_nm(sample) + noise[sample]) / step).round())
    };
    for (step, sd) in [(0.2, 0.02), (0.05, 0.005), (0.02, 0.002)] {
        let found = of(step, sd);
        assert!(found.len() == 1 && found[0].kind == Kind::Quantised, "{step}, {sd}: {found:?}");
        assert!((found[0].size / step - 1.0).abs() < 1e-6 && found[0].consequence == Consequence::Demote);
    }
    for (step, sd) in [(0.02, 0.02), (0.01, 0.01), (0.002, 0.0005), (0.001, 0.0)] {
        assert!(of(step, sd).is_empty(), "{step}, {sd}: {:?}", of(step, sd));
    }
}

#[test]
fn what_no_joint_shows_is_refused() {
    let noise = noise(8, 0.01);
    let far = read(|sample| if (100..150).contains(&sample) { 1e155 } else { torque_nm(sample) + noise[sample] });
    let text = far.unwrap_err().to_string();
    assert!(text.contains("row 102") && text.contains("1e155 N m") && text.contains("`trq`"), "{text}");
    let turned = moved(|sample| 600.0 * position_deg(sample), |sample| torque_nm(sample) + noise[sample]);
    assert!(turned.unwrap_err().to_string().contains("`pos`"));
}
