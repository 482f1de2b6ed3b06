//! Simulating: what is recorded with an effect is foretold with it, the clock runs on, seeds repeat, motions are those asked for.

use crate::campaigns::{plan, record, truth};
use crate::cli::tautline;
use crate::effects::example;
use std::path::Path;
use tautline::dynamics::Chain;
use tautline::effects::LIBRARY;
use tautline::log::{Campaign, Protocol, read_trial};
use tautline::model::Model;
use tautline::numerics::filter::LowPass;
use tautline::predict::Prediction;
use tautline::prepare::{Trial, prepare};
use tautline::simulate::{Plan, Sensors, SimulatedArm};
use tautline::trajectory::{Path as Motion, Segment, Trajectory};
use tempfile::TempDir;

/// Sweeps and cosines up to 1 rad and 1 rad/s, resting between; 30 s.
pub fn mixed() -> Trajectory {
    let sweep = |to_rad, speed_rad_s| Segment::Sweep { to_rad, speed_rad_s, acceleration_rad_s2: 4.0 };
    let rest = Segment::Rest { duration_s: 0.5 };
    let cosine = |period_s, periods| Segment::Cosine { low_rad: 0.1, high_rad: 1.1, period_s, periods };
    let segments = vec![
        rest.clone(),
        sweep(1.1, 0.2),
        rest.clone(),
        sweep(0.1, 0.3),
        rest.clone(),
        cosine(8.0, 1),
        cosine(3.0, 2),
        sweep(0.4, 0.3),
        rest,
    ];
    Trajectory {
        name: "mixed".to_string(),
        protocol: Protocol::Free,
        repeats: None,
        own: Motion { start_rad: 0.1, segments },
        others: Vec::new(),
    }
}

/// Two repeats of `mixed` at 500 Hz, without noise.
pub fn free() -> Plan {
    Plan { speeds: 0, repeats: 2, trajectories: vec![mixed()], rate_hz: 500.0, ..plan() }
}

/// The trials of a recorded campaign, with its clock.
pub fn trials(folder: &Path) -> Vec<Trial> {
    let campaign = Campaign::read(folder).unwrap().with_clock().unwrap();
    (0..campaign.trials.len())
        .map(|index| prepare(&campaign, index, read_trial(&campaign, index).unwrap()).unwrap())
        .collect()
}

/// What `model` leaves of `trial`, N m: root mean square, both sides low-passed, from where the state is known.
pub fn left_nm(model: &Model, trial: &Trial) -> f64 {
    let prediction = Prediction::new(model, trial);
    let lowpass = LowPass::new(4, 5.0, trial.log.rate_hz).unwrap();
    let predicted = lowpass.zero_phase(&prediction.torque_nm);
    let known = prediction.states.known_from + trial.log.rate_hz as usize / 2;
    let squares = (known..predicted.len()).map(|i| (predicted[i] - trial.torque_nm[i]).powi(2));
    (squares.sum::<f64>() / (predicted.len() - known) as f64).sqrt()
}

pub fn range_nm(trial: &Trial) -> f64 {
    let (low, high) = trial.torque_nm.iter().fold((f64::MAX, f64::MIN), |(low, high), y| (low.min(*y), high.max(*y)));
    high - low
}

#[test]
fn what_is_recorded_with_an_effect_is_foretold_with_it() {
    for about in LIBRARY.map(|effect| effect.about()) {
        let id = about.id;
        let model = Model { effects: vec![example(id)], ..truth() };
        let folder = record(&model, &Plan { other_joints: 1, ..free() });
        for trial in trials(folder.path()) {
            let (with_nm, without_nm) = (left_nm(&model, &trial), left_nm(&truth(), &trial));
            // The motion's own low-pass leaves this much of the corners of a sweep.
            assert!(with_nm < 0.004, "{id}: {with_nm} N m left of {}", range_nm(&trial));
            let shows = id != "contact" || trial.entry.repeat == 1;
            assert!(!shows || without_nm > 2.0 * with_nm, "{id}: {without_nm} N m without, {with_nm} with");
        }
    }
}

