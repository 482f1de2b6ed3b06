//! Many campaigns: each fails alone, none is done twice, and the table is the same however it came about.

use crate::campaigns::{plan, record_in, truth};
use crate::cli::tautline;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use tautline::batch::Batch;
use tautline::model::Model;
use tautline::simulate::{Plan, Sensors};
use tempfile::TempDir;

/// A noisy campaign that is read in no time.
fn small(seed: u64) -> Plan {
    Plan { rate_hz: 50.0, seed, sensors: Sensors { torque_noise_nm: 0.02, encoder_counts: 0.0 }, ..plan() }
}

/// Four campaigns below a folder, the second of which cannot be used.
fn fleet() -> TempDir {
    let fleet = TempDir::new().unwrap();
    for seed in 1..=4 {
        record_in(&fleet.path().join(format!("joint/{seed}")), &truth(), &small(seed));
    }
    fs::write(fleet.path().join("joint/2/campaign.toml"), "format = \"campaign/1\"\nfrmat = 2\n").unwrap();
    fleet
}

/// Runs `batch` over `what`; its result, and its exit status.
fn batch(what: &Path, out: &Path, more: &[&str]) -> (Value, i32) {
    let (what, out) = (what.to_string_lossy(), out.to_string_lossy());
    let done = tautline(&[&["batch", &what, "-o", &out, "--json"], more].concat());
    let json = serde_json::from_slice(&done.stdout).unwrap_or_else(|_| panic!("{done:?}"));
    (json, done.status.code().unwrap())
}

/// The table by campaign, column by column, without what may differ.
fn table(out: &Path) -> BTreeMap<String, BTreeMap<String, String>> {
    let mut reader = csv::Reader::from_path(out.join("fleet/table.csv")).unwrap();
    let heads: Vec<String> = reader.headers().unwrap().iter().map(String::from).collect();
    assert_eq!(heads.last().unwrap(), "duration_s");
    let row = |row: csv::StringRecord| -> BTreeMap<String, String> {
        heads.iter().cloned().zip(row.iter().map(String::from)).filter(|(head, _)| head != "duration_s").collect()
    };
    let rows: Vec<_> = reader.records().map(|found| row(found.unwrap())).collect();
    let count = rows.len();
    let by_name: BTreeMap<_, _> = rows.into_iter().map(|row| (row["name"].clone(), row)).collect();
    assert_eq!(by_name.len(), count, "a campaign is counted twice");
    by_name
}

/// What lies in the results' folder and is none, or holds no model that can be read, is worked out again.
#[test]
fn damaged_results_are_done_again() {
    let (fleet, out) = (fleet(), TempDir::new().unwrap());
    batch(fleet.path(), out.path(), &[]);
    let before = table(out.path());
    for entry in fs::read_dir(out.path().join("campaigns")).unwrap() {
        let file = entry.unwrap().path();
        let is_first = file.to_string_lossy().contains("joint_1-");
        let text = fs::read_to_string(&file).unwrap();
        fs::write(&file, if is_first { "PAR1".to_string() } else { text.replace("mu_c", "mu") }).unwrap();
    }
    let (json, status) = batch(fleet.path(), out.path(), &[]);
    assert_eq!((status, &json["work"]["done"], &json["work"]["kept"]), (1, &3.into(), &0.into()));
    assert_eq!(table(out.path()), before);
}

#[test]
fn lists_add_up_with_their_retensionings() {
    let folder = TempDir::new().unwrap();
    let list = |name: &str, date: &str| {
        let file = folder.path().join(name);
        let campaign = format!("[[campaigns]]\npath = \"{name}\"\n");
        let retensioned = format!("[[retensioned]]\njoint = \"elbow\"\ndate = {date}\n");
        fs::write(&file, format!("format = \"batch/1\"\n{campaign}{retensioned}")).unwrap();
        file
    };
    let lists = [list("late.toml", "2026-03-01"), list("early.toml", "2026-01-01")];
    assert_eq!(Batch::read(&lists).unwrap().retensioned["elbow"], ["2026-01-01", "2026-03-01"]);
}

