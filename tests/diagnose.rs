//! `tautline diagnose` end to end: what it writes, prints and refuses. One run on the bundled da Vinci campaign serves all tests.

use crate::cli::tautline;
use resvg::usvg::roxmltree::Document;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use tempfile::TempDir;

const CAMPAIGN: &str = "data/davinci_l4";
const MODEL: &str = "data/davinci_l4/base_model.json";
/// Every figure that this campaign has data for, with labels that it must bear.
const FIGURES: [(&str, &[&str]); 11] = [
    ("budget", &["RMS (", "gap as delivered", "remains", "noise floor"]),
    ("map", &["position (deg)", "speed (rad/s)", "as delivered", "floor"]),
    ("candidates", &["how far the gap above the floor shrinks (%)", "named in the verdict", "flexible fit"]),
    ("where", &["share of the gap's mean square (%)"]),
    ("residual_time", TRACE),
    ("residual_time_02", TRACE),
    ("residual_time_03", TRACE),
    ("residual_time_04", TRACE),
    ("residual_time_05", TRACE),
    ("residual_time_06", TRACE),
    ("residual_position", &["position (deg)", "sample, moving up", "sample, moving down", "median"]),
];
const TRACE: &[&str] = &["time (s)", "position (deg)", "as delivered: RMS"];

/// A run with `--json`: its folder and what it printed.
struct Run {
    folder: TempDir,
    printed: Vec<u8>,
}

static RUN: LazyLock<Run> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    let to = folder.path().join("r").to_string_lossy().into_owned();
    let done = tautline(&["diagnose", CAMPAIGN, "--model", MODEL, "-o", &to, "--json"]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    Run { folder, printed: done.stdout }
});

fn path(name: &str) -> PathBuf {
    RUN.folder.path().join("r").join(name)
}

