//! The paper's formula: laws of friction, of the transition, and of the file.

use crate::campaigns::truth;
use proptest::prelude::*;
use std::path::Path;
use tautline::model::{Combination, Direction, Friction, Model, Passage, Transition, settle};

const CURVES: [Combination; 4] = [
    Combination::Sign,
    Combination::Linear,
    Combination::Arctan { k: 0.7535, p: 2.011 },
    Combination::Power { n: 0.6 },
];

#[test]
fn a_model_knows_which_checks_it_failed() {
    let mut json = truth().to_json();
    let check =
        |name: &str, passes: bool| serde_json::json!({ "check": name, "passes": passes, "value": 3.0, "limit": 1.0 });
    json["checks"] = serde_json::json!([check("clearance", true), check("curve_describes", false)]);
    let model = Model::parse(Path::new("model.json"), &json.to_string()).unwrap();
    assert_eq!(model.failed_checks, ["curve_describes"]);
    assert!(truth().failed_checks.is_empty());
}

/// What a filter leaves at rest is rounding: its sign must not throw friction from branch to branch.
#[test]
fn at_rest_friction_that_jumps_stays_where_it_was() {
    let model = Model { combination: Combination::Sign, ..truth() };
    for direction in Direction::BOTH {
        let (sign, on_branch) = (direction.sign(), (direction.sign() + 1.0) / 2.0);
        let mut passage = Passage::after(&model, direction.opposite(), 0.0, 1e-4);
        assert_eq!(passage.step(0.01 * sign, Direction::of(0.1 * sign)), on_branch);
        for rounding in [1e-13, -1e-13, 0.0, -0.0] {
            assert_eq!(passage.step(0.01 * sign, Direction::of(rounding)), on_branch, "{direction:?} {rounding}");
        }
        assert_eq!(passage.step(0.01 * sign, Direction::of(-0.1 * sign)), 1.0 - on_branch);
    }
}

#[test]
fn on_a_branch_the_prediction_is_equation_17() {
    let model = truth();
    for (direction, k_tilde) in [(Direction::Up, 1.0), (Direction::Down, 0.0)] {
        let f = model.friction.of(direction);
        let (r1, r2) = (model.joint.winch_radius_m, model.joint.pulley_radius_m);
        let (load_nm, v) = (0.4, direction.sign() * 0.15);
        let exponentials = f.b_c * (-f.c_c * r2 * v).exp() + f.b_j * (-f.c_j * v).exp();
        let b_nm = r1 / (1.0 - f.mu_c) * (f.a_j + exponentials + f.d * v);
        let expected = r1 / r2 * load_nm / (1.0 - f.mu_c) + b_nm;
        let predicted = model.torque_nm(load_nm, v, k_tilde);
        assert!((predicted.torque_nm - expected).abs() < 1e-12);
        assert!((predicted.rigid_nm + predicted.friction_nm - predicted.torque_nm).abs() < 1e-12);
    }
}

#[test]
fn friction_solves_its_own_load_term() {
    // y = rigid + f with f = mu_c y + unloaded on the branch: the solved formula must satisfy what it was solved from.
    let model = truth();
    let y = model.torque_nm(0.5, 0.2, 1.0);
    let up: &Friction = &model.friction.up;
    let unloaded = up.unloaded_nm(Direction::Up, 0.2, model.joint.winch_radius_m, model.joint.pulley_radius_m);
    assert!((y.friction_nm - (up.mu_c * y.torque_nm + unloaded)).abs() < 1e-12);
}

#[test]
fn a_whole_transition_follows_the_curve_both_ways() {
    for curve in CURVES {
        let mut up = Transition::after(Direction::Down, 0.0);
        let mut down = Transition::after(Direction::Up, 0.0);
        for i in 1..=200 {
            let x = 0.02 * f64::from(i) / 200.0;
            let (rising, falling) = (up.step(x, &curve, 0.02, 0.0), down.step(-x, &curve, 0.02, 0.0));
            assert!((rising - curve.share(f64::from(i) / 200.0)).abs() < 1e-9, "{curve:?} at {x}");
            assert!((rising + falling - 1.0).abs() < 1e-9, "{curve:?} is not the same rotated");
        }
        up.step(0.021, &curve, 0.02, 0.0);
        down.step(-0.021, &curve, 0.02, 0.0);
        assert!(up.is_stable() && down.is_stable());
    }
}

#[test]
fn noise_at_rest_restarts_nothing() {
    let mut still = Transition::after(Direction::Up, 0.0);
    for i in 0..1000 {
        let x = if i % 2 == 0 { 0.0 } else { -1e-5 };
        assert_eq!(still.step(x, &Combination::Linear, 0.02, 2e-5), 1.0);
    }
    // And the travel inside the deadband is made up for once it is left: none is lost.
    let k_tilde = still.step(-0.01, &Combination::Linear, 0.02, 2e-5);
    assert!((k_tilde - 0.5).abs() < 1e-12, "{k_tilde}");
}

