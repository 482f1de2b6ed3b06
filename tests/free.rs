//! Campaigns without sweeps: judged on what the fit did not see, refused where nothing can be.

use crate::campaigns::{plan, truth};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use std::path::Path;
use tautline::dynamics::Dynamics;
use tautline::identify::combination::{CurveKind, JudgedOn, Settings as CombinationSettings};
use tautline::identify::{Identification, Route, Settings, run};
use tautline::log::{Campaign, Protocol, Signal, TrialEntry};
use tautline::model::{Combination, Direction, Model, Status, Term};
use tautline::problem::Result;
use tautline::simulate::{Course, Plan, Sensors, record};
use tautline::trajectory::{Path as Motion, Segment};
use tempfile::TempDir;

const RATE_HZ: f64 = 100.0;
/// Periods whose strokes go both ways at three speeds.
const PERIODS_S: [f64; 4] = [20.0, 8.0, 4.0, 2.0];

/// A campaign of `trials` cosine trials, each of these periods.
fn cosines(model: &Model, periods_s: &[f64], trials: u32, protocol: Protocol) -> TempDir {
    let folder = TempDir::new().unwrap();
    let sensors = Sensors { torque_noise_nm: 0.005, encoder_counts: 524_288.0 };
    let (low_rad, high_rad) = (0.35, 1.05);
    let period = |period_s: &f64| Segment::Cosine { low_rad, high_rad, period_s: *period_s, periods: 1 };
    let path = Motion { start_rad: low_rad, segments: periods_s.iter().map(period).collect() };
    let mut campaign = plan().campaign(model, folder.path(), &[]);
    for repeat in 1..=trials {
        let course = Course { position_rad: path.positions_rad(RATE_HZ), ..Course::default() };
        let log = record(model, None, &course, RATE_HZ, sensors, u64::from(repeat));
        let row = |((t, x), y): ((&f64, &f64), &f64)| format!("{t:.5},{:.7},{:.6}\n", x.to_degrees(), -y);
        let rows: String = log.time_s.iter().zip(&log.position_rad).zip(&log.torque_nm).map(row).collect();
        let file = format!("cosine_{repeat}.csv");
        std::fs::write(folder.path().join(&file), format!("time_s,position_deg,torque_nm\n{rows}")).unwrap();
        campaign.trials.push(TrialEntry {
            file,
            part: None,
            protocol,
            repeat,
            trajectory: None,
            capture: None,
            controller: None,
        });
    }
    std::fs::write(folder.path().join("campaign.toml"), campaign.to_toml()).unwrap();
    folder
}

fn tried(folder: &Path, combination: CombinationSettings) -> Result<Identification> {
    run(&Campaign::read(folder).unwrap(), Settings { combination, ..Settings::default() }, &|| ())
}

