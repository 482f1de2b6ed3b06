//! The program end to end: what it writes, what it prints, how it ends.

use crate::campaigns::{plan, record, truth};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tautline::simulate::{Plan, Sensors};
use tempfile::TempDir;

pub fn tautline(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_tautline")).args(arguments).env_remove("NO_COLOR").output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn campaign() -> TempDir {
    record(&truth(), &Plan { cosines: 1, rate_hz: 100.0, ..plan() })
}

/// The lines of `output`'s errors; it must have ended with status 2 and left `stdout` empty.
fn refused(output: &Output) -> String {
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    assert!(output.stdout.is_empty(), "{output:?}");
    text(&output.stderr)
}

fn path(folder: &TempDir, name: &str) -> (PathBuf, String) {
    let path = folder.path().join(name);
    (path.clone(), path.to_string_lossy().into_owned())
}

#[test]
fn a_model_is_named_by_its_file_or_its_folder() {
    let (out, truth) = (TempDir::new().unwrap(), "data/elbow/truth");
    let (_, simulated) = path(&out, "simulated");
    let simulate = ["simulate", "--model", truth, "-o", &simulated, "--speeds", "1", "--rate-hz", "50", "--quiet"];
    for done in [tautline(&simulate), tautline(&["compare", truth, "data/elbow/truth/model.json"])] {
        assert_eq!(done.status.code(), Some(0), "{done:?}");
    }
    let compare = tautline(&["compare", &simulated, truth]);
    assert!(refused(&compare).contains(&format!("{simulated}: is a folder without a model.json")), "{compare:?}");
}

#[test]
fn identify_writes_all_its_files() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let (folder, name) = path(&out, "result");
    let done = tautline(&["identify", &campaign.path().to_string_lossy(), "-o", &name, "--png"]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    assert!(text(&done.stdout).contains("mu_c") && !text(&done.stdout).contains('\u{1b}'), "colours in a pipe");
    let model: Value = serde_json::from_str(&std::fs::read_to_string(folder.join("model.json")).unwrap()).unwrap();
    assert_eq!(model["format"], "model/1");
    for direction in ["up", "down"] {
        for key in ["a_nm", "a_sd_nm", "rmse_nm", "r_squared", "points"] {
            assert!(model["fit"][direction][key].is_number(), "fit.{direction}.{key}");
        }
        assert_eq!(model["confidence"][format!("friction.{direction}.mu_c")]["status"], "pinned");
    }
    let table = std::fs::read_to_string(folder.join("trials.csv")).unwrap();
    assert!(table.starts_with("file,repeat,direction,speed_rad_s,samples,a_nm,b_nm,r_squared,rmse_nm"), "{table}");
    assert_eq!(table.lines().count(), 17);
    let report = std::fs::read_to_string(folder.join("report.html")).unwrap();
    for outside in ["src=\"http", "href=\"http", "url(http", "@import", "<script src", "<link"] {
        assert!(!report.contains(outside), "report.html reaches outside: {outside}");
    }
    let plots: Vec<_> = std::fs::read_dir(folder.join("plots")).unwrap().map(|e| e.unwrap().path()).collect();
    let ending = |e: &str| plots.iter().filter(|p| p.extension().is_some_and(|x| x == e)).count();
    assert!(ending("svg") >= 7 && ending("svg") == ending("png"), "{plots:?}");
    // And the model can be read by what follows.
    tautline::model::Model::read(&folder.join("model.json")).unwrap();
}

#[test]
fn json_is_all_that_standard_output_holds() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let done = tautline(&["identify", &campaign.path().to_string_lossy(), "-o", &path(&out, "r").1, "--json"]);
    assert_eq!(done.status.code(), Some(0));
    let result: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(result["format"], "model/1");
    assert!(done.stderr.is_empty(), "{}", text(&done.stderr));
}

