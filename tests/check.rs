//! `check`: green while nothing changed, red for each seeded regression, green under what does not matter.

use crate::campaigns::{plan, record, truth};
use crate::cli::tautline;
use std::path::Path;
use tautline::check::sketch::{Relation, Sketch};
use tautline::check::{Baseline, Checked, Outcome, Part, Recipe};
use tautline::identify::Settings;
use tautline::log::Campaign;
use tautline::simulate::{Plan, Sensors};
use tempfile::TempDir;

fn campaign() -> TempDir {
    let sensors = Sensors { torque_noise_nm: 0.005, encoder_counts: 0.0 };
    record(&truth(), &Plan { cosines: 2, repeats: 2, rate_hz: 100.0, sensors, ..plan() })
}

fn baseline(folder: &TempDir) -> Baseline {
    let campaign = Campaign::read(folder.path()).unwrap();
    Baseline::record(&campaign, "rehearsal", Recipe::Identify(Settings::default()), None).unwrap()
}

/// `baseline` as its file gives it back.
fn stored(baseline: &Baseline) -> Baseline {
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), baseline.to_json_text()).unwrap();
    Baseline::read(file.path()).unwrap()
}

fn copied(folder: &TempDir) -> TempDir {
    let copy = TempDir::new().unwrap();
    for entry in std::fs::read_dir(folder.path()).unwrap() {
        let file = entry.unwrap().path();
        std::fs::copy(&file, copy.path().join(file.file_name().unwrap())).unwrap();
    }
    copy
}

/// Changes every log whose name begins with `prefix`: each row as time (s), position (deg), torque (N m).
fn logs(folder: &Path, prefix: &str, change: impl Fn(&mut Vec<[f64; 3]>)) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        let name = file.file_name().unwrap().to_string_lossy().into_owned();
        if !name.ends_with(".csv") || !name.starts_with(prefix) {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let (header, body) = text.split_once('\n').unwrap();
        assert_eq!(header, "time_s,position_deg,torque_nm");
        let row = |line: &str| -> [f64; 3] {
            line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>().try_into().unwrap()
        };
        let mut rows: Vec<[f64; 3]> = body.lines().map(row).collect();
        change(&mut rows);
        let lines: Vec<String> = rows.iter().map(|[t, p, y]| format!("{t:?},{p:?},{y:?}")).collect();
        std::fs::write(&file, format!("{header}\n{}\n", lines.join("\n"))).unwrap();
    }
}

fn torque(folder: &Path, prefix: &str, change: impl Fn(f64) -> f64) {
    logs(folder, prefix, |rows| rows.iter_mut().for_each(|row| row[2] = change(row[2])));
}

fn toml(folder: &Path, change: impl Fn(&str) -> String) {
    let file = folder.join("campaign.toml");
    let old = std::fs::read_to_string(&file).unwrap();
    let new = change(&old);
    assert_ne!(old, new, "nothing was changed in\n{old}");
    std::fs::write(&file, new).unwrap();
}