fn declare(folder: &Path, backlash_m: f64) {
    let file = folder.join("campaign.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(text.contains("backlash_m = 0.0008"));
    std::fs::write(&file, text.replace("backlash_m = 0.0008", &format!("backlash_m = {backlash_m}"))).unwrap();
}

const ESTIMATE: CombinationSettings = CombinationSettings { wanted: None, estimate_backlash: true };

#[test]
fn few_trials_are_judged_stroke_by_stroke() {
    for trials in [1, 2, 3] {
        let folder = cosines(&truth(), &PERIODS_S, trials, Protocol::Cosine);
        let found = tried(folder.path(), CombinationSettings::default()).unwrap();
        let Route::Free(free) = &found.route else { panic!("no sweeps, yet a sweep's route") };
        assert!(free.held_out_nm < 0.02, "{trials} trials: {} N m held out", free.held_out_nm);
        let Combination::Arctan { p, .. } = found.model.combination else { panic!("{:?}", found.model.combination) };
        assert!((p / 2.05 - 1.0).abs() < 0.05, "{trials} trials: p = {p}");
        assert!(!found.warnings.iter().any(|w| w.contains("clearance")), "{trials} trials: {:?}", found.warnings);
    }
}

/// A coarse encoder tells late that the joint is back by more than its noise; the speed tells earlier which way it moves.
#[test]
fn friction_that_jumps_does_so_where_the_motion_turns() {
    let mut joint = truth();
    joint.combination = Combination::Sign;
    for direction in Direction::BOTH {
        let friction = joint.friction.of_mut(direction);
        (friction.b_c, friction.c_c, friction.b_j, friction.c_j) = (0.0, 0.0, 0.0, 0.0);
    }
    let sensors = Sensors { torque_noise_nm: 0.01, encoder_counts: 8000.0 };
    let signal = Signal { torque_sign: -1.0, lowpass_hz: 10.0, lowpass_order: 4 };
    let folder =
        crate::campaigns::record(&joint, &Plan { speeds: 0, cosines: 2, rate_hz: 100.0, sensors, signal, ..plan() });
    let found = tried(folder.path(), CombinationSettings::default()).unwrap();
    let Route::Free(free) = &found.route else { panic!("no sweeps, yet a sweep's route") };
    assert_eq!(found.model.combination, Combination::Sign);
    // Jumps as late as the deadband leave 0.09 N m, and make of a_j = 36 N what may be anything from 11 to 94 N.
    assert!(free.held_out_nm < 0.03, "{} N m held out", free.held_out_nm);
    for direction in Direction::BOTH {
        let [found_n, true_n] = [&found.model, &joint].map(|model| model.friction.of(direction).a_j);
        assert!((found_n / true_n - 1.0).abs() < 0.15, "{found_n} N for {true_n}");
    }
}

#[test]
fn the_curves_are_those_of_the_form_taken() {
    let folder = cosines(&truth(), &PERIODS_S, 2, Protocol::Cosine);
    let found = tried(folder.path(), ESTIMATE).unwrap();
    let Route::Free(free) = &found.route else { panic!("no sweeps, yet a sweep's route") };
    let curves = found.combination.as_ref().unwrap();
    assert_eq!(curves.judged_on, JudgedOn::UnseenStrokes);
    assert_eq!(curves.curve().curve, found.model.combination);
    assert_eq!(curves.curve().backlash_m, found.model.joint.backlash_m);
    assert_eq!(curves.curve().rmse_nm, free.held_out_nm);
    let of_form = free.forms.iter().find(|(form, _)| *form == free.form).unwrap();
    assert_eq!(of_form.1, free.held_out_nm);
}

#[test]
fn a_wrong_clearance_is_doubted() {
    for declared_m in [0.0003, 0.002] {
        let folder = cosines(&truth(), &PERIODS_S, 2, Protocol::Cosine);
        declare(folder.path(), declared_m);
        let warnings = tried(folder.path(), CombinationSettings::default()).unwrap().warnings;
        assert!(warnings.iter().any(|w| w.contains("--estimate-backlash")), "{declared_m}: {warnings:?}");
        let backlash_m = tried(folder.path(), ESTIMATE).unwrap().model.joint.backlash_m;
        assert!((backlash_m / 0.0008 - 1.0).abs() < 0.1, "declared {declared_m}, estimated {backlash_m}");
    }
}

/// A clearance of 0.4 rad at the joint, where at most half of the stroke of 0.7 rad is looked for.
#[test]
fn a_clearance_beyond_the_search_is_told() {
    let mut wide = truth();
    (wide.joint.backlash_m, wide.combination) = (0.016, Combination::Linear);
    let folder = cosines(&wide, &PERIODS_S, 2, Protocol::Cosine);
    let warnings = tried(folder.path(), ESTIMATE).unwrap().warnings;
    assert!(warnings.iter().any(|w| w.contains("largest looked for")), "{warnings:?}");
}

#[test]
fn too_few_strokes_are_refused() {
    for (periods_s, backlash_m) in [(vec![8.0], 0.0008), (PERIODS_S.to_vec(), 0.08)] {
        let folder = cosines(&truth(), &periods_s, 1, Protocol::Cosine);
        declare(folder.path(), backlash_m);
        let problems = tried(folder.path(), CombinationSettings::default()).unwrap_err().to_string();
        assert!(problems.contains("two are needed") && problems.contains("campaign.toml"), "{problems}");
    }
}

#[test]
fn interaction_alone_is_refused_for_what_it_is() {
    let folder = cosines(&truth(), &PERIODS_S, 1, Protocol::Interaction);
    let problems = tried(folder.path(), CombinationSettings::default()).unwrap_err().to_string();
    assert!(problems.contains("`interaction`") && problems.contains("uniform"), "{problems}");
}

/// Without a load mu_c is a factor of all friction: it is left out, not fitted to an interval without end.
#[test]
fn without_a_load_no_load_coefficient_is_fitted() {
    let mut model = truth();
    model.dynamics = Dynamics { gravity_nm: 0.0, inertia_kg_m2: 0.0, ..model.dynamics };
    let folder = cosines(&model, &PERIODS_S, 3, Protocol::Cosine);
    let found = tried(folder.path(), CombinationSettings::default()).unwrap();
    let Route::Free(free) = &found.route else { panic!("no sweeps, yet a sweep's route") };
    assert!(!free.is_loaded);
    assert_eq!(free.forms.len(), 2, "{:?}", free.forms);
    for direction in Direction::BOTH {
        assert_eq!(found.model.friction.of(direction).mu_c, 0.0);
        let known = &found.model.confidence[&Term::Coulomb.dotted(direction)];
        assert!(known.high - known.low < 20.0, "{known:?}");
    }
    // B(v) is known even so.
    let up = found.model.functions.branches.up.as_ref().unwrap();
    assert!(up.levels.iter().all(|level| level.se_nm.hypot(up.common_se_nm) < 0.05 * level.b_nm.abs()), "{up:?}");
}

/// One Stribeck term stands for two: its parameters are not those of (15), nor are a_j and d beside it.
#[test]
fn one_stribeck_term_is_merged_from_two() {
    let folder = cosines(&truth(), &PERIODS_S, 2, Protocol::Cosine);
    let found = tried(folder.path(), CombinationSettings::default()).unwrap();
    for direction in Direction::BOTH {
        let branch = found.model.friction.of(direction);
        assert!(branch.b_c == 0.0 && branch.b_j != 0.0, "{branch:?}");
        for term in [Term::Coulomb, Term::JointStribeck, Term::JointDecay, Term::Viscous] {
            let known = found.model.confidence[&term.dotted(direction)];
            assert!(matches!(known.status, Status::Merged | Status::Flat), "{term:?}: {known:?}");
        }
    }
}

/// A curve asked for where the clearance is next to nothing: its p is not shown, and nothing else becomes open because of it.
#[test]
fn what_is_not_shown_opens_no_other_interval() {
    let mut joint = truth();
    joint.joint.backlash_m = 1e-7;
    let folder = cosines(&joint, &PERIODS_S, 2, Protocol::Free);
    let wanted = CombinationSettings { wanted: Some(CurveKind::Arctan), estimate_backlash: false };
    let found = tried(folder.path(), wanted).unwrap();
    assert_eq!(found.model.confidence["combination.p"].status, Status::Flat);
    for direction in Direction::BOTH {
        let of = found.model.functions.branches.of(direction).clone().unwrap();
        assert!(of.a_se_nm.is_finite() && of.common_se_nm.is_finite(), "{of:?}");
        let known = found.model.confidence[&Term::Coulomb.dotted(direction)];
        assert!(known.low.is_finite() && known.high.is_finite(), "{known:?}");
    }
}

/// A direct drive whose load acts both ways, and whose friction is a share of it: 0.2 up and 0.3 down, with 0.02 N m beside. It stands
/// still at the share `pause` of each wave, held by friction under a torque that tells nothing.
fn servo(drive: &str, pause: f64) -> TempDir {
    let folder = TempDir::new().unwrap();
    let mut trials = String::new();
    for (number, period_s) in [7.0, 5.0, 3.5, 2.5].into_iter().enumerate() {
        let mut rng = ChaCha8Rng::seed_from_u64(number as u64);
        let row = |i: usize| {
            let t = i as f64 / 100.0;
            let (wave_s, pause_s) = (t % (period_s + 2.0), pause * period_s);
            let rests = wave_s > pause_s && wave_s < pause_s + 2.0;
            let moved_s = if wave_s <= pause_s { wave_s } else { (wave_s - 2.0).max(pause_s) };
            let phase = std::f64::consts::TAU * moved_s / period_s;
            let (q, v) = (-(1.0 - 0.07 * number as f64) * phase.cos(), phase.sin());
            let load_nm = 1.5 * q.sin();
            let of_load_nm = if v > 0.0 { 0.2 } else { 0.3 } * load_nm.abs();
            let held = if rests { ((0.7 + 0.1 * number as f64) * t).sin() } else { v.signum() };
            let y = load_nm + held * (0.02 + of_load_nm);
            format!("{t:.2},{q:.7},{:.6}\n", y + 0.005 * rng.sample::<f64, _>(StandardNormal))
        };
        let rows: String = (0..4000).map(row).collect();
        std::fs::write(folder.path().join(format!("{number}.csv")), format!("t,q,y\n{rows}")).unwrap();
        trials += &format!("[[trials]]\nfile = \"{number}.csv\"\nprotocol = \"free\"\n");
    }
    let text = format!(
        "format = \"campaign/1\"\n[joint]\nname = \"servo\"\n{drive}\n[dynamics]\ngravity_nm = 1.5\ninertia_kg_m2 = 0.0\n[signal]\n\
         torque_sign = 1\nlowpass_hz = 5.0\nlowpass_order = 4\n[columns]\ntime = {{ name = \"t\", unit = \"s\" }}\nposition = {{ name = \
         \"q\", unit = \"rad\" }}\ntorque = {{ name = \"y\", unit = \"N m\" }}\n{trials}"
    );
    std::fs::write(folder.path().join("campaign.toml"), text).unwrap();
    folder
}

/// What is found: the model, its shares of the load's size, and the dry friction beside, N m, both up and down.
fn found_of_the_load(campaign: &Path) -> (Model, Vec<f64>, [f64; 2]) {
    let model = tried(campaign, CombinationSettings::default()).unwrap().model;
    let [added] = &model.effects[..] else { panic!("{:?}", model.effects) };
    let shares: Vec<f64> = added.named().take(2).map(|(_, share)| share).collect();
    let dry_nm = Direction::BOTH.map(|direction| direction.sign() * model.friction.of(direction).a_j);
    (model, shares, dry_nm)
}

#[test]
fn friction_that_goes_with_the_size_of_the_load_is_found_whichever_way_it_acts() {
    let (model, shares, dry_nm) = found_of_the_load(servo("drive = \"direct\"", 1.0).path());
    assert!((shares[0] - 0.2).abs() < 0.02 && (shares[1] - 0.3).abs() < 0.02, "{shares:?}");
    let held = "what holds it at rest is no friction of its motion";
    assert!(dry_nm.iter().all(|dry_nm| (dry_nm - 0.02).abs() < 0.01), "{dry_nm:?} N m: {held}");
    let known = &model.confidence["effects.load_dependent_friction.up"];
    assert!(known.low < 0.2 && 0.2 < known.high && known.high - known.low < 0.1, "{known:?}");
}

/// Fitted with what is beside the pauses, the share of 0.2 comes out at 0.25.
#[test]
fn pauses_within_a_stroke_tell_nothing_of_friction() {
    let (_, shares, dry_nm) = found_of_the_load(servo("drive = \"direct\"", 0.35).path());
    assert!((shares[0] - 0.2).abs() < 0.01 && (shares[1] - 0.3).abs() < 0.01, "{shares:?}");
    // Less of the motion is left where the load is small, which tells dry friction from a share of the load.
    assert!(dry_nm.iter().all(|dry_nm| (dry_nm - 0.02).abs() < 0.02), "{dry_nm:?} N m");
}

/// Of a cable the load term is the paper's.
#[test]
fn a_cable_keeps_the_paper_s_load_term() {
    let cable = "winch_radius_m = 1.0\npulley_radius_m = 1.0\nbacklash_m = 0.01";
    let found = tried(servo(cable, 1.0).path(), CombinationSettings::default()).unwrap();
    assert!(found.model.effects.is_empty(), "{:?}", found.model.effects);
}