#[test]
fn a_bad_campaign_fails_alone_with_its_reason() {
    let (fleet, out) = (fleet(), TempDir::new().unwrap());
    let (json, status) = batch(fleet.path(), out.path(), &[]);
    assert_eq!((status, &json["work"]["done"], &json["work"]["failed"]), (1, &3.into(), &1.into()));
    let table = table(out.path());
    assert_eq!(table.keys().map(String::as_str).collect::<Vec<_>>(), ["joint/1", "joint/2", "joint/3", "joint/4"]);
    assert_eq!(table["joint/2"]["status"], "failed");
    assert!(table["joint/2"]["reason"].contains("joint/2/campaign.toml"), "{}", table["joint/2"]["reason"]);
    for name in ["joint/1", "joint/3", "joint/4"] {
        let row = &table[name];
        assert_eq!((row["status"].as_str(), row["joint"].as_str(), row["reason"].as_str()), ("done", "elbow", ""));
        let number = |column: &str| row[column].parse::<f64>().unwrap();
        assert!((number("friction.up.mu_c") - 0.41).abs() < 0.02, "{row:?}");
        assert!(number("friction.up.mu_c.low") < number("friction.up.mu_c"));
        assert!(number("friction.up.mu_c.high") > number("friction.up.mu_c"));
    }
    // The same numbers as `identify` finds, bit for bit.
    let alone = out.path().join("alone");
    let campaign = fleet.path().join("joint/3");
    let done = tautline(&["identify", &campaign.to_string_lossy(), "-o", &alone.to_string_lossy(), "--quiet"]);
    assert!(done.status.success());
    let model = Model::read(&alone.join("model.json")).unwrap();
    assert_eq!(table["joint/3"]["friction.down.a_j"].parse::<f64>().unwrap(), model.friction.down.a_j);
    for file in ["fleet/table.parquet", "fleet/report.html", "fleet/fleet.json"] {
        assert!(fs::metadata(out.path().join(file)).unwrap().len() > 500, "{file}");
    }
}

#[test]
fn what_is_done_is_not_done_again_unless_it_changed() {
    let (fleet, out) = (fleet(), TempDir::new().unwrap());
    batch(fleet.path(), out.path(), &[]);
    let first = table(out.path());
    let kept = |json: &Value| json["work"]["kept"].as_u64().unwrap();
    // What failed is tried again.
    let (json, _) = batch(fleet.path(), out.path(), &[]);
    assert_eq!((kept(&json), &json["work"]["failed"]), (3, &1.into()));
    // A result that a killed program left half-written counts for nothing, and what it was writing goes.
    let file = |name: &str| {
        let found = fs::read_dir(out.path().join("campaigns")).unwrap().map(|entry| entry.unwrap().path());
        found.into_iter().find(|path| path.file_name().unwrap().to_string_lossy().starts_with(name)).unwrap()
    };
    let half = fs::read(file("joint_3")).unwrap();
    fs::write(file("joint_3"), &half[..half.len() / 2]).unwrap();
    fs::write(out.path().join("campaigns/.writing-1"), "x").unwrap();
    fs::remove_file(file("joint_1")).unwrap();
    let (json, _) = batch(fleet.path(), out.path(), &[]);
    assert_eq!(kept(&json), 1);
    assert_eq!(table(out.path()), first);
    assert!(!out.path().join("campaigns/.writing-1").exists());
    // Other settings, other data: done again, and only those.
    let (json, _) = batch(fleet.path(), out.path(), &["--form", "one"]);
    assert_eq!(kept(&json), 0);
    record_in(&fleet.path().join("joint/4"), &truth(), &small(9));
    let (json, _) = batch(fleet.path(), out.path(), &["--form", "one"]);
    assert_eq!(kept(&json), 2);
    // And what was mended does not fail any more.
    record_in(&fleet.path().join("joint/2"), &truth(), &small(2));
    let (json, status) = batch(fleet.path(), out.path(), &["--form", "one", "--force"]);
    assert_eq!((kept(&json), &json["work"]["done"], status), (0, &4.into(), 0));
}

#[test]
fn threads_and_parts_make_no_difference() {
    let (fleet, out) = (fleet(), TempDir::new().unwrap());
    let folder = |name: &str| out.path().join(name);
    batch(fleet.path(), &folder("one"), &["--threads", "1"]);
    batch(fleet.path(), &folder("three"), &["--threads", "3"]);
    // More threads than campaigns: they help each other within one.
    batch(fleet.path(), &folder("many"), &["--threads", "11"]);
    let mut shares = 0;
    for part in ["1/3", "2/3", "3/3"] {
        let (json, _) = batch(fleet.path(), &folder("parts"), &["--shard", part]);
        assert!(!folder("parts").join("fleet").exists());
        shares += json["done"].as_u64().unwrap() + json["failed"].as_u64().unwrap();
    }
    assert_eq!(shares, 4);
    let (json, _) = batch(fleet.path(), &folder("parts"), &[]);
    assert_eq!(json["work"]["done"], 0);
    let one = table(&folder("one"));
    for other in ["three", "many", "parts"] {
        assert_eq!(table(&folder(other)), one, "{other}");
    }
}