/// `text` with the value of `key` replaced.
fn with(text: &str, key: &str, value: &str) -> String {
    let line = |line: &str| match line.split_once(" = ") {
        Some((name, _)) if name == key => format!("{key} = {value}"),
        _ => line.to_string(),
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n") + "\n"
}

fn checked(baseline: &Baseline, folder: &Path) -> Checked {
    baseline.check(&Campaign::read(folder).unwrap()).unwrap()
}

fn delay(rows: &mut [[f64; 3]]) {
    (5..rows.len()).rev().for_each(|at| rows[at][2] = rows[at - 5][2]);
}

/// As a sensor whose range ends at 0.8 of what it was to record.
fn clip(rows: &mut [[f64; 3]]) {
    let end = 0.8 * rows.iter().fold(0.0, |end: f64, row| end.max(row[2].abs()));
    rows.iter_mut().for_each(|row| row[2] = row[2].clamp(-end, end));
}

fn swap(folder: &Path) {
    let at = |name: &str| folder.join(name);
    std::fs::rename(at("cosine_1.csv"), at("aside")).unwrap();
    std::fs::rename(at("cosine_2.csv"), at("cosine_1.csv")).unwrap();
    std::fs::rename(at("aside"), at("cosine_2.csv")).unwrap();
}

fn lose(folder: &Path) {
    toml(folder, |text| {
        let parts: Vec<&str> = text.split("\n[[trials]]\n").filter(|part| !part.contains("cosine_2.csv")).collect();
        parts.join("\n[[trials]]\n")
    });
}

type Act = fn(&Path);

/// What must turn red, and the parts that must say so.
const RED: [(&str, Act, &[Part]); 13] = [
    ("torque scaled", |f| torque(f, "", |y| 1.02 * y), &[Part::Figure]),
    ("one trial's torque scaled", |f| torque(f, "cosine_2", |y| 1.05 * y), &[Part::Figure]),
    ("torque 50 ms late", |f| logs(f, "cosine", |rows| delay(rows)), &[Part::Figure]),
    ("sign of the torque", |f| torque(f, "", |y| -y), &[Part::Figure]),
    ("sign declared otherwise", |f| toml(f, |t| with(t, "torque_sign", "1")), &[Part::Figure]),
    ("trial lost", lose, &[Part::Data]),
    ("filter's order", |f| toml(f, |t| with(t, "lowpass_order", "5")), &[Part::Setting]),
    ("low-pass", |f| toml(f, |t| with(t, "lowpass_hz", "6.0")), &[Part::Setting]),
    ("trials swapped", swap, &[Part::Data]),
    ("gravity", |f| toml(f, |t| with(t, "gravity_nm", "0.7")), &[Part::Setting]),
    ("backlash", |f| toml(f, |t| with(t, "backlash_m", "0.0009")), &[Part::Setting]),
    ("position off", |f| logs(f, "", |rows| rows.iter_mut().for_each(|row| row[1] += 1.0)), &[Part::Figure]),
    ("torque clipped", |f| logs(f, "cosine", |rows| clip(rows)), &[Part::Figure]),
];

#[test]
fn every_seeded_regression_is_red() {
    let recorded = campaign();
    let baseline = stored(&baseline(&recorded));
    for (name, seed, parts) in RED {
        let copy = copied(&recorded);
        seed(copy.path());
        let found = checked(&baseline, copy.path());
        assert!(found.is_regressed(), "{name} stays green");
        for part in parts {
            assert!(found.with(Outcome::Regressed).any(|f| f.part == *part), "{name}: {part:?} says nothing");
        }
    }
}

#[test]
fn what_does_not_matter_stays_green() {
    let rounded = |x: f64| x * (1.0 + 1e-12 * (1e7 * x).sin());
    let recorded = campaign();
    let baseline = stored(&baseline(&recorded));
    let reorder = |f: &Path| {
        for name in ["sweep_0.0500_1.csv", "cosine_1.csv"] {
            let text = std::fs::read_to_string(f.join(name)).unwrap();
            let turned = |line: &str| line.split(',').rev().collect::<Vec<_>>().join(",");
            std::fs::write(f.join(name), text.lines().map(turned).collect::<Vec<_>>().join("\n") + "\n").unwrap();
        }
    };
    type Case<'c> = (&'c str, &'c dyn Fn(&Path), Outcome);
    let cases: [Case<'_>; 4] = [
        ("nothing", &|_| (), Outcome::Same),
        ("columns in another order", &reorder, Outcome::Same),
        ("other text for the same numbers", &|f| logs(f, "", |_| ()), Outcome::Same),
        (
            "rounding",
            &|f| logs(f, "", |rows| rows.iter_mut().for_each(|row| *row = row.map(rounded))),
            Outcome::Rounded,
        ),
    ];
    for (name, change, data) in cases {
        let copy = copied(&recorded);
        change(copy.path());
        let found = checked(&baseline, copy.path());
        let regressed: Vec<_> = found.with(Outcome::Regressed).collect();
        assert!(regressed.is_empty(), "{name}: {regressed:#?}");
        let trials = || found.findings.iter().filter(|f| f.part == Part::Data);
        assert!(trials().count() > 0 && trials().all(|f| f.outcome == data), "{name}");
        // Nothing hangs on a last digit: no sample more or less, no other choice.
        let figures = found.findings.iter().filter(|f| f.part == Part::Figure);
        let moved: Vec<_> = figures.filter(|f| f.outcome != Outcome::Same).collect();
        assert!(moved.is_empty(), "{name}: {moved:#?}");
    }
}

/// A change of code leaves settings and data as they were: as if the baseline had declared what the code now does.
#[test]
fn a_change_of_code_is_red_on_the_same_data() {
    let recorded = campaign();
    let baseline = stored(&baseline(&recorded));
    for (setting, key, value) in [
        ("signal.lowpass_order", "lowpass_order", "5"),
        ("signal.lowpass_hz", "lowpass_hz", "5.05"),
        ("dynamics.gravity_nm", "gravity_nm", "0.6923"),
    ] {
        let copy = copied(&recorded);
        toml(copy.path(), |text| with(text, key, value));
        let mut disguised = baseline.clone();
        disguised.snapshot.settings.insert(setting.to_string(), value.to_string());
        let found = checked(&disguised, copy.path());
        let regressed: Vec<_> = found.with(Outcome::Regressed).collect();
        assert!(!regressed.is_empty(), "{setting} stays green");
        assert!(regressed.iter().all(|f| matches!(f.part, Part::Figure | Part::Choice)), "{regressed:?}");
    }
}

#[test]
fn changed_data_are_told_by_column_and_kind() {
    let recorded = campaign();
    let baseline = baseline(&recorded);
    let told = |change: Act| {
        let copy = copied(&recorded);
        change(copy.path());
        let found = checked(&baseline, copy.path());
        let one = found.findings.iter().find(|f| f.part == Part::Data && f.name == "cosine_1.csv").unwrap();
        (one.outcome, one.note.clone())
    };
    let scaled = told(|f| torque(f, "cosine_1", |y| 1.02 * y));
    assert_eq!(scaled, (Outcome::Changed, "torque_nm times 1.02".to_string()));
    let turned = told(|f| torque(f, "cosine_1", |y| -y));
    assert_eq!(turned, (Outcome::Changed, "torque_nm with its sign turned".to_string()));
    // The model predicts y = -torque.
    let shifted = told(|f| torque(f, "cosine_1", |y| y - 0.005));
    assert_eq!(shifted, (Outcome::Changed, "torque_nm plus 0.005".to_string()));
    let swapped = told(swap);
    assert_eq!(swapped, (Outcome::Regressed, "holds the data of cosine_2.csv".to_string()));
    let shorter = told(|f| logs(f, "cosine_1", |rows| rows.truncate(rows.len() - 7)));
    assert!(shorter.0 == Outcome::Changed && shorter.1.contains("rows, not"), "{shorter:?}");
}

#[test]
fn a_digest_tells_rounding_from_change() {
    let column: Vec<f64> = (0..10_000).map(|i| (0.01 * f64::from(i)).sin() + 0.3).collect();
    let of = |change: &dyn Fn(usize, f64) -> f64| {
        Sketch::of(&column.iter().enumerate().map(|(i, x)| change(i, *x)).collect::<Vec<f64>>())
    };
    let plain = Sketch::of(&column);
    assert!(of(&|_, x| x * (1.0 + 1e-12 * (1e6 * x).sin())).is_same(&plain));
    assert!(!of(&|i, x| if i == 5000 { x + 1e-5 } else { x }).is_same(&plain));
    assert!(!of(&|i, _| column[(i + 1) % column.len()]).is_same(&plain));
    let both = of(&|_, x| 1.5 * x - 0.2).relation(&plain, column.len()).unwrap();
    let Relation { times, plus } = both;
    assert!((times - 1.5).abs() < 1e-9 && (plus + 0.2).abs() < 1e-9, "{both:?}");
    assert_eq!(of(&|_, x| x * x).relation(&plain, column.len()), None);
}

#[test]
fn the_bundled_campaigns_are_green_on_any_number_of_threads() {
    for (name, threads) in [("elbow", "1"), ("elbow", "3"), ("arm", "1"), ("davinci_l4", "2")] {
        let (folder, file) = (format!("data/{name}"), format!("data/{name}/baseline.json"));
        let done = std::process::Command::new(env!("CARGO_BIN_EXE_tautline"))
            .args(["check", &folder, "--baseline", &file])
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert_eq!(done.status.code(), Some(0), "{name}: {}", String::from_utf8_lossy(&done.stdout));
    }
}

#[test]
fn a_baseline_of_another_campaign_is_no_judgement_and_is_not_replaced() {
    let (folder, copy) = (TempDir::new().unwrap(), "data/davinci_l4/baseline.json");
    let file = folder.path().join("baseline.json");
    std::fs::copy(copy, &file).unwrap();
    for more in [&[][..], &["--update"]] {
        let done = tautline(&[&["check", "data/arm", "--baseline", &file.to_string_lossy()], more].concat());
        let told = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.code() == Some(2) && told.contains("another campaign, davinci_l4"), "{told}");
    }
    assert_eq!(std::fs::read(&file).unwrap(), std::fs::read(copy).unwrap());
}

