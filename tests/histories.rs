//! The life of a joint: jumps, retensionings, drift and temperature told apart, and when a limit will be reached.

use crate::campaigns::truth;
use serde_json::Value;
use std::fs;
use tautline::batch::{Batch, Entry, Fleet, Record, Row, date_of};
use tautline::model::{Both, BranchFunctions, Direction, Level, Model};
use tempfile::TempDir;

/// The model of a session with so much friction, relative to 0.8 N m moving up and 0.3 N m moving down.
fn session_model(relative_level: f64) -> Model {
    let mut model = truth();
    let branch = |direction: Direction, a_nm: f64, b_nm: f64| BranchFunctions {
        a_nm,
        a_se_nm: 0.0005,
        levels: [0.02, 0.1, 0.4]
            .map(|speed_rad_s| Level { speed_rad_s, b_nm: direction.sign() * b_nm * relative_level, se_nm: 0.002 })
            .to_vec(),
        common_se_nm: 0.001,
        errors: Vec::new(),
    };
    model.functions.branches =
        Both { up: Some(branch(Direction::Up, 0.35, 0.8)), down: Some(branch(Direction::Down, 0.33, 0.3)) };
    model
}

/// When it was, its value, and the temperature where it is known.
type Session = (String, f64, Option<f64>);

/// The joints of a fleet, each with sessions (date, relative level of friction) that stand in the results' folder already.
fn fleet(joints: &[(&str, Vec<Session>)]) -> Vec<Value> {
    let folder = TempDir::new().unwrap();
    let all = || joints.iter().flat_map(|(joint, sessions)| sessions.iter().map(move |session| (joint, session)));
    let entry = |(joint, (date, ..)): (&&str, &Session)| {
        format!("[[campaigns]]\npath = \"{joint}/{date}\"\njoint = \"{joint}\"\ndate = {date}\n")
    };
    let file = folder.path().join("fleet.toml");
    fs::write(&file, "format = \"batch/1\"\n".to_string() + &all().map(entry).collect::<String>()).unwrap();
    let batch = Batch::read(&[file]).unwrap();
    let row = |(entry, (_, session)): (&Entry, (&&str, &Session))| Row {
        entry: entry.clone(),
        record: Record { name: entry.name.clone(), ..Record::default() },
        model: Some(session_model(session.1)),
    };
    let rows = batch.entries.iter().zip(all()).map(row).collect();
    tautline::report::fleet::to_json(&Fleet::new(&batch, rows))["joints"].as_array().unwrap().clone()
}

#[test]
fn other_joints_tell_what_a_short_history_scatters() {
    let shifted = |by: usize| {
        let sessions = every_month(8 + by, |_| 1.0);
        (0..8).map(|i| (sessions[i].0.clone(), sessions[i + by].1, None)).collect::<Vec<_>>()
    };
    let mut jump = shifted(0);
    jump[6..].iter_mut().for_each(|session| session.1 += 0.06);
    let alone = fleet(&[("a", jump.clone())]);
    assert!(happened(&alone[0], "B(0.089").is_empty(), "a history of eight sessions cannot know: {alone:?}");
    let found = fleet(&[("a", jump), ("b", shifted(3)), ("c", shifted(6)), ("d", shifted(9)), ("e", shifted(12))]);
    let told = happened(&found[0], "B(0.089");
    assert_eq!((told.len(), told[0]["kind"].as_str()), (1, Some("jump")), "{told:?}");
    assert!(found[1..].iter().all(|joint| happened(joint, "B(0.089").is_empty()));
}

/// The joint "elbow" of a fleet whose `sessions` (date, relative level of friction, temperature) stand in the results' folder
/// already; `more` is added to the list.
fn history(sessions: &[(String, f64, Option<f64>)], more: &str) -> Value {
    let folder = TempDir::new().unwrap();
    let mut list = "format = \"batch/1\"\n".to_string();
    for (date, _, temperature) in sessions {
        list += &format!("[[campaigns]]\npath = \"{date}\"\njoint = \"elbow\"\ndate = {date}\n");
        list += &temperature.map_or(String::new(), |t| format!("conditions = {{ temperature_degc = {t} }}\n"));
    }
    let file = folder.path().join("fleet.toml");
    fs::write(&file, list + more).unwrap();
    let batch = Batch::read(&[file]).unwrap();
    let row = |(entry, session): (&Entry, &(String, f64, Option<f64>))| Row {
        entry: entry.clone(),
        record: Record { name: entry.name.clone(), ..Record::default() },
        model: Some(session_model(session.1)),
    };
    let rows = batch.entries.iter().zip(sessions).map(row).collect();
    tautline::report::fleet::to_json(&Fleet::new(&batch, rows))["joints"][0].clone()
}

