//! The exported code is compiled, run over the bundled trials, and equals `predict`.

use crate::cli::tautline;
use crate::effects::{example, examples};
use crate::simulate::{free, trials};
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use tautline::effects::{Added, LIBRARY, Role};
use tautline::export::{
    Language, Likeness, Settings, controller, csv, latex, markdown, mujoco_xml, plain_name, urdf_xml,
};
use tautline::log::{Campaign, read_trial};
use tautline::model::{BranchFunctions, Combination, Confidence, Level, Model, Status, settle};
use tautline::predict::Prediction;
use tautline::prepare::{Trial, prepare};
use tautline::simulate::Plan;
use tempfile::TempDir;

/// N m: sums are rounded in another order.
const WITHIN_NM: f64 = 1e-12;
/// Numbers a sample: position as measured, the joint's three, load, its slope, both clocks, one other joint's three.
const WIDTH: usize = 11;

/// What the code is given for each sample of `trial`: by `model`, where a chain's torque is the caller's to add. Where friction jumps the sign
/// of the speed is that of the direction: that a filter rings at rest is known only from what follows.
fn samples(model: &Model, trial: &Trial) -> Vec<f64> {
    let kind = model.joint.kind;
    let jumps = model.combination == Combination::Sign && model.added_curve().is_none();
    let directions = trial.directions(&trial.turns());
    let moving = |i: usize, speed: f64| directions[i].sign() * speed.abs();
    let mut others = Vec::new();
    let one = |i: usize| {
        let sample = trial.sample(i, &mut others);
        let rigid_nm = if model.chain.is_some() { trial.rigid(i, kind, &model.dynamics).total_nm() } else { 0.0 };
        let other = sample.others.first().copied().unwrap_or_default();
        let (own, load_nm) = (sample.own, rigid_nm + trial.load_nm(i));
        let slope = trial.asked(i, kind, &model.dynamics).slope_nm_rad;
        [
            [
                trial.followed_rad()[i],
                own.position,
                if jumps { moving(i, own.velocity) } else { own.velocity },
                own.acceleration,
                load_nm,
                slope,
                sample.time_s,
                sample.elapsed_s,
            ],
            [other.position, other.velocity, other.acceleration, 0.0, 0.0, 0.0, 0.0, 0.0],
        ]
        .concat()[..WIDTH]
            .to_vec()
    };
    (0..trial.torque_nm.len()).flat_map(one).collect()
}

/// A program that reads samples and writes torques, made of the code in `language`.
fn compiled(model: &Model, language: Language, rate_hz: f64, folder: &Path) -> std::path::PathBuf {
    let settings = Settings { rate_hz, source: "model.json".to_string() };
    let (code, name) = (controller(model, language, &settings).unwrap(), plain_name(model));
    let (has_other, has_slope) =
        (code.contains("others["), code.contains("slope_nm_rad;") || code.contains("slope_nm_rad: f64"));
    let program = folder.join(format!("{language:?}"));
    let done = match language {
        Language::C => {
            std::fs::write(folder.join("model.h"), code).unwrap();
            std::fs::write(folder.join("main.c"), c_program(&name, has_other, has_slope)).unwrap();
            Command::new("cc")
                .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1", "main.c", "-lm", "-o"])
                .arg(&program)
                .current_dir(folder)
                .output()
        }
        Language::Rust => {
            std::fs::write(folder.join("model.rs"), format!("#![no_std]\n{code}")).unwrap();
            std::fs::write(folder.join("libm.rs"), LIBM).unwrap();
            std::fs::write(folder.join("main.rs"), rust_program(has_other, has_slope)).unwrap();
            let library = |name: &str| ["--edition=2024", "--crate-type=lib", "-O", name].map(String::from).into_iter();
            rustc(library("libm.rs"), folder);
            rustc(library("model.rs").chain(["--extern=libm=liblibm.rlib".to_string()]), folder);
            Command::new("rustc")
                .args(["--edition=2024", "-O", "main.rs", "--extern=model=libmodel.rlib", "-L.", "-o"])
                .arg(&program)
                .current_dir(folder)
                .output()
        }
    };
    let done = done.unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    program
}