fn read(name: &str) -> String {
    std::fs::read_to_string(path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn json_is_what_the_file_holds() {
    let printed: Value = serde_json::from_slice(&RUN.printed).unwrap();
    let written: Value = serde_json::from_str(&read("diagnosis.json")).unwrap();
    assert_eq!(printed, written);
    assert_eq!(written["format"], "diagnosis/1");
    assert_ne!(written["verdict"]["kind"], "none", "the base model lacks what its README tells");
    assert!(written["gap"]["rmse_nm"].as_f64().unwrap() > 0.01 && !written["where"].as_array().unwrap().is_empty());
}

#[test]
fn thresholds_that_differ_from_the_default_decide_and_are_recorded() {
    let folder = TempDir::new().unwrap();
    let to = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let run = |policy: &str| {
        std::fs::write(to("policy.toml"), policy).unwrap();
        tautline(&["diagnose", CAMPAIGN, "--model", MODEL, "--policy", &to("policy.toml"), "-o", &to("r"), "--json"])
    };
    let done = run("format = \"policy/1\"\nfirst_floors = 1000\ncontact_floors = 1000\nopen_floors = 1\n");
    let told: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(told["policy"], serde_json::json!({ "contact_floors": 1000.0, "first_floors": 1000.0 }));
    assert_eq!(told["verdict"]["effects"], serde_json::json!([]), "no cause reaches a thousand floors");
    let usual: Value = serde_json::from_slice(&RUN.printed).unwrap();
    assert_eq!(usual.get("policy"), None);
    let refused = run("format = \"policy/1\"\nfirst_floor = 1\ngain_errors = 0\n");
    let said = String::from_utf8(refused.stderr).unwrap();
    assert!(!refused.status.success() && said.contains("did you mean `first_floors`?"), "{said}");
    assert!(said.contains("expected a number above 0"), "{said}");
}

/// What an earlier version found, or somebody wrote, and the rules of today would not name.
#[test]
fn an_effect_of_the_delivered_model_does_not_keep_others_from_being_named() {
    let folder = TempDir::new().unwrap();
    let to = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let mut model: Value = serde_json::from_str(&std::fs::read_to_string(MODEL).unwrap()).unwrap();
    let faint = serde_json::json!({
        "restarts": 1, "cold_share": 0, "cold_nm": 1e-9, "cold_nm_s_rad": 0, "time_constant_s": 5, "exponent": 1, "long_tail": 0, "parts": 0
    });
    model["effects"] = serde_json::json!([{ "id": "warm_up", "parameters": faint }]);
    std::fs::write(to("model.json"), model.to_string()).unwrap();
    let done = tautline(&["diagnose", CAMPAIGN, "--model", &to("model.json"), "-o", &to("r"), "--json"]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let [told, usual]: [Value; 2] =
        [&done.stdout, &RUN.printed].map(|printed| serde_json::from_slice(printed).unwrap());
    assert_eq!(told["verdict"]["effects"], usual["verdict"]["effects"]);
}

/// Friction that jumps is not known at rest and around rests before turns: here there is nothing else.
#[test]
fn a_joint_that_sticks_at_each_turn_is_refused() {
    let folder = TempDir::new().unwrap();
    let to = |name: &str| folder.path().join(name);
    let bundled = std::fs::read_to_string(format!("{CAMPAIGN}/campaign.toml")).unwrap();
    let (head, _) = bundled.split_once("[[trials]]").unwrap();
    let head = head.lines().filter(|line| !line.starts_with("load_torque"));
    let head: String = head.map(|line| line.replace("lowpass_hz = 20.0", "lowpass_hz = 2.0") + "\n").collect();
    std::fs::write(to("campaign.toml"), head + "[[trials]]\nfile = \"a.csv\"\nprotocol = \"free\"\n").unwrap();
    // Up and down by 0.02 rad within 0.06 s each, and a rest of 0.54 s before every turn.
    let row = |i: u32| {
        let (stroke, moved) = (i / 120, f64::from((i % 120).min(12)) / 12.0);
        let position_rad = 0.02 * if stroke % 2 == 0 { moved } else { 1.0 - moved };
        let torque_nm = if stroke % 2 == 0 { 0.05 } else { -0.05 } + 1e-3 * (f64::from(i) * 12.9898).sin();
        format!("{:.3},{position_rad:.6},{torque_nm:.6}\n", f64::from(i) / 200.0)
    };
    let log: String = (0..4000).map(row).collect();
    std::fs::write(to("a.csv"), format!("time_s,position_rad,torque_nm\n{log}")).unwrap();
    let [campaign, out] = ["campaign.toml", "out"].map(|name| to(name).to_string_lossy().into_owned());
    let refused = tautline(&["diagnose", &campaign, "--model", MODEL, "-o", &out]);
    let said = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("campaign.toml: no sample can be judged: the model's friction jumps at reversals"), "{said}");
    assert!(!to("out").exists());
}

#[test]
fn the_parts_of_the_gap_add_up() {
    let written: Value = serde_json::from_str(&read("diagnosis.json")).unwrap();
    let budget = &written["budget"];
    let part = |name: &str| budget[name].as_f64().unwrap();
    let causes: f64 = budget["causes"].as_array().unwrap().iter().map(|c| c["square"].as_f64().unwrap()).sum();
    let whole = part("floor") + part("within_confidence") + causes + part("unexplained");
    let rmse_nm = written["gap"]["rmse_nm"].as_f64().unwrap();
    assert!((whole.sqrt() / rmse_nm - 1.0).abs() < 1e-6, "{} against {rmse_nm}", whole.sqrt());
}

#[test]
fn every_figure_is_well_formed_and_labelled() {
    for (name, labels) in FIGURES {
        let svg = read(&format!("plots/{name}.svg"));
        let drawing = Document::parse(&svg).unwrap_or_else(|error| panic!("{name}: {error}"));
        let texts: Vec<&str> = drawing.descendants().filter(|n| n.is_text()).filter_map(|n| n.text()).collect();
        for label in labels {
            assert!(texts.iter().any(|text| text.trim().starts_with(label)), "{name} lacks `{label}`: {texts:?}");
        }
    }
    let drawn = std::fs::read_dir(path("plots")).unwrap().count();
    assert_eq!(drawn, FIGURES.len(), "a figure that this test does not know");
}

#[test]
fn the_report_stands_alone() {
    let page = read("report.html").replace("xmlns=\"http://www.w3.org/2000/svg\"", "").replace("href=\"#", "");
    let page = page.replace("const SVG = \"http://www.w3.org/2000/svg\"", "");
    for link in ["http:", "https:", "src=", "href=", "@import", "url(http", "url(\"http"] {
        assert!(!page.contains(link), "the report links to something outside: {link}");
    }
    for heading in ["What to do next", "Candidate causes", "Where the gap lies", "Residual over time", "Provenance"] {
        assert!(page.contains(heading), "{heading}");
    }
    assert_eq!(page.matches("<svg").count(), FIGURES.len());
    let verdict = page.find("class=\"short\"").unwrap();
    let place = |text: &str| page.find(text).unwrap();
    assert!(verdict < place("id=\"budget\"") && place("id=\"budget\"") < place("What to do next"), "figure first");
}

#[test]
fn the_model_is_written_with_what_was_found() {
    let model = tautline::model::Model::read(&path("model.json")).unwrap();
    let base = tautline::model::Model::read(Path::new(MODEL)).unwrap();
    assert_eq!(model.joint.name, base.joint.name);
}

#[test]
fn quiet_prints_nothing_and_the_summary_its_headings() {
    let out = TempDir::new().unwrap();
    let to = |name: &str| out.path().join(name).to_string_lossy().into_owned();
    // Two trials do for the wording.
    let quick = crate::campaigns::record(&crate::campaigns::truth(), &crate::campaigns::plan());
    let (campaign, model) = (quick.path().to_string_lossy().into_owned(), "data/elbow/truth/model.json");
    let quiet = tautline(&["diagnose", &campaign, "--model", model, "-o", &to("q"), "--quiet"]);
    assert_eq!(quiet.status.code(), Some(0), "{}", String::from_utf8_lossy(&quiet.stderr));
    assert!(quiet.stdout.is_empty() && quiet.stderr.is_empty());
    let told = tautline(&["diagnose", &campaign, "--model", model, "-o", &to("t"), "--png", "--profile"]);
    let profile = String::from_utf8(told.stderr).unwrap();
    let phases: Vec<&str> = profile.lines().map(|line| line.get(..40).unwrap_or(line).trim()).collect();
    let first = ["reading", "noise floor", "contact events", "cause 1"];
    assert!(
        phases.starts_with(&first) && phases.ends_with(&["verdict", "next experiment", "whole diagnosis"]),
        "{profile}"
    );
    let told = String::from_utf8(told.stdout).unwrap();
    for part in ["diagnosed on 8 trials", "Gap (RMS above the noise floor)", "What to do next", "written to"] {
        assert!(told.contains(part), "{told}");
    }
    assert!(!told.contains('\u{1b}') && !told.contains('\u{a0}'), "{told}");
    assert!(out.path().join("t/plots/budget.png").exists());
}

#[test]
fn bad_input_is_refused() {
    let out = TempDir::new().unwrap();
    let to = out.path().join("r").to_string_lossy().into_owned();
    for (campaign, model) in [("data/nowhere", MODEL), (CAMPAIGN, "data/nowhere.json"), ("data/elbow", MODEL)] {
        let done = tautline(&["diagnose", campaign, "--model", model, "-o", &to]);
        assert_eq!(done.status.code(), Some(2), "{campaign} {model}");
        assert!(done.stdout.is_empty() && !done.stderr.is_empty());
        assert!(!Path::new(&to).exists(), "something was left behind");
    }
}

/// The first paragraph of the page on a small recording of the elbow with more Coulomb friction than its model has, or with `effect`.
fn first_sentences(effect: Option<&str>) -> String {
    const MODEL: &str = "data/elbow/truth/model.json";
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let mut model: Value = serde_json::from_str(&std::fs::read_to_string(MODEL).unwrap()).unwrap();
    if effect.is_none() {
        for direction in ["up", "down"] {
            let coulomb = &mut model["friction"][direction]["a_j"];
            *coulomb = (1.2 * coulomb.as_f64().unwrap()).into();
        }
    }
    std::fs::write(at("recorded.json"), model.to_string()).unwrap();
    let (recorded, logs, out) = (at("recorded.json"), at("logs"), at("out"));
    let mut simulate = vec!["simulate", "--model", &recorded, "-o", &logs, "--quiet", "--seed", "5"];
    simulate.extend(["--rate-hz", "50", "--speeds", "5", "--repeats", "2", "--cosines", "2"]);
    simulate.extend(effect.iter().flat_map(|effect| ["--effect", effect]));
    for command in [&simulate[..], &["diagnose", &logs, "--model", MODEL, "-o", &out, "--quiet"]] {
        let done = tautline(command);
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    }
    let page = std::fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    let from = &page[page.find("class=\"short\"").unwrap()..];
    from[..from.find("</p>").unwrap()].to_string()
}

#[test]
fn the_first_sentences_give_what_was_fitted_once() {
    let stale = first_sentences(None);
    assert!(stale.contains("out of date in") && !stale.contains("Fitted:"), "{stale}");
    assert_eq!(stale.matches("friction.up.a_j").count(), 1, "{stale}");
    let spring = first_sentences(Some("elastic_spring:stiffness_nm_rad=0.25"));
    assert_eq!(spring.matches("Fitted: stiffness 0.2").count(), 1, "{spring}");
}
