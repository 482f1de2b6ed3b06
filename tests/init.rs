//! `tautline init`: from a lab's own files to a campaign that `validate` and `identify` accept.

use crate::campaigns::{plan, record, truth};
use crate::cli::tautline;
use serde_json::Value;
use std::fmt::Write;
use std::path::Path;
use tautline::simulate::Plan;
use tempfile::TempDir;

/// Simulated logs without their campaign.toml, each put through `change`: time s, position deg, torque N m of every row.
fn logs(change: impl Fn(&str, Vec<[f64; 3]>) -> (String, Vec<u8>)) -> TempDir {
    let recorded = record(&truth(), &Plan { speeds: 4, repeats: 2, cosines: 2, rate_hz: 100.0, ..plan() });
    let folder = TempDir::new().unwrap();
    for entry in std::fs::read_dir(recorded.path()).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_some_and(|ending| ending == "csv") {
            let text = std::fs::read_to_string(&file).unwrap();
            let row = |line: &str| {
                let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
                [cells[0], cells[1], cells[2]]
            };
            let name = file.file_stem().unwrap().to_string_lossy().into_owned();
            let (name, bytes) = change(&name, text.lines().skip(1).map(row).collect());
            std::fs::write(folder.path().join(name), bytes).unwrap();
        }
    }
    folder
}

const ANSWERS: [&str; 8] = [
    "--winch-radius-mm=12",
    "--pulley-radius-mm=40",
    "--backlash-mm=0.8",
    "--gravity-nm=0.6916",
    "--inertia-kg-m2=0.012",
    "--torque-sign=-1",
    "--zero=0",
    "--json",
];

fn init(files: &Path, output: &Path, options: &[&str]) -> Value {
    let (files, output) = (files.to_string_lossy(), output.to_string_lossy());
    let done = tautline(&[&["init", &files, "-o", &output], options].concat());
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    serde_json::from_slice(&done.stdout).unwrap_or(Value::Null)
}

