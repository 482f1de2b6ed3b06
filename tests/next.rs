//! The next experiment: recorded, it tells the rivals apart; and what a campaign cannot show is said.

use crate::campaigns::{plan, record, truth};
use tautline::diagnose::{Diagnosis, Kind, run};
use tautline::effects::Added;
use tautline::log::{Campaign, Signal};
use tautline::model::{Combination, Joint, Model};
use tautline::report::diagnosis::{next_toml, sentences, to_json};
use tautline::simulate::{Plan, Sensors};
use tautline::trajectory::{Path, Protocol, Segment, Trajectory};
use tempfile::TempDir;

/// A spring and a shifted centre of mass that give the same torque and slope in the middle of the narrow motion.
const SPRING: &str = "elastic_spring:stiffness_nm_rad=0.265,preload_nm=-0.484";
const SHIFTED: &str = "gravity_phase:cos_nm=-0.4";

/// Cosines over 14 deg at three speeds.
fn narrow() -> Trajectory {
    let (low_rad, high_rad) = (0.6, 0.85);
    let cosine = |(period_s, periods): (f64, u32)| Segment::Cosine { low_rad, high_rad, period_s, periods };
    let segments = [(8.0, 2), (3.0, 3), (1.5, 4)].into_iter().map(cosine).collect();
    Trajectory {
        name: "narrow".to_string(),
        protocol: Protocol::Free,
        repeats: Some(4),
        own: Path { start_rad: low_rad, segments },
        others: Vec::new(),
    }
}

/// `trajectory` recorded from the elbow with `effects`, and diagnosed with the elbow's model.
fn diagnosed(effects: &[&str], trajectory: Trajectory, seed: u64) -> Diagnosis {
    diagnosed_with((&truth(), &truth()), 0.02, effects, trajectory, seed)
}

/// The same for a joint like the first model, diagnosed with the second, with so much noise.
pub fn diagnosed_with(
    (like, model): (&Model, &Model),
    torque_noise_nm: f64,
    effects: &[&str],
    trajectory: Trajectory,
    seed: u64,
) -> Diagnosis {
    let mut joint = like.clone();
    joint.effects.extend(effects.iter().map(|text| Added::parse(text).unwrap()));
    let sensors = Sensors { torque_noise_nm, encoder_counts: 0.0 };
    let signal = Signal { torque_sign: -1.0, lowpass_hz: 3.0, lowpass_order: 4 };
    let wanted = Plan { speeds: 0, trajectories: vec![trajectory], rate_hz: 100.0, sensors, signal, seed, ..plan() };
    let folder = record(&joint, &wanted);
    run(&Campaign::read(folder.path()).unwrap(), model, &|_| ()).unwrap()
}

fn named(found: &Diagnosis) -> (Kind, Vec<&'static str>) {
    (found.verdict.kind, found.verdict.effects.iter().map(|cause| cause.name()).collect())
}

/// The proposed motion, by way of its file.
fn proposed(found: &Diagnosis) -> Trajectory {
    let folder = TempDir::new().unwrap();
    let file = folder.path().join("next_experiment.toml");
    std::fs::write(&file, next_toml(found).unwrap()).unwrap();
    let read = Trajectory::read(&file).unwrap();
    assert_eq!(Some(&read), found.next.as_ref().unwrap().trajectory.as_ref());
    read
}

fn resolves(truth: &'static str) {
    let tied = diagnosed(&[truth], narrow(), 1);
    let (kind, mut rivals) = named(&tied);
    rivals.sort_unstable();
    assert_eq!((kind, &rivals[..]), (Kind::Ambiguous, &["elastic_spring", "gravity_phase"][..]));
    let next = tied.next.as_ref().unwrap();
    assert!(next.difference_over_floor.unwrap() > 1.0, "{next:?}");
    assert_eq!(next.separates.len(), 2);
    let id = truth.split(':').next().unwrap();
    assert_eq!(named(&diagnosed(&[truth], proposed(&tied), 2)), (Kind::Effect, vec![id]));
}

#[test]
fn the_proposed_motion_finds_the_spring() {
    resolves(SPRING);
}

#[test]
fn the_proposed_motion_finds_the_shifted_mass() {
    resolves(SHIFTED);
}

#[test]
fn what_one_load_hides_is_said_with_a_motion_that_shows_it() {
    let found = diagnosed(&[], narrow(), 3);
    assert_eq!(found.verdict.kind, Kind::None);
    let spot = found.blind_spots.iter().find(|spot| spot.hides.contains(&"load_dependent_friction")).unwrap();
    assert!(spot.what.starts_with("one load only"), "{}", spot.what);
    assert!(sentences(&found).iter().any(|line| line.contains("load dependence cannot be detected")));
    let wide = diagnosed(&[], proposed(&found), 4);
    assert!(wide.blind_spots.iter().all(|spot| !spot.what.contains("load") && !spot.what.contains("way")));
}

#[test]
fn what_no_motion_tells_apart_is_left_to_a_hand() {
    let wide = Trajectory {
        own: Path {
            start_rad: 0.1,
            segments: [(20.0, 1), (6.0, 2), (3.0, 3)]
                .into_iter()
                .map(|(period_s, periods)| Segment::Cosine { low_rad: 0.1, high_rad: 1.4, period_s, periods })
                .collect(),
        },
        ..narrow()
    };
    let found = diagnosed(&["sensor_bias:bias_nm=0.05"], wide, 5);
    let (kind, mut rivals) = named(&found);
    rivals.sort_unstable();
    assert_eq!((kind, &rivals[..]), (Kind::Ambiguous, &["coulomb", "sensor_bias"][..]));
    assert_eq!(next_toml(&found), None);
    let told = to_json(&found, "", "");
    assert!(told["next_experiment"]["trajectory_file"].is_null());
    let instruction = told["next_experiment"]["instruction"].as_str().unwrap();
    assert!(instruction.contains("take the cable off"), "{instruction}");
}

/// A few sweeps leave open how friction changes over, whether the joint's clearance is known or not.
#[test]
fn a_verdict_that_rests_on_being_simplest_says_what_would_settle_it() {
    let with_clearance = |backlash_m: f64| {
        let joint = Joint { backlash_m, ..truth().joint };
        Model { joint, combination: Combination::Sign, ..truth() }
    };
    let (jumps, measured) = (with_clearance(0.0), with_clearance(0.0016));
    let sweep = |(to_rad, speed_rad_s)| Segment::Sweep { to_rad, speed_rad_s, acceleration_rad_s2: 4.0 };
    let segments = [(1.2, 0.4), (0.2, 0.4), (1.2, 0.8), (0.2, 0.8)].into_iter().map(sweep).collect();
    let few = Trajectory { own: Path { start_rad: 0.2, segments }, repeats: Some(3), ..narrow() };
    let passes = "reversal_transition:backlash_m=0.0016,p=2,n=1";
    let known = diagnosed_with((&measured, &measured), 0.1, &[passes], few.clone(), 7);
    assert_eq!(known.verdict.kind, Kind::Ambiguous);
    let open = diagnosed_with((&jumps, &jumps), 0.1, &[passes], few, 7);
    let next = open.next.as_ref().unwrap();
    let both = ["presliding", "reversal_transition"];
    assert_eq!((named(&open), &next.separates[..]), ((Kind::Ambiguous, both.to_vec()), &both[..]));
    let settled = diagnosed_with((&jumps, &jumps), 0.1, &[passes], proposed(&open), 8);
    assert_eq!(named(&settled), (Kind::Effect, vec!["reversal_transition"]));
}