#[test]
fn the_same_campaign_gives_the_same_bytes() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    for (name, threads) in [("one", "1"), ("two", "2")] {
        std::fs::create_dir(out.path().join(name)).unwrap();
        let done = Command::new(env!("CARGO_BIN_EXE_tautline"))
            .args(["identify", &campaign.path().to_string_lossy(), "-o", "r", "--quiet"])
            .current_dir(out.path().join(name))
            // The page tells when it was made.
            .env("SOURCE_DATE_EPOCH", "0")
            .env("RAYON_NUM_THREADS", threads)
            .output()
            .unwrap();
        assert!(done.status.success() && done.stdout.is_empty());
    }
    for file in ["model.json", "trials.csv", "report.html"] {
        let read = |name: &str| std::fs::read(out.path().join(name).join("r").join(file)).unwrap();
        assert!(read("one") == read("two"), "{file} differs between one and two threads");
    }
}

#[test]
fn the_steps_alone_reach_what_identify_reaches() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let folder = campaign.path().to_string_lossy().into_owned();
    let at = |name: &str| path(&out, name).1;
    for arguments in [
        vec!["fit", "trials", &folder, "-o", &at("a")],
        vec!["fit", "friction", &folder, "--trials", &at("a/trials.csv"), "-o", &at("b")],
        vec!["fit", "combination", &folder, "--model", &at("b/model.json"), "-o", &at("c")],
        vec!["identify", &folder, "-o", &at("d")],
    ] {
        let done = tautline(&arguments);
        assert!(done.status.success(), "{arguments:?}: {}", text(&done.stderr));
    }
    let read = |name: &str| tautline::model::Model::read(&out.path().join(name).join("model.json")).unwrap();
    let (steps, whole) = (read("c"), read("d"));
    assert_eq!(steps.friction, whole.friction);
    assert_eq!(steps.combination, whole.combination);
    assert_eq!(steps.confidence, whole.confidence);
}

#[test]
fn an_existing_output_is_replaced_only_when_told() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let (folder, name) = path(&out, "result");
    let arguments = ["identify", &campaign.path().to_string_lossy(), "-o", &name, "--quiet"];
    assert!(tautline(&arguments).status.success());
    assert!(refused(&tautline(&arguments)).contains("--force"));
    assert!(tautline(&[&arguments[..], &["--force"]].concat()).status.success());
    // Never what is not ours.
    std::fs::write(folder.join("thesis.tex"), "years of work").unwrap();
    refused(&tautline(&[&arguments[..], &["--force"]].concat()));
    assert!(folder.join("thesis.tex").exists() && folder.join("model.json").exists());
}

#[test]
fn a_recorded_campaign_is_never_replaced_by_a_simulated_one() {
    let recorded = campaign();
    let to = recorded.path().to_string_lossy().into_owned();
    let short = ["--speeds", "1", "--repeats", "1", "--cosines", "0", "--rate-hz", "50", "--force"];
    let simulate = [&["simulate", "--model", "data/elbow/truth/model.json", "-o", &to][..], &short].concat();
    assert!(refused(&tautline(&simulate)).contains(".tautline.json"));
    assert!(recorded.path().join("cosine_1.csv").exists());
    // Nor where somebody made it look like a simulated one.
    std::fs::write(recorded.path().join("simulated.json"), "{}").unwrap();
    refused(&tautline(&simulate));
    assert!(recorded.path().join("cosine_1.csv").exists());
}

#[test]
fn interrupted_work_leaves_nothing() {
    let out = TempDir::new().unwrap();
    let to = path(&out, "long").1;
    let mut child = Command::new(env!("CARGO_BIN_EXE_tautline"))
        .args(["simulate", "--model", "data/elbow/truth/model.json", "-o", &to, "--rate-hz", "4000", "--quiet"])
        .spawn()
        .unwrap();
    let staged = || std::fs::read_dir(out.path()).unwrap().count() > 0;
    for _ in 0..500 {
        if staged() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert!(staged(), "nothing was begun");
    // SIGINT, as Ctrl-C sends it.
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!staged(), "{:?}", std::fs::read_dir(out.path()).unwrap().collect::<Vec<_>>());
}

#[test]
fn a_full_disk_is_no_success() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let Ok(full) = std::fs::OpenOptions::new().write(true).open("/dev/full") else { return };
    let status = Command::new(env!("CARGO_BIN_EXE_tautline"))
        .args(["identify", &campaign.path().to_string_lossy(), "-o", &path(&out, "r").1, "--json"])
        .stdout(full)
        .status();
    assert_eq!(status.unwrap().code(), Some(2));
}