fn rustc(arguments: impl Iterator<Item = String>, folder: &Path) {
    let done = Command::new("rustc").args(arguments).current_dir(folder).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

/// The functions of the crate `libm`, by the standard library.
const LIBM: &str = "
pub fn atan(x: f64) -> f64 { x.atan() }
pub fn copysign(x: f64, s: f64) -> f64 { x.copysign(s) }
pub fn cos(x: f64) -> f64 { x.cos() }
pub fn exp(x: f64) -> f64 { x.exp() }
pub fn log(x: f64) -> f64 { x.ln() }
pub fn hypot(x: f64, y: f64) -> f64 { x.hypot(y) }
pub fn fabs(x: f64) -> f64 { x.abs() }
pub fn fmax(x: f64, y: f64) -> f64 { x.max(y) }
pub fn fmin(x: f64, y: f64) -> f64 { x.min(y) }
pub fn pow(x: f64, y: f64) -> f64 { x.powf(y) }
pub fn sin(x: f64) -> f64 { x.sin() }
pub fn tanh(x: f64) -> f64 { x.tanh() }
";

fn c_program(name: &str, has_other: bool, has_slope: bool) -> String {
    let other = if has_other {
        "x.others[0].position_rad = r[8]; x.others[0].velocity_rad_s = r[9]; x.others[0].acceleration_rad_s2 = r[10];"
    } else {
        ""
    };
    let slope = if has_slope { "x.slope_nm_rad = r[5];" } else { "" };
    format!(
        "#include <stdio.h>
#include \"model.h\"
int main(void) {{
    double r[{WIDTH}], y;
    {name}_state s;
    {name}_sample x;
    if (fread(r, sizeof(double), 3, stdin) != 3) return 1;
    {name}_start(&s, r[0], r[1] > 0.0, r[2]);
    while (fread(r, sizeof(double), {WIDTH}, stdin) == {WIDTH}) {{
        x.measured_rad = r[0];
        x.own.position_rad = r[1]; x.own.velocity_rad_s = r[2]; x.own.acceleration_rad_s2 = r[3];
        x.load_nm = r[4]; {slope}
        x.time_s = r[6]; x.elapsed_s = r[7]; {other}
        y = {name}_torque_nm(&s, &x);
        if (fwrite(&y, sizeof(double), 1, stdout) != 1) return 1;
    }}
    return 0;
}}
"
    )
}

fn rust_program(has_other: bool, has_slope: bool) -> String {
    let other = if has_other {
        "x.others[0] = Motion { position_rad: r[8], velocity_rad_s: r[9], acceleration_rad_s2: r[10] };"
    } else {
        ""
    };
    let slope = if has_slope { "x.slope_nm_rad = r[5];" } else { "" };
    format!(
        "use model::*;
use std::io::{{Read, Write}};
fn main() {{
    let mut bytes = Vec::new();
    std::io::stdin().read_to_end(&mut bytes).unwrap();
    let all: Vec<f64> = bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect();
    let mut s = State::new(all[0], all[1] > 0.0, all[2]);
    let mut out = Vec::new();
    for r in all[3..].chunks_exact({WIDTH}) {{
        let own = Motion {{ position_rad: r[1], velocity_rad_s: r[2], acceleration_rad_s2: r[3] }};
        let mut x = Sample {{ measured_rad: r[0], own, load_nm: r[4], time_s: r[6], elapsed_s: r[7], ..Sample::default() }};
        {slope} {other}
        out.extend(s.torque_nm(&x).to_le_bytes());
    }}
    std::io::stdout().write_all(&out).unwrap();
}}
"
    )
    .replace("let mut x", "#[allow(unused_mut)] let mut x")
}

/// What `program` makes of `trial`, N m.
fn ran(program: &Path, model: &Model, trial: &Trial) -> Vec<f64> {
    let backlash_rad = model.backlash_m() / model.joint.pulley_radius_m;
    let (direction, _) = settle(trial.followed_rad(), backlash_rad, trial.deadband_rad);
    let start = [trial.followed_rad()[0], direction.sign(), trial.deadband_rad];
    fed(program, &start.into_iter().chain(samples(model, trial)).collect::<Vec<f64>>())
}

/// What `program` answers to `numbers`.
fn fed(program: &Path, numbers: &[f64]) -> Vec<f64> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    let mut child = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let feeding = std::thread::spawn(move || input.write_all(&bytes));
    let out = child.wait_with_output().unwrap();
    feeding.join().unwrap().unwrap();
    assert!(out.status.success());
    out.stdout.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

/// The largest difference to `predict` over `trials`, N m.
fn largest_nm(model: &Model, language: Language, trials: &[Trial]) -> f64 {
    let folder = TempDir::new().unwrap();
    let program = compiled(model, language, trials[0].log.rate_hz, folder.path());
    let of = |trial: &Trial| {
        let (code_nm, predicted_nm) = (ran(&program, model, trial), Prediction::new(model, trial).torque_nm);
        assert_eq!(code_nm.len(), predicted_nm.len());
        code_nm
            .iter()
            .zip(&predicted_nm)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, |m: f64, d| if d > m || d.is_nan() { d } else { m })
    };
    trials.iter().map(of).fold(0.0, f64::max)
}

