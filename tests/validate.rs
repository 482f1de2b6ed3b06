//! `validate` says everything that is wrong with a campaign at once, and all that `identify` would refuse it for.

use crate::campaigns::{plan, record, truth};
use crate::cli::tautline;
use serde_json::Value;
use std::path::Path;
use tautline::simulate::Plan;
use tempfile::TempDir;

fn campaign() -> TempDir {
    record(&truth(), &Plan { speeds: 6, cosines: 1, rate_hz: 50.0, ..plan() })
}

/// The file's text with the first `from` replaced.
fn change(folder: &Path, file: &str, from: &str, to: &str) {
    let file = folder.join(file);
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains(from), "{from}");
    std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
}

/// Every row of a log after its header, changed by its number, its fields given.
fn change_rows(folder: &Path, file: &str, change: impl Fn(usize, &mut Vec<String>)) {
    let file = folder.join(file);
    let text = std::fs::read_to_string(&file).unwrap();
    let one = |(row, line): (usize, &str)| {
        let mut fields: Vec<String> = line.split(',').map(str::to_string).collect();
        if row > 0 {
            change(row, &mut fields);
        }
        if fields.is_empty() { String::new() } else { fields.join(",") + "\n" }
    };
    std::fs::write(&file, text.lines().enumerate().map(one).collect::<String>()).unwrap();
}

/// "severity file: what; cure" of every problem.
fn problems(folder: &Path) -> Vec<String> {
    let done = tautline(&["validate", &folder.to_string_lossy(), "--json"]);
    let result: Value = serde_json::from_slice(&done.stdout).unwrap();
    let text = |problem: &Value, key: &str| problem[key].as_str().unwrap().to_string();
    let all = result["problems"].as_array().unwrap().iter();
    let found: Vec<String> = all
        .map(|p| {
            let file = text(p, "file");
            let name = Path::new(&file).file_name().unwrap().to_string_lossy().into_owned();
            format!("{} {name}: {}; {}", text(p, "severity"), text(p, "what"), text(p, "cure"))
        })
        .collect();
    let is_usable = found.iter().all(|problem| problem.starts_with("warning"));
    assert_eq!(done.status.code(), Some(if is_usable { 0 } else { 2 }), "{found:#?}");
    found
}

#[track_caller]
fn assert_told(found: &[String], expected: &[(&str, &str)]) {
    for (file, words) in expected {
        assert!(found.iter().any(|p| p.contains(file) && p.contains(words)), "{file}: {words} not in {found:#?}");
    }
    assert_eq!(found.len(), expected.len(), "{found:#?}");
}

#[test]
fn every_fault_of_a_campaign_is_listed_at_once() {
    let folder = campaign();
    let at = folder.path();
    change(at, "campaign.toml", "backlash_m", "colour = \"red\"\nbacklash_m");
    change(at, "campaign.toml", "torque_sign = -1", "torque_sign = 1");
    change(at, "campaign.toml", "speed_rad_s = 0.1149\n", "speed_rad_s = 0.2\n");
    std::fs::remove_file(at.join("cosine_1.csv")).unwrap();
    // In one log a text, a gap and a dead sensor.
    change_rows(at, "sweep_0.0500_1.csv", |row, fields| {
        fields[2] = if row == 7 { "abc" } else { "0.5" }.to_string();
        if (20..30).contains(&row) {
            fields.clear();
        }
    });
    change(at, "sweep_0.4000_1.csv", "torque_nm", "torqe_nm");
    // A text in a log whose sweep misses its speed hides neither.
    change_rows(at, "sweep_0.1149_1.csv", |row, fields| {
        if row == 9 {
            fields[0] = "noon".to_string();
        }
    });
    assert_told(
        &problems(at),
        &[
            ("campaign.toml", "friction would drive the joint, and gravity would lift it"),
            ("campaign.toml", "unknown key `colour`"),
            ("campaign.toml", "there is no file `cosine_1.csv`"),
            ("sweep_0.0500_1.csv", "holds `abc`"),
            ("sweep_0.0500_1.csv", "a gap of"),
            ("sweep_0.0500_1.csv", "reads 0.5 N m throughout"),
            ("sweep_0.1149_1.csv", "holds `noon`"),
            ("sweep_0.1149_1.csv", "no plateau at the declared speed_rad_s = 0.2 rad/s"),
            ("sweep_0.4000_1.csv", "there is no such column"),
            ("campaign.toml", "moving up, but the load it belongs to is 0.6916 N m: opposite signs"),
            ("campaign.toml", "moving down, but the load it belongs to is 0.6916 N m: opposite signs"),
        ],
    );
}