#[test]
fn a_failed_run_leaves_nothing() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    std::fs::write(campaign.path().join("sweep_0.0500_1.csv"), "time_s,position_deg,torque_nm\n0,0,x\n").unwrap();
    let errors = refused(&tautline(&["identify", &campaign.path().to_string_lossy(), "-o", &path(&out, "r").1]));
    assert!(errors.contains("sweep_0.0500_1.csv") && errors.contains("row 2"), "{errors}");
    assert_eq!(std::fs::read_dir(out.path()).unwrap().count(), 0, "something was left behind");
}

#[test]
fn a_sweep_that_misses_its_speed_is_refused() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let file = campaign.path().join("campaign.toml");
    let toml = std::fs::read_to_string(&file).unwrap();
    assert!(toml.contains("speed_rad_s = 0.05\n"));
    std::fs::write(&file, toml.replace("speed_rad_s = 0.05\n", "speed_rad_s = 0.5\n")).unwrap();
    let errors = refused(&tautline(&["identify", &campaign.path().to_string_lossy(), "-o", &path(&out, "r").1]));
    assert!(errors.contains("no plateau") && errors.contains("sweep_0.0500_1.csv"), "{errors}");
}

#[test]
fn a_turned_sign_is_not_guessed() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let file = campaign.path().join("campaign.toml");
    let toml = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, toml.replace("torque_sign = -1", "torque_sign = 1")).unwrap();
    let errors = refused(&tautline(&["identify", &campaign.path().to_string_lossy(), "-o", &path(&out, "r").1]));
    assert!(errors.contains("torque_sign") && errors.contains("campaign.toml"), "{errors}");
}

#[test]
fn wrong_usage_ends_with_status_2() {
    for arguments in [
        &["identify"][..],
        &["identify", "nowhere", "-o", "never"],
        &["frobnicate"],
        &["simulate", "--model", "data/elbow/truth/model.json", "-o", "never", "--rate-hz=-5"],
        &["simulate", "--model", "data/elbow/truth/model.json", "-o", "never", "--speeds", "0", "--cosines", "0"],
        &["simulate", "--model", "data/elbow/truth/model.json", "-o", "never", "--slowest-rad-s", "0.00001"],
        &["simulate", "--model", "data/elbow/truth/model.json", "-o", "never", "--slowest-rad-s", "0.4"],
    ] {
        assert_eq!(tautline(arguments).status.code(), Some(2), "{arguments:?}");
    }
    assert!(!Path::new("never").exists());
}

#[test]
fn sweeps_too_fast_for_their_stroke_are_not_simulated() {
    let out = TempDir::new().unwrap();
    let to = path(&out, "fast").1;
    let simulate = |fastest: &str, to: &str| {
        let fixed = ["simulate", "--model", "data/elbow/truth/model.json", "--speeds", "2", "--repeats", "1", "-o", to];
        tautline(&[&fixed[..], &["--cosines", "0", "--rate-hz", "100", "--fastest-rad-s", fastest, "--quiet"]].concat())
    };
    let errors = refused(&simulate("19", &to));
    let fastest = errors.split_whitespace().find(|word| errors.contains(&format!("{word} is the fastest")));
    assert!(simulate(fastest.expect("names the largest speed"), &to).status.success());
    assert!(tautline(&["validate", &to]).status.success());
}

#[test]
fn a_prismatic_joint_is_simulated_without_sweeps() {
    let out = TempDir::new().unwrap();
    let (model, to) = (path(&out, "model.json"), path(&out, "slide").1);
    let mut slide = truth();
    slide.joint.kind = tautline::dynamics::JointKind::Prismatic;
    (slide.joint.winch_radius_m, slide.joint.pulley_radius_m) = (1.0, 1.0);
    std::fs::write(&model.0, slide.to_json().to_string()).unwrap();
    let arguments = ["simulate", "--model", &model.1, "-o", &to, "--rate-hz", "50", "--cosines", "1", "--quiet"];
    assert!(refused(&tautline(&arguments)).contains("--speeds 0"));
    assert!(tautline(&[&arguments[..], &["--speeds", "0"]].concat()).status.success());
    assert!(tautline(&["validate", &to]).status.success());
}

