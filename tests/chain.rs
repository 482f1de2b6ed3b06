//! A joint in a whole arm: other joints moving, columns matched with joints, what is missing told.

use crate::campaigns::{plan, truth};
use std::path::Path;
use tautline::diagnose::{self, Cause, Kind};
use tautline::dynamics::{Chain, Dynamics, Motion, Payload};
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

/// A load on the handle, of which the URDF says nothing: in the frame of the forearm, the last link that moves, it hangs at 0.02, 0, -0.24 m.
const LOAD_KG: f64 = 0.3;
const LOAD: Payload =
    Payload { mass_kg: LOAD_KG, moment_kg_m: [LOAD_KG * 0.02, 0.0, LOAD_KG * -0.24], inertia_kg_m2: LOAD_KG * 0.058 };

fn elbow(urdf: &str) -> Chain {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("arm.urdf");
    std::fs::write(&file, urdf).unwrap();
    Chain::read(&file, "elbow_flexion").unwrap()
}

fn of_elbow(payload: Payload) -> Model {
    let chain = ChainName { urdf: "arm.urdf".to_string(), joint: "elbow_flexion".to_string() };
    Model { chain: Some(chain), dynamics: Dynamics { payload, ..Dynamics::default() }, ..truth() }
}

#[test]
fn a_payload_is_a_mass_on_the_last_link() {
    let text = std::fs::read_to_string(URDF).unwrap();
    let handle = "<mass value=\"0.0\"/>";
    assert!(text.contains(handle));
    let loaded = elbow(&text.replace(handle, &format!("<mass value=\"{LOAD_KG}\"/>")));
    let carrying = elbow(&text).carrying(&LOAD);
    let own = Motion { position: 1.1, velocity: 1.3, acceleration: 4.0 };
    let others = [Motion { position: -0.4, velocity: 0.6, acceleration: 2.0 }; 2];
    let (a, b) = (loaded.torque(own, &others), carrying.torque(own, &others));
    // A point mass has no inertia about the line to it, on which the forearm hardly turns.
    let most_nm = 2e-2 * a.total_nm().abs();
    assert!((a.gravity_nm - b.gravity_nm).abs() < 1e-9, "{} and {} N m", a.gravity_nm, b.gravity_nm);
    for (a, b) in [(a.inertia_nm, b.inertia_nm), (a.coriolis_nm, b.coriolis_nm)] {
        assert!((a - b).abs() < most_nm, "{a} and {b} N m");
    }
    let bare = elbow(&text).torque(own, &others);
    assert!((a.gravity_nm - bare.gravity_nm).abs() > 0.1);
    assert!((a.inertia_nm - bare.inertia_nm).abs() > 0.02);
}

/// The arm carries a load, recorded with the shoulder moving, that the model's URDF does not know.
#[test]
fn a_payload_that_the_urdf_lacks_is_diagnosed_and_predicted() {
    let chain = Chain::read(Path::new(URDF), "elbow_flexion").unwrap().carrying(&LOAD);
    let arm = SimulatedArm { urdf: "arm.urdf".to_string(), chain, multi_joint: 4 };
    let sensors = Sensors { torque_noise_nm: 0.01, encoder_counts: 524_288.0 };
    let plan = Plan { speeds: 3, cosines: 2, arm: Some(arm), sensors, rate_hz: 100.0, ..plan() };
    let folder = crate::campaigns::record(&truth(), &plan);
    std::fs::copy(URDF, folder.path().join("arm.urdf")).unwrap();
    let campaign = Campaign::read(folder.path()).unwrap();
    let found = diagnose::run(&campaign, &of_elbow(Payload::default()), &|_| ()).unwrap();
    assert_eq!((found.verdict.kind, &found.verdict.effects[..]), (Kind::Stale, &[Cause::Stale("gravity")][..]));
    assert!(found.after.dynamics.payload.inertia_kg_m2 >= 0.0);
    assert!(found.verdict.shrink.value > 0.95, "{:?}", found.verdict.shrink);
    // What was found is written, read, and predicts what the arm does with it.
    let written = found.after.to_json().to_string();
    let read = Model::parse(Path::new("model.json"), &written).unwrap();
    let weigh = |model: &Model| {
        let payload = model.dynamics.payload;
        (payload.mass_kg, payload.moment_kg_m)
    };
    assert_eq!(weigh(&read), weigh(&found.after));
    let with = run(&campaign, &read, &Settings::default(), &|| ()).unwrap();
    let without = run(&campaign, &of_elbow(Payload::default()), &Settings::default(), &|| ()).unwrap();
    for (with, without) in with.trials.iter().zip(&without.trials) {
        let (with, without) = (with.filtered.all.rmse_nm, without.filtered.all.rmse_nm);
        assert!(with < 0.2 * without, "{with} of {without} N m");
    }
    let again = diagnose::run(&campaign, &read, &|_| ()).unwrap();
    assert_eq!(again.verdict.kind, Kind::None);
}

#[test]
fn a_payload_on_a_joint_that_moves_alone_is_refused() {
    let alone = Model { chain: None, ..of_elbow(LOAD) };
    let refused = Model::parse(Path::new("model.json"), &alone.to_json().to_string()).unwrap_err().to_string();
    assert!(refused.contains("is a payload on a joint that moves alone"), "{refused}");
}