#[test]
fn a_joint_that_drifted_is_told_apart_from_one_that_did_not() {
    let fleet = TempDir::new().unwrap();
    let mut slack = truth();
    slack.friction.up.a_j *= 0.85;
    let mut list = "format = \"batch/1\"\n".to_string();
    for (joint, number, date, model) in [
        // Its change before the cables were retensioned is none since.
        ("steady", 1, "2026-01-10", &slack),
        ("steady", 2, "2026-02-10", &truth()),
        ("steady", 3, "2026-03-10", &truth()),
        ("slack", 1, "2026-03-12", &slack),
        ("slack", 2, "2026-01-12", &truth()),
    ] {
        record_in(&fleet.path().join(format!("{joint}{number}")), model, &Plan { cosines: 1, ..small(number) });
        list += &format!("[[campaigns]]\npath = \"{joint}{number}\"\njoint = \"{joint}\"\ndate = {date}\n");
    }
    list += "[[retensioned]]\njoint = \"steady\"\ndate = 2026-02-01\n";
    list += "[[retensioned]]\njoint = \"slakc\"\ndate = 2026-02-01\n";
    fs::write(fleet.path().join("fleet.toml"), list).unwrap();
    let out = fleet.path().join("out");
    let (json, status) = batch(&fleet.path().join("fleet.toml"), &out, &[]);
    assert_eq!(status, 0);
    assert!(json["warnings"].to_string().contains("did you mean `slack`?"), "{}", json["warnings"]);
    let joint = |name: &str| json["joints"].as_array().unwrap().iter().find(|j| j["joint"] == name).unwrap().clone();
    assert_eq!((&joint("steady")["since"], &joint("steady")["drifted"]), (&"steady2".into(), &Value::Array(vec![])));
    let drifted = joint("slack")["drifted"].clone();
    let is_level = |d: &&Value, direction: &str| {
        let name = d["name"].as_str().unwrap();
        name.starts_with("B(") && name.ends_with(direction)
    };
    let of = |direction: &str| drifted.as_array().unwrap().iter().find(|d| is_level(d, direction)).cloned();
    let level = of("moving up").expect("a change of B(v)");
    // r1 times the change of a_j over 1 - mu_c.
    let expected_nm = -0.012 * 0.15 * truth().friction.up.a_j / (1.0 - truth().friction.up.mu_c);
    assert!((level["change"].as_f64().unwrap() / expected_nm - 1.0).abs() < 0.1, "{level} {expected_nm}");
    assert_eq!(of("moving down"), None, "{drifted}");
    let report = fs::read_to_string(out.join("fleet/report.html")).unwrap();
    assert!(
        report.contains(
            "1 of 2 joints changed since the cables were last retensioned: slack, Coulomb friction moving up"
        ) && report.contains("days since 2026-01-12")
    );
    assert!(!report.contains("http://") || !report.contains("src=\"http"));
}

#[test]
fn a_given_model_is_judged_and_diagnosed() {
    let fleet = TempDir::new().unwrap();
    let mut biased = truth();
    biased.effects.push(tautline::effects::Added::parse("sensor_bias:bias_nm=0.05").unwrap());
    record_in(&fleet.path().join("c"), &biased, &Plan { cosines: 2, speeds: 6, ..small(1) });
    fs::write(fleet.path().join("model.json"), truth().to_json().to_string()).unwrap();
    let list = "format = \"batch/1\"\n[[campaigns]]\npath = \"c\"\nmodel = \"model.json\"\n";
    fs::write(fleet.path().join("list.toml"), list).unwrap();
    let out = fleet.path().join("out");
    batch(&fleet.path().join("list.toml"), &out, &["--diagnose"]);
    let row = table(&out).remove("c").unwrap();
    assert!(row["verdict"] != "none" && row["causes"].starts_with("sensor_bias"), "{row:?}");
    assert!((row["rmse_nm"].parse::<f64>().unwrap() - 0.05).abs() < 0.01, "{row:?}");
}

