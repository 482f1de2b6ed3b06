//! Two models of one joint: what changed, and what cannot be said.

use crate::campaigns::truth;
use tautline::compare::{CauseKind, Comparison, FunctionKind, Verdict, compare};
use tautline::model::{Both, BranchFunctions, Confidence, Direction, Functions, Level, Model, SharedError, Status};
use tautline::report::chart::{Series, Shape};

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
        Some(BranchFunctions { a_nm, a_se_nm: 1e-3 * a_nm, levels, common_se_nm: 1e-4, errors: Vec::new() })
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

/// A tare moves both directions alike; a mass hung elsewhere than the others adds a level beside its sine.
#[test]
fn an_offset_is_told_and_one_beside_a_load_is_that_loads() {
    let found = |load: f64, offset_nm: f64| {
        let mut after = with_functions(truth());
        for direction in Direction::BOTH {
            let of = after.functions.branches.of_mut(direction).as_mut().unwrap();
            of.a_nm *= load;
            of.levels.iter_mut().for_each(|level| level.b_nm += offset_nm);
        }
        compare(&with_functions(truth()), &after).unwrap().attribution.causes
    };
    let [tare] = &found(1.0, -0.03)[..] else { panic!() };
    assert_eq!((tare.kind, tare.direction), (CauseKind::Offset, None));
    assert!((tare.change + 0.03).abs() < 1e-3 && tare.high < 0.0, "{tare:?}");
    let [mass] = &found(1.2, 0.03)[..] else { panic!() };
    assert_eq!((mass.kind, mass.direction, mass.rivals.len()), (CauseKind::Gravity, None, 0));
    assert!((mass.change - 0.2).abs() < 5e-3, "{mass:?}");
}