/// Sessions every 30 days with noise of 1 %; `level` says how much friction there is in each.
fn every_month(sessions: usize, level: impl Fn(usize) -> f64) -> Vec<(String, f64, Option<f64>)> {
    // Fixed noise without a trend, of standard deviation 1 %.
    let noise = |i: usize| 0.014 * ((i * i * 37 + 11 * i) as f64).sin();
    (0..sessions).map(|i| (date_of(18_000.0 + 30.0 * i as f64), level(i) + noise(i), None)).collect()
}

/// What happened to a quantity whose name begins with `name`.
fn happened(joint: &Value, name: &str) -> Vec<Value> {
    let of = joint["quantities"].as_array().unwrap().iter().find(|q| q["name"].as_str().unwrap().starts_with(name));
    of.unwrap()["happened"].as_array().unwrap().clone()
}

#[test]
fn a_history_in_which_nothing_happened_says_so() {
    let joint = history(&every_month(16, |_| 1.0), "");
    assert!(happened(&joint, "B(0.089").is_empty(), "{joint}");
    let of = joint["quantities"].as_array().unwrap().iter().find(|q| q["name"] == "B(0.089 rad/s) moving up").unwrap();
    let scatter = of["session_scatter"].as_f64().unwrap();
    assert!((0.006..0.012).contains(&scatter), "1 % of 0.8 N m, found {scatter}");
    assert_eq!((&joint["drifted"], &joint["what_changed"]), (&Value::Array(vec![]), &Value::Array(vec![])));
    assert_eq!(joint["changed"], false, "{joint}");
}

#[test]
fn one_campaign_since_retensioning_shows_no_drift() {
    let sessions = every_month(2, |_| 1.0);
    let joint = history(&sessions, &format!("[[retensioned]]\njoint = \"elbow\"\ndate = {}\n", sessions[1].0));
    assert_eq!(joint["retensionings"].as_array().unwrap().len(), 1);
    assert_eq!(joint["changed"], false, "{joint}");
}

#[test]
fn a_jump_is_told_from_drift_and_from_an_odd_session() {
    let jump = history(&every_month(16, |i| if i >= 9 { 1.15 } else { 1.0 }), "");
    let found = happened(&jump, "B(0.089");
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(
        (found[0]["kind"].as_str(), found[0]["after"].as_str()),
        (Some("jump"), Some("2020-01-09")),
        "{found:?}"
    );
    assert!((found[0]["change"].as_f64().unwrap() - 0.12).abs() < 0.015);
    let cause = &jump["events"][0]["what_changed"][0]["what"];
    assert!(jump["events"].as_array().unwrap().len() == 1 && cause != &Value::Null, "{}", jump["events"]);

    let drift = happened(&history(&every_month(16, |i| 1.0 + 0.01 * i as f64), ""), "B(0.089");
    assert_eq!((drift.len(), drift[0]["kind"].as_str()), (1, Some("drift")), "{drift:?}");
    let per_day = drift[0]["change_per_day"].as_f64().unwrap();
    assert!((per_day / (0.8 * 0.01 / 30.0) - 1.0).abs() < 0.2, "{per_day}");

    let odd = happened(&history(&every_month(16, |i| if i == 7 { 1.2 } else { 1.0 }), ""), "B(0.089");
    assert_eq!((odd.len(), odd[0]["kind"].as_str()), (1, Some("episode")), "{odd:?}");
}