#[test]
fn help_has_examples_and_completions_are_generated() {
    for command in [
        &["--help"][..],
        &["identify", "--help"],
        &["fit", "--help"],
        &["simulate", "--help"],
        &["validate", "--help"],
        &["effects", "--help"],
    ] {
        let help = tautline(command);
        assert!(help.status.success() && text(&help.stdout).contains("Example"), "{command:?}");
    }
    for shell in ["bash", "zsh", "fish"] {
        assert!(text(&tautline(&["completions", shell]).stdout).contains("tautline"));
    }
}

#[test]
fn simulate_repeats_by_its_seed() {
    let out = TempDir::new().unwrap();
    let make = |name: &str, seed: &str| {
        let to = path(&out, name).1;
        let short = ["--speeds", "1", "--repeats", "1", "--cosines", "0", "--rate-hz", "50", "--quiet", "--seed", seed];
        let done = tautline(&[&["simulate", "--model", "data/elbow/truth/model.json", "-o", &to][..], &short].concat());
        assert!(done.status.success(), "{done:?}");
        std::fs::read(out.path().join(name).join("sweep_0.0200_1.csv")).unwrap()
    };
    assert!(make("a", "4") == make("b", "4"));
    assert!(make("c", "4") != make("d", "5"));
}

#[test]
fn predictions_are_replaced_only_when_told() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let model = campaign.path().join("model.json");
    std::fs::write(&model, tautline::report::json_text(&truth().to_json())).unwrap();
    let (folder, name) = path(&out, "p");
    let arguments = ["predict", &campaign.path().to_string_lossy(), "--model", &model.to_string_lossy(), "-o", &name];
    assert_eq!(tautline(&arguments).status.code(), Some(0));
    assert!(refused(&tautline(&arguments)).contains("--force"));
    assert_eq!(tautline(&[&arguments[..], &["--force"]].concat()).status.code(), Some(0));
    let table = std::fs::read_to_string(folder.join("cosine_1.csv")).unwrap();
    let wanted = "time_s,torque_nm,predicted_nm,gravity_nm,inertia_nm,friction_nm,residual_nm";
    assert!(table.starts_with(wanted), "{}", table.lines().next().unwrap());
}

#[test]
fn evaluate_writes_its_files_and_judges() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let model = campaign.path().join("model.json");
    std::fs::write(&model, tautline::report::json_text(&truth().to_json())).unwrap();
    let (folder, name) = path(&out, "judged");
    let (of, with) = (campaign.path().to_string_lossy().into_owned(), model.to_string_lossy().into_owned());
    let arguments = ["evaluate", &of, "--model", &with, "-o", &name, "--json", "--force"];
    let done = tautline(&arguments);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let found: Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(found["format"], "evaluation/1");
    for key in ["rmse_nm", "mae_nm", "peak_nm", "rmse_percent", "mae_percent", "raw_rmse_nm"] {
        assert!(found["trials"][0][key].is_number(), "trials[0].{key}");
        assert!(found["trials"][0]["stable"][key].is_number() && found["trials"][0]["transition"][key].is_number());
    }
    for curve in ["sign", "linear", "arctan", "power"] {
        assert!(found["combinations"][curve]["rmse_nm"].is_number(), "combinations.{curve}");
    }
    assert!(folder.join("report.html").is_file() && folder.join("plots/combinations.svg").is_file());
    let failed = tautline(&[&arguments[..], &["--fail-above", "1e-9"]].concat());
    assert_eq!(failed.status.code(), Some(1), "{failed:?}");
}

