//! Joints that no cable drives: what is read, identified and printed of a screw's slide, a gear, a motor whose constant is unknown.

use crate::campaigns::{plan, record};
use crate::cli::tautline;
use std::path::Path;
use tautline::log::Campaign;
use tautline::model::{Direction, Model};
use tautline::simulate::Plan;

/// A slide of 3 kg on a screw of 5 mm a turn, 20 N of weight along it.
const SCREW: &str = r#"{"format": "model/1",
 "joint": {"name": "slide", "kind": "prismatic", "drive": "screw", "winch_radius_m": 0.000795774715, "pulley_radius_m": 1.0, "backlash_m": 0.0},
 "dynamics": {"gravity_nm": 20.0, "inertia_kg_m2": 3.0},
 "friction": {"up": {"mu_c": 0.2, "a_j": 40.0, "b_c": 0, "c_c": 10, "b_j": 0, "c_j": 10, "d": 60.0},
              "down": {"mu_c": 0.2, "a_j": -35.0, "b_c": 0, "c_c": -10, "b_j": 0, "c_j": -10, "d": 50.0}},
 "combination": {"kind": "sign"}, "effects": []}"#;

fn said(words: &[&str]) -> String {
    let done = tautline(words);
    assert!(done.status.success(), "{words:?}: {}", String::from_utf8_lossy(&done.stderr));
    String::from_utf8(done.stdout).unwrap()
}

#[test]
fn a_screw_has_its_slides_forces_in_newton_and_its_motors_torque_in_newton_metres() {
    let model = Model::parse(Path::new("screw.json"), SCREW).unwrap();
    let folder = record(&model, &Plan { speeds: 0, cosines: 2, rate_hz: 50.0, ..plan() });
    let file = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("motor_torque_nm") && text.contains("unit = \"N m\""), "{text}");
    std::fs::write(&file, text.replace("unit = \"N m\"", "unit = \"N\"")).unwrap();
    let refused = Campaign::read(folder.path()).unwrap_err().to_string();
    assert!(refused.contains("torque is the motor's, before the screw"), "{refused}");
    std::fs::write(&file, text).unwrap();

    let out = folder.path().join("out");
    let [campaign, out_of] = [folder.path(), &out].map(|path| path.to_str().unwrap());
    let understood = said(&["validate", campaign]);
    assert!(understood.contains(" mm, speed ") && understood.contains(" N m, with torque_sign"), "{understood}");
    let told = said(&["identify", campaign, "-o", out_of]);
    for expected in ["a_j    N  ", "d      N s/m", "mN m"] {
        assert!(told.contains(expected), "no `{expected}` in\n{told}");
    }
    assert!(!told.contains("mN ") || !told.replace("mN m", "").contains("mN"), "{told}");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("screw, 5.000 mm a turn") && !page.contains("winch radius"));
    // The whole friction of either direction at the slide: what no load tells apart is one number.
    let found = Model::read(&out.join("model.json")).unwrap();
    for (direction, force_n) in
        [(Direction::Up, 40.0 + 0.1 * 60.0 + 0.2 * 20.0), (Direction::Down, -35.0 - 0.1 * 50.0 + 0.2 * 20.0)]
    {
        let b_n = found.b_nm(direction, 0.1) / found.joint.transmission();
        let expected_n = force_n / 0.8;
        assert!((b_n - expected_n).abs() < 0.1 * expected_n.abs(), "{b_n} N where {expected_n} N was, {direction:?}");
    }
}

#[test]
fn a_gear_has_torques_at_the_joint_and_no_cable() {
    let gear = SCREW
        .replace("\"prismatic\", \"drive\": \"screw\"", "\"revolute\", \"drive\": \"gear\"")
        .replace("0.000795774715", "0.02");
    let model = Model::parse(Path::new("gear.json"), &gear).unwrap();
    let folder = record(&model, &plan());
    let out = folder.path().join("out");
    let told = said(&["identify", folder.path().to_str().unwrap(), "-o", out.to_str().unwrap()]);
    assert!(told.contains("a_j    N m  ") && !told.contains("cable"), "{told}");
    let page = std::fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("gear or belt, ratio 50") && page.contains("1 less the efficiency under load"));
}

#[test]
fn an_unknown_torque_constant_leaves_one_factor_open_to_the_end() {
    let folder = record(&crate::campaigns::truth(), &Plan { cosines: 1, ..plan() });
    let file = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(
        &file,
        text.replace(
            "torque = { name = \"torque_nm\", unit = \"N m\" }",
            "current = { name = \"torque_nm\", unit = \"A\" }",
        ),
    )
    .unwrap();
    let [out, why] = ["out", "why"].map(|name| folder.path().join(name).to_str().unwrap().to_string());
    let campaign = folder.path().to_str().unwrap();
    let identified = tautline(&["identify", campaign, "-o", &out]);
    assert!(identified.status.success(), "{identified:?}");
    let words = |text: &[u8]| String::from_utf8_lossy(text).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words(&identified.stdout).contains("up to one factor"), "{identified:?}");
    let model: serde_json::Value =
        serde_json::from_slice(&std::fs::read(format!("{out}/model.json")).unwrap()).unwrap();
    for direction in ["up", "down"] {
        let status = |name: &str| model["confidence"][format!("friction.{direction}.{name}")]["status"].clone();
        assert_ne!(status("mu_c"), "pinned", "{:#}", model["confidence"]);
    }
    let told = tautline(&["diagnose", campaign, "--model", &format!("{out}/model.json"), "-o", &why]);
    assert!(told.status.success(), "{told:?}");
}