#[test]
fn without_a_clearance_the_change_is_at_once() {
    for curve in CURVES {
        let mut state = Transition::after(Direction::Up, 0.0);
        assert_eq!(state.step(-1e-9, &curve, 0.0, 0.0), 0.0);
        assert_eq!(state.step(0.0, &curve, 0.0, 0.0), 1.0);
    }
}

#[test]
fn standing_still_after_a_motion_changes_nothing() {
    for curve in CURVES {
        let mut state = Transition::after(Direction::Up, 0.0);
        assert!((0..50).all(|_| state.step(0.0, &curve, 0.02, 0.0) == 1.0));
    }
}

proptest! {
    /// Wherever the joint wanders, K~ stays in [0, 1] and moves no faster than the curve's steepest slope allows:
    /// a reversal inside a transition does not jump.
    #[test]
    fn k_tilde_is_bounded_and_continuous(steps in prop::collection::vec(-1.0f64..1.0, 1..400), which in 1usize..3) {
        let curve = CURVES[which];
        let (backlash, step) = (0.02, 1e-5);
        // Slope of g(u)/g(1) at u = 0 is the steepest of linear and arctan; a restart scales it by at most 1 / what is left.
        let steepest = curve.share(1e-6) / 1e-6;
        let mut state = Transition::after(Direction::Up, 0.0);
        let (mut x, mut before) = (0.0, 1.0);
        for s in steps.iter().flat_map(|s| std::iter::repeat_n(*s, 50)) {
            x += s * step;
            let k_f = state.k_f;
            let now = state.step(x, &curve, backlash, 0.0);
            prop_assert!((0.0..=1.0 + 1e-12).contains(&now), "{now}");
            let moved = (state.k_f - k_f).abs();
            let left = (1.0 - k_f.abs()).max(moved).max(f64::MIN_POSITIVE);
            prop_assert!((now - before).abs() <= steepest * moved / left + 1e-9, "{before} -> {now}");
            before = now;
        }
    }

    #[test]
    fn settling_forgets_the_start(turns in prop::collection::vec(-0.05f64..0.05, 2..20)) {
        let mut positions = vec![0.0];
        for to in turns {
            let from = positions[positions.len() - 1];
            positions.extend((1..=40).map(|i| from + (to - from) * f64::from(i) / 40.0));
        }
        let (_, known_from) = settle(&positions, 0.02, 0.0);
        let run = |start| {
            let mut state = Transition::after(start, 0.0);
            positions.iter().map(|x| state.step(*x, &Combination::arctan(2.0), 0.02, 0.0)).collect::<Vec<f64>>()
        };
        let (a, b) = (run(Direction::Up), run(Direction::Down));
        for i in known_from..positions.len() {
            prop_assert!((a[i] - b[i]).abs() < 1e-9, "sample {i} of {}: {} and {}", positions.len(), a[i], b[i]);
        }
    }
}

#[test]
fn model_json_reads_back() {
    let folder = tempfile::TempDir::new().unwrap();
    let file = folder.path().join("model.json");
    for name in ["data/elbow/truth/model.json", "data/paper/model.json", "data/davinci_l4/model.json"] {
        let model = Model::read(Path::new(name)).unwrap();
        std::fs::write(&file, model.to_json().to_string()).unwrap();
        assert_eq!(Model::read(&file).unwrap(), model, "{name}");
    }
}

#[test]
fn an_impossible_model_is_refused_with_its_keys() {
    let text = std::fs::read_to_string("data/elbow/truth/model.json").unwrap();
    let folder = tempfile::TempDir::new().unwrap();
    let file = folder.path().join("model.json");
    for (from, to, expected) in [
        ("\"mu_c\": 0.41", "\"mu_c\": 1.2", "friction.up.mu_c"),
        ("\"c_c\": 640.0", "\"c_c\": -640.0", "friction.up.c_c"),
        ("\"a_j\": 36.0,", "", "friction.up.a_j"),
        ("\"kind\": \"arctan\"", "\"kind\": \"atan\"", "arctan"),
        ("\"inertia_kg_m2\"", "\"inertia_kgm2\"", "inertia_kg_m2"),
        ("\"effects\": []", "\"effects\": [{\"id\": \"stribeck\"}]", "effects"),
        ("\"winch_radius_m\": 0.012", "\"winch_radius_m\": 0", "winch_radius_m"),
    ] {
        assert!(text.contains(from), "{from}");
        std::fs::write(&file, text.replacen(from, to, 1)).unwrap();
        let problems = Model::read(&file).unwrap_err().to_string();
        assert!(problems.contains(expected) && problems.contains("model.json"), "{from} -> {to}: {problems}");
    }
}
