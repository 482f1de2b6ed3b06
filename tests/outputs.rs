//! Every output: whole or refused, finite, harmless to whoever reads it, and never in the place of somebody else's file.

use crate::campaigns::{plan, record, record_in, truth};
use crate::cli::tautline;
use proptest::prelude::*;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::time::Duration;
use tautline::model::Model;
use tautline::problem::acts;
use tautline::report::json_text;
use tautline::simulate::Plan;
use tempfile::TempDir;

fn campaign() -> TempDir {
    record(&truth(), &Plan { cosines: 1, rate_hz: 100.0, ..plan() })
}

fn at(folder: &TempDir, name: &str) -> String {
    folder.path().join(name).to_string_lossy().into_owned()
}

fn errors(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

/// What was said when it was refused.
#[track_caller]
fn refused(arguments: &[&str]) -> String {
    let output = tautline(arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    errors(&output)
}

#[track_caller]
fn done(arguments: &[&str]) -> Output {
    let output = tautline(arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", errors(&output));
    output
}

fn model_in(folder: &TempDir, model: &Model) -> String {
    let file = at(folder, "model.json");
    std::fs::write(&file, json_text(&model.to_json())).unwrap();
    file
}

/// Every file below `folder`.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        match entry.path() {
            path if path.is_dir() => found.extend(files(&path)),
            path => found.push(path),
        }
    }
    found
}

const SHORT: [&str; 9] = [
    "simulate",
    "--model",
    "data/elbow/truth/model.json",
    "--speeds=1",
    "--repeats=1",
    "--cosines=0",
    "--rate-hz=50",
    "-q",
    "-o",
];

// Not a number

#[test]
fn numbers_beyond_all_measure_end_as_an_error_everywhere() {
    let (recorded, out) = (campaign(), TempDir::new().unwrap());
    let (folder, to) = (recorded.path().to_string_lossy().into_owned(), at(&out, "r"));
    for exponent in [155, 200, 300] {
        let mut huge = truth();
        huge.friction.up.a_j = 10f64.powi(exponent);
        huge.friction.down.a_j = -10f64.powi(exponent);
        let model = model_in(&out, &huge);
        for command in ["evaluate", "diagnose"] {
            let said = refused(&[command, &folder, "--model", &model, "-o", &to]);
            assert!(said.contains("figure") || said.contains("not a number"), "{command} 1e{exponent}: {said}");
            assert!(!Path::new(&to).exists(), "{command} left an output");
        }
    }
    let mut endless = truth();
    endless.friction.up.a_j = 1.7e308;
    endless.friction.up.b_c = 1.7e308;
    let model = model_in(&out, &endless);
    for format in ["--format=csv", "--format=parquet"] {
        let told =
            refused(&["simulate", "--model", &model, "--rate-hz=50", "--speeds=1", "--repeats=1", "-o", &to, format]);
        assert!(told.contains("numerical overflow"), "{format}: {told}");
    }
    refused(&["predict", &folder, "--model", &model, "-o", &to]);
    refused(&["export", &model, "-o", &to]);
    assert!(!Path::new(&to).exists());
}

/// The campaign with `reading` in place of `count` torques of its cosines, from row 2001 on.
fn beyond_measure(reading: &str, count: usize) -> TempDir {
    let recorded = campaign();
    let file = recorded.path().join("cosine_1.csv");
    let log = std::fs::read_to_string(&file).unwrap();
    let spoil = |(row, line): (usize, &str)| match row {
        row if (2000..2000 + count).contains(&row) => format!("{},{reading}\n", line.rsplit_once(',').unwrap().0),
        _ => format!("{line}\n"),
    };
    std::fs::write(&file, log.lines().enumerate().map(spoil).collect::<String>()).unwrap();
    recorded
}

/// The largest number in `json`.
fn largest(json: &serde_json::Value) -> f64 {
    match json {
        serde_json::Value::Array(items) => items.iter().map(largest).fold(0.0, f64::max),
        serde_json::Value::Object(entries) => entries.values().map(largest).fold(0.0, f64::max),
        other => other.as_f64().map_or(0.0, f64::abs),
    }
}