fn agree(model: &Model, trials: &[Trial], what: &str) {
    for language in [Language::C, Language::Rust] {
        let largest_nm = largest_nm(model, language, trials);
        assert!(largest_nm <= WITHIN_NM, "{what}, {language:?}: {largest_nm:e} N m");
    }
}

fn bundled(folder: &str, model: &Model) -> Vec<Trial> {
    let campaign = tautline::log::Campaign::read(Path::new(folder)).unwrap();
    let campaign = if model.needs_clock() { campaign.with_clock().unwrap() } else { campaign };
    let read = |index: usize| prepare(&campaign, index, read_trial(&campaign, index).unwrap()).unwrap();
    (0..campaign.trials.len()).map(read).collect()
}

fn model(file: &str) -> Model {
    Model::read(Path::new(file)).unwrap()
}

#[test]
fn over_the_bundled_trials_the_code_equals_predict() {
    for (folder, file) in [
        ("data/elbow", "data/elbow/truth/model.json"),
        ("data/davinci_l4", "data/davinci_l4/model.json"),
        ("data/davinci_l4", "data/davinci_l4/base_model.json"),
    ] {
        let model = model(file);
        agree(&model, &bundled(folder, &model), file);
    }
}

#[test]
fn with_an_arm_the_caller_adds_the_chain_s_torque() {
    let arm = Campaign::read(Path::new("data/arm")).unwrap().arm.unwrap();
    let chain = Some(tautline::model::ChainName { urdf: arm.urdf, joint: arm.chain.joint().to_string() });
    let effects = vec![example("cable_elasticity"), example("joint_coupling")];
    let model = Model { chain, effects, ..model("data/elbow/truth/model.json") };
    agree(&model, &bundled("data/arm", &model), "arm");
    let hardens = "cable_elasticity:with_friction=1,compliance_rad_nm=0.03,hardens=1,hardens_nm=0.2";
    let model = Model { effects: vec![Added::parse(hardens).unwrap()], ..model };
    agree(&model, &bundled("data/arm", &model), "a cable that hardens, under loads of either sign");
}

/// `effect` as it is, and with each of its choices the other way.
fn choices(effect: Added) -> Vec<Added> {
    let mut all = vec![effect.clone()];
    for (at, (parameter, value)) in effect.named().enumerate() {
        let is_choice = parameter.role == Role::Choice || (parameter.role == Role::Form && parameter.bounds.1 == 1.0);
        if is_choice && parameter.name != "joint" {
            let mut other = all[all.len() - 1].clone();
            let switches = parameter.bounds.1 == 1.0;
            other.parameters[at] = match switches {
                true if parameter.bounds.0 < 0.0 => -value,
                true => 1.0 - value,
                false => value + 0.3_f64.min(parameter.bounds.1),
            };
            all.push(other);
        }
    }
    all
}

