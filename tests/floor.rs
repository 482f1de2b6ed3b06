//! The noise floor of a campaign without repeats, and what a coarse encoder leaves.

use crate::campaigns::{plan, record, truth};
use crate::next::diagnosed_with;
use std::f64::consts::PI;
use tautline::diagnose::{Cause, Diagnosis, FloorSource, Gap, Kind, run};
use tautline::log::{Campaign, Signal};
use tautline::model::Model;
use tautline::simulate::{Plan, Sensors};
use tautline::trajectory::{Path, Protocol, Segment, Trajectory};

#[test]
fn reversals_in_every_stretch_are_no_noise() {
    let segments = vec![Segment::Cosine { low_rad: 0.2, high_rad: 0.9, period_s: 0.7, periods: 100 }];
    let quick = Trajectory {
        name: "quick".to_string(),
        protocol: Protocol::Free,
        repeats: Some(1),
        own: Path { start_rad: 0.2, segments },
        others: Vec::new(),
    };
    let mut worn = truth();
    worn.friction.up.d *= 1.5;
    worn.friction.down.d *= 1.5;
    let found = diagnosed_with((&worn, &truth()), 0.02, &[], quick, 1);
    // A zero-phase low-pass of 3 Hz, of order 4 each way, passes white noise within 0.898 times 3 Hz: the integral of
    // 1/(1 + x^8)^2. At 100 Hz noise reaches to 50.
    let floor_nm = 0.02 * (3.0 * 7.0 / 8.0 * (PI / 8.0) / (PI / 8.0).sin() / 50.0).sqrt();
    assert_eq!(found.gap.floor.source, FloorSource::Spectrum);
    let ratio = found.gap.floor.rms_nm / floor_nm;
    assert!((0.85..1.15).contains(&ratio), "{ratio}");
    assert_ne!(found.verdict.kind, Kind::None);
}

/// A joint that follows `like`, its quick motion read by a coarse encoder of `encoder_counts`, held against the true model.
fn read_coarsely(like: &Model, encoder_counts: f64) -> Diagnosis {
    let segments = vec![Segment::Cosine { low_rad: 0.2, high_rad: 0.9, period_s: 0.9, periods: 40 }];
    let own = Path { start_rad: 0.2, segments };
    let quick =
        Trajectory { name: "quick".to_string(), protocol: Protocol::Free, repeats: Some(1), own, others: Vec::new() };
    let sensors = Sensors { torque_noise_nm: 0.005, encoder_counts };
    let signal = Signal { torque_sign: -1.0, lowpass_hz: 3.0, lowpass_order: 4 };
    let wanted = Plan { speeds: 0, trajectories: vec![quick], rate_hz: 100.0, sensors, signal, seed: 3, ..plan() };
    let folder = record(like, &wanted);
    run(&Campaign::read(folder.path()).unwrap(), &truth(), &|_| ()).unwrap()
}

/// Within 5 % of each of its parameters the base imitates a gain to within the floor, but only if most of them are off, and the same way.
#[test]
fn a_gain_that_only_an_improbable_base_could_imitate_is_named() {
    let short = || Trajectory {
        name: "short".to_string(),
        protocol: Protocol::Free,
        repeats: Some(1),
        own: Path {
            start_rad: 0.2,
            segments: vec![Segment::Cosine { low_rad: 0.2, high_rad: 0.9, period_s: 4.0, periods: 16 }],
        },
        others: Vec::new(),
    };
    let found = diagnosed_with((&truth(), &truth()), 0.03, &["sensor_gain:error=0.11"], short(), 1);
    let decisions = &found.verdict.decisions;
    let named = |rule: &str| decisions.iter().find(|d| d.rule == rule && d.outcome == "named").expect(rule);
    let (gain, penalty) = (named("share of the gap").value, named("prior penalty"));
    assert!(gain < (0.4 * found.gap.floor.rms_nm).powi(2), "{gain} of {:?}: not within the floor", found.gap.floor);
    assert!(penalty.value > 1.2 * penalty.limit, "{penalty:?}");
    assert!(found.verdict.effects.contains(&Cause::Effect("sensor_gain")), "{:?}", found.verdict.effects);
    // The same base, with nothing wrong.
    let like = diagnosed_with((&truth(), &truth()), 0.03, &[], short(), 1);
    assert_eq!(like.verdict.kind, Kind::None, "{:?}", like.verdict.effects);
}

#[test]
fn what_a_coarse_encoder_leaves_of_a_true_model_is_floor_and_no_cause() {
    let right = read_coarsely(&truth(), 600.0);
    let Gap { floor, rmse_nm, .. } = right.gap;
    assert!(floor.encoder_nm > 0.5 * rmse_nm, "{:?}", right.gap);
    assert_eq!(right.verdict.kind, Kind::None, "{:?} {:?}", right.gap, right.verdict.effects);
    let mut worn = truth();
    worn.friction.up.d *= 1.5;
    worn.friction.down.d *= 1.5;
    let found = read_coarsely(&worn, 1200.0);
    assert_eq!(found.verdict.effects, [Cause::Stale("viscous")], "{:?}", found.gap);
    let probabilities: f64 = found.verdict.probabilities.iter().map(|(_, p)| p).sum();
    assert!((probabilities - 1.0).abs() < 1e-9, "{probabilities}");
    assert!(found.verdict.decisions.iter().any(|d| d.rule == "encoder" && d.value >= d.limit && d.limit > 0.0));
}