#[test]
fn one_reading_beyond_all_measure_is_told_and_in_no_figure() {
    for reading in ["1e155", "1e308"] {
        let (recorded, out) = (beyond_measure(reading, 1), TempDir::new().unwrap());
        let (folder, model) = (recorded.path().to_string_lossy().into_owned(), model_in(&out, &truth()));
        // `diagnose` reads trials as `evaluate` does, but takes long on sound ones.
        for (command, model) in [("evaluate", &["--model", &model][..]), ("identify", &[])] {
            let output = done(&[&[command, &folder, "--json", "-o", &at(&out, command)], model].concat());
            let text = String::from_utf8(output.stdout).unwrap();
            let told = "cosine_1.csv, row 2001, `torque_nm`: glitches of up to";
            assert!(text.contains(told), "{command} {reading}: {text}");
            let json: serde_json::Value = serde_json::from_str(&text).unwrap();
            assert!(largest(&json) < 1e100, "{command} {reading}: {text}");
        }
    }
}

#[test]
fn a_stretch_beyond_all_measure_is_no_diagnosis() {
    for reading in ["1e155", "1e200", "1e308"] {
        let (recorded, out) = (beyond_measure(reading, 30), TempDir::new().unwrap());
        let (folder, model) = (recorded.path().to_string_lossy().into_owned(), model_in(&out, &truth()));
        for command in ["diagnose", "evaluate"] {
            let said = refused(&[command, &folder, "--model", &model, "-o", &at(&out, "r")]);
            assert!(said.contains("row 2001") && said.contains("which no joint or sensor shows"), "{said}");
        }
        refused(&["identify", &folder, "-o", &at(&out, "r")]);
        assert!(!out.path().join("r").exists());
    }
}

#[test]
fn an_impossible_radius_is_refused_with_a_cure() {
    let recorded = campaign();
    let file = recorded.path().join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    for radius in ["1e-300", "5e-324", "1e300"] {
        std::fs::write(&file, text.replace("winch_radius_m = 0.012", &format!("winch_radius_m = {radius}"))).unwrap();
        let folder = recorded.path().to_string_lossy().into_owned();
        let said = refused(&["identify", &folder, "-o", &at(&recorded, "r")]);
        assert!(
            said.contains("winch_radius_m") && said.contains("12 mm is 0.012") && !said.contains("panicked"),
            "{said}"
        );
    }
}

// Text from files

/// What would act on a terminal, in `text`.
fn acting(text: &str) -> Vec<char> {
    text.chars().filter(|c| acts(*c) && !matches!(c, '\n' | '\t')).collect()
}

#[test]
fn nothing_quoted_acts_on_a_terminal() {
    let hostile = "\u{1b}]0;owned\u{7}\u{1b}[2J\u{202e}";
    let recorded = campaign();
    let folder = recorded.path().to_string_lossy().into_owned();
    let file = recorded.path().join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let quoted = hostile.replace('\u{1b}', "\\u001b").replace('\u{7}', "\\u0007").replace('\u{202e}', "\\u202e");
    for (from, to) in [
        ("name = \"elbow\"", format!("name = \"{quoted}\"")),
        ("name = \"torque_nm\"", format!("name = \"{quoted}\"")),
        ("protocol = \"cosine\"", format!("protocol = \"{quoted}\"")),
        ("file = \"cosine_1.csv\"", format!("file = \"{quoted}\"")),
        ("[joint]", format!("\"{quoted}\" = 1\n[joint]")),
    ] {
        assert!(text.contains(from), "{from}");
        std::fs::write(&file, text.replacen(from, &to, 1)).unwrap();
        for arguments in [vec!["validate", &folder], vec!["identify", &folder, "-o", &at(&recorded, "r")]] {
            let output = tautline(&arguments);
            assert_eq!(output.status.code(), Some(2), "{from}: {output:?}");
            let said = errors(&output) + &String::from_utf8(output.stdout).unwrap();
            assert_eq!(acting(&said), [], "{from}: {said:?}");
            assert!(said.contains("1b") || said.contains("U+001B"), "{said}");
        }
    }
    std::fs::write(&file, text).unwrap();
    let log = recorded.path().join("cosine_1.csv");
    let rows = std::fs::read_to_string(&log).unwrap();
    std::fs::write(&log, rows.replacen("\n0.0", &format!("\n{hostile}0.0"), 1)).unwrap();
    assert_eq!(acting(&errors(&tautline(&["validate", &folder]))), []);
}

