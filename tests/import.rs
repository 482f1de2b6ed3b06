//! Other programs' formats give the motion that was written into them; damage is refused and never panics.

use crate::cli::tautline;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tautline::import::{picked, read};
use tautline::log::{Campaign, read_trial};
use tempfile::TempDir;

const FOLDER: &str = "tests/reference/import";

/// File, then what it calls time, position, torque, and (where it has it) the other joint's position; seconds a unit of time.
const FILES: [(&str, &[&str], f64); 6] = [
    ("v5_plain.mat", &["t", "q", "both(:,1)", "both(:,2)"], 1.0),
    ("v5_compressed.mat", &["t", "q", "both(:,1)", "both(:,2)"], 1.0),
    ("v73.mat", &["t", "q", "run.both(:,1)", "run.both(:,2)"], 1.0),
    ("states.mcap", &["time", "elbow.position", "elbow.effort", "shoulder.position"], 1.0),
    ("scope_tabs.csv", &["time", "position", "torque"], 1e-3),
    ("scope_commas.csv", &["time", "position", "torque"], 1e-3),
];

fn file(name: &str) -> PathBuf {
    Path::new(FOLDER).join(name)
}

/// Time, position in deg, torque, the other joint's position in deg.
fn truth() -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(file("truth.csv")).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    (0..4).map(|column| rows.iter().map(|row| row[column]).collect()).collect()
}

#[test]
fn every_format_gives_what_was_written() {
    let truth = truth();
    for (name, columns, seconds) in FILES {
        let all = read(&file(name)).unwrap().unwrap();
        let found = picked(&file(name), &all, columns).unwrap().columns;
        for (at, (found, truth)) in found.iter().zip(&truth).enumerate() {
            let factor = match at {
                0 => seconds,
                2 => 1.0,
                _ if name.ends_with("mcap") => 180.0 / std::f64::consts::PI,
                _ => 1.0,
            };
            assert_eq!(found.len(), truth.len(), "{name}, {}", columns[at]);
            let off = found.iter().zip(truth).map(|(x, y)| (factor * x - y).abs()).fold(0.0, f64::max);
            assert!(off < 1e-6, "{name}, {}: {off}", columns[at]);
        }
    }
    let all = read(&file("v5_plain.mat")).unwrap().unwrap();
    assert!(all.iter().any(|series| series.name == "count") && all.iter().all(|series| series.name != "rate_hz"));
    assert!(read(&file("truth.csv")).unwrap().is_none());
}

pub const HEAD: &str = r#"format = "campaign/1"
[joint]
name = "elbow"
winch_radius_m = 0.012
pulley_radius_m = 0.040
backlash_m = 0.0008
[dynamics]
gravity_nm = 0.6916
inertia_kg_m2 = 0.012
[signal]
torque_sign = -1
lowpass_hz = 5.0
lowpass_order = 4
"#;

/// A folder with a draft of a campaign of `logs`, whose columns are called as `columns` says.
fn draft(columns: &str, logs: &[&str]) -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut text = format!("{HEAD}[columns]\n{columns}\n");
    for log in logs {
        if file(log).exists() {
            std::fs::copy(file(log), folder.path().join(log)).unwrap();
        }
        text += &format!("[[trials]]\nfile = \"{log}\"\nprotocol = \"free\"\n");
    }
    std::fs::write(folder.path().join("campaign.toml"), text).unwrap();
    folder
}

const MATLAB: &str = r#"time = { name = "t", unit = "s" }
position = { name = "q", unit = "deg" }
torque = { name = "both(:,1)", unit = "N m" }
other_position = { name = "both(:,2)", unit = "deg" }"#;
const SCOPE: &str = r#"time = { name = "time", unit = "ms" }
position = { name = "position", unit = "deg" }
torque = { name = "torque", unit = "N m" }"#;

fn imported(folder: &TempDir, more: &[&str]) -> (PathBuf, std::process::Output) {
    let out = folder.path().join("campaign");
    let (from, to) = (folder.path().to_string_lossy(), out.to_string_lossy());
    let done = tautline(&[&["import", &from, "-o", &to], more].concat());
    (out, done)
}

