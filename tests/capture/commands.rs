//! The commands as a user types them.

use crate::cli::tautline;
use serde_json::Value;
use std::process::Output;
use tempfile::TempDir;

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    text(&output.stderr)
}

#[test]
fn the_demo_needs_no_hardware() {
    let out = TempDir::new().unwrap();
    let (plan, folder) = (out.path().join("plan.toml"), out.path().join("captured"));
    std::fs::write(&plan, super::SWEEP).unwrap();
    let (plan, folder) = (plan.to_string_lossy(), folder.to_string_lossy());
    let done = tautline(&["capture", "--rig", "demo", "--plan", &plan, "-o", &folder, "--json"]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let outcome: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!((&outcome["complete"], &outcome["missed_cycles"]), (&2.into(), &0.into()));
    let read = out.path().join("predicted").to_string_lossy().into_owned();
    let done = tautline(&["predict", &folder, "--model", "data/elbow/truth/model.json", "-o", &read]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    // Again into the same folder: not over what is there, but on from it.
    let again = tautline(&["capture", "--rig", "demo", "--plan", &plan, "-o", &folder]);
    assert!(refused(&again).contains("--resume"));
    let resumed = tautline(&["capture", "--rig", "demo", "--plan", &plan, "-o", &folder, "--resume", "--json"]);
    let outcome: Value = serde_json::from_slice(&resumed.stdout).unwrap();
    assert_eq!((&outcome["complete"], &outcome["recorded_before"]), (&0.into(), &2.into()));
}

#[test]
fn a_dry_run_and_a_check_find_the_demo_in_order() {
    for arguments in [&["rig", "check", "--rig", "demo"][..], &["capture", "--rig", "demo"]] {
        let done = tautline(arguments);
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        assert!(text(&done.stdout).contains("nothing was enabled"), "{done:?}");
    }
    let done = tautline(&["rig", "scan", "--interface", "demo", "--json"]);
    let devices: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(devices["devices"][1]["product"], 0x301);
    let done = tautline(&["rig", "tare", "--rig", "demo", "--json"]);
    let tared: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert!(tared["zero_counts"].is_number());
}

/// Nobody is asked before there is a bus to ask on.
#[test]
fn without_a_bus_nobody_is_asked() {
    let out = TempDir::new().unwrap();
    let path = |name: &str| out.path().join(name).to_string_lossy().into_owned();
    std::fs::write(path("plan.toml"), super::SWEEP).unwrap();
    std::fs::write(path("rig.toml"), super::RIG.replace("\"demo\"", "\"no-such-interface\"")).unwrap();
    let armed = ["capture", "--rig", &path("rig.toml"), "--plan", &path("plan.toml"), "-o", &path("c"), "--arm"];
    let said = refused(&tautline(&armed));
    assert!(said.contains("cannot be opened") && !said.contains("Type"), "{said}");
    assert!(!out.path().join("c").exists());
}

/// Two of the worst faults, in the modes in which they are worst.
#[test]
fn the_fault_matrix_names_what_is_beyond_the_limits() {
    let done = tautline(&["rig", "faults", "--only", "csv FrozenEncoder", "--json"]);
    let told: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!((&told["wrong"], done.status.code()), (&0.into(), Some(0)), "{told}");
    assert_eq!(told["cases"][0]["cause"], "not_following", "{told}");
    assert!(told["cases"][0]["speed_rad_s"].as_f64().unwrap() < 0.625, "{told}");
}

#[test]
fn a_plan_beyond_the_limits_is_refused() {
    let out = TempDir::new().unwrap();
    let path = |name: &str| out.path().join(name).to_string_lossy().into_owned();
    std::fs::write(path("fast.toml"), super::SWEEP.replace("speed_rad_s = 0.4", "speed_rad_s = 1.6")).unwrap();
    let said = refused(&tautline(&["capture", "--rig", "demo", "--plan", &path("fast.toml")]));
    assert!(said.contains("sweep_1.6000 goes beyond the limit of speed, rad/s"), "{said}");
    std::fs::write(path("typo.toml"), super::SWEEP.replace("uniform", "uniforn")).unwrap();
    let said = refused(&tautline(&["capture", "--rig", "demo", "--plan", &path("typo.toml")]));
    assert!(said.contains("did you mean `uniform`?"), "{said}");
    std::fs::write(path("missing.toml"), "format = \"plan/1\"\n[[motions]]\ntrajectory = \"a.toml\"").unwrap();
    let said = refused(&tautline(&["capture", "--rig", "demo", "--plan", &path("missing.toml")]));
    assert!(said.contains("a.toml: cannot be read"), "{said}");
    std::fs::write(path("slow.toml"), super::SWEEP.replace("speed_rad_s = 0.4", "speed_rad_s = 1e-9")).unwrap();
    let said = refused(&tautline(&["capture", "--rig", "demo", "--plan", &path("slow.toml")]));
    assert!(said.contains("expected 0.001 to 100"), "{said}");
    std::fs::write(path("rest.toml"), super::SWEEP.replace("rest_s = 0.1", "rest_s = 1e12")).unwrap();
    let said = refused(&tautline(&["capture", "--rig", "demo", "--plan", &path("rest.toml")]));
    assert!(said.contains("expected 3600 s at most"), "{said}");
}
