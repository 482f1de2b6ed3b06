//! Two models of one joint: what changed, and what cannot be said.

use crate::campaigns::truth;
use tautline::compare::{CauseKind, Comparison, Verdict, compare};
use tautline::model::{Both, BranchFunctions, Confidence, Direction, Functions, Level, Model, Status};

fn verdict(found: &Comparison, name: &str) -> Verdict {
    found.changes.iter().find(|c| c.name == name).unwrap().verdict
}

#[test]
fn nothing_changes_between_a_model_and_itself() {
    let found = compare(&truth(), &truth()).unwrap();
    assert!(found.changes.len() >= 18);
    assert!(found.changes.iter().all(|c| c.verdict == Verdict::Within && c.low <= 0.0 && c.high >= 0.0));
    assert_eq!((found.effect.rms_nm, found.effect.peak_nm), (0.0, 0.0));
}

#[test]
fn a_change_beyond_its_confidence_is_told() {
    let mut after = truth();
    after.friction.up.a_j *= 1.2;
    let found = compare(&truth(), &after).unwrap();
    let changed: Vec<&str> =
        found.changes.iter().filter(|c| c.verdict == Verdict::Changed).map(|c| c.name.as_str()).collect();
    assert_eq!(changed, ["friction.up.a_j"]);
    // r1 times the change over 1 - mu_c, whenever the joint moves up.
    let expected_nm = 0.012 * 0.2 * 36.0 / (1.0 - 0.41);
    assert!((found.effect.peak_nm / expected_nm - 1.0).abs() < 1e-6, "{} {expected_nm}", found.effect.peak_nm);
    assert!(found.levels.iter().any(|l| (l.after_nm - l.before_nm - expected_nm).abs() < 1e-9));
}

#[test]
fn what_is_not_known_alone_is_not_judged_alone() {
    let with = |status, half: f64| {
        let mut model = truth();
        let a_j = model.friction.up.a_j;
        let confidence = Confidence { low: a_j - half, high: a_j + half, cv: 0.1, status };
        model.confidence.insert("friction.up.a_j".to_string(), confidence);
        model
    };
    let mut after: Model = truth();
    after.friction.up.a_j *= 1.2;
    let name = "friction.up.a_j";
    assert_eq!(verdict(&compare(&with(Status::Pinned, 0.5), &after).unwrap(), name), Verdict::Changed);
    assert_eq!(verdict(&compare(&with(Status::Pinned, 9.0), &after).unwrap(), name), Verdict::Within);
    assert_eq!(verdict(&compare(&with(Status::TradeOff, 0.5), &after).unwrap(), name), Verdict::Together);
    assert_eq!(verdict(&compare(&with(Status::Flat, f64::INFINITY), &after).unwrap(), name), Verdict::Unknown);
}

#[test]
fn models_of_two_joints_are_refused() {
    let mut other = truth();
    other.joint.name = "knee".to_string();
    other.joint.winch_radius_m = 0.02;
    let refused = compare(&truth(), &other).unwrap_err().to_string();
    assert!(refused.contains("`joint.name`") && refused.contains("`joint.winch_radius_m`"), "{refused}");
}

/// A and B(v) of `model` at twelve speeds, each known to 1 mN m.
fn with_functions(mut model: Model) -> Model {
    let speeds: Vec<f64> = (0..12).map(|i| 0.02 * 20f64.powf(f64::from(i) / 11.0)).collect();
    let branch = |direction| {
        let mu_c = model.friction.of(direction).mu_c;
        let level = |v: &f64| Level { speed_rad_s: *v, b_nm: model.b_nm(direction, *v), se_nm: 1e-3 };
        let a_nm = model.joint.transmission() * model.dynamics.gravity_nm / (1.0 - mu_c);
        let levels = speeds.iter().map(level).collect();
        Some(BranchFunctions { a_nm, a_se_nm: 1e-3 * a_nm, levels, common_se_nm: 1e-4 })
    };
    model.functions = Functions { branches: Both::make(branch) };
    model
}

/// What changed from the bundled elbow to `after`: cause and direction.
fn changed(change: impl Fn(&mut Model)) -> Vec<(CauseKind, Option<Direction>)> {
    let mut after = truth();
    change(&mut after);
    let found = compare(&with_functions(truth()), &with_functions(after)).unwrap();
    assert_eq!(found.attribution.differs(), !found.attribution.causes.is_empty());
    found.attribution.causes.iter().map(|cause| (cause.kind, cause.direction)).collect()
}