#[test]
fn a_retensioning_needs_less_evidence_than_a_jump_at_any_time() {
    // 4.5 % over a scatter of 0.9 %, seen in five sessions only.
    let sessions = every_month(10, |i| if i >= 5 { 1.045 } else { 1.0 });
    let date = &sessions[5].0;
    assert!(happened(&history(&sessions, ""), "B(0.089").is_empty());
    let told = history(&sessions, &format!("[[retensioned]]\njoint = \"elbow\"\ndate = {date}\n"));
    let found = happened(&told, "B(0.089");
    assert_eq!((found.len(), found[0]["kind"].as_str()), (1, Some("retensioning")), "{found:?}");
    assert_eq!(told["retensionings"][0]["date"].as_str(), Some(date.as_str()));
    assert!(!told["retensionings"][0]["changes"].as_array().unwrap().is_empty());
    assert!(told["retensionings"][0]["differs"].to_string().contains("B(0.089"), "{told}");
}

#[test]
fn a_retensioning_that_restores_the_joint_says_so() {
    // Friction falls steadily, and a retensioning brings it back.
    let sessions = every_month(16, |i| if i >= 9 { 1.0 - 0.02 * (i - 9) as f64 } else { 1.0 - 0.02 * i as f64 });
    let joint = history(&sessions, &format!("[[retensioned]]\njoint = \"elbow\"\ndate = {}\n", sessions[9].0));
    let found = &joint["retensionings"][0];
    assert!(!found["changes"].as_array().unwrap().is_empty(), "{found}");
    assert_eq!((&found["differs"], &found["as_after"]), (&Value::Array(vec![]), &sessions[0].0.as_str().into()));
}

#[test]
fn what_follows_the_temperature_is_no_drift() {
    let degc = |i: usize| 20.0 + 6.0 * (i as f64 / 15.0) + f64::from(u8::from(i.is_multiple_of(3))) * 3.0;
    let sessions = every_month(16, |i| 1.0 - 0.02 * (degc(i) - 20.0));
    let without = happened(&history(&sessions, ""), "B(0.089");
    assert!(without.iter().any(|of| of["kind"] == "drift"), "{without:?}");
    let warm: Vec<_> = sessions.into_iter().enumerate().map(|(i, (date, b, _))| (date, b, Some(degc(i)))).collect();
    let joint = history(&warm, "");
    let with = happened(&joint, "B(0.089");
    assert_eq!((with.len(), with[0]["kind"].as_str()), (1, Some("temperature")), "{with:?}");
    assert!((with[0]["change_per_k"].as_f64().unwrap() / (-0.02 * 0.8) - 1.0).abs() < 0.2, "{with:?}");
    assert_eq!(joint["drifted"], Value::Array(vec![]));
}

#[test]
fn a_limit_is_foreseen_or_refused_with_the_reason() {
    let limit = |value: f64| format!("[[limits]]\nwhat = \"friction_nm\"\nspeed_rad_s = 0.1\nat_most = {value}\n");
    let of = |sessions: &[(String, f64, Option<f64>)], value: f64| {
        let joint = history(sessions, &limit(value));
        joint["limits"].as_array().unwrap().iter().find(|l| l["name"] == "B(0.100 rad/s) moving up").unwrap().clone()
    };
    let drifting = every_month(16, |i| 1.0 + 0.01 * i as f64);
    // 0.8 (1 + 0.01 i) is 1.0 at i = 25, the last session being 15.
    let told = of(&drifting, 1.0);
    let due = date_of(18_000.0 + 30.0 * 25.0);
    let (low, high) = (told["low"].as_str().unwrap(), told["high"].as_str().unwrap());
    assert!(low < due.as_str() && due.as_str() < high, "{told}");
    assert_eq!(of(&drifting, 0.85)["reached"], true);
    for (sessions, value, why) in [
        (every_month(16, |_| 1.0), 1.0, "no drift"),
        (every_month(16, |i| 1.0 - 0.01 * i as f64), 1.0, "away"),
        (drifting.clone(), 2.0, "history"),
        (drifting[..5].to_vec(), 1.0, "too few"),
    ] {
        let told = of(&sessions, value);
        assert!(told["unknown"].as_str().is_some_and(|text| text.contains(why)), "{why}: {told}");
    }
}