/// Adds to each log noise slower than the low-pass, N m: it never comes twice the same, and no noise beyond the low-pass tells of it.
fn with_slow_noise(folder: &std::path::Path, rms_nm: f64) {
    let logs = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut logs: Vec<_> = logs.filter(|path| path.extension().is_some_and(|e| e == "csv")).collect();
    logs.sort();
    logs.iter().zip(1..).for_each(|(log, seed)| add_slow_noise(log, rms_nm, seed));
}

fn add_slow_noise(log: &std::path::Path, rms_nm: f64, seed: u64) {
    const KEPT: f64 = 0.97;
    let text = std::fs::read_to_string(log).unwrap();
    let (header, rows) = text.split_once('\n').unwrap();
    let torque = header.split(',').position(|name| name.contains("torque")).unwrap();
    let (mut noise_nm, mut smooth_nm, mut state) = (0.0, 0.0, seed);
    let noisy = |row: &str| {
        let mut cells: Vec<String> = row.split(',').map(str::to_string).collect();
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let white = (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5;
        noise_nm = KEPT * noise_nm + (1.0 - KEPT * KEPT).sqrt() * 12.0_f64.sqrt() * rms_nm * white;
        smooth_nm += 0.2 * (noise_nm - smooth_nm);
        cells[torque] = format!("{}", cells[torque].parse::<f64>().unwrap() + smooth_nm);
        cells.join(",")
    };
    let rows: Vec<String> = rows.lines().map(noisy).collect();
    std::fs::write(log, format!("{header}\n{}\n", rows.join("\n"))).unwrap();
}

/// A plan of one motion, so often.
fn to_and_fro(repeats: u32, torque_noise_nm: f64) -> Plan {
    let segments = vec![Segment::Cosine { low_rad: 0.2, high_rad: 0.9, period_s: 3.1, periods: 20 }];
    let own = Path { start_rad: 0.2, segments };
    let (name, protocol) = ("to_and_fro".to_string(), Protocol::Cosine);
    let cosine = Trajectory { name, protocol, repeats: Some(repeats), own, others: Vec::new() };
    let sensors = Sensors { torque_noise_nm, encoder_counts: 0.0 };
    Plan { speeds: 0, trajectories: vec![cosine], rate_hz: 100.0, sensors, seed: 5, ..plan() }
}

#[test]
fn what_repeats_differ_by_beyond_noise_has_a_cause_that_no_model_of_the_motion_knows() {
    let found = |slow_noise_nm: f64| {
        let folder = record(&truth(), &to_and_fro(3, 0.01));
        with_slow_noise(folder.path(), slow_noise_nm);
        run(&Campaign::read(folder.path()).unwrap(), &truth(), &|_| ()).unwrap()
    };
    let factor = |found: &Diagnosis| found.gap.floor.differing.unwrap();
    let (still, shaken) = (found(0.0), found(0.03));
    assert_eq!([&still, &shaken].map(|found| found.gap.floor.source), [FloorSource::Repeats; 2]);
    assert_eq!([&still, &shaken].map(|found| found.verdict.kind), [Kind::None, Kind::Unknown]);
    assert!((0.7..1.4).contains(&factor(&still)) && factor(&shaken) > 4.0, "{} {}", factor(&still), factor(&shaken));
    assert!(still.verdict.differing().is_none() && shaken.verdict.differing() == Some(factor(&shaken)));
    assert!(shaken.verdict.effects.is_empty(), "{:?}", shaken.verdict.effects);
    assert!(still.verdict.decisions.iter().any(|decision| decision.rule == "repeats"));
    assert!(shaken.after == shaken.before && !shaken.verdict.tells_of_a_gap());
}

#[test]
fn what_no_fit_finds_again_is_noise_where_no_motion_was_repeated() {
    let found = |joint: &Model| {
        let folder = record(joint, &to_and_fro(1, 0.002));
        with_slow_noise(folder.path(), 0.03);
        run(&Campaign::read(folder.path()).unwrap(), &truth(), &|_| ()).unwrap()
    };
    let same = found(&truth());
    assert_eq!(same.gap.floor.source, FloorSource::Unforeseen, "{:?}", same.gap);
    assert_eq!(same.verdict.kind, Kind::None, "{:?} {:?}", same.gap, same.verdict.effects);
    assert!(same.warnings.iter().any(|warning| warning.contains("repeats of one motion would tell")));
    // What does come again with the motion is no noise, however much there is of the other.
    let mut worn = truth();
    worn.friction.up.a_j *= 1.5;
    worn.friction.down.a_j *= 1.5;
    let worn = found(&worn);
    assert_ne!(worn.verdict.kind, Kind::None, "{:?}", worn.gap);
}
