//! A joint in a whole arm: other joints moving, columns matched with joints, what is missing told.

use crate::campaigns::{plan, truth};
use std::path::Path;
use tautline::dynamics::Chain;
use tautline::evaluate::{Settings, run};
use tautline::log::Campaign;
use tautline::model::{ChainName, Model};
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
    let still: String =
        still.lines().filter(|line| !line.starts_with("other_position")).map(|l| format!("{l}\n")).collect();
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
fn a_joint_is_held_or_recorded() {
    let held = changed("joint = \"elbow_flexion\"", "joint = \"elbow_flexion\"\nheld_rad = { shoulder_flexion = 0.1 }");
    assert!(held.unwrap_err().contains("joint `shoulder_flexion` is held here, and recorded"));
    let other = changed("joint = \"shoulder_flexion\"", "joint = \"shoulder_flexon\"").unwrap_err();
    assert!(
        other.contains("of joint `shoulder_flexon`") && other.contains("did you mean `shoulder_flexion`"),
        "{other}"
    );
}

#[test]
fn links_without_mass_are_told() {
    let folder = arm();
    let file = folder.path().join("arm.urdf");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replace("<mass value=\"0.75\"/>", "<mass value=\"0\"/>")).unwrap();
    let refused = Campaign::read(folder.path()).unwrap_err().to_string();
    assert!(refused.contains("nothing that hangs on joint `elbow_flexion` has a mass"), "{refused}");
}

#[test]
fn a_model_of_another_joint_of_the_arm_is_refused() {
    let folder = arm();
    let campaign = Campaign::read(folder.path()).unwrap();
    let of = |joint: &str| {
        let chain = ChainName { urdf: "arm.urdf".to_string(), joint: joint.to_string() };
        Model { chain: Some(chain), ..truth() }
    };
    assert!(run(&campaign, &of("elbow_flexion"), &Settings::default(), &|| ()).is_ok());
    let refused = run(&campaign, &of("shoulder_abduction"), &Settings::default(), &|| ()).unwrap_err();
    assert!(refused.to_string().contains("joint `shoulder_abduction` of its chain"), "{refused}");
    assert!(tautline::compare::compare(&of("elbow_flexion"), &of("shoulder_abduction")).is_err());
    let alone = crate::campaigns::record(&truth(), &Plan { speeds: 0, cosines: 1, ..plan() });
    let refused =
        run(&Campaign::read(alone.path()).unwrap(), &of("elbow_flexion"), &Settings::default(), &|| ()).unwrap_err();
    assert!(refused.to_string().contains("names no URDF"), "{refused}");
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
