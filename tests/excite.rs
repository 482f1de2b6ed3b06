//! Motions to record: the paper's numbers, limits, and files that the simulator takes as they are.

use crate::cli::tautline;
use crate::simulate::mixed;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Output;
use tautline::log::{Campaign, Protocol};
use tautline::numerics::difference::{acceleration, velocity};
use tautline::numerics::statistics::quantile;
use tautline::trajectory::{Extremes, Path as Motion, Segment, Trajectory, Uniform, Wave};
use tempfile::TempDir;

const MODEL: &str = "data/elbow/truth/model.json";

fn excite(folder: &TempDir, arguments: &[&str]) -> (PathBuf, Output) {
    let out = folder.path().join("out");
    let done = tautline(&[&["excite"], arguments, &["-o", &out.to_string_lossy(), "--json"]].concat());
    (out, done)
}

/// What `excite` printed; it must have succeeded.
fn told(done: &Output) -> Value {
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    serde_json::from_slice(&done.stdout).unwrap()
}

fn refused(arguments: &[&str]) -> String {
    let folder = TempDir::new().unwrap();
    let (out, done) = excite(&folder, arguments);
    assert_eq!(done.status.code(), Some(2), "{arguments:?}: {done:?}");
    assert!(!out.exists(), "{arguments:?} left something behind");
    String::from_utf8(done.stderr).unwrap()
}

#[test]
fn the_paper_s_cascade_takes_265_6_seconds_between_20_and_60_deg() {
    let folder = TempDir::new().unwrap();
    let (out, done) = excite(&folder, &["cosine"]);
    let motion = &told(&done)["motions"][0];
    let near = |key: &str, expected: f64| {
        let found = motion[key].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-9 * expected, "{key}: {found}, not {expected}");
    };
    near("duration_s", 265.6);
    near("low_rad", 20f64.to_radians());
    near("high_rad", 60f64.to_radians());
    // 20 deg at 1.6 s: A w and A w^2.
    near("speed_rad_s", 20f64.to_radians() * std::f64::consts::TAU / 1.6);
    near("acceleration_rad_s2", 20f64.to_radians() * (std::f64::consts::TAU / 1.6).powi(2));
    assert_eq!(Trajectory::read(&out.join("cosine.toml")).unwrap().own, Trajectory::cascade().own);
}

#[test]
fn the_paper_s_sweeps_are_twenty_and_the_simulator_records_them_as_such() {
    let folder = TempDir::new().unwrap();
    let (out, done) = excite(&folder, &["uniform", "--repeats", "1"]);
    let told = told(&done);
    assert_eq!(told["motions"].as_array().unwrap().len(), 20);
    assert_eq!(told["runs"], 20);
    let campaign = |name: &str, rest: &[&str]| {
        let to = folder.path().join(name);
        let to_text = to.to_string_lossy();
        let fixed = ["simulate", "--model", MODEL, "-o", &to_text, "--rate-hz", "50", "--quiet"];
        let done = tautline(&[&fixed, rest].concat());
        assert!(done.status.success(), "{done:?}");
        to
    };
    let from_files = campaign("files", &["--trajectory", &out.to_string_lossy()]);
    let built_in = campaign("built_in", &["--repeats", "1", "--cosines", "0"]);
    assert_eq!(Campaign::read(&from_files).unwrap().trials, Campaign::read(&built_in).unwrap().trials);
    for trial in Campaign::read(&built_in).unwrap().trials {
        let read = |of: &Path| std::fs::read(of.join(&trial.file)).unwrap();
        assert!(read(&from_files) == read(&built_in), "{} differs", trial.file);
    }
}

