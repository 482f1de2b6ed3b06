//! Joints whose torque is not measured: it follows from command and position by the controller's law.

use crate::campaigns::{identified, plan, record, truth};
use crate::cli::tautline;
use std::path::Path;
use tautline::identify::Settings;
use tautline::log::{Campaign, read_trial};
use tautline::model::{Direction, Model};
use tautline::simulate::{Controller, Plan, Wanted};
use tempfile::TempDir;

const CAMPAIGN: &str = r#"format = "campaign/1"
[joint]
name = "servo"
drive = "gear"
gear_ratio = 2.0
[dynamics]
gravity_nm = 0.7
inertia_kg_m2 = 0.01
[signal]
torque_sign = 1
lowpass_hz = 5.0
lowpass_order = 4
[controller]
stiffness_nm_rad = 20.0
damping_nm_s_rad = 0.5
torque_limit_nm = 3.0
[columns]
time = { name = "t", unit = "s" }
position = { name = "q", unit = "rad" }
command = { name = "c", unit = "rad" }
[[trials]]
file = "a.csv"
protocol = "free"
"#;

/// Two seconds of a joint that trails its command, 0.1 rad behind at 0.4 rad/s.
fn folder(campaign: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    let row = |i: usize| {
        let (t, command) = (i as f64 / 500.0, 0.4 * i as f64 / 500.0);
        format!("{t:.3},{},{command}\n", command - 0.1 - 1e-6 * (i as f64 * 0.7).sin())
    };
    std::fs::write(folder.path().join("a.csv"), format!("t,q,c\n{}", (0..1000).map(row).collect::<String>())).unwrap();
    std::fs::write(folder.path().join("campaign.toml"), campaign).unwrap();
    folder
}

fn torque_nm(campaign: &str) -> f64 {
    let folder = folder(campaign);
    let log = read_trial(&Campaign::read(folder.path()).unwrap(), 0).unwrap();
    assert_eq!(log.command_rad.as_ref().map(Vec::len), Some(log.torque_nm.len()));
    log.torque_nm[500]
}

fn refused(campaign: &str) -> String {
    Campaign::read(folder(campaign).path()).expect_err("is refused").to_string()
}

#[test]
fn the_torque_is_what_the_law_makes_of_command_and_position() {
    let near = |campaign: &str, nm: f64| {
        let found = torque_nm(campaign);
        assert!((found - nm).abs() < 1e-3, "{found} where {nm} was expected");
    };
    // At the joint 20 * 0.1 - 0.5 * 0.4; half of it at the motor.
    near(CAMPAIGN, 0.9);
    near(&CAMPAIGN.replace("torque_limit", "damped = \"error\"\ntorque_limit"), 1.0);
    near(&CAMPAIGN.replace("torque_limit_nm = 3.0", "torque_limit_nm = 1.5"), 0.75);
    near(&format!("{CAMPAIGN}controller = {{ stiffness_nm_rad = 10.0 }}\n"), 0.5);
    let (start, end) = (CAMPAIGN.find("[controller]").unwrap(), CAMPAIGN.find("[columns]").unwrap());
    let unknown = format!("{}{}", &CAMPAIGN[..start], &CAMPAIGN[end..]);
    near(&unknown, 0.05);
    let campaign = Campaign::read(folder(&unknown).path()).unwrap();
    assert!(campaign.warnings.iter().any(|warning| warning.what.contains("up to one factor")));
    assert!(campaign.uncertainty.torque_scale_percent.is_infinite());
}

