//! A joint beside a simulator's log of the same commands: the difference in motion is found, located, explained; none is made.

use crate::cli::tautline;
use serde_json::Value;
use std::path::Path;
use tempfile::TempDir;

const MODEL: &str = "data/elbow/truth/model.json";
/// Where the joint gives way by 1 mrad under 100 mN m.
const STIFFNESS_NM_RAD: f64 = 100.0;

const TRAJECTORY: &str = r#"format = "trajectory/1"
name = "NAME"
repeats = 2
start_rad = 0.2

[[segments]]
kind = "sweep"
to_rad = 1.3
speed_rad_s = 0.15
acceleration_rad_s2 = 4.0

[[segments]]
kind = "sweep"
to_rad = 0.3
speed_rad_s = 0.35
acceleration_rad_s2 = 4.0

[[segments]]
kind = "cosine"
low_rad = 0.3
high_rad = 1.1
period_s = 4.0
periods = 3
"#;

/// Two motions, two times each, under a controller, with `more` than the model.
fn played(folder: &TempDir, name: &str, seed: &str, more: &[&str]) -> String {
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let files = ["first", "second"].map(|name| (name, at(&format!("{name}.toml"))));
    for (name, file) in &files {
        let text = TRAJECTORY.replace("NAME", name);
        std::fs::write(file, if *name == "second" { text.replace("4.0\nperiods", "2.5\nperiods") } else { text })
            .unwrap();
    }
    let (output, stiffness) = (at(name), STIFFNESS_NM_RAD.to_string());
    let fixed = ["simulate", "--model", MODEL, "-o", &output, "--closed-loop", "--quiet", "--rate-hz", "200"];
    let motions = ["--trajectory", &files[0].1, "--trajectory", &files[1].1, "--stiffness-nm-rad", &stiffness];
    let noise = ["--noise-nm", "0.005", "--seed", seed];
    let done = tautline(&[&fixed[..], &motions, &noise, more].concat());
    assert!(done.status.success(), "{done:?}");
    output
}

fn diagnosed(folder: &TempDir, real: &str, simulated: &str) -> Value {
    let out = folder.path().join("diagnosed");
    let arguments =
        ["diagnose", real, "--model", MODEL, "--simulated", simulated, "--force", "-o", &out.to_string_lossy()];
    let done = tautline(&arguments);
    assert!(done.status.success(), "{done:?}");
    assert!(out.join("plots/motion.svg").is_file());
    let told = String::from_utf8(done.stdout).unwrap();
    assert!(told.contains("The joint moves"), "{told}");
    serde_json::from_str(&std::fs::read_to_string(out.join("diagnosis.json")).unwrap()).unwrap()
}

#[test]
fn what_a_simulation_lacks_shows_in_motion_and_is_explained() {
    let folder = TempDir::new().unwrap();
    let simulated = played(&folder, "simulated", "1", &[]);
    let spring = "elastic_spring:stiffness_nm_rad=0.5,preload_nm=-0.2";
    let real = played(&folder, "real", "2", &["--effect", spring]);
    let found = diagnosed(&folder, &real, &simulated);
    let motion = &found["motion"];
    assert_eq!(motion["warnings"], serde_json::json!([]), "the model is the simulator's: {motion}");
    assert_eq!(motion["separates"], serde_json::json!(["elastic_spring"]), "{motion}");
    assert_eq!(motion["is_there"], true);
    // 0.5 N m/rad within 1 rad of where it rests, against the controller's 100 N m/rad, friction in proportion on top.
    let rmse_rad = motion["rmse_rad"].as_f64().unwrap();
    assert!((0.003..0.004).contains(&rmse_rad), "{rmse_rad}");
    assert_eq!(motion["where"][0]["region"], "position", "{motion}");
    assert!(motion["where"][0]["share_of_gap"].as_f64().unwrap() > 0.9);
    let follows = &motion["follows"];
    assert!(follows["share"].as_f64().unwrap() > 0.9, "{follows}");
    // The winch sees 0.3 of the joint's torque: -1 / (0.3 * 100).
    let rad_per_nm = follows["rad_per_nm"].as_f64().unwrap();
    assert!((rad_per_nm * 0.3 * STIFFNESS_NM_RAD + 1.0).abs() < 0.1, "{rad_per_nm}");
    for trial in motion["trials"].as_array().unwrap() {
        assert_eq!(trial["shifted_s"], 0.0, "{trial}");
    }
    // A campaign against itself moves as itself.
    let same = &diagnosed(&folder, &real, &real)["motion"];
    assert_eq!((&same["is_there"], same["rmse_rad"].as_f64()), (&Value::Bool(false), Some(0.0)), "{same}");
    assert!(same["where"].as_array().unwrap().is_empty() && same["follows"].is_null());
}

#[test]
fn clocks_that_begin_apart_are_no_gap_but_drag_that_delays_is() {
    let folder = TempDir::new().unwrap();
    let simulated = played(&folder, "simulated", "1", &[]);
    let late = played(&folder, "late", "2", &[]);
    for entry in std::fs::read_dir(&late).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "csv") {
            // The recording begins 0.3 s after the command does.
            let text = std::fs::read_to_string(&path).unwrap();
            let kept = text.lines().enumerate().filter(|(row, _)| *row == 0 || *row > 60);
            std::fs::write(&path, kept.map(|(_, line)| format!("{line}\n")).collect::<String>()).unwrap();
        }
    }
    let motion = &diagnosed(&folder, &late, &simulated)["motion"];
    for trial in motion["trials"].as_array().unwrap() {
        assert!((trial["shifted_s"].as_f64().unwrap() + 0.3).abs() < 0.002, "{trial}");
    }
    assert!(motion["rmse_rad"].as_f64().unwrap() < 2e-4, "{motion}");
    let drag = played(&folder, "drag", "2", &["--effect", "quadratic_viscous:up_nm_s2_rad2=0.2,down_nm_s2_rad2=0.2"]);
    let motion = &diagnosed(&folder, &drag, &simulated)["motion"];
    for trial in motion["trials"].as_array().unwrap() {
        assert_eq!(trial["shifted_s"], 0.0, "{trial}");
    }
    assert_eq!(motion["is_there"], true);
}

#[test]
fn trials_without_partners_are_named() {
    let folder = TempDir::new().unwrap();
    let simulated = played(&folder, "simulated", "1", &[]);
    let out = folder.path().join("out").to_string_lossy().into_owned();
    let refused = tautline(&["diagnose", "data/elbow", "--model", MODEL, "--simulated", &simulated, "-o", &out]);
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    let words = String::from_utf8(refused.stderr).unwrap();
    assert!(words.contains("no trial is one of data/elbow") && words.contains("first_1"), "{words}");
    assert!(!Path::new(&out).exists());
}