#[test]
fn other_joints_swing_in_whole_periods_and_the_simulator_moves_them() {
    let folder = TempDir::new().unwrap();
    let (out, done) = excite(&folder, &["multi-joint", "--others", "2", "--repeats", "1"]);
    assert_eq!(told(&done)["motions"][0]["other_joints"], 2);
    let moving = Trajectory::read(&out.join("multi_joint.toml")).unwrap();
    assert_eq!(moving.protocol, Protocol::Cosine);
    for other in &moving.others {
        assert!((other.duration_s() - 265.6).abs() < 1e-6, "{}", other.duration_s());
    }
    let to = folder.path().join("campaign");
    let (from, to_text) = (out.to_string_lossy(), to.to_string_lossy());
    let done =
        tautline(&["simulate", "--model", MODEL, "-o", &to_text, "--trajectory", &from, "--rate-hz", "50", "--quiet"]);
    assert!(done.status.success(), "{done:?}");
    let campaign = Campaign::read(&to).unwrap();
    assert_eq!(campaign.columns.other_position.len(), 2);
    assert_eq!(campaign.trials[0].trajectory.as_deref(), Some("multi_joint"));
}

#[test]
fn each_limit_is_checked_by_name_and_nothing_is_written() {
    for (arguments, expected) in [
        (&["cosine", "--limit-high-rad", "1.0"][..], "goes up to 1.0472 rad"),
        (&["cosine", "--limit-low-rad", "0.35"], "goes down to 0.3491 rad"),
        (&["cosine", "--limit-speed-rad-s", "1.3"], "reaches 1.3708 rad/s"),
        (&["cosine", "--limit-acceleration-rad-s2", "5"], "reaches 5.383"),
        (&["uniform", "--limit-speed-rad-s", "0.39"], "sweep_0.4000: reaches 0.4000 rad/s"),
        (&["cosine", "--limit-torque-nm", "1.5"], "add --model"),
        (&["cosine", "--limit-torque-nm", "0.2", "--model", MODEL], "N m, and the limit is 0.2000 N m"),
        (&["cosine", "--limit-low-rad", "2", "--limit-high-rad", "1"], "lowest position is 2 rad"),
        (&["cosine", "--limit-speed-rad-s", "0"], "expected a number above 0"),
        (&["cosine", "--high-rad", "0.1"], "above the lower end"),
        (&["cosine", "--periods-s", "16,0"], "--periods-s is 0"),
        (&["uniform", "--fastest-rad-s", "0.01"], "the slowest speed or more"),
        (&["uniform", "--speeds", "1", "--slowest-rad-s", "0.0001", "--rest-s", "5000"], "36000 s at most"),
        (&["uniform", "--speeds", "900"], "differ by 0.0001"),
        (&["uniform", "--fastest-rad-s", "3"], "more than half of the way"),
        (&["multi-joint", "--other-high-rad", "-1"], "above --other-low-rad"),
        (&["next", "data/elbow/truth/model.json"], "format"),
        (&["next", "data/paper"], "holds no motion"),
        (&["cosine", "--urdf", "data/arm/arm.urdf", "--joint", "elbow_flexion"], "add --model"),
    ] {
        let said = refused(arguments);
        assert!(said.contains(expected), "{arguments:?}: {said}");
    }
}

#[test]
fn what_touches_its_limits_passes_and_a_rig_s_file_tells_them() {
    let folder = TempDir::new().unwrap();
    let rig = folder.path().join("rig.toml");
    let write = |limits: &str| std::fs::write(&rig, format!("format = \"rig/1\"\n[limits]\n{limits}")).unwrap();
    let name = rig.to_string_lossy().into_owned();
    write("low_rad = 0.0\nhigh_rad = 1.5707963267948966\nspeed_rad_s = 0.4\nacceleration_rad_s2 = 4\nlag_rad = 0.05\n");
    told(&excite(&folder, &["uniform", "--limits", &name]).1);
    // The command line goes before the file.
    assert!(refused(&["uniform", "--limits", &name, "--limit-speed-rad-s", "0.3"]).contains("0.3000 rad/s"));
    write("speed_rads = 0.4\n");
    assert!(refused(&["uniform", "--limits", &name]).contains("did you mean `speed_rad_s`?"));
}