/// Every effect alone in C; in Rust all at once, and with each curve.
#[test]
fn every_effect_of_the_library_is_in_the_code() {
    let base = model("data/elbow/truth/model.json");
    let folder = crate::campaigns::record(&base, &Plan { other_joints: 1, repeats: 1, ..free() });
    let trials = trials(folder.path());
    for effect in LIBRARY {
        let id = effect.about().id;
        for chosen in choices(example(id)) {
            let told = chosen.to_json();
            let with = Model { effects: vec![chosen], ..base.clone() };
            let found = largest_nm(&with, Language::C, &trials);
            assert!(found <= WITHIN_NM, "{told}: {found:e} N m");
        }
        let with = Model { effects: vec![example(id)], ..base.clone() };
        let without = Prediction::new(&base, &trials[0]).torque_nm;
        let mut pairs = Prediction::new(&with, &trials[0]).torque_nm.into_iter().zip(&without);
        assert!(pairs.any(|(a, b)| (a - b).abs() > 1e-3), "{id} does nothing along this motion, so nothing was tested");
    }
    let all: Vec<Added> = examples().collect();
    agree(&Model { effects: all.clone(), ..base.clone() }, &trials, "all effects");
    let others: Vec<_> = all.iter().filter_map(|e| choices(e.clone()).into_iter().last()).collect();
    agree(&Model { effects: others, ..base.clone() }, &trials, "all effects, chosen otherwise");
    let alone: Vec<_> = all.into_iter().filter(|e| e.id() == "presliding").collect();
    for combination in [Combination::Sign, Combination::Linear, Combination::Power { n: 0.4 }] {
        for effects in [Vec::new(), alone.clone()] {
            let with = Model { combination, effects, ..base.clone() };
            let found = largest_nm(&with, Language::C, &trials);
            assert!(found <= WITHIN_NM, "{combination:?}: {found:e} N m");
        }
    }
}

#[test]
fn what_no_controller_can_do_is_refused() {
    let settings = Settings { rate_hz: 1000.0, source: String::new() };
    let refused = |effect: &str| {
        let effects = vec![tautline::effects::Added::parse(effect).unwrap()];
        let model = Model { effects, ..model("data/elbow/truth/model.json") };
        controller(&model, Language::C, &settings).unwrap_err().to_string()
    };
    assert!(refused("time_delay:delay_s=-0.01,first_order=0").contains("takes the motion to come"));
    let fast = Settings { rate_hz: 1e6, ..settings.clone() };
    let effects = vec![tautline::effects::Added::parse("time_delay:delay_s=1,first_order=0").unwrap()];
    let model = Model { effects, ..model("data/elbow/truth/model.json") };
    assert!(controller(&model, Language::C, &fast).unwrap_err().to_string().contains("lower --rate-hz"));
}

/// The simple joint's numbers from the formula by hand: a joint that is one.
#[test]
fn a_joint_that_is_simple_is_held_whole() {
    let mut model = model("data/elbow/truth/model.json");
    let tr = model.joint.transmission();
    for (branch, sign) in [(&mut model.friction.up, 1.0), (&mut model.friction.down, -1.0)] {
        *branch = tautline::model::Friction { a_j: sign * 20.0, d: 5.0, ..Default::default() };
    }
    let like = Likeness::of(&model, (0.02, 0.4));
    let r1 = model.joint.winch_radius_m;
    assert!((like.friction_nm - 20.0 * r1 / tr).abs() < 1e-9, "{like:?}");
    assert!((like.damping_nm_s_rad - 5.0 * r1 / tr).abs() < 1e-9, "{like:?}");
    assert!(like.left_nm < 1e-9 && like.whole_nm > 0.5, "{like:?}");
    let like = Likeness::of(&tautline::model::Model { effects: vec![example("elastic_spring")], ..model }, (0.02, 0.4));
    assert!((like.stiffness_nm_rad - 0.3).abs() < 1e-12 && (like.spring_rests_rad - 1.0 / 3.0).abs() < 1e-12);
    assert!(like.left_nm < 1e-9, "{like:?}");
}

#[test]
fn simulators_and_tables_say_what_they_lack() {
    let model = model("data/elbow/truth/model.json");
    let like = Likeness::of(&model, (0.02, 0.4));
    assert!(like.friction_nm > 0.0 && like.left_nm > 0.01 && like.left_nm < like.whole_nm, "{like:?}");
    for text in [mujoco_xml(&model, &like, "m--x"), urdf_xml(&model, &like, "m--x")] {
        let (_, rest) = text.split_once("<!--").unwrap();
        let (comment, element) = rest.split_once("-->").unwrap();
        assert!(!comment.contains("--") && element.contains("friction"), "{text}");
        for word in ["between moving up and down", "grows with the load", "after a reversal"] {
            assert!(comment.contains(word), "{word}: {text}");
        }
    }
    let table = csv(&model);
    let columns = table.lines().next().unwrap().split(',').count();
    assert!(table.lines().count() > 15 && table.contains("friction.up.mu_c,,0."), "{table}");
    assert!(table.lines().all(|line| line.split(',').count() >= columns), "{table}");
    let spring = Added::parse("elastic_spring:stiffness_nm_rad=0.25,preload_nm=-0.1").unwrap();
    let sprung = csv(&Model { effects: vec![spring], ..model.clone() });
    assert!(sprung.contains("effects.elastic_spring.stiffness_nm_rad,N m/rad,0.25"), "{sprung}");
    assert!(latex(&model).contains("friction.up.mu\\_c") && markdown(&model).contains("| `friction.up.mu_c` |"));
}