#[test]
#[cfg(unix)]
fn a_hostile_folder_name_leaves_every_output_well_formed() {
    let out = TempDir::new().unwrap();
    let recorded = out.path().join("a\u{1b}[31m\u{202e}<b>&\u{1}");
    record_in(&recorded, &truth(), &Plan { cosines: 1, rate_hz: 100.0, ..plan() });
    let (folder, to) = (recorded.to_string_lossy().into_owned(), at(&out, "r"));
    let model = model_in(&out, &truth());
    let output = done(&["identify", &folder, "-o", &to]);
    assert_eq!(acting(&String::from_utf8(output.stdout).unwrap()), []);
    let output = done(&["evaluate", &folder, "--model", &model, "-o", &at(&out, "e"), "--json"]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(acting(&text), []);
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(json["provenance"]["campaign"].as_str().unwrap().contains("\\u{1b}[31m\\u{202e}"), "{text}");
    for file in [files(Path::new(&to)), files(&out.path().join("e"))].concat() {
        let text = std::fs::read_to_string(&file).unwrap();
        assert_eq!(acting(&text), [], "{}", file.display());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn any_name_makes_code_and_xml_that_hold_it_as_text(name in "(?s).{0,24}", extra in "[\\]\\[()<>*/`&=@+\u{1b}\u{202e}-]{0,8}") {
        use tautline::export::{Language, Likeness, Settings, controller, markdown, mujoco_xml, urdf_xml};
        let mut model = truth();
        model.joint.name = format!("{name}{extra}");
        let like = Likeness::of(&model, (0.02, 0.4));
        for xml in [mujoco_xml(&model, &like, &name), urdf_xml(&model, &like, &name)] {
            prop_assert!(acting(&xml).is_empty() && xml.matches("--").count() == 2, "{xml}");
        }
        let settings = Settings { rate_hz: 1000.0, source: name };
        let [plain, code] = [truth(), model.clone()].map(|m| controller(&m, Language::C, &settings).unwrap());
        prop_assert!(acting(&code).is_empty());
        prop_assert_eq!(code.matches("*/").count(), plain.matches("*/").count());
        prop_assert_eq!(code.lines().count(), plain.lines().count());
        let page = markdown(&model);
        prop_assert!(acting(&page).is_empty());
        let title = page.lines().next().unwrap();
        prop_assert!(!title.replace("\\\\", "").replace("\\]", "").contains("]("), "{title}");
    }
}

#[test]
fn a_name_is_no_link_and_a_file_no_formula() {
    let out = TempDir::new().unwrap();
    let mut model = truth();
    model.joint.name = "[open](javascript:alert(1))<script>".to_string();
    let file = model_in(&out, &model);
    done(&["export", &file, "-o", &at(&out, "x"), "--only", "markdown"]);
    let page = std::fs::read_to_string(out.path().join("x/parameters.md")).unwrap();
    assert!(page.starts_with("Parameters of \\[open\\]\\(javascript\\:alert\\(1\\)\\)\\<script\\>\n"), "{page}");

    let recorded = campaign();
    let folder = recorded.path().to_string_lossy().into_owned();
    let toml = recorded.path().join("campaign.toml");
    let text = std::fs::read_to_string(&toml).unwrap();
    std::fs::write(&toml, text.replace("sweep_0.0500_1.csv", "=1+cmd.csv")).unwrap();
    std::fs::rename(recorded.path().join("sweep_0.0500_1.csv"), recorded.path().join("=1+cmd.csv")).unwrap();
    done(&["fit", "trials", &folder, "-o", &at(&out, "t")]);
    let table = std::fs::read_to_string(out.path().join("t/trials.csv")).unwrap();
    assert!(table.contains("\n'=1+cmd.csv,1,") && !table.contains("\n="), "{table}");
    done(&["fit", "friction", &folder, "--trials", &at(&out, "t/trials.csv"), "-o", &at(&out, "f")]);
}

// --force and the list

#[test]
fn force_replaces_only_what_was_written_and_is_unchanged() {
    let out = TempDir::new().unwrap();
    let to = at(&out, "s");
    let simulate = [&SHORT[..], &[&to]].concat();
    let again = [&simulate[..], &["--force"]].concat();
    done(&simulate);
    done(&again);
    for (name, holds) in [("recorded.csv", "time_s\n0\n"), ("notes/day.txt", "warm"), ("campaign.toml.bak", "")] {
        let file = out.path().join("s").join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(&file, holds).unwrap();
        let said = refused(&again);
        assert!(said.contains(name), "{said}");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), holds);
        std::fs::remove_file(&file).unwrap();
        // An empty folder is not ours either.
        if let Some(folder) = file.parent().filter(|folder| !folder.ends_with("s")) {
            assert!(refused(&again).contains("notes"));
            std::fs::remove_dir(folder).unwrap();
        }
    }
    let toml = out.path().join("s/campaign.toml");
    let text = std::fs::read_to_string(&toml).unwrap();
    std::fs::write(&toml, text.replace("0.012", "0.013")).unwrap();
    let said = refused(&again);
    assert!(said.contains("`campaign.toml`") && said.contains("changed"), "{said}");
    std::fs::write(&toml, text).unwrap();
    // What was deleted is not missed; another command's folder, and one without a list, stay.
    std::fs::remove_file(out.path().join("s/simulated.json")).unwrap();
    done(&again);
    let said = refused(&["man", "-o", &to, "--force"]);
    assert!(said.contains("tautline simulate"), "{said}");
    std::fs::remove_file(out.path().join("s/.tautline.json")).unwrap();
    assert!(refused(&again).contains(".tautline.json"));
    assert!(toml.exists());
}