#[test]
fn what_drifts_goes_on_from_trial_to_trial() {
    let drift = tautline::effects::Added::parse("sensor_drift:restarts=0,horizon_s=10,settle_s=2,line_nm=0.1").unwrap();
    let model = Model { effects: vec![drift], ..truth() };
    let (plan, exact) = (Plan { repeats: 3, ..free() }, record(&truth(), &Plan { repeats: 3, ..free() }));
    let folder = record(&model, &plan);
    let trials_of = |folder: &TempDir| trials(folder.path());
    let mut expected_s = 0.0;
    for (drifting, still) in trials_of(&folder).iter().zip(&trials_of(&exact)) {
        assert_eq!(drifting.log.time_s[0], 0.0);
        assert!((drifting.began_s - expected_s).abs() < 1e-4, "{} for {expected_s}", drifting.began_s);
        let last = still.log.time_s.len() - 1;
        for i in [0, last] {
            let drift_nm = drifting.log.torque_nm[i] - still.log.torque_nm[i];
            let due_nm = 0.01 * (drifting.began_s + drifting.log.time_s[i]);
            assert!((drift_nm - due_nm).abs() < 1e-6, "{drift_nm} for {due_nm}");
        }
        expected_s += drifting.log.time_s[last];
    }
}

#[test]
fn logs_on_one_clock_are_in_the_order_of_their_stamps_however_listed() {
    const BEGAN_S: [f64; 3] = [500.0, 0.0, 900.0];
    let folder = record(&truth(), &Plan { repeats: 3, ..free() });
    for (trial, began_s) in Campaign::read(folder.path()).unwrap().trials.iter().zip(BEGAN_S) {
        let file = folder.path().join(&trial.file);
        let text = std::fs::read_to_string(&file).unwrap();
        let (header, rows) = text.split_once('\n').unwrap();
        assert!(header.starts_with("time_s,"), "{header}");
        let later = |row: &str| {
            let (time_s, rest) = row.split_once(',').unwrap();
            format!("{},{rest}\n", time_s.parse::<f64>().unwrap() + 20.0 + began_s)
        };
        std::fs::write(&file, format!("{header}\n{}", rows.lines().map(later).collect::<String>())).unwrap();
    }
    let began_s: Vec<f64> = trials(folder.path()).iter().map(|trial| trial.began_s).collect();
    assert!(began_s.iter().zip(BEGAN_S).all(|(found, began)| (found - began).abs() < 1e-6), "{began_s:?}");
}

#[test]
fn a_log_does_not_depend_on_the_others_being_made() {
    let sensors = Sensors { torque_noise_nm: 0.01, encoder_counts: 4096.0 };
    let plan =
        Plan { sensors, other_joints: 2, tracking_error_rad: 0.002, speeds: 1, cosines: 1, rate_hz: 100.0, ..free() };
    let trials = plan.trials(truth().joint.kind);
    let made = |at: usize| plan.log_bytes(&truth(), &trials[at]).unwrap();
    let forwards: Vec<Vec<u8>> = (0..trials.len()).map(made).collect();
    let backwards: Vec<Vec<u8>> = (0..trials.len()).rev().map(made).collect();
    assert!(forwards.iter().eq(backwards.iter().rev()));
    assert!(forwards.windows(2).all(|pair| pair[0] != pair[1]), "two trials are the same");
    let other = Plan { seed: 2, ..plan.clone() };
    assert!(forwards[0] != other.log_bytes(&truth(), &other.trials(truth().joint.kind)[0]).unwrap());
}