/// Friction that rises in both directions, by unlike amounts, is not an offset with friction of one of them.
#[test]
fn coulomb_friction_of_both_directions_is_no_offset() {
    let both = [(CauseKind::Coulomb, Some(Direction::Up)), (CauseKind::Coulomb, Some(Direction::Down))];
    let mut named =
        changed(|m| (m.friction.up.a_j, m.friction.down.a_j) = (1.1 * m.friction.up.a_j, 1.4 * m.friction.down.a_j));
    named.sort_by_key(|(_, direction)| *direction != Some(Direction::Up));
    assert_eq!(named, both);
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

/// The slowest and the fastest speed of every curve of B(v) between `before` and `after`, and the caption.
fn drawn_speeds(before: &Model, after: &Model) -> (Vec<[f64; 2]>, String) {
    let figures = tautline::report::plots::comparison::figures(&compare(before, after).unwrap());
    let friction = figures.into_iter().find(|figure| figure.name == "friction").unwrap();
    let ends = |series: &Series| match &series.shape {
        Shape::Line(points, _) => [points[0].0, points[points.len() - 1].0],
        _ => panic!("only lines are drawn"),
    };
    let curves = friction.panels().flat_map(|panel| &panel.series).map(ends).collect();
    (curves, friction.caption)
}

#[test]
fn b_is_drawn_over_the_speeds_that_the_data_of_both_models_cover() {
    let sweeps = with_functions(truth());
    let mut free = with_functions(truth());
    for direction in Direction::BOTH {
        let of = free.functions.branches.of_mut(direction).as_mut().unwrap();
        of.levels.retain(|level| level.speed_rad_s > 0.1);
    }
    let slowest = free.functions.branches.up.as_ref().unwrap().levels[0].speed_rad_s;
    let is_near = |[low, high]: &[f64; 2]| (low - slowest).abs() < 1e-9 && (high - 0.4).abs() < 1e-9;
    let (curves, caption) = drawn_speeds(&sweeps, &free);
    assert!(curves.len() == 4 && curves.iter().all(is_near), "{curves:?}");
    assert!(caption.contains("the speeds that the data of both cover"), "{caption}");
    // A model that somebody wrote does not say what its data cover; the other one does.
    let (curves, caption) = drawn_speeds(&truth(), &free);
    assert!(curves.iter().all(is_near) && caption.contains("of the model after cover"), "{curves:?} {caption}");
    assert!(drawn_speeds(&truth(), &truth()).1.contains("may be extrapolated"));
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

/// The zero of the position moves B of both directions alike: it hides neither a change of one of them nor the width between them.
#[test]
fn an_error_of_both_directions_hides_no_change_of_one() {
    let known = |mut model: Model, is_shared: bool| {
        model = with_functions(model);
        let zero = SharedError { a_nm: 0.0, b_nm: 5e-3 };
        for direction in Direction::BOTH {
            let of = model.functions.branches.of_mut(direction).as_mut().unwrap();
            let own = SharedError { a_nm: of.a_se_nm, b_nm: -0.6 * of.a_se_nm };
            let none = SharedError::default();
            let told = if direction == Direction::Up { vec![own, none, zero] } else { vec![none, own, zero] };
            of.common_se_nm = own.b_nm.hypot(zero.b_nm);
            of.errors = if is_shared { told } else { Vec::new() };
        }
        model
    };
    let found = |is_shared: bool| {
        let mut after = truth();
        after.friction.down.a_j *= 1.03;
        compare(&known(truth(), is_shared), &known(after, is_shared)).unwrap()
    };
    let (shared, apart) = (found(true), found(false));
    let named: Vec<_> = shared.attribution.causes.iter().map(|cause| (cause.kind, cause.direction)).collect();
    assert_eq!(named, [(CauseKind::Coulomb, Some(Direction::Down))]);
    assert!(apart.attribution.causes.is_empty(), "{:?}", apart.attribution);
    let width = |found: &Comparison| {
        found.functions.iter().find(|of| of.kind == FunctionKind::Hysteresis).unwrap().half_width()
    };
    assert!(width(&shared) < 0.5 * width(&apart), "{} {}", width(&shared), width(&apart));
    assert!(shared.effect.explained_nm < apart.effect.explained_nm);
    // The file keeps what they share.
    let text = known(truth(), true).to_json().to_string();
    let read = Model::parse(std::path::Path::new("model.json"), &text).unwrap();
    for (a, b) in read.functions.errors(Direction::Up).iter().zip(known(truth(), true).functions.errors(Direction::Up))
    {
        assert!((a.a_nm - b.a_nm).abs() < 1e-9 && (a.b_nm - b.b_nm).abs() < 1e-9);
    }
}

/// Free motion tells B at its own speeds, and where no load shows A, only that is not known.
#[test]
fn what_one_model_leaves_open_is_named_and_the_rest_compared() {
    let moved = |mut model: Model, speeds: [f64; 2]| {
        for direction in Direction::BOTH {
            let b_nm = |v: f64| model.b_nm(direction, v);
            let levels = speeds.map(|v| Level { speed_rad_s: v, b_nm: b_nm(v), se_nm: 1e-3 }).to_vec();
            let of =
                BranchFunctions { a_nm: 0.35, a_se_nm: f64::INFINITY, levels, common_se_nm: 1e-3, errors: Vec::new() };
            *model.functions.branches.of_mut(direction) = Some(of);
        }
        model
    };
    let mut after = truth();
    after.friction.up.a_j *= 1.1;
    let found = compare(&moved(truth(), [0.5, 1.3]), &moved(after, [0.6, 1.5])).unwrap();
    assert_eq!(found.unknown, Direction::BOTH.map(|direction| (FunctionKind::Load, direction)));
    let b: Vec<f64> =
        found.functions.iter().filter(|of| of.kind == FunctionKind::Friction).filter_map(|of| of.speed_rad_s).collect();
    assert!(b.len() == 6 && b.iter().all(|speed| (0.6..=1.3).contains(speed)), "{b:?}");
    let [cause] = &found.attribution.causes[..] else { panic!("{:?}", found.attribution) };
    assert_eq!((cause.kind, cause.direction), (CauseKind::Coulomb, Some(Direction::Up)));
}
