//! A zero of the position, a clearance or a load that is wrong: found, carried in the intervals, told.

use crate::campaigns::{identified, plan, record, truth};
use std::path::Path;
use tautline::identify::{Identification, Settings, zero};
use tautline::log::Campaign;
use tautline::model::{Confidence, Direction, Model, Status};
use tautline::simulate::{Plan, Sensors};

/// The bundled elbow with an encoder whose zero is off by `deg`.
fn off_by(deg: f64) -> Model {
    let mut model = truth();
    model.dynamics.position_zero_rad = deg.to_radians();
    model
}

/// A whole protocol at a low rate, whose torque has noise of `noise_nm`.
fn noisy(noise_nm: f64) -> Plan {
    let sensors = Sensors { torque_noise_nm: noise_nm, encoder_counts: 524_288.0 };
    Plan { speeds: 12, repeats: 3, rate_hz: 100.0, sensors, ..plan() }
}

/// Seeds of the noise: an interval of 95 % may miss in one of them.
const SEEDS: [u64; 3] = [1, 2, 3];

/// That the intervals of `name` hold `truth`, one for each seed: all but one, and that one within 1.5 times its half width.
fn assert_held(name: &str, found: &[Identification], truth: f64) {
    let known: Vec<_> = found.iter().map(|one| one.model.confidence[name]).collect();
    let off = |known: &Confidence| (truth - (known.low + known.high) / 2.0).abs() / ((known.high - known.low) / 2.0);
    let half_widths: Vec<f64> = known.iter().map(off).collect();
    let inside = half_widths.iter().filter(|off| **off <= 1.0).count();
    let most = half_widths.iter().copied().fold(0.0, f64::max);
    assert!(
        inside + 1 >= found.len() && most <= 1.5,
        "{name}: truth {truth} is {half_widths:?} half widths off: {known:?}"
    );
}

/// An encoder off by `deg`, identified once for each seed of a noise of `noise_nm`: the zero and mu_c are in their intervals.
fn held(deg: f64, noise_nm: f64) -> Vec<Identification> {
    let of =
        |seed: u64| identified(record(&off_by(deg), &Plan { seed, ..noisy(noise_nm) }).path(), Settings::default());
    let found: Vec<Identification> = SEEDS.into_iter().map(of).collect();
    assert_held(zero::NAME, &found, deg.to_radians());
    for direction in Direction::BOTH {
        let name = format!("friction.{}.mu_c", direction.name());
        assert_held(&name, &found, truth().friction.of(direction).mu_c);
    }
    found
}

#[test]
fn a_zero_that_is_off_is_found_and_told_and_leaves_mu_c_right() {
    let exact = || vec![identified(record(&off_by(2.0), &noisy(0.0)).path(), Settings::default())];
    for (deg, noise_nm) in [(2.0, 0.0), (2.0, 0.005), (5.0, 0.02), (-3.0, 0.02)] {
        for found in if noise_nm == 0.0 { exact() } else { held(deg, noise_nm) } {
            let found_deg = found.model.dynamics.position_zero_rad.to_degrees();
            assert!((found_deg - deg).abs() < 0.5, "{found_deg} deg for {deg}");
            assert_eq!(found.model.confidence[zero::NAME].status, Status::Pinned);
            assert!(found.warnings[0].contains("the position's zero is off by"), "{:?}", found.warnings);
            for direction in Direction::BOTH {
                let mu_c = found.model.friction.of(direction).mu_c;
                assert!((mu_c - truth().friction.of(direction).mu_c).abs() < 0.01, "{mu_c} at {deg} deg");
            }
        }
    }
}

#[test]
fn a_zero_that_is_right_is_not_told() {
    for found in held(0.0, 0.02) {
        assert!(!found.warnings.iter().any(|w| w.contains("zero is off")), "{:?}", found.warnings);
        for direction in Direction::BOTH {
            let name = format!("friction.{}.mu_c", direction.name());
            assert_eq!(found.model.confidence[&name].status, Status::Pinned);
            assert!(!found.rests_on[&name].is_empty());
        }
        assert!(found.checks.iter().all(|check| check.passes()), "{:?}", found.checks);
    }
}

#[test]
fn the_model_predicts_at_the_zero_that_was_found() {
    let folder = record(&off_by(3.0), &Plan { cosines: 1, ..plan() });
    let (fitted, declared) = (
        identified(folder.path(), Settings::default()),
        identified(folder.path(), Settings { zero_as_declared: true, ..Settings::default() }),
    );
    let worst = |found: &Identification| found.residuals.iter().map(|r| r.rmse_nm).fold(0.0, f64::max);
    assert!(worst(&fitted) < 0.5 * worst(&declared), "{} and {}", worst(&fitted), worst(&declared));
    assert_eq!(declared.model.dynamics.position_zero_rad, 0.0);
    // What is written reads back.
    let text = fitted.model.to_json().to_string();
    let back = Model::parse(Path::new("model.json"), &text).unwrap();
    assert_eq!(back.dynamics, fitted.model.dynamics);
}