#[test]
fn lists_patterns_and_folders_are_read_or_refused() {
    let fleet = fleet();
    let named = |path: &str| Batch::read(&[fleet.path().join(path)]);
    let names = |path: &str| named(path).unwrap().entries.into_iter().map(|e| e.name).collect::<Vec<_>>();
    assert_eq!(names(""), ["joint/1", "joint/2", "joint/3", "joint/4"]);
    assert_eq!(names("joint/3"), ["3"]);
    assert_eq!(named("*/[12]").unwrap().entries.len(), 2);
    assert_eq!(named("joint/*/campaign.toml").unwrap().entries.len(), 4);
    for (path, list, told) in [
        ("nowhere", "", "there is no such file or campaign"),
        ("a.toml", "format = \"batch/1\"\n", "[[campaigns]]"),
        ("b.toml", "format = \"batch/1\"\n[[campaigns]]\npth = \"joint/1\"\n", "did you mean `path`"),
        ("c.toml", "format = \"batch/1\"\n[[campaigns]]\npath = \"x\"\n[[campaigns]]\npath = \"x\"\n", "there twice"),
        ("d.toml", "format = \"batch/1\"\n[[campaigns]]\npath = \"x\"\ndate = \"2026-03-02\"\n", "without quotes"),
        ("e.toml", "format = \"batch/1\"\ncampaigns = []\n", "lists no campaign"),
    ] {
        if !list.is_empty() {
            fs::write(fleet.path().join(path), list).unwrap();
        }
        let refused = named(path).unwrap_err().to_string();
        assert!(refused.contains(told), "{path}: {refused}");
    }
    // A folder of somebody else's is not written to.
    let done =
        tautline(&["batch", &fleet.path().to_string_lossy(), "-o", &fleet.path().join("joint").to_string_lossy()]);
    assert_eq!(done.status.code(), Some(2));
    assert!(!fleet.path().join("joint/campaigns").exists());
    let shard = tautline(&["batch", &fleet.path().to_string_lossy(), "-o", "never", "--shard", "4/3"]);
    assert_eq!(shard.status.code(), Some(2));
}

/// `joint/1` to `joint/3`, listed with dates; `more` belongs to the second.
fn dated(more: &str) -> TempDir {
    let fleet = TempDir::new().unwrap();
    let mut list = String::from("format = \"batch/1\"\n");
    for (seed, date) in [(1, "2026-01-05"), (2, "2026-02-05"), (3, "2026-03-05")] {
        record_in(&fleet.path().join(format!("joint/{seed}")), &truth(), &small(seed));
        list += &format!("[[campaigns]]\npath = \"joint/{seed}\"\ndate = {date}\n");
        list += if seed == 2 { more } else { "" };
    }
    fs::write(fleet.path().join("fleet.toml"), list).unwrap();
    fleet
}

#[test]
fn campaigns_are_held_against_their_joints_reference() {
    let against = |more: &str, after: &str| {
        let fleet = dated(more);
        let file = fleet.path().join("fleet.toml");
        fs::write(&file, fs::read_to_string(&file).unwrap() + after).unwrap();
        let read = Batch::read(&[file]).unwrap();
        read.entries.iter().map(|entry| entry.against.as_ref().map(|to| to.name.clone())).collect::<Vec<_>>()
    };
    let first = Some("joint/1".to_string());
    assert_eq!(against("", ""), [None, first.clone(), first.clone()]);
    let retensioned = "[[retensioned]]\njoint = \"elbow\"\ndate = 2026-02-01\n";
    let second = Some("joint/2".to_string());
    assert_eq!(against("", retensioned), [None, None, second.clone()]);
    assert_eq!(against("reference = true\n", ""), [second.clone(), None, second]);
    assert_eq!(against("model = \"m.json\"\n", ""), [None, None, first]);
}