#[test]
fn a_joint_strays_as_far_as_told_and_each_time_another_way() {
    let planned = mixed().positions_rad(500.0);
    let folder = record(&truth(), &Plan { tracking_error_rad: 0.003, ..free() });
    let strays: Vec<Vec<f64>> = trials(folder.path())
        .iter()
        .map(|trial| trial.log.position_rad.iter().zip(&planned).map(|(x, wanted)| x - wanted).collect())
        .collect();
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        let squares: Vec<f64> = values.map(|x| x * x).collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    for stray in &strays {
        assert!((rms(&mut stray.iter().copied()) - 0.003).abs() < 1e-6);
    }
    let apart = rms(&mut strays[0].iter().zip(&strays[1]).map(|(a, b)| a - b));
    assert!(apart > 0.002, "repeats are {apart} rad apart");
    // And the log says where the joint was: the model leaves nothing.
    for trial in trials(folder.path()) {
        assert!(left_nm(&truth(), &trial) < 0.004, "{}", left_nm(&truth(), &trial));
    }
}

#[test]
fn other_joints_move_alike_in_repeats_and_rest_in_sweeps() {
    let folder =
        record(&truth(), &Plan { other_joints: 2, speeds: 1, slowest_rad_s: 0.2, fastest_rad_s: 0.2, ..free() });
    let text = std::fs::read_to_string(folder.path().join("campaign.toml")).unwrap();
    assert!(
        text.contains("other_position = { name = \"other_1_deg\"") && text.contains("other_position_2 ="),
        "{text}"
    );
    let trials = trials(folder.path());
    let (sweeps, free) = trials.split_at(2);
    for sweep in sweeps {
        assert!(matches!(sweep.entry.protocol, Protocol::Uniform { .. }));
        assert!(sweep.log.other_position_rad.iter().flatten().all(|x| *x == 0.0));
    }
    let moved = &free[0].log.other_position_rad;
    assert_eq!(moved, &free[1].log.other_position_rad);
    assert_ne!(moved[0], moved[1]);
    for positions in moved {
        let farthest = positions.iter().fold(0.0, |far: f64, x| far.max(x.abs()));
        assert!(positions[0].abs() < 1e-9 && (0.2..1.2).contains(&farthest), "{farthest} rad");
    }
}

#[test]
fn a_trajectory_moves_the_other_joints_it_names() {
    let to_rad = 0.5;
    let sweep = Segment::Sweep { to_rad, speed_rad_s: 0.2, acceleration_rad_s2: 1.0 };
    let others = vec![Motion { start_rad: -0.1, segments: vec![sweep] }];
    let trajectories = vec![Trajectory { others, ..mixed() }];
    let folder = record(&truth(), &Plan { trajectories, ..free() });
    for trial in trials(folder.path()) {
        let [other] = &trial.log.other_position_rad[..] else { panic!("one other joint") };
        assert!((other[0] + 0.1).abs() < 1e-9);
        // It has arrived long before the joint's own motion ends.
        assert!(other[other.len() / 2..].iter().all(|x| (x - to_rad).abs() < 1e-9));
    }
}

#[test]
fn a_stretched_cable_lags_in_a_whole_arm_too() {
    let urdf = "data/arm/arm.urdf";
    let chain = Chain::read(Path::new(urdf), "elbow_flexion").unwrap();
    let arm = SimulatedArm { urdf: "arm.urdf".to_string(), chain, multi_joint: 1 };
    let model = Model { effects: vec![example("cable_elasticity")], ..truth() };
    let folder = record(&model, &Plan { speeds: 0, cosines: 0, arm: Some(arm), rate_hz: 100.0, ..plan() });
    std::fs::copy(urdf, folder.path().join("arm.urdf")).unwrap();
    let trial = &trials(folder.path())[0];
    let (with_nm, without_nm) = (left_nm(&model, trial), left_nm(&truth(), trial));
    assert!(with_nm < 0.002 && without_nm > 0.005, "{with_nm} N m with the lag, {without_nm} without");
}

/// A short free trajectory in `folder`, and what `simulate` is called with for it.
fn written(folder: &TempDir) -> (String, String) {
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    std::fs::write(at("wide.toml"), Trajectory { name: "wide".to_string(), ..mixed() }.to_toml()).unwrap();
    (at("wide.toml"), at("out"))
}

