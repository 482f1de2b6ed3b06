//! The change of friction after a reversal: the right curve, its parameter, the clearance.

use crate::campaigns::{identified, plan, record, truth};
use tautline::identify::combination::Settings as CombinationSettings;
use tautline::identify::{CurveKind, Identification, Settings};
use tautline::model::{Combination, Model};
use tautline::simulate::{Plan, Sensors};

fn with_curve(curve: Combination) -> (Model, Plan) {
    let sensors = Sensors { torque_noise_nm: 0.005, encoder_counts: 524_288.0 };
    (Model { combination: curve, ..truth() }, Plan { cosines: 1, sensors, ..plan() })
}

fn found(curve: Combination, settings: CombinationSettings) -> Identification {
    let (model, plan) = with_curve(curve);
    identified(record(&model, &plan).path(), Settings { combination: settings, ..Settings::default() })
}

#[test]
fn each_curve_is_told_from_the_others() {
    for curve in
        [Combination::Linear, Combination::arctan(2.4), Combination::Power { n: 0.5 }, Combination::Power { n: 1.8 }]
    {
        let found = found(curve, CombinationSettings::default());
        let parameter = |c: Combination| match c {
            Combination::Arctan { p, .. } => p,
            Combination::Power { n } => n,
            _ => 1.0,
        };
        assert_eq!(found.model.combination.name(), curve.name());
        let ratio = parameter(found.model.combination) / parameter(curve);
        assert!((ratio - 1.0).abs() < 0.03, "{curve:?}: found {:?}", found.model.combination);
    }
}

#[test]
fn the_wanted_curve_overrides_the_supported_one() {
    let settings = CombinationSettings { wanted: Some(CurveKind::Power), ..CombinationSettings::default() };
    let found = found(Combination::arctan(2.0), settings);
    let fit = found.combination.unwrap();
    assert_eq!(found.model.combination.name(), "power");
    assert_eq!(fit.curves[fit.supported].kind, CurveKind::Arctan);
    assert_eq!(fit.curves.len(), 4);
    assert!(fit.curves.iter().all(|c| c.rmse_nm >= fit.curves[fit.supported].rmse_nm));
}

#[test]
fn a_wrong_clearance_is_doubted_and_can_be_estimated() {
    let (model, plan) = with_curve(Combination::arctan(2.0));
    for declared_m in [0.0003, 0.002] {
        let folder = record(&model, &plan);
        let file = folder.path().join("campaign.toml");
        let text = std::fs::read_to_string(&file).unwrap();
        assert!(text.contains("backlash_m = 0.0008"));
        std::fs::write(&file, text.replace("backlash_m = 0.0008", &format!("backlash_m = {declared_m}"))).unwrap();
        let doubted = identified(folder.path(), Settings::default());
        assert!(doubted.warnings.iter().any(|w| w.contains("--estimate-backlash")), "{:?}", doubted.warnings);
        let words = if declared_m < 0.0008 { "a larger clearance" } else { "a smaller clearance" };
        assert!(doubted.warnings.iter().any(|w| w.contains(words)), "{:?}", doubted.warnings);
        assert!(doubted.checks.iter().any(|check| check.name == "clearance" && !check.passes()));
        let combination = CombinationSettings { estimate_backlash: true, ..CombinationSettings::default() };
        let estimated = identified(folder.path(), Settings { combination, ..Settings::default() });
        let backlash_m = estimated.model.joint.backlash_m;
        assert!((backlash_m / 0.0008 - 1.0).abs() < 0.03, "declared {declared_m}, estimated {backlash_m}");
        assert!(estimated.model.confidence.contains_key("joint.backlash_m"));
    }
}

#[test]
fn a_right_clearance_is_not_doubted() {
    let found = found(Combination::arctan(2.0), CombinationSettings::default());
    assert!(!found.warnings.iter().any(|w| w.contains("clearance")), "{:?}", found.warnings);
}

#[test]
fn exact_data_are_not_doubted() {
    let found = identified(record(&truth(), &Plan { cosines: 1, ..plan() }).path(), Settings::default());
    assert!(!found.warnings.iter().any(|w| w.contains("change-over")), "{:?}", found.warnings);
}

/// 4096 counts: the clearance is 13 steps, and friction changes by a fifth in the first.
#[test]
fn a_coarse_encoder_does_not_spoil_the_curve() {
    for torque_noise_nm in [0.0, 0.002] {
        let sensors = Sensors { torque_noise_nm, encoder_counts: 4096.0 };
        let found = identified(record(&truth(), &Plan { cosines: 1, sensors, ..plan() }).path(), Settings::default());
        let Combination::Arctan { p, .. } = found.model.combination else { panic!("{:?}", found.model.combination) };
        assert!((p / 2.05 - 1.0).abs() < 0.05, "p = {p}");
        let known = found.model.confidence["combination.p"];
        assert!((known.low..=known.high).contains(&2.05), "{known:?}");
        assert!(!found.warnings.iter().any(|w| w.contains("change-over")), "{:?}", found.warnings);
    }
}
