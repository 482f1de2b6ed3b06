//! Judging a model: no artefact of our own, the right figures, the wrong model refused.

use crate::campaigns::{plan, record, truth};
use std::path::Path;
use tautline::evaluate::{Evaluation, Settings, run};
use tautline::log::table::{Numbers, csv_bytes};
use tautline::log::{Campaign, read_trial};
use tautline::model::{Combination, Model, recorded_curves};
use tautline::numerics::filter::LowPass;
use tautline::predict::Prediction;
use tautline::prepare::prepare;
use tautline::simulate::{Course, Plan, Sensors};
use tempfile::TempDir;

/// Noise of the torque sensor, N m.
const NOISE_NM: f64 = 0.02;
/// The stable-state RMSE of a correct model equals the filtered noise within this share.
const STABLE: f64 = 0.1;
/// In transitions it is no larger than this many times that.
const TRANSITION: f64 = 1.5;

fn noisy() -> Sensors {
    Sensors { torque_noise_nm: NOISE_NM, encoder_counts: 524_288.0 }
}

fn judged(folder: &Path, model: &Model) -> Evaluation {
    run(&Campaign::read(folder).unwrap(), model, &Settings::default(), &|| ()).unwrap()
}

/// What a 4th-order zero-phase low-pass at 5 Hz leaves of white noise at `rate_hz`, as a share of it.
fn noise_left(rate_hz: f64) -> f64 {
    let mut impulse = vec![0.0; 4001];
    impulse[2000] = 1.0;
    LowPass::new(4, 5.0, rate_hz).unwrap().zero_phase(&impulse).iter().map(|h| h * h).sum::<f64>().sqrt()
}

fn assert_only_noise(found: &Evaluation, rate_hz: f64) {
    let floor_nm = NOISE_NM * noise_left(rate_hz);
    let overall = found.overall();
    let stable = overall.stable.rmse_nm / floor_nm;
    assert!((stable - 1.0).abs() < STABLE, "stable state: {stable} of the noise");
    let transition = overall.transition.rmse_nm / floor_nm;
    assert!(overall.transition.samples > 500 && transition < TRANSITION, "transition: {transition} of the noise");
}

#[test]
fn a_correct_model_leaves_only_the_noise() {
    let folder = record(&truth(), &Plan { speeds: 0, cosines: 2, rate_hz: 1000.0, sensors: noisy(), ..plan() });
    assert_only_noise(&judged(folder.path(), &truth()), 1000.0);
}

/// A campaign with one trial along `positions_rad`.
fn one_trial(positions_rad: Vec<f64>, rate_hz: f64, sensors: Sensors) -> TempDir {
    let folder = record(&truth(), &Plan { speeds: 0, cosines: 1, rate_hz, ..plan() });
    let course = Course { position_rad: positions_rad, ..Course::default() };
    let made = tautline::simulate::record(&truth(), None, &course, rate_hz, sensors, 7);
    let torque: Vec<f64> = made.torque_nm.iter().map(|y| -y).collect();
    let position: Vec<f64> = made.position_rad.iter().map(|x| x.to_degrees()).collect();
    let column = |name, values| Numbers { name, values, decimals: 9 };
    let bytes =
        csv_bytes(&[column("time_s", &made.time_s), column("position_deg", &position), column("torque_nm", &torque)]);
    std::fs::write(folder.path().join("cosine_1.csv"), bytes).unwrap();
    folder
}

/// A slow motion up and down whose direction changes again and again inside the clearance of 0.02 rad.
fn partial_reversals(rate_hz: f64) -> Vec<f64> {
    let wiggle = |t: f64| 0.006 * (std::f64::consts::TAU * t / 3.0).sin();
    let slow = |t: f64| 0.6 - 0.25 * (std::f64::consts::TAU * t / 120.0).cos();
    (0..(240.0 * rate_hz) as usize).map(|i| i as f64 / rate_hz).map(|t| slow(t) + wiggle(t)).collect()
}

#[test]
fn reversals_inside_a_transition_stay_continuous() {
    let rate_hz = 1000.0;
    let folder = one_trial(partial_reversals(rate_hz), rate_hz, noisy());
    assert_only_noise(&judged(folder.path(), &truth()), rate_hz);
    // The whole change of friction is 1.2 N m; a jump would be a share of it between two samples.
    let campaign = Campaign::read(folder.path()).unwrap();
    let trial = prepare(&campaign, 0, read_trial(&campaign, 0).unwrap()).unwrap();
    let prediction = Prediction::new(&truth(), &trial);
    let inside = prediction.states.k_tilde.iter().filter(|k| **k > 0.05 && **k < 0.95).count();
    assert!(inside > 20_000, "the motion does not turn inside the clearance: {inside}");
    let largest = prediction.torque_nm.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    assert!(largest < 0.05, "the prediction jumps by {largest} N m");
}

