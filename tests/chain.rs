//! A joint in a whole arm: other joints moving, columns matched with joints, what is missing told.

use crate::campaigns::{plan, truth};
use std::path::Path;
use tautline::dynamics::Chain;
use tautline::evaluate::{Settings, run};
use tautline::log::Campaign;
use tautline::simulate::{Plan, Sensors, SimulatedArm};
use tempfile::TempDir;

const URDF: &str = "data/arm/arm.urdf";

fn arm() -> TempDir {
    let chain = Chain::read(Path::new(URDF), "elbow_flexion").unwrap();
    let arm = SimulatedArm { urdf: "arm.urdf".to_string(), chain, multi_joint: 1 };
    let sensors = Sensors { torque_noise_nm: 0.01, encoder_counts: 524_288.0 };
    let plan = Plan { speeds: 0, cosines: 1, arm: Some(arm), sensors, rate_hz: 100.0, ..plan() };
    let folder = crate::campaigns::record(&truth(), &plan);
    std::fs::copy(URDF, folder.path().join("arm.urdf")).unwrap();
    folder
}

/// `campaign.toml` of `arm` with `old` replaced by `new`, read.
fn changed(old: &str, new: &str) -> Result<Campaign, String> {
    let folder = arm();
    let file = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains(old), "{text}");
    std::fs::write(&file, text.replace(old, new)).unwrap();
    Campaign::read(folder.path()).map_err(|problems| problems.to_string())
}

#[test]
fn the_elbow_of_the_arm_is_the_bundled_elbow() {
    // With the shoulder at rest the chain's gravity and inertia are those of the single joint.
    let folder = arm();
    let found = run(&Campaign::read(folder.path()).unwrap(), &truth(), &Settings::default(), &|| ()).unwrap();
    let floor_nm = 0.01 * 0.31;
    for trial in &found.trials {
        assert!(trial.filtered.all.rmse_nm < 1.2 * floor_nm, "{}: {}", trial.entry.file, trial.filtered.all.rmse_nm);
    }
}

#[test]
fn the_other_joint_matters() {
    // Without the shoulder's motion the same prediction is far off: gravity turns with it.
    let held = "held_rad = { shoulder_abduction = 0.0, shoulder_flexion = 0.0 }";
    let folder = arm();
    let file = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let still = text.replace("joint = \"elbow_flexion\"", &format!("joint = \"elbow_flexion\"\n{held}"));
    std::fs::write(&file, still).unwrap();
    let found = run(&Campaign::read(folder.path()).unwrap(), &truth(), &Settings::default(), &|| ()).unwrap();
    let of = |name: &str| found.trials.iter().find(|t| t.entry.file.starts_with(name)).unwrap().filtered.all.rmse_nm;
    assert!(of("multi_joint") > 3.0 * of("cosine"), "{} against {}", of("multi_joint"), of("cosine"));
}

#[test]
fn what_a_chain_lacks_is_told() {
    let lost = changed("joint = \"elbow_flexion\"", "joint = \"elbow_flexon\"").unwrap_err();
    assert!(lost.contains("has no joint `elbow_flexon`") && lost.contains("did you mean `elbow_flexion`"), "{lost}");
    let fixed = changed("joint = \"elbow_flexion\"", "joint = \"handle_mount\"").unwrap_err();
    assert!(fixed.contains("joint `handle_mount` is fixed"), "{fixed}");
    let gone = changed("urdf = \"arm.urdf\"", "urdf = \"leg.urdf\"").unwrap_err();
    assert!(gone.contains("leg.urdf") && gone.contains("cannot be read"), "{gone}");
    let unit = changed(
        "name = \"shoulder_abduction_deg\", unit = \"deg\"",
        "name = \"shoulder_abduction_deg\", unit = \"mm\"",
    );
    assert!(unit.unwrap_err().contains("joint `shoulder_abduction` is revolute"));
    let twice = changed("urdf = \"arm.urdf\"", "urdf = \"arm.urdf\"\ngravity_nm = 0.7").unwrap_err();
    assert!(twice.contains("beside a URDF"), "{twice}");
}

#[test]
fn a_missing_position_of_another_joint_is_told() {
    let column =
        "other_position_2 = { joint = \"shoulder_flexion\", name = \"shoulder_flexion_deg\", unit = \"deg\" }\n";
    let missing = changed(column, "").unwrap_err();
    assert!(missing.contains("the position of joint `shoulder_flexion`") && missing.contains("held_rad"), "{missing}");
}

#[test]
fn columns_are_matched_by_name_and_a_guess_is_told() {
    let by_name = changed("joint = \"shoulder_flexion\", ", "").unwrap();
    assert!(by_name.warnings.is_empty(), "{:?}", by_name.warnings);
    let guessed = changed("joint = \"shoulder_flexion\", name = \"shoulder_flexion_deg\"", "name = \"q2\"").unwrap();
    assert!(
        guessed.warnings.iter().any(|w| w.to_string().contains("column `q2` is taken for joint `shoulder_flexion`"))
    );
}