/// A joint that speeds up by 1 rad/s^2, 0.1 rad behind its command: its controller has the velocity as it was 0.05 s ago.
#[test]
fn a_velocity_that_is_filtered_comes_late() {
    let torque_nm = |campaign: &str| {
        let folder = folder(campaign);
        let row = |i: usize| {
            let (t, position) = (i as f64 / 500.0, 0.5 * (i as f64 / 500.0).powi(2));
            format!("{t:.3},{position},{}\n", position + 0.1 + 1e-9 * (i as f64 * 0.7).sin())
        };
        std::fs::write(folder.path().join("a.csv"), format!("t,q,c\n{}", (0..1000).map(row).collect::<String>()))
            .unwrap();
        read_trial(&Campaign::read(folder.path()).unwrap(), 0).unwrap().torque_nm[500]
    };
    let filtered = CAMPAIGN.replace("torque_limit", "speed_filter_s = 0.05\ntorque_limit");
    // 0.5 N m s/rad times 0.05 rad/s, half of it at the motor.
    let more_nm = torque_nm(&filtered) - torque_nm(CAMPAIGN);
    assert!((more_nm - 0.0125).abs() < 1e-4, "{more_nm}");
    assert!(refused(&filtered.replace("damping_nm_s_rad = 0.5\n", "")).contains("without a damping"));
}

#[test]
fn what_a_controller_lacks_is_told() {
    assert!(refused(&CAMPAIGN.replace("torque_sign = 1", "torque_sign = -1")).contains("write torque_sign = 1"));
    assert!(refused(&CAMPAIGN.replace("stiffness_nm_rad = 20.0\n", "")).contains("without the stiffness"));
    let own = format!("{CAMPAIGN}controller = {{ damping_nm_s_rad = 1.0 }}\n");
    assert!(refused(&own).contains("give the stiffness in this trial"));
    let neither = CAMPAIGN.replace("command = ", "velocity = ").replace("\"rad\" }\n[[", "\"rad/s\" }\n[[");
    assert!(refused(&neither).contains("`command` of its position"));
}

/// The elbow under a controller, logged without its torque.
fn alone(plan: Plan) -> TempDir {
    let wanted = Wanted { stiffness_nm_rad: Some(60.0), ..Wanted::default() };
    let controller = Controller::new(wanted, &truth(), &truth(), None).unwrap();
    record(&truth(), &Plan { controller: Some(controller), position_alone: true, ..plan })
}

#[test]
fn friction_is_identified_from_command_and_position() {
    let folder = alone(plan());
    let text = std::fs::read_to_string(folder.path().join("campaign.toml")).unwrap();
    assert!(text.contains("[controller]") && !text.contains("torque = "), "{text}");
    let campaign = Campaign::read(folder.path()).unwrap();
    assert_eq!(campaign.to_toml(), text);
    let found = identified(folder.path(), Settings::default()).model;
    let truth = truth();
    for speed_rad_s in [-0.3, -0.1, 0.1, 0.3] {
        let direction = if speed_rad_s > 0.0 { Direction::Up } else { Direction::Down };
        let b_nm = |model: &Model| model.b_nm(direction, f64::abs(speed_rad_s));
        let (is, was) = (b_nm(&found), b_nm(&truth));
        assert!((is - was).abs() < 0.03 * was.abs(), "{is} N m where {was} was at {speed_rad_s} rad/s");
    }
}

#[test]
fn an_unknown_stiffness_leaves_one_factor_open_and_says_so() {
    let folder = alone(Plan { cosines: 1, ..plan() });
    let file = folder.path().join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let (start, end) = (text.find("[controller]").unwrap(), text.find("[columns]").unwrap());
    std::fs::write(&file, format!("{}{}", &text[..start], &text[end..])).unwrap();
    let out = folder.path().join("out");
    let said = tautline(&["identify", folder.path().to_str().unwrap(), "-o", out.to_str().unwrap()]);
    assert!(said.status.success(), "{said:?}");
    let words = String::from_utf8_lossy(&said.stdout).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("up to one factor"), "{words}");
    let model: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("model.json")).unwrap()).unwrap();
    for direction in ["up", "down"] {
        let mu_c = &model["confidence"][format!("friction.{direction}.mu_c")];
        assert_ne!(mu_c["status"], "pinned", "{mu_c}");
    }
    let model = out.join("model.json");
    let why = folder.path().join("why");
    let [campaign, model, why] = [folder.path(), &model, &why].map(|path: &Path| path.to_str().unwrap());
    assert!(tautline(&["diagnose", campaign, "--model", model, "-o", why, "--quiet"]).status.success());
}