#[test]
fn a_log_that_begins_at_a_reversal_shows_no_start() {
    // Cut where the motion turns, K_f is on the wrong side at first; what the low-pass makes of that is in no figure.
    let rate_hz = 200.0;
    let turn = |t: f64| 0.7 - 0.3 * (std::f64::consts::TAU * t / 8.0).cos();
    let whole: Vec<f64> = (0..(40.0 * rate_hz) as usize).map(|i| turn(i as f64 / rate_hz)).collect();
    let folder = one_trial(whole, rate_hz, Sensors { torque_noise_nm: 0.0, encoder_counts: 524_288.0 });
    let file = folder.path().join("cosine_1.csv");
    let text = std::fs::read_to_string(&file).unwrap();
    let cut: Vec<&str> = text.lines().take(1).chain(text.lines().skip(1 + (4.0 * rate_hz) as usize)).collect();
    std::fs::write(&file, cut.join("\n")).unwrap();
    let found = judged(folder.path(), &truth());
    let peak_nm = found.overall().stable.peak_nm;
    assert!(peak_nm < 0.01, "the start leaves {peak_nm} N m in stable state");
}

#[test]
fn the_parts_add_up_to_the_prediction() {
    let folder = record(&truth(), &Plan { speeds: 2, cosines: 1, sensors: noisy(), ..plan() });
    let campaign = Campaign::read(folder.path()).unwrap();
    for index in 0..campaign.trials.len() {
        let trial = prepare(&campaign, index, read_trial(&campaign, index).unwrap()).unwrap();
        let p = Prediction::new(&truth(), &trial);
        for i in 0..p.torque_nm.len() {
            let sum = p.gravity_nm[i] + p.inertia_nm[i] + p.coriolis_nm[i] + p.load_nm[i] + p.friction_nm[i];
            assert!((sum - p.torque_nm[i]).abs() < 1e-12);
        }
    }
}

#[test]
fn the_curves_are_told_apart_in_transitions_alone() {
    let folder = record(&truth(), &Plan { speeds: 0, cosines: 1, sensors: noisy(), ..plan() });
    let found = judged(folder.path(), &truth());
    let of = |name: &str| {
        let at = found.rivals.iter().position(|r| r.kind.name() == name).unwrap();
        found.together(|t| &t.rivals[at])
    };
    let (sign, linear, arctan, power) = (of("sign"), of("linear"), of("arctan"), of("power"));
    assert!(arctan.transition.rmse_nm < 0.2 * power.transition.rmse_nm);
    assert!(power.transition.rmse_nm < linear.transition.rmse_nm);
    assert!(linear.transition.rmse_nm < sign.transition.rmse_nm);
    assert!(sign.all.peak_nm > 1.0, "without any coefficient the peak is the whole change of friction");
    assert!(linear.stable.rmse_nm < 2.0 * arctan.stable.rmse_nm);
    assert_eq!(arctan.all, found.overall().all);
}

/// What the base model leaves of each run by SciPy, N m (`scripts/reference/davinci.py`).
const DAVINCI_BASE_NM: [(&str, f64); 6] = [
    ("run_02.csv", 15.53e-3),
    ("run_06.csv", 22.80e-3),
    ("run_21.csv", 21.48e-3),
    ("run_25.csv", 16.59e-3),
    ("run_43.csv", 22.25e-3),
    ("run_47.csv", 22.63e-3),
];

#[test]
fn the_davinci_base_model_is_judged_as_scipy_does() {
    let model = Path::new("data/davinci_l4/base_model.json");
    let found = judged(Path::new("data/davinci_l4"), &Model::read(model).unwrap());
    for (file, rmse_nm) in DAVINCI_BASE_NM {
        let run = found.trials.iter().find(|trial| trial.entry.file == file).unwrap();
        let ratio = run.filtered.all.rmse_nm / rmse_nm;
        assert!((ratio - 1.0).abs() < 0.02, "{file}: {ratio} of SciPy's");
    }
    assert_eq!(recorded_curves(model).unwrap(), vec![]);
}

#[test]
fn curves_of_the_identification_are_compared_with_their_own_parameters() {
    let folder = record(&truth(), &Plan { cosines: 1, sensors: noisy(), ..plan() });
    let identified = crate::campaigns::identified(folder.path(), tautline::identify::Settings::default());
    let file = folder.path().join("model.json");
    let json = tautline::report::identification::to_json(&identified, "elbow");
    std::fs::write(&file, tautline::report::json_text(&json)).unwrap();
    let recorded_curves = recorded_curves(&file).unwrap();
    let power = recorded_curves.iter().find(|r| r.curve.name() == "power").unwrap();
    let settings = Settings { recorded_curves: recorded_curves.clone(), ..Settings::default() };
    let campaign = Campaign::read(folder.path()).unwrap();
    let found = run(&campaign, &identified.model, &settings, &|| ()).unwrap();
    let rival = found.rivals.iter().find(|r| r.kind.name() == "power").unwrap();
    assert_eq!((rival.curve, rival.source.name()), (power.curve, "identification"));
    assert!(matches!(rival.curve, Combination::Power { n } if n < 1.0));
}

#[test]
fn another_joints_model_is_refused() {
    let folder = record(&truth(), &Plan { speeds: 0, cosines: 1, ..plan() });
    let campaign = Campaign::read(folder.path()).unwrap();
    let refused = |change: &dyn Fn(&mut Model)| {
        let mut model = truth();
        change(&mut model);
        run(&campaign, &model, &Settings::default(), &|| ()).unwrap_err().to_string()
    };
    assert!(refused(&|m| m.joint.name = "knee".to_string()).contains("joint `knee`, the campaign joint `elbow`"));
    assert!(refused(&|m| m.joint.winch_radius_m = 0.02).contains("`joint.winch_radius_m`"));
    assert!(refused(&|m| m.joint.pulley_radius_m = 0.05).contains("`joint.pulley_radius_m`"));
}