#[test]
fn a_draft_becomes_a_campaign_that_every_command_reads() {
    for (columns, logs, more, made) in [
        (MATLAB, ["v5_plain.mat", "v5_compressed.mat"], &[][..], "v5_compressed.parquet"),
        (SCOPE, ["scope_tabs.csv", "scope_commas.csv"], &["--format", "csv"], "scope_commas.csv"),
    ] {
        let folder = draft(columns, &logs);
        let (out, done) = imported(&folder, more);
        assert_eq!(done.status.code(), Some(0), "{done:?}");
        assert!(out.join(made).is_file());
        let campaign = Campaign::read(&out).unwrap();
        let log = read_trial(&campaign, 1).unwrap();
        let truth = truth();
        assert!((log.rate_hz - 100.0).abs() < 1e-6, "{}", log.rate_hz);
        let off = log.position_rad.iter().zip(&truth[1]).map(|(x, y)| (x.to_degrees() - y).abs()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{off}");
        assert!((log.torque_nm[10] + truth[2][10]).abs() < 1e-9);
        let checked = tautline(&["validate", &out.to_string_lossy()]);
        assert_eq!(checked.status.code(), Some(0), "{checked:?}");
    }
}

#[test]
fn plain_tables_are_taken_as_they_are() {
    let columns = r#"time = { name = "time_s", unit = "s" }
position = { name = "position_deg", unit = "deg" }
torque = { name = "torque_nm", unit = "N m" }"#;
    let folder = draft(columns, &["truth.csv"]);
    let (out, done) = imported(&folder, &[]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    assert_eq!(std::fs::read(out.join("truth.csv")).unwrap(), std::fs::read(file("truth.csv")).unwrap());
}

#[test]
fn what_cannot_be_imported_is_refused_with_its_file() {
    let refused = |columns: &str, logs: &[&str], expected: &str| {
        let folder = draft(columns, logs);
        let (out, done) = imported(&folder, &[]);
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(2), "{said}");
        assert!(said.contains(expected) && !out.exists(), "{expected}: {said}");
    };
    let missing = MATLAB.replace("\"q\"", "\"qq\"");
    refused(&missing, &["v5_plain.mat"], "has no column `qq`; it has: t, q, both(:,1)");
    refused(SCOPE, &["states.mcap"], "has no column `position`");
    refused(MATLAB, &["absent.mat"], "there is no file");
    refused(
        &MATLAB.replace("\"q\"", "\"count\"").replace("\"t\"", "\"time\""),
        &["v5_plain.mat"],
        "has no column `time`",
    );
    refused(SCOPE, &["v5_plain.mat", "truth.csv", "truth.csv"], "listed already");
    for (name, bytes, expected) in [
        ("v4.mat", &b"\0\0\0\0no such"[..], "does not begin as a .mat"),
        ("cut.mat", &b"MATLAB 5.0 MAT-file"[..], "cannot be read as MATLAB's"),
        ("empty.mcap", &b""[..], "damaged as MCAP"),
        ("words.csv", &b"Name\tx\nFile\ty\n"[..], "no line of numbers"),
        ("wrong.csv", &b"Name;a;b\n0;1;2\n1;x;3\n"[..], "wrong.csv, row 3, `a`: holds `x`, no number"),
    ] {
        let folder = TempDir::new().unwrap();
        let at = folder.path().join(name);
        std::fs::write(&at, bytes).unwrap();
        let said = read(&at).unwrap_err().to_string();
        assert!(said.contains(expected), "{name}: {said}");
    }
    let listed = tautline(&["import", "--list", &file("states.mcap").to_string_lossy()]);
    assert!(String::from_utf8_lossy(&listed.stdout).contains("elbow.effort"), "{listed:?}");
}

#[test]
fn clocks_of_their_own_are_not_mixed() {
    let folder = TempDir::new().unwrap();
    let at = folder.path().join("two.csv");
    let text = "Name\tfast\tName\tslow\n0\t1\t0\t10\n1\t2\t2\t20\n2\t3\t4\t30\n3\t4\t\t\n";
    std::fs::write(&at, text).unwrap();
    let all = read(&at).unwrap().unwrap();
    assert_eq!(picked(&at, &all, &["time", "slow"]).unwrap().columns, [vec![0.0, 2.0, 4.0], vec![10.0, 20.0, 30.0]]);
    assert_eq!(picked(&at, &all, &["time", "fast"]).unwrap().columns[0], [0.0, 1.0, 2.0, 3.0]);
    assert!(picked(&at, &all, &["time", "fast", "slow"]).unwrap_err().to_string().contains("another clock"));
}

/// The bytes of the fixtures, read once.
fn originals() -> &'static Vec<(String, Vec<u8>)> {
    static READ: OnceLock<Vec<(String, Vec<u8>)>> = OnceLock::new();
    READ.get_or_init(|| FILES.map(|(name, ..)| (name.to_string(), std::fs::read(file(name)).unwrap())).to_vec())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases.max(1500), ..ProptestConfig::default() })]

    /// Bytes changed, cut off, put in, doubled: read or refused, never a panic.
    #[test]
    fn damaged_files_never_panic(
        which in 0usize..6,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..12),
        cut in prop::option::weighted(0.3, any::<prop::sample::Index>()),
        put in prop::option::weighted(0.2, (any::<prop::sample::Index>(), prop::collection::vec(any::<u8>(), 1..40))),
    ) {
        let (name, original) = &originals()[which];
        let mut bytes = original.clone();
        for (at, value) in changes {
            // The beginning holds what the rest is read by: damage it as often as all the rest.
            let place = if value % 2 == 0 { at.index(bytes.len()) } else { at.index(bytes.len().min(700)) };
            bytes[place] = value;
        }
        if let Some((at, more)) = put {
            let place = at.index(bytes.len());
            bytes.splice(place..place, more);
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        let folder = TempDir::new().unwrap();
        let at = folder.path().join(name);
        std::fs::write(&at, bytes).unwrap();
        match read(&at) {
            Ok(Some(all)) => { let _ = picked(&at, &all, FILES[which].1); }
            Ok(None) => {}
            Err(problems) => prop_assert!(problems.to_string().contains(name.as_str()), "{problems}"),
        }
    }
}