#[test]
fn a_step_takes_only_the_flags_that_it_uses() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let folder = campaign.path().to_string_lossy().into_owned();
    let to = path(&out, "r").1;
    let friction = ["fit", "friction", &folder, "--trials", "t.csv", "-o", &to];
    let combination = ["fit", "combination", &folder, "--model", "m.json", "-o", &to];
    for flag in [&["--estimate-backlash"][..], &["--combination", "sign"]] {
        assert!(refused(&tautline(&[&friction[..], flag].concat())).contains("unexpected argument"), "{flag:?}");
    }
    assert!(refused(&tautline(&[&combination[..], &["--form", "one"]].concat())).contains("unexpected argument"));
}

#[test]
fn what_another_joint_left_is_refused() {
    let (campaign, out) = (campaign(), TempDir::new().unwrap());
    let folder = campaign.path().to_string_lossy().into_owned();
    let at = |name: &str| path(&out, name).1;
    assert!(tautline(&["fit", "trials", &folder, "-o", &at("a")]).status.success());
    let friction = |to: &str| tautline(&["fit", "friction", &folder, "--trials", &at("a/trials.csv"), "-o", &at(to)]);
    assert!(friction("b").status.success());
    let combination =
        |to: &str| tautline(&["fit", "combination", &folder, "--model", &at("b/model.json"), "-o", &at(to)]);
    let file = campaign.path().join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let change = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        std::fs::write(&file, text.replace(from, to)).unwrap();
    };
    change("pulley_radius_m = 0.04", "pulley_radius_m = 0.05");
    assert!(refused(&combination("c")).contains("pulley_radius_m is 0.04, here 0.05"));
    let name = truth().joint.name;
    change(&format!("name = \"{name}\""), "name = \"knee\"");
    assert!(refused(&combination("c")).contains("here `knee`"));
    assert!(refused(&friction("c")).contains("the campaign's is `knee`"));
    change("sweep_0.0500_1.csv", "./sweep_0.0500_1.csv");
    let errors = refused(&friction("c"));
    assert!(errors.contains("names no trial of the campaign") && errors.contains("row 2"), "{errors}");
    assert!(!out.path().join("c").exists());
}

#[test]
fn a_step_tells_what_identify_tells() {
    let sensors = Sensors { torque_noise_nm: 0.005, encoder_counts: 524_288.0 };
    let campaign = record(&truth(), &Plan { speeds: 16, sensors, ..plan() });
    let out = TempDir::new().unwrap();
    let folder = campaign.path().to_string_lossy().into_owned();
    // Two clipped samples at the top of a sweep are a warning of the log.
    let file = campaign.path().join("sweep_0.0500_1.csv");
    let log = std::fs::read_to_string(&file).unwrap();
    let clipped = |line: &str| match line.rsplit_once(',') {
        Some((head, y)) if y.parse::<f64>().is_ok_and(|y| y < -1.0) => format!("{head},-1.0\n"),
        _ => format!("{line}\n"),
    };
    std::fs::write(&file, log.lines().map(clipped).collect::<String>()).unwrap();
    let at = |name: &str| path(&out, name).1;
    let told = |arguments: &[&str]| {
        let done = tautline(arguments);
        assert!(done.status.success(), "{arguments:?}: {}", text(&done.stderr));
        text(&done.stdout)
    };
    // One exponential: of two, identify judges by the series, which a table of legs does not hold.
    let identify = told(&["identify", &folder, "-o", &at("d"), "--form", "one"]);
    let trials = told(&["fit", "trials", &folder, "-o", &at("a")]);
    let friction =
        told(&["fit", "friction", &folder, "--trials", &at("a/trials.csv"), "-o", &at("b"), "--form", "one"]);
    let combination = told(&["fit", "combination", &folder, "--model", &at("b/model.json"), "-o", &at("c")]);
    for steps in [&trials, &combination] {
        assert!(steps.contains("sweep_0.0500_1.csv") && steps.contains("clip"), "{steps}");
    }
    let table = |text: &str| -> Vec<String> {
        let rows = text.lines().skip_while(|line| !line.starts_with("Friction parameters")).skip(2).take(7);
        rows.map(str::to_string).collect()
    };
    assert_eq!(table(&friction), table(&identify));
    let two = told(&["fit", "friction", &folder, "--trials", &at("a/trials.csv"), "-o", &at("e")]);
    assert!(two.contains("trade-off"), "{two}");
}