/// A campaign is judged by its own model, diagnosed against the reference's; a reference that fails leaves the others standing.
#[test]
fn a_reference_serves_the_diagnosis_alone() {
    let fleet = dated("");
    let mut after = truth();
    after.friction.up.a_j *= 1.3;
    let folder = fleet.path().join("joint/3");
    fs::remove_dir_all(&folder).unwrap();
    record_in(&folder, &after, &Plan { cosines: 1, ..small(3) });
    let file = fleet.path().join("fleet.toml");
    let (plain, told) = (TempDir::new().unwrap(), TempDir::new().unwrap());
    batch(&file, plain.path(), &[]);
    batch(&file, told.path(), &["--diagnose"]);
    let (plain, with) = (table(plain.path()), table(told.path()));
    assert_eq!(plain["joint/3"]["rmse_nm"], with["joint/3"]["rmse_nm"]);
    assert_eq!((with["joint/3"]["against"].as_str(), with["joint/1"]["against"].as_str()), ("joint/1", "itself"));
    assert!(with["joint/3"]["causes"].contains("coulomb"), "{:?}", with["joint/3"]);
    let mut other = truth();
    other.joint.winch_radius_m *= 1.5;
    fs::remove_dir_all(fleet.path().join("joint/1")).unwrap();
    record_in(&fleet.path().join("joint/1"), &other, &Plan { cosines: 1, ..small(1) });
    let (_, status) = batch(&file, told.path(), &["--diagnose"]);
    let with = table(told.path());
    assert_eq!((status, with["joint/3"]["status"].as_str()), (0, "done"));
    assert_eq!(plain["joint/3"]["rmse_nm"], with["joint/3"]["rmse_nm"]);
    assert!(with["joint/3"]["warnings"].contains("not diagnosed: against joint/1"), "{:?}", with["joint/3"]);
    fs::write(fleet.path().join("joint/1/campaign.toml"), "format = \"campaign/1\"\n").unwrap();
    // Which joint it is of can no longer be read: the list says so.
    let list = fs::read_to_string(&file).unwrap().replacen("date =", "joint = \"elbow\"\ndate =", 1);
    fs::write(&file, list).unwrap();
    let (_, status) = batch(&file, told.path(), &["--diagnose"]);
    let with = table(told.path());
    assert_eq!((status, with["joint/3"]["status"].as_str()), (1, "done"));
    assert!(with["joint/3"]["warnings"].contains("not diagnosed: its reference"), "{:?}", with["joint/3"]);
}

#[test]
fn what_retensioning_changed_is_told() {
    let fleet = dated("");
    let mut after = truth();
    after.friction.up.a_j *= 1.3;
    for seed in [2, 3] {
        let folder = fleet.path().join(format!("joint/{seed}"));
        fs::remove_dir_all(&folder).unwrap();
        record_in(&folder, &after, &small(seed));
    }
    let file = fleet.path().join("fleet.toml");
    let list = fs::read_to_string(&file).unwrap() + "[[retensioned]]\njoint = \"elbow\"\ndate = 2026-02-01\n";
    fs::write(&file, list).unwrap();
    let out = TempDir::new().unwrap();
    let (_, status) = batch(&file, out.path(), &[]);
    assert_eq!(status, 0);
    let told: Value = serde_json::from_slice(&fs::read(out.path().join("fleet/fleet.json")).unwrap()).unwrap();
    let joint = &told["joints"][0];
    assert_eq!(joint["retensionings"][0]["what_changed"][0]["what"], "coulomb_friction", "{joint}");
    assert_eq!(joint["retensionings"][0]["what_changed"][0]["direction"], "up");
    assert_eq!(joint["what_changed"], Value::Array(Vec::new()), "nothing changed since");
    assert_eq!(joint["changed"], false, "nothing changed since");
}

/// Four runs: nothing moves but Coulomb friction up, which follows a named payload.
#[test]
fn repeatability_finds_what_follows_a_condition() {
    let folder = TempDir::new().unwrap();
    let mut list = String::from("format = \"batch/1\"\n");
    for (seed, payload) in [(1, 0.0), (2, 0.5), (3, 1.0), (4, 1.5)] {
        let mut model = truth();
        model.friction.up.a_j *= 1.0 + 0.2 * payload;
        record_in(&folder.path().join(format!("run{seed}")), &model, &small(seed));
        list += &format!(
            "[[campaigns]]\npath = \"run{seed}\"\nconditions = {{ payload_kg = {payload:?}, room = \"b\" }}\n"
        );
    }
    let file = folder.path().join("runs.toml");
    fs::write(&file, list).unwrap();
    let out = folder.path().join("out");
    let done = tautline(&["repeatability", &file.to_string_lossy(), "-o", &out.to_string_lossy(), "--json"]);
    assert!(done.status.success(), "{done:?}");
    let found: Value = serde_json::from_slice(&done.stdout).unwrap();
    let quantities = found["joints"][0]["quantities"].as_array().unwrap();
    let of = |name: &str| quantities.iter().find(|q| q["name"].as_str().unwrap().contains(name)).unwrap();
    assert_eq!(of("B(0.141 rad/s) moving up")["verdict"], "depends_on_condition", "{:#}", of("moving up"));
    assert_eq!(of("B(0.141 rad/s) moving up")["condition"], "payload_kg");
    assert_eq!(of("B(0.141 rad/s) moving down")["verdict"], "repeatable");
    assert_eq!(of("A moving up")["verdict"], "repeatable");
    // Known to more than its own size: no run shows it.
    assert_eq!(of("friction.down.d")["verdict"], "not_identifiable");
    assert!(out.join("report.html").is_file() && out.join("plots").is_dir());
}