const MODEL: [&str; 4] = ["simulate", "--model", "data/elbow/truth/model.json", "--quiet"];

fn simulated(rest: &[&str]) -> std::process::Output {
    tautline(&[&MODEL[..], rest].concat())
}

#[test]
fn a_trajectory_s_file_takes_the_place_of_the_protocol() {
    let folder = TempDir::new().unwrap();
    let (file, out) = written(&folder);
    let done = simulated(&["-o", &out, "--trajectory", &file, "--repeats", "2", "--rate-hz", "50", "--cosines", "1"]);
    assert!(done.status.success(), "{done:?}");
    let campaign = Campaign::read(Path::new(&out)).unwrap();
    let said: Vec<_> =
        campaign.trials.iter().map(|t| (&t.file[..], t.protocol, t.repeat, t.trajectory.as_deref())).collect();
    assert_eq!(
        said,
        [
            ("cosine_1.csv", Protocol::Cosine, 1, None),
            ("wide_1.csv", Protocol::Free, 1, Some("wide")),
            ("wide_2.csv", Protocol::Free, 2, Some("wide")),
        ]
    );
    assert!(tautline(&["validate", &out]).status.success());
}

#[test]
fn the_same_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let folder = TempDir::new().unwrap();
    let (file, _) = written(&folder);
    let made = |name: &str, threads: &str| {
        let out = folder.path().join(name);
        let short = ["--rate-hz", "100", "--trajectory", &file, "--closed-loop", "--other-joints", "1", "--seed", "8"];
        let done = std::process::Command::new(env!("CARGO_BIN_EXE_tautline"))
            .args([&MODEL[..], &["-o", &out.to_string_lossy()], &short].concat())
            .env("RAYON_NUM_THREADS", threads)
            .status();
        assert!(done.unwrap().success());
        ["wide_1.csv", "wide_3.csv", "campaign.toml", "simulated.json"]
            .map(|file| std::fs::read(out.join(file)).unwrap())
    };
    assert!(made("a", "1") == made("b", "2"));
}

#[test]
fn what_cannot_be_simulated_is_refused() {
    let folder = TempDir::new().unwrap();
    let (file, out) = written(&folder);
    for (rest, expected) in [
        (&["--effect", "stribek:up_nm=1"][..], "did you mean `stribeck`?"),
        (&["--effect", "joint_coupling:joint=2,offset_nm=0.1", "--other-joints", "1"], "add --other-joints 2"),
        (&["--trajectory", "nowhere.toml"], "nowhere.toml"),
        (&["--trajectory", &file, "--trajectory", &file], "wide_1.csv"),
        (&["--trajectory", &file, "--rate-hz", "0.01", "--lowpass-hz", "0.001"], "rows"),
        (&["--tracking-error-rad", "2"], "expected 0 to 1"),
        (&["--closed-loop", "--stiffness-nm-rad", "0"], "stiffness-nm-rad"),
        (&["--torque-limit-nm", "1"], "--closed-loop"),
        (&["--closed-loop", "--tracking-error-rad", "0.1"], "cannot be used with"),
        (&["--closed-loop", "--effect", "inertia:inertia_kg_m2=-0.012"], "inertia"),
    ] {
        let done = simulated(&[&["-o", &out][..], rest].concat());
        let errors = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.code() == Some(2) && errors.contains(expected), "{rest:?}: {errors}");
        assert!(!Path::new(&out).exists());
    }
}

#[test]
fn the_library_is_listed() {
    let done = tautline(&["effects"]);
    let text = String::from_utf8(done.stdout).unwrap();
    let listed: serde_json::Value = serde_json::from_slice(&tautline(&["effects", "--json"]).stdout).unwrap();
    assert_eq!(listed.as_array().unwrap().len(), LIBRARY.len());
    for effect in listed.as_array().unwrap() {
        assert!(text.contains(effect["id"].as_str().unwrap()));
        assert!(effect["parameters"].as_array().unwrap().iter().all(|p| text.contains(p["name"].as_str().unwrap())));
    }
}