#[test]
fn each_change_is_named() {
    let (up, down) = (Some(Direction::Up), Some(Direction::Down));
    assert_eq!(changed(|_| ()), []);
    assert_eq!(changed(|m| m.friction.up.a_j *= 1.1), [(CauseKind::Coulomb, up)]);
    assert_eq!(changed(|m| m.friction.down.a_j *= 1.3), [(CauseKind::Coulomb, down)]);
    assert_eq!(changed(|m| m.friction.up.d *= 1.8), [(CauseKind::Viscous, up)]);
    assert_eq!(changed(|m| m.friction.down.mu_c *= 1.1), [(CauseKind::LoadCoefficient, down)]);
    let stribeck =
        |m: &mut Model| (m.friction.up.b_c, m.friction.up.b_j) = (1.5 * m.friction.up.b_c, 1.5 * m.friction.up.b_j);
    assert_eq!(changed(stribeck), [(CauseKind::Stribeck, up)]);
    assert_eq!(changed(|m| m.dynamics.gravity_nm *= 1.05), [(CauseKind::Gravity, None)]);
}

/// The load coefficient of each direction by itself, not a gain that one direction compensates for: a gain is their rival.
#[test]
fn load_coefficients_of_both_directions_are_told_apart_from_a_gain() {
    let mut after = truth();
    (after.friction.up.mu_c, after.friction.down.mu_c) = (1.3 * after.friction.up.mu_c, 1.3 * after.friction.down.mu_c);
    let found = compare(&with_functions(truth()), &with_functions(after.clone())).unwrap();
    let mut causes = found.attribution.causes.clone();
    causes.sort_by_key(|cause| cause.direction != Some(Direction::Up));
    for (cause, direction) in causes.iter().zip(Direction::BOTH) {
        assert_eq!((cause.kind, cause.direction), (CauseKind::LoadCoefficient, Some(direction)));
        assert_eq!(cause.rivals, [(CauseKind::Gain, None)]);
        let mu_c = |model: &Model| model.friction.of(direction).mu_c;
        let expected = (1.0 - mu_c(&truth())) / (1.0 - mu_c(&after)) - 1.0;
        assert!((cause.change - expected).abs() < 2e-3, "{cause:?}");
    }
    assert_eq!(causes.len(), 2);
}

#[test]
fn a_cause_comes_with_its_size() {
    let mut after = truth();
    after.friction.up.a_j *= 1.1;
    let found = compare(&with_functions(truth()), &with_functions(after)).unwrap();
    let [cause] = &found.attribution.causes[..] else { panic!("{:?}", found.attribution) };
    let expected_nm = 0.012 * 0.1 * 36.0 / (1.0 - 0.41);
    assert!((cause.low..=cause.high).contains(&expected_nm), "{cause:?}");
    assert!((cause.change / expected_nm - 1.0).abs() < 0.02, "{cause:?}");
}

/// A share is of what was, not of its logarithm.
#[test]
fn shares_are_relative_changes() {
    let of = |change: &dyn Fn(&mut Model)| {
        let mut after = truth();
        change(&mut after);
        let found = compare(&with_functions(truth()), &with_functions(after)).unwrap();
        let [cause] = &found.attribution.causes[..] else { panic!("{:?}", found.attribution) };
        cause.change
    };
    assert!((of(&|m| m.dynamics.gravity_nm *= 1.4) - 0.4).abs() < 1e-3);
    let scaled = (1.0 - 0.41) / (1.0 - 0.5) - 1.0;
    assert!((of(&|m| m.friction.up.mu_c = 0.5) - scaled).abs() < 1e-3);
}

#[test]
fn functions_are_read_back_from_the_file() {
    let model = with_functions(truth());
    let text = model.to_json().to_string();
    let read = Model::parse(std::path::Path::new("model.json"), &text).unwrap();
    let (a, b) = (model.functions.branches.up.unwrap(), read.functions.branches.up.unwrap());
    assert_eq!(a.levels.len(), b.levels.len());
    assert!((a.levels[3].se_nm - b.levels[3].se_nm).abs() < 1e-12 && a.levels[3].b_nm == b.levels[3].b_nm);
    assert!((a.a_se_nm / b.a_se_nm - 1.0).abs() < 1e-9);
}