#[test]
fn the_command_stores_checks_and_ends_as_it_should() {
    let recorded = campaign();
    let (folder, file) = (recorded.path().to_string_lossy().into_owned(), recorded.path().join("baseline.json"));
    let name = file.to_string_lossy().into_owned();
    let run = |more: &[&str]| tautline(&[&["check", &folder, "--baseline", &name], more].concat());
    let told = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).unwrap();

    // Could not run: no baseline, none of ours, a broken one; what is none of ours is not replaced either.
    assert_eq!(run(&[]).status.code(), Some(2));
    for text in ["{}", "mine", "{\"format\": \"baseline/1\", \"figure\": []}"] {
        std::fs::write(&file, text).unwrap();
        for more in [&[][..], &["--update"]] {
            let done = run(more);
            assert!(done.status.code() == Some(2) && done.stdout.is_empty(), "{text}: {done:?}");
        }
        assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
    }
    std::fs::remove_file(&file).unwrap();
    assert_eq!(run(&["--estimate-backlash"]).status.code(), Some(2), "how to identify belongs to --update");

    assert_eq!(run(&["--update"]).status.code(), Some(0));
    let green = run(&[]);
    assert_eq!(green.status.code(), Some(0), "{green:?}");
    assert!(told(&green.stdout).contains("within tolerance") && !told(&green.stdout).contains('\u{1b}'));

    torque(recorded.path(), "cosine_2", |y| 1.2 * y);
    let red = run(&[]);
    assert!(red.status.code() == Some(1) && told(&red.stdout).contains("torque_nm times 1.2"), "{red:?}");
    let junit = told(&run(&["--format", "junit"]).stdout);
    assert!(junit.starts_with("<?xml") && junit.contains("<failure message="), "{junit}");
    let github = told(&run(&["--format", "github"]).stdout);
    assert!(github.contains("::error file=") && github.contains("cosine_2.csv"), "{github}");
    let json: serde_json::Value = serde_json::from_slice(&run(&["--format", "json"]).stdout).unwrap();
    assert!(json["regressed"] == true && json["counts"]["changed"] == 1, "{}", json["counts"]);
    assert!(run(&["--quiet"]).stdout.is_empty());

    // Accepted, it is green again.
    assert_eq!(run(&["--update", "--quiet"]).status.code(), Some(0));
    assert_eq!(run(&[]).status.code(), Some(0));
    // A log that cannot be read is no judgement.
    std::fs::write(recorded.path().join("cosine_2.csv"), "time_s,position_deg,torque_nm\n0,oops,1\n").unwrap();
    assert_eq!(run(&[]).status.code(), Some(2));
}