#[test]
fn the_torque_is_the_model_s_along_the_motion() {
    let folder = TempDir::new().unwrap();
    let (_, done) = excite(&folder, &["cosine", "--model", MODEL]);
    let torque_nm = told(&done)["motions"][0]["torque_nm"].as_f64().unwrap();
    // A sin(60 deg) of the elbow's A of 0.35, and friction up of about 0.65 N m and below.
    assert!((0.3..1.5).contains(&torque_nm), "{torque_nm}");
    let slow = TempDir::new().unwrap();
    let (_, done) = excite(&slow, &["cosine", "--model", MODEL, "--low-rad", "1.5", "--high-rad", "1.6"]);
    assert!(told(&done)["motions"][0]["torque_nm"].as_f64().unwrap() > torque_nm, "near 90 deg it weighs more");
}

#[test]
fn what_diagnose_proposes_is_taken_with_its_repeats() {
    let folder = TempDir::new().unwrap();
    let diagnosed = folder.path().join("diagnosed");
    std::fs::create_dir(&diagnosed).unwrap();
    std::fs::write(diagnosed.join("diagnosis.json"), "{}").unwrap();
    let name = diagnosed.to_string_lossy().into_owned();
    assert!(refused(&["next", &name]).contains("proposes no motion"));
    let proposed = Trajectory { repeats: Some(5), ..mixed() };
    std::fs::write(diagnosed.join("next_experiment.toml"), proposed.to_toml()).unwrap();
    let (out, done) = excite(&folder, &["next", &name]);
    assert_eq!(told(&done)["motions"][0]["repeats"], 5);
    assert_eq!(Trajectory::read(&out.join("mixed.toml")).unwrap(), proposed);
}

/// What differences of its samples say, 2 kHz. A sweep that ends between two samples bends twice as hard in the last one: of the
/// accelerations, what all but 1 in 2000 reach.
fn sampled(motion: &Motion) -> Extremes {
    let positions = motion.positions_rad(2000.0);
    let largest = |values: Vec<f64>| values.into_iter().map(f64::abs).fold(0.0, f64::max);
    Extremes {
        low_rad: positions.iter().copied().fold(f64::MAX, f64::min),
        high_rad: positions.iter().copied().fold(f64::MIN, f64::max),
        speed_rad_s: largest(velocity(&positions, 2000.0)),
        acceleration_rad_s2: {
            let mut sizes: Vec<f64> = acceleration(&positions, 2000.0).into_iter().map(f64::abs).collect();
            quantile(&mut sizes, 0.9995)
        },
    }
}

#[test]
fn extremes_are_those_of_the_samples() {
    let wave = |amplitude_rad, frequency_hz| Wave { amplitude_rad, frequency_hz, phase_rad: 0.4 };
    let waves = vec![wave(0.2, 0.5), wave(0.05, 2.3)];
    let multisine = vec![Segment::Multisine { duration_s: 12.0, fade_s: 2.0, waves }];
    let short = Segment::Sweep { to_rad: 0.01, speed_rad_s: 1.0, acceleration_rad_s2: 2.0 };
    let motions = [
        Motion { start_rad: 0.3, segments: multisine },
        Motion { start_rad: 0.0, segments: vec![short] },
        Trajectory::cascade().own,
        Uniform::default().trajectories()[19].own.clone(),
    ];
    for motion in motions {
        let (found, expected) = (motion.extremes(), sampled(&motion));
        let near = |a: f64, b: f64, within: f64| assert!((a - b).abs() < within, "{found:?}\n{expected:?}");
        near(found.low_rad, expected.low_rad, 1e-4);
        near(found.high_rad, expected.high_rad, 1e-4);
        near(found.speed_rad_s, expected.speed_rad_s, 0.01 * found.speed_rad_s);
        near(found.acceleration_rad_s2, expected.acceleration_rad_s2, 0.03 * found.acceleration_rad_s2);
    }
}