/// `campaign.toml` in `folder` with `old` replaced by `new`.
fn edit(folder: &Path, old: &str, new: &str) {
    let file = folder.join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains(old), "{old}");
    std::fs::write(file, text.replace(old, new)).unwrap();
}

#[test]
fn a_declared_uncertainty_widens_what_rests_on_it() {
    let folder = record(&truth(), &noisy(0.02));
    let width = |found: &Identification, name: &str| {
        let known = found.model.confidence[name];
        known.high - known.low
    };
    let before = identified(folder.path(), Settings::default());
    edit(folder.path(), "[signal]", "[uncertainty]\ngravity_percent = 2.0\ntorque_zero_nm = 0.01\n\n[signal]");
    let after = identified(folder.path(), Settings::default());
    // 2 % of 1 - mu_c either side.
    assert!(width(&after, "friction.up.mu_c") > 2.0 * 0.02 * 0.55);
    // 10 mN m at the winch, over r1 and times 1 - mu_c, either side.
    assert!(width(&after, "friction.up.a_j") > 2.0 * 0.01 / 0.012 * 0.55);
    assert!(width(&before, "friction.up.mu_c") < width(&after, "friction.up.mu_c"));
    edit(folder.path(), "gravity_percent = 2.0", "gravity_percent = 200.0");
    assert!(Campaign::read(folder.path()).unwrap_err().to_string().contains("gravity_percent"));
}

#[test]
fn a_narrow_declaration_holds_a_zero_that_the_legs_hardly_show() {
    let folder = record(&off_by(0.0), &noisy(0.3));
    edit(folder.path(), "[signal]", "[uncertainty]\nposition_zero_rad = 0.002\n\n[signal]");
    let known = identified(folder.path(), Settings::default()).model.confidence[zero::NAME];
    assert!(known.high - known.low <= 2.0 * 0.002 * 1.001, "{known:?}");
}

#[test]
fn a_clearance_25_times_too_large_is_told_and_nothing_of_the_curve_is_pinned() {
    for noise_nm in [0.005, 0.1] {
        let folder = record(&truth(), &Plan { cosines: 1, ..noisy(noise_nm) });
        let right = identified(folder.path(), Settings::default());
        assert!(!right.warnings.iter().any(|w| w.contains("clearance")), "{:?}", right.warnings);
        edit(folder.path(), "backlash_m = 0.0008", "backlash_m = 0.02");
        let found = identified(folder.path(), Settings::default());
        assert!(found.warnings.iter().any(|w| w.contains("a smaller clearance")), "{noise_nm}: {:?}", found.warnings);
        assert!(found.checks.iter().any(|check| check.name == "clearance" && !check.passes()));
        let of_curve = found.model.confidence.iter().filter(|(name, _)| name.starts_with("combination."));
        assert!(of_curve.clone().count() > 0);
        of_curve.for_each(|(name, known)| assert_ne!(known.status, Status::Pinned, "{name}"));
    }
}

#[test]
fn free_motion_finds_the_zero_too() {
    let plan = Plan { speeds: 0, cosines: 1, ..noisy(0.005) };
    let found = identified(record(&off_by(3.0), &plan).path(), Settings::default());
    let found_deg = found.model.dynamics.position_zero_rad.to_degrees();
    let known = found.model.confidence[zero::NAME];
    assert!((found_deg - 3.0).abs() < 1.0 || known.status == Status::Flat, "{found_deg}: {known:?}");
}

#[test]
fn free_motion_counts_what_the_zero_may_be_off_by() {
    let plan = Plan { speeds: 0, cosines: 2, ..noisy(0.005) };
    let campaign = record(&truth(), &plan);
    let known = |zero_as_declared: bool| {
        let settings = Settings { zero_as_declared, ..Settings::default() };
        identified(campaign.path(), settings).model.confidence
    };
    let (fitted, exact) = (known(false), known(true));
    let half = |of: &Confidence| (of.high - of.low) / 2.0;
    for direction in ["up", "down"] {
        let mu_c = format!("friction.{direction}.mu_c");
        assert!(half(&fitted[&mu_c]) > 1.05 * half(&exact[&mu_c]), "{:?} {:?}", fitted[&mu_c], exact[&mu_c]);
        // Free motion has one Stribeck term at most.
        assert_ne!(fitted[&format!("friction.{direction}.a_j")].status, Status::Pinned);
    }
}

#[test]
fn a_spring_that_looks_like_a_wrong_zero_is_told() {
    let mut model = truth();
    model.effects.push(tautline::effects::Added::parse("elastic_spring:stiffness_nm_rad=0.3").unwrap());
    let found = identified(record(&model, &noisy(0.005)).path(), Settings::default());
    let is_told = found.checks.iter().any(|check| !check.passes()) || found.warnings[0].contains("zero is off");
    assert!(is_told, "{:?}", found.checks);
}