#[test]
fn repeated_rows_are_dropped_and_trials_parted_at_gaps() {
    let recorded = crate::campaigns::record(
        &crate::campaigns::truth(),
        &tautline::simulate::Plan { speeds: 3, cosines: 1, rate_hz: 50.0, ..crate::campaigns::plan() },
    );
    let log = recorded.path().join("cosine_1.csv");
    let text = std::fs::read_to_string(&log).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let kept = [&lines[..500], &lines[499..6000], &lines[6040..]].concat();
    std::fs::write(&log, kept.join("\n") + "\n").unwrap();
    let out = TempDir::new().unwrap();
    let to = out.path().join("made");
    let done = tautline(&["import", &recorded.path().to_string_lossy(), "-o", &to.to_string_lossy(), "--json"]);
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(done.status.success(), "{said}");
    assert!(said.contains("1 rows repeat the row before") && said.contains("parted there into 2"), "{said}");
    let made = Campaign::read(&to).unwrap();
    let parts: Vec<usize> =
        made.trials.iter().filter_map(|entry| entry.part.as_ref().map(|part| part.rows.len())).collect();
    assert_eq!((made.trials.len(), parts), (5, vec![5999, lines.len() - 6040]));
    assert_eq!(
        std::fs::read(recorded.path().join("sweep_0.0500_1.csv")).unwrap(),
        std::fs::read(to.join("sweep_0.0500_1.csv")).unwrap()
    );
    let checked = tautline(&["validate", &to.to_string_lossy()]);
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stderr));
}