#[test]
fn a_plot_of_the_users_in_an_output_is_kept() {
    let (recorded, out) = (campaign(), TempDir::new().unwrap());
    let (folder, to) = (recorded.path().to_string_lossy().into_owned(), at(&out, "r"));
    done(&["identify", &folder, "-o", &to, "-q"]);
    let mine = out.path().join("r/plots/mine.svg");
    std::fs::write(&mine, "<svg/>").unwrap();
    let said = refused(&["identify", &folder, "-o", &to, "--force"]);
    assert!(said.contains("plots/mine.svg") && mine.exists(), "{said}");
}

#[test]
fn a_name_too_long_is_no_matter_of_free_space() {
    let out = TempDir::new().unwrap();
    let said = refused(&[&SHORT[..], &[&at(&out, &"x".repeat(300))]].concat());
    assert!(said.contains("shorter name") && !said.contains("space"), "{said}");
    let below = refused(&[&SHORT[..], &[&at(&out, &format!("{}/r", "x".repeat(300)))]].concat());
    assert!(below.contains("shorter name"), "{below}");
}

// Killed

/// A run that takes long, once it has begun to write.
#[cfg(unix)]
fn long_run(out: &TempDir) -> Child {
    let arguments = ["simulate", "--model", "data/elbow/truth/model.json", "--rate-hz", "20000", "--quiet", "-o"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_tautline"));
    let before = staged(out);
    let mut child = command.args(arguments).arg(out.path().join("long")).spawn().unwrap();
    for _ in 0..2000 {
        if staged(out).iter().any(|name| !before.contains(name)) {
            return child;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    child.kill().and_then(|()| child.wait()).unwrap();
    panic!("nothing was begun");
}

#[cfg(unix)]
fn staged(out: &TempDir) -> Vec<String> {
    let names = std::fs::read_dir(out.path()).unwrap().flatten().map(|entry| entry.file_name());
    names.map(|name| name.to_string_lossy().into_owned()).filter(|name| name.starts_with(".tautline-")).collect()
}

#[test]
#[cfg(unix)]
fn what_kill_9_leaves_goes_with_the_next_output_and_the_living_keep_theirs() {
    let out = TempDir::new().unwrap();
    let mut killed = long_run(&out);
    killed.kill().unwrap();
    killed.wait().unwrap();
    assert_eq!(staged(&out).len(), 1);
    let mut living = long_run(&out);
    done(&[&SHORT[..], &[&at(&out, "short")]].concat());
    assert_eq!(staged(&out).len(), 1, "that of the living alone");
    // kill, as a system that shuts down sends it.
    assert!(Command::new("kill").args(["-TERM", &living.id().to_string()]).status().unwrap().success());
    assert_eq!(living.wait().unwrap().code(), Some(143));
    assert_eq!(staged(&out), Vec::<String>::new());
}

// Captures that broke off

#[test]
fn a_trial_that_broke_off_blocks_no_command() {
    let out = TempDir::new().unwrap();
    let model = model_in(&out, &truth());
    let recorded = campaign();
    let folder = recorded.path().to_string_lossy().into_owned();
    let toml = recorded.path().join("campaign.toml");
    let text = std::fs::read_to_string(&toml).unwrap();
    let name = "sweep_0.0673_1.csv";
    assert!(text.contains(name), "{text}");
    let whole = std::fs::read_to_string(recorded.path().join(name)).unwrap();
    let marked = text.replace(&format!("file = \"{name}\""), &format!("file = \"{name}\"\nincomplete = \"killed\""));
    let commands = |to: &str| -> Vec<Vec<String>> {
        let all: [&[&str]; 6] = [
            &["validate", &folder],
            &["identify", &folder, "-o", to],
            &["fit", "trials", &folder, "-o", to],
            &["evaluate", &folder, "--model", &model, "-o", to, "--sweeps"],
            &["predict", &folder, "--model", &model, "-o", to],
            &["check", &folder, "--update", "--baseline", &format!("{to}.json"), "--model", &model],
        ];
        all.iter().map(|one| one.iter().map(|word| word.to_string()).collect()).collect()
    };
    // Nothing, a header alone, a few rows, the ramp, half of the clearance.
    for (at_row, rows) in [0, 1, 3, 12, 40].into_iter().enumerate() {
        let cut: String = whole.lines().take(rows).map(|line| format!("{line}\n")).collect();
        std::fs::write(recorded.path().join(name), cut).unwrap();
        std::fs::write(&toml, &marked).unwrap();
        for (i, arguments) in commands(&at(&out, &format!("r{at_row}"))).iter().enumerate() {
            let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
            let output = done(&arguments);
            let said = errors(&output) + &String::from_utf8_lossy(&output.stdout);
            let flat = said.split_whitespace().collect::<Vec<_>>().join(" ");
            // `check` tells the trials that it holds.
            assert!(
                flat.contains("broke off too early") || arguments[0] == "check",
                "{rows} rows: {arguments:?}: {said}"
            );
            let to = out.path().join(format!("r{at_row}"));
            if to.exists() {
                std::fs::rename(&to, out.path().join(format!("done{at_row}_{i}"))).unwrap();
            }
        }
        // Without the mark it is a fault.
        std::fs::write(&toml, &text).unwrap();
        refused(&["identify", &folder, "-o", &at(&out, "never")]);
    }
}

// The guide

#[test]
fn the_guide_has_a_page_on_security() {
    let list = String::from_utf8(done(&["guide"]).stdout).unwrap();
    assert!(list.contains("security"));
    let page = String::from_utf8(done(&["guide", "security"]).stdout).unwrap();
    for word in ["What is not trusted", "--force", "CAP_NET_RAW", "src/core/limits.rs", "143"] {
        assert!(page.contains(word), "{word}");
    }
    assert_eq!(tautline(&["guide", "nothing"]).status.code(), Some(2));
}
