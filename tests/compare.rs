//! Two models of one joint: what changed, and what cannot be said.

use crate::campaigns::truth;
use tautline::compare::{Comparison, Verdict, compare};
use tautline::model::{Confidence, Model, Status};

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