/// An end at which the search for a rate stopped is no knowledge: the terminal says so, and so do the tables.
#[test]
fn tables_tell_where_a_search_ended() {
    let mut model = model("data/elbow/truth/model.json");
    let levels = [0.02, 0.4].map(|speed_rad_s| Level { speed_rad_s, b_nm: 0.8, se_nm: 0.001 }).to_vec();
    let up = BranchFunctions { a_nm: 0.35, a_se_nm: 0.001, levels, common_se_nm: 0.001, errors: Vec::new() };
    model.functions.branches.up = Some(up);
    // The slowest rate that sweeps up to 0.4 rad/s show.
    let known = Confidence { low: 0.2 / 0.4, high: 12.2, cv: 0.3, status: Status::TradeOff };
    model.confidence.insert("friction.up.c_j".to_string(), known);
    for table in [markdown(&model), latex(&model)] {
        assert!(table.contains("search limit to 12.2"), "{table}");
    }
    let row = csv(&model).lines().find(|line| line.starts_with("friction.up.c_j")).unwrap().to_string();
    let cells: Vec<&str> = row.split(',').collect();
    assert_eq!((cells[3], cells[4]), ("", "12.2"), "{row}");
}

#[test]
fn export_writes_what_is_asked_for() {
    let folder = TempDir::new().unwrap();
    let out = folder.path().join("out");
    let to = out.to_string_lossy().into_owned();
    let done = tautline(&["export", "data/elbow/truth", "-o", &to]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    let names = |of: &Path| {
        let mut names: Vec<String> =
            std::fs::read_dir(of).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|name| name != ".tautline.json");
        names.sort();
        names
    };
    let all = [
        "elbow_model.h",
        "elbow_model.rs",
        "export.json",
        "mujoco.xml",
        "parameters.csv",
        "parameters.md",
        "parameters.tex",
        "urdf_dynamics.xml",
    ];
    assert_eq!(names(&out), all);
    let done = tautline(&["export", "data/elbow/truth", "-o", &to, "--force", "--only", "c,csv", "--json"]);
    assert_eq!(done.status.code(), Some(0), "{done:?}");
    assert_eq!(names(&out), ["elbow_model.h", "export.json", "parameters.csv"]);
    for (arguments, expected) in [
        (&["--rate-hz", "0"][..], "--rate-hz is 0"),
        (&["--slowest-rad-s", "2"], "speeds from 2 to 0.4"),
        (&[], "--force"),
    ] {
        let done = tautline(&[&["export", "data/elbow/truth", "-o", &to], arguments].concat());
        assert_eq!(done.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&done.stderr).contains(expected), "{done:?}");
    }
}

/// A sample that is no number spoils its own torque, not those after it.
#[test]
fn a_sample_that_is_no_number_is_forgotten() {
    let base = model("data/elbow/truth/model.json");
    let late = Added::parse("time_delay:delay_s=0.004,first_order=1").unwrap();
    let model = Model { effects: vec![example("presliding"), example("time_delay"), late], ..base };
    let folder = TempDir::new().unwrap();
    let mut input = vec![0.5, 1.0, 0.0];
    for i in 0..2000 {
        let q = 0.5 + 0.3 * (0.005 * f64::from(i)).sin();
        let wrong = if i == 1000 { f64::NAN } else { q };
        input.extend([wrong, wrong, wrong, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    }
    for language in [Language::C, Language::Rust] {
        let torque_nm = fed(&compiled(&model, language, 500.0, folder.path()), &input);
        assert!(torque_nm[..1000].iter().all(|y| y.is_finite()), "{language:?}");
        assert!(torque_nm.iter().any(|y| y.is_nan()), "{language:?}: the sample was not seen");
        assert!(torque_nm[1100..].iter().all(|y| y.is_finite()), "{language:?}: never forgotten");
    }
}