#[track_caller]
fn assert_leads_to_identify(campaign: &Path) {
    let campaign = campaign.to_string_lossy();
    let done = tautline(&["validate", &campaign, "--strict"]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let out = TempDir::new().unwrap();
    let to = out.path().join("r").to_string_lossy().into_owned();
    let done = tautline(&["identify", &campaign, "-o", &to, "--json"]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let found: Value = serde_json::from_slice(&done.stdout).unwrap();
    let mu_c = found["friction"]["up"]["mu_c"].as_f64().unwrap();
    assert!((mu_c - 0.41).abs() < 0.02, "mu_c = {mu_c}");
}

#[track_caller]
fn assert_protocols(found: &Value) {
    let trials = found["trials"].as_array().unwrap();
    let of = |protocol: &str| trials.iter().filter(|trial| trial["protocol"] == protocol).count();
    assert_eq!((of("uniform"), of("cosine")), (8, 2), "{trials:#?}");
    let mut speeds: Vec<f64> = trials.iter().filter_map(|trial| trial["speed_rad_s"].as_f64()).collect();
    speeds.sort_by(f64::total_cmp);
    for (found, true_rad_s) in speeds.iter().zip([0.05, 0.05, 0.1, 0.1, 0.2, 0.2, 0.4, 0.4]) {
        assert!((found / true_rad_s - 1.0).abs() < 0.01, "{speeds:?}");
    }
    assert!(trials.iter().all(|trial| (1..=2).contains(&trial["repeat"].as_i64().unwrap())), "{trials:#?}");
}

fn keys(found: &Value) -> Vec<String> {
    found["questions"]
        .as_array()
        .unwrap()
        .iter()
        .map(|question| question["key"].as_str().unwrap().to_string())
        .collect()
}

#[test]
fn german_csv_becomes_a_campaign_once_its_questions_are_answered() {
    let folder = logs(|name, rows| {
        let mut text =
            "Messung vom 3.4.;;\r\nPr\u{fc}fstand 2;;\r\nZeit [s];Winkel [\u{b0}];Drehmoment [mNm]\r\n".to_string();
        for [t, q, y] in rows {
            writeln!(text, "{t:.3};{q:.6};{:.4}\r", 1e3 * y).unwrap();
        }
        let text = text.replacen("vom 3.4.", "vom 3,4,", 1).replace('.', ",");
        // As Windows writes it.
        (format!("{name}.csv"), text.chars().map(|sign| u8::try_from(u32::from(sign)).unwrap()).collect())
    });
    let before = std::fs::read(folder.path().join("cosine_1.csv")).unwrap();
    // In place, nothing answered: only what no data can tell is asked, and validate refuses each by name.
    let found = init(folder.path(), folder.path(), &["--json"]);
    assert_protocols(&found);
    assert_eq!(
        keys(&found),
        [
            "joint.winch_radius_m",
            "joint.pulley_radius_m",
            "dynamics.gravity_nm",
            "signal.torque_sign",
            "columns.position.offset"
        ]
    );
    let suggested = |key: &str| {
        let all = found["questions"].as_array().unwrap();
        all.iter().find(|question| question["key"] == key).unwrap()["suggested"].clone()
    };
    assert_eq!((suggested("signal.torque_sign"), suggested("dynamics.gravity_nm")), ("-1".into(), Value::Null));
    let done = tautline(&["validate", &folder.path().to_string_lossy()]);
    let errors = String::from_utf8(done.stderr).unwrap();
    assert_eq!((done.status.code(), errors.matches("is still a question").count()), (Some(2), 5), "{errors}");
    assert_eq!(std::fs::read(folder.path().join("cosine_1.csv")).unwrap(), before, "logs are not changed");
    // Into a new folder, with the answers.
    let out = TempDir::new().unwrap();
    let campaign = out.path().join("campaign");
    assert_eq!(keys(&init(folder.path(), &campaign, &ANSWERS)), Vec::<String>::new());
    assert_leads_to_identify(&campaign);
}

#[test]
fn nanoseconds_radians_and_gaps_are_understood() {
    let folder = logs(|name, rows| {
        let mut text = "stamp [ns]\tq [rad]\tdq [rad s^-1]\ttau [N.m]\n".to_string();
        for (at, [t, q, y]) in rows.iter().enumerate() {
            // A cosine is interrupted, and says one row twice.
            if name == "cosine_1" && (900..950).contains(&at) {
                continue;
            }
            let before = rows[at.saturating_sub(1)][1];
            let after = rows[(at + 1).min(rows.len() - 1)][1];
            let speed = (after - before).to_radians() * 50.0;
            let line = format!("{:.0}\t{:.8}\t{speed:.6}\t{y:.6}\n", 1.7e18 + (t * 1e9), q.to_radians());
            text.push_str(&line);
            if name == "cosine_2" && at == 500 {
                text.push_str(&line);
            }
        }
        (format!("{name}.txt"), text.into_bytes())
    });
    let out = TempDir::new().unwrap();
    let campaign = out.path().join("campaign");
    let found = init(folder.path(), &campaign, &ANSWERS);
    let units: Vec<(&str, &str)> = found["columns"]
        .as_array()
        .unwrap()
        .iter()
        .map(|column| (column["key"].as_str().unwrap(), column["unit"].as_str().unwrap()))
        .collect();
    assert_eq!(units, [("time", "ns"), ("position", "rad"), ("torque", "N m"), ("velocity", "rad/s")], "{found:#}");
    let parts = found["trials"].as_array().unwrap().iter().filter(|trial| !trial["rows"].is_null()).count();
    assert_eq!(parts, 2, "the interrupted cosine is two trials: {found:#}");
    assert!(found["notes"].to_string().contains("repeats 1 rows"), "{found:#}");
    assert_leads_to_identify(&campaign);
}

#[test]
fn what_names_do_not_tell_is_asked_not_guessed() {
    let folder = logs(|name, rows| {
        let mut text = "angle,torque\n".to_string();
        rows.iter().for_each(|[_, q, y]| writeln!(text, "{q:.6},{y:.6}").unwrap());
        (format!("{name}.csv"), text.into_bytes())
    });
    let out = TempDir::new().unwrap();
    let campaign = out.path().join("campaign");
    let found = init(folder.path(), &campaign, &["--json", "--winch-radius-mm=12"]);
    assert_eq!(
        keys(&found),
        [
            "files.rate_hz",
            "joint.pulley_radius_m",
            "dynamics.gravity_nm",
            "signal.torque_sign",
            "columns.position.offset",
            "columns.torque"
        ]
    );
    let answers = [&ANSWERS[..], &["--rate-hz=100", "--torque-unit=Nm", "--force"]].concat();
    let found = init(folder.path(), &campaign, &answers);
    assert_eq!(keys(&found), Vec::<String>::new());
    assert_protocols(&found);
    assert_leads_to_identify(&campaign);
}

#[test]
fn logs_of_command_and_position_ask_for_no_torque() {
    let wanted = tautline::simulate::Wanted { stiffness_nm_rad: Some(60.0), ..Default::default() };
    let controller = tautline::simulate::Controller::new(wanted, &truth(), &truth(), None).unwrap();
    let controller = Some(controller);
    let recorded = record(&truth(), &Plan { speeds: 4, rate_hz: 100.0, controller, position_alone: true, ..plan() });
    std::fs::remove_file(recorded.path().join("campaign.toml")).unwrap();
    let out = recorded.path().join("campaign");
    let found = init(recorded.path(), &out, &["--json"]);
    let asked = keys(&found);
    assert!(!asked.iter().any(|key| key.contains("torque")), "{asked:?}");
    let text = std::fs::read_to_string(out.join("campaign.toml")).unwrap();
    assert!(text.contains("command = { name = \"command_deg\", unit = \"deg\" }") && text.contains("torque_sign = 1"));
    assert!(text.contains("[controller]") && text.contains("# stiffness_nm_rad"), "{text}");

    let out = recorded.path().join("answered");
    let answers: Vec<&str> = ANSWERS.iter().filter(|answer| !answer.starts_with("--torque-sign")).copied().collect();
    init(recorded.path(), &out, &[&answers[..], &["--stiffness-nm-rad=60"]].concat());
    let done = tautline(&["validate", out.to_str().unwrap(), "--strict"]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn counts_other_languages_subfolders_and_what_is_no_log() {
    let folder = logs(|name, rows| {
        let mut text = "Tiempo (s);Encoder;Par (kgf cm)\n".to_string();
        for [t, q, y] in rows {
            let counts = (q / 360.0 * 65536.0).round();
            writeln!(text, "{t:.3};{counts};{:.5}", y / 0.0980665).unwrap();
        }
        (format!("{name}.csv"), text.into_bytes())
    });
    let inner = folder.path().join("cosenos");
    std::fs::create_dir(&inner).unwrap();
    for name in ["cosine_1.csv", "cosine_2.csv"] {
        std::fs::rename(folder.path().join(name), inner.join(name)).unwrap();
    }
    for (name, bytes) in [("notas.docx", b"PK\x03\x04".as_slice()), ("vacio.csv", b""), ("leame.txt", b"prueba\n")] {
        std::fs::write(folder.path().join(name), bytes).unwrap();
    }
    let out = TempDir::new().unwrap();
    let asked = init(folder.path(), &out.path().join("asked"), &["--json"]);
    assert!(keys(&asked).contains(&"columns.position".to_string()), "{asked:#}");
    let question = asked["questions"].to_string();
    assert!(question.contains("1/4096 turn"), "{question}");

    let campaign = out.path().join("campaign");
    let found = init(folder.path(), &campaign, &[&ANSWERS[..], &["--position-unit=1/65536 turn"]].concat());
    assert_eq!(keys(&found), Vec::<String>::new());
    assert_protocols(&found);
    let notes = found["notes"].to_string();
    assert!(["notas.docx", "vacio.csv", "leame.txt"].iter().all(|name| notes.contains(name)), "{notes}");
    assert_leads_to_identify(&campaign);
}

#[test]
fn japanese_headers_keep_their_letters() {
    let folder = logs(|name, rows| {
        // Shift-JIS for time [s], angle [deg], torque [N m], the units' dot as Japanese write it.
        let mut bytes = b"\x8e\x9e\x8a\xd4[s],\x8ap\x93x[deg],\x83g\x83\x8b\x83N[N\x81Em]\r\n".to_vec();
        rows.iter().for_each(|[t, q, y]| bytes.extend(format!("{t:.3},{q:.6},{y:.6}\r\n").bytes()));
        (format!("{name}.csv"), bytes)
    });
    let out = TempDir::new().unwrap();
    let campaign = out.path().join("campaign");
    let found = init(folder.path(), &campaign, &ANSWERS);
    assert_eq!(found["columns"][1]["name"], "\u{89d2}\u{5ea6}[deg]");
    assert_eq!(found["columns"][2]["unit"], "N m");
    assert_leads_to_identify(&campaign);
}

#[test]
fn a_joint_that_stands_still_beside_the_one_that_moves_asks_nothing() {
    let folder = logs(|name, rows| {
        let mut text = "t_s,shoulder_pos_deg,elbow_pos_deg,elbow_torque_nm\n".to_string();
        let noise = |at: usize| 1e-3 * (at * 7919 % 13) as f64;
        let line = |(at, [t, q, y]): (usize, &[f64; 3])| format!("{t:.3},{:.4},{q:.5},{y:.6}\n", 30.0 + noise(at));
        text.extend(rows.iter().enumerate().map(line));
        (format!("{name}.csv"), text.into_bytes())
    });
    let out = TempDir::new().unwrap();
    let found = init(folder.path(), &out.path().join("campaign"), &ANSWERS);
    assert_eq!(keys(&found), Vec::<String>::new());
    assert_eq!(found["columns"][1]["name"], "elbow_pos_deg");
    assert!(found["columns"].as_array().unwrap().iter().all(|column| column["key"] != "other_position"), "{found:#}");
}

#[test]
fn columns_without_names_are_found_or_named() {
    let folder = logs(|name, rows| {
        let mut text = String::new();
        for (at, [t, q, y]) in rows.iter().enumerate() {
            let (before, after) = (rows[at.saturating_sub(1)][1], rows[(at + 1).min(rows.len() - 1)][1]);
            // As Fortran and `savetxt` write it: columns aligned by blanks.
            let speed = (after - before).to_radians() * 50.0;
            writeln!(text, "{t:10.3} {:12.7} {speed:12.7} {y:10.6}", q.to_radians()).unwrap();
        }
        (format!("{name}.txt"), text.into_bytes())
    });
    let out = TempDir::new().unwrap();
    let found = init(folder.path(), &out.path().join("asked"), &["--json"]);
    let of = |found: &Value, key: &str| {
        let all = found["columns"].as_array().unwrap();
        all.iter().find(|column| column["key"] == key).map(|column| column["name"].clone()).unwrap_or_default()
    };
    assert_eq!((of(&found, "time"), of(&found, "position")), ("column_1".into(), "column_2".into()), "{found:#}");
    assert_eq!((of(&found, "velocity"), of(&found, "torque")), ("column_3".into(), "column_4".into()), "{found:#}");
    let named = ["--column=position=column_2", "--column=velocity=column_3", "--column=torque=column_4"];
    let units = ["--torque-unit=Nm", "--position-unit=rad"];
    let in_rad = init(folder.path(), &out.path().join("in_rad"), &[&ANSWERS[..], &named, &units[..1]].concat());
    assert_eq!(keys(&in_rad), ["columns.position"], "of a small range in deg and a large one in rad no data tell");
    let campaign = out.path().join("campaign");
    let found = init(folder.path(), &campaign, &[&ANSWERS[..], &named, &units].concat());
    assert_eq!((keys(&found), of(&found, "velocity")), (Vec::new(), "column_3".into()), "{found:#}");
    assert_protocols(&found);
    assert_leads_to_identify(&campaign);
}

#[test]
fn a_velocity_tells_the_unit_of_a_position_that_has_none() {
    for (unit, factor) in [("rad", 1.0), ("deg", 1_f64.to_degrees())] {
        let folder = logs(|name, rows| {
            let mut text = "time_s,position,velocity_rad_s,torque_nm\n".to_string();
            for (at, [t, q, y]) in rows.iter().enumerate() {
                let (before, after) = (rows[at.saturating_sub(1)][1], rows[(at + 1).min(rows.len() - 1)][1]);
                let speed = (after - before).to_radians() * 50.0;
                // In deg it stays within 7, too.
                let (position, speed) = (0.05 * factor * q.to_radians(), 0.05 * speed);
                writeln!(text, "{t:.3},{position:.9},{speed:.9},{y:.6}").unwrap();
            }
            (format!("{name}.csv"), text.into_bytes())
        });
        let out = TempDir::new().unwrap();
        let found = init(folder.path(), &out.path().join("campaign"), &ANSWERS);
        assert_eq!((keys(&found), &found["columns"][1]["unit"]), (Vec::new(), &unit.into()), "{found:#}");
    }
}

#[test]
fn a_motors_position_and_rows_without_a_reading_are_asked_and_told() {
    let folder = logs(|name, rows| {
        let mut text = "time_s,motor_angle_rad,torque_mNm\n".to_string();
        for (at, [t, q, y]) in rows.iter().enumerate() {
            let torque = if at == 321 { "NaN".to_string() } else { format!("{:.4}", 1e3 * y) };
            writeln!(text, "{t:.3},{:.6},{torque}", 50.0 * q.to_radians()).unwrap();
        }
        (format!("{name}.csv"), text.into_bytes())
    });
    let out = TempDir::new().unwrap();
    let asked = init(folder.path(), &out.path().join("asked"), &["--json"]);
    assert!(asked["questions"].to_string().contains("if it is the motor's"), "{asked:#}");
    assert!(asked["notes"].to_string().contains("lacks a reading in 1 rows"), "{asked:#}");
    let campaign = out.path().join("campaign");
    let found = init(folder.path(), &campaign, &[&ANSWERS[..], &["--position-unit=1/50 rad"]].concat());
    assert_eq!(found["columns"][2]["unit"], "mN m");
    assert_protocols(&found);
    let done = tautline(&["validate", campaign.to_str().unwrap()]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

#[test]
fn formats_that_are_not_read_say_how_to_make_one_that_is() {
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("run.xlsx"), b"PK\x03\x04").unwrap();
    let done = tautline(&["init", &folder.path().to_string_lossy(), "-o", &folder.path().join("c").to_string_lossy()]);
    let errors = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(2));
    assert!(errors.contains("run.xlsx") && errors.contains("save the sheet as CSV"), "{errors}");
}