#[test]
fn logs_are_checked_whatever_is_wrong_with_campaign_toml() {
    for (from, to) in [
        ("winch_radius_m", "winch_radius"),
        ("gravity_nm", "gravity"),
        ("torque_sign = -1", "torque_sign = -2"),
        ("lowpass_hz = 5", "lowpass_hz = -5"),
        ("unit = \"N m\"", "unit = \"nm\""),
        ("\ntorque = {", "\ntroque = {"),
        ("campaign/1", "campaign/2"),
        ("protocol = \"cosine\"", "protocol = \"cosin\""),
    ] {
        let folder = campaign();
        change(folder.path(), "campaign.toml", from, to);
        change(folder.path(), "sweep_0.0500_1.csv", "\n0.02000,", "\nNaN,");
        let found = problems(folder.path());
        assert!(found[0].contains("campaign.toml"), "{to}: {found:#?}");
        let of_logs: Vec<&String> = found.iter().filter(|p| !p.contains("campaign.toml:")).collect();
        assert!(of_logs.len() == 1 && of_logs[0].contains("holds `NaN`"), "{to}: {found:#?}");
    }
}

/// What `identify` says of a campaign that it refuses; `validate` must say all of it.
#[track_caller]
fn assert_refused_by_both(folder: &Path, words: &str) {
    let out = TempDir::new().unwrap();
    let to = out.path().join("r").to_string_lossy().into_owned();
    let done = tautline(&["identify", &folder.to_string_lossy(), "-o", &to]);
    assert_eq!(done.status.code(), Some(2));
    let errors = String::from_utf8(done.stderr).unwrap();
    assert!(errors.contains(words), "{errors}");
    let found = problems(folder);
    assert!(found.iter().any(|p| p.starts_with("error") && p.contains(words)), "{found:#?}");
}

#[test]
fn what_identify_refuses_validate_tells() {
    let folder = record(&truth(), &Plan { speeds: 1, repeats: 2, rate_hz: 50.0, ..plan() });
    assert_refused_by_both(folder.path(), "2 of the legs move up, all at one speed");

    let folder = campaign();
    change(folder.path(), "campaign.toml", "gravity_nm = 0.6916", "gravity_nm = 0.0");
    assert_refused_by_both(folder.path(), "gravity_nm = 0, yet moving down");

    // Only the way up of every sweep.
    let folder = campaign();
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let file = entry.unwrap().path();
        if file.file_name().is_some_and(|name| name.to_string_lossy().starts_with("sweep")) {
            let text = std::fs::read_to_string(&file).unwrap();
            let rows = text.lines().count();
            let half = text.lines().take(rows / 2).map(|line| format!("{line}\n")).collect::<String>();
            std::fs::write(&file, half).unwrap();
        }
    }
    assert_refused_by_both(folder.path(), "no leg of constant speed moves down");

    let folder = record(&truth(), &Plan { speeds: 0, cosines: 1, rate_hz: 50.0, ..plan() });
    let text = std::fs::read_to_string(folder.path().join("cosine_1.csv")).unwrap();
    let start = text.lines().take(2000).map(|line| format!("{line}\n")).collect::<String>();
    std::fs::write(folder.path().join("cosine_1.csv"), start).unwrap();
    assert_refused_by_both(folder.path(), "no trial in which the joint turns");

    // And a speed that no window fits.
    let folder = campaign();
    change(folder.path(), "campaign.toml", "speed_rad_s = 0.05\n", "speed_rad_s = 1e-12\n");
    assert_refused_by_both(folder.path(), "the joint moves at up to 0.05");
}

#[test]
fn one_fault_in_many_logs_names_them_all() {
    let folder = campaign();
    for file in ["sweep_0.0500_1.csv", "sweep_0.1149_1.csv", "sweep_0.4000_1.csv"] {
        change(folder.path(), file, "torque_nm", "torque");
    }
    let done = tautline(&["validate", &folder.path().to_string_lossy()]);
    let errors = String::from_utf8(done.stderr).unwrap();
    assert_eq!(errors.lines().count(), 1, "{errors}");
    assert!(errors.contains("(the same: sweep_0.1149_1.csv row 1, sweep_0.4000_1.csv row 1)"), "{errors}");
}

#[test]
fn a_folder_shows_each_trial_as_it_was_understood() {
    let folder = crate::campaigns::record(&crate::campaigns::truth(), &crate::campaigns::plan());
    let out = folder.path().join("looked-at");
    let done = crate::cli::tautline(&["validate", folder.path().to_str().unwrap(), "-o", out.to_str().unwrap()]);
    assert!(done.status.success(), "{done:?}");
    let text = String::from_utf8(done.stdout).unwrap();
    assert!(text.contains("sweeps at 8 speeds") && text.contains("found within"), "{text}");
    for file in ["report.html", "validation.json", "plots/speeds.svg", "plots/trial_0.svg"] {
        assert!(out.join(file).is_file(), "{file}");
    }
    let found: serde_json::Value =
        serde_json::from_slice(&std::fs::read(out.join("validation.json")).unwrap()).unwrap();
    for rate_hz in found["understood"]["rate_hz"].as_array().unwrap() {
        let planned_hz = crate::campaigns::plan().rate_hz;
        assert!((rate_hz.as_f64().unwrap() / planned_hz - 1.0).abs() < 1e-6, "{rate_hz} of {planned_hz}");
    }
    let speeds = found["understood"]["speeds"].as_array().unwrap();
    assert_eq!(speeds.len(), 8);
    for speed in speeds {
        let declared = speed["declared_rad_s"].as_f64().unwrap();
        assert!((speed["found_rad_s"][0].as_f64().unwrap() / declared - 1.0).abs() < 0.01, "{speed}");
    }
}
