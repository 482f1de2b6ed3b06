//! A joint under a controller: it follows, within its motor's limit; its torques and energy add up; friction holds it at rest.

use crate::campaigns::{plan, truth};
use crate::cli::tautline;
use crate::effects::example;
use crate::simulate::{free, left_nm, mixed, range_nm, trials};
use std::f64::consts::TAU;
use tautline::log::Campaign;
use tautline::model::{Both, Combination, Friction, Model};
use tautline::simulate::{Controller, Plan, Wanted};
use tautline::trajectory::{Path, Segment, Trajectory, Wave};
use tempfile::TempDir;

/// A log's columns.
struct Log {
    time_s: Vec<f64>,
    position_rad: Vec<f64>,
    torque_nm: Vec<f64>,
    command_rad: Vec<f64>,
}

impl Log {
    /// How far the joint is from its command, rad: root mean square.
    fn missed_rad(&self) -> f64 {
        let squares = self.position_rad.iter().zip(&self.command_rad).map(|(x, wanted)| (x - wanted).powi(2));
        (squares.sum::<f64>() / self.time_s.len() as f64).sqrt()
    }

    /// Times that the motion turns round.
    fn turns(&self) -> usize {
        let steps: Vec<f64> =
            self.position_rad.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| step.abs() > 1e-7).collect();
        steps.windows(2).filter(|pair| pair[0] * pair[1] < 0.0).count()
    }
}

/// `model` driven through `trajectory` by a controller as `wanted` that knows it as `known`.
fn driven(model: &Model, known: &Model, wanted: Wanted, trajectory: Trajectory) -> Log {
    let controller = Some(Controller::new(wanted, model, known, None).unwrap());
    let plan = Plan { speeds: 0, repeats: 1, trajectories: vec![trajectory], rate_hz: 1000.0, controller, ..plan() };
    let bytes = plan.log_bytes(model, &plan.trials(model.joint.kind)[0]).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let rows: Vec<Vec<f64>> =
        text.lines().skip(1).map(|line| line.split(',').map(|x| x.parse().unwrap()).collect()).collect();
    assert_eq!(text.lines().next(), Some("time_s,position_deg,torque_nm,command_deg"));
    let column = |at: usize, factor: f64| rows.iter().map(|row| factor * row[at]).collect();
    let rad = 1f64.to_radians();
    Log {
        time_s: column(0, 1.0),
        position_rad: column(1, rad),
        torque_nm: column(2, -1.0),
        command_rad: column(3, rad),
    }
}

fn alone(model: &Model, wanted: Wanted, trajectory: Trajectory) -> Log {
    driven(model, model, wanted, trajectory)
}

/// The elbow without friction.
fn free_of_friction() -> Model {
    let none = Friction::default();
    Model { friction: Both { up: none, down: none }, combination: Combination::Sign, ..truth() }
}

fn held(start_rad: f64, duration_s: f64) -> Trajectory {
    Trajectory { own: Path { start_rad, segments: vec![Segment::Rest { duration_s }] }, ..mixed() }
}

/// Work at the joint over the log, N m.
fn work_nm(model: &Model, log: &Log) -> f64 {
    let (x, y) = (&log.position_rad, &log.torque_nm);
    let step = |i: usize| (x[i] - x[i - 1]) * (y[i] + y[i - 1]) / 2.0;
    (1..x.len()).map(step).sum::<f64>() / model.joint.transmission()
}

/// Weight and motion, N m, from where the joint hangs.
fn energy_nm(model: &Model, log: &Log, at: usize) -> f64 {
    let speed_rad_s = (log.position_rad[at + 1] - log.position_rad[at - 1]) * 500.0;
    let dynamics = &model.dynamics;
    dynamics.gravity_nm * (1.0 - log.position_rad[at].cos()) + dynamics.inertia_kg_m2 * speed_rad_s.powi(2) / 2.0
}

#[test]
fn it_follows_a_command_and_better_what_it_knows() {
    let blind = alone(&truth(), Wanted::default(), mixed());
    // The default stiffness lets weight and friction deflect it by 0.01 rad.
    assert!((0.001..0.012).contains(&blind.missed_rad()), "{} rad", blind.missed_rad());
    let knowing = Wanted { feedforward: true, ..Wanted::default() };
    let informed = alone(&truth(), knowing, mixed());
    assert!(informed.missed_rad() < blind.missed_rad() / 50.0, "{} rad", informed.missed_rad());
    // What it does not know shows in the motion.
    let spring = Model { effects: vec![example("elastic_spring")], ..truth() };
    let surprised = driven(&spring, &truth(), knowing, mixed());
    assert!(surprised.missed_rad() > 20.0 * informed.missed_rad(), "{} rad", surprised.missed_rad());
}

#[test]
fn its_torque_is_what_the_model_predicts_for_its_motion() {
    for id in [None, Some("torque_ripple"), Some("presliding"), Some("time_delay"), Some("warm_up"), Some("inertia")] {
        let model = Model { effects: id.map(example).into_iter().collect(), ..truth() };
        let wanted = Wanted { motor_inertia_kg_m2: 1e-4, ..Wanted::default() };
        let controller = Some(Controller::new(wanted, &model, &truth(), None).unwrap());
        let folder = crate::campaigns::record(&model, &Plan { controller, ..free() });
        for trial in trials(folder.path()) {
            let left = left_nm(&model, &trial) / range_nm(&trial);
            assert!(left < 0.003, "{id:?}: {left} of the torque's range");
        }
    }
}

#[test]
fn the_motor_gives_no_more_than_its_limit() {
    let needed_nm = alone(&truth(), Wanted::default(), mixed()).torque_nm.iter().fold(0.0, |most: f64, y| most.max(*y));
    let limit_nm = 0.8 * needed_nm;
    let log = alone(&truth(), Wanted { torque_limit_nm: Some(limit_nm), ..Wanted::default() }, mixed());
    assert!(log.torque_nm.iter().all(|y| y.abs() <= limit_nm + 1e-9));
    let at_limit = log.torque_nm.iter().filter(|y| (**y - limit_nm).abs() < 1e-9).count();
    assert!(at_limit > 1000, "{at_limit} samples at the limit");
    assert!(log.missed_rad() > 0.02, "missed by {} rad only", log.missed_rad());
}

#[test]
fn a_joint_let_go_swings_and_gains_nothing() {
    let model = free_of_friction();
    let log = alone(&model, Wanted { torque_limit_nm: Some(1e-9), ..Wanted::default() }, held(0.5, 5.0));
    let first_nm = energy_nm(&model, &log, 1);
    let mut most_nm = first_nm;
    for at in (1..log.time_s.len() - 1).step_by(10) {
        let now_nm = energy_nm(&model, &log, at);
        assert!(now_nm < 1.001 * most_nm, "gains at {} s: {now_nm} of {first_nm} N m", log.time_s[at]);
        most_nm = most_nm.min(now_nm.max(0.999 * most_nm));
    }
    // Steps of 0.25 ms taken at their ends cost 1.4 % a second at 1.2 Hz.
    let last_nm = energy_nm(&model, &log, log.time_s.len() - 2);
    assert!(last_nm > 0.9 * first_nm, "{last_nm} of {first_nm} N m are left");
    // It swings as a pendulum of 1.2 Hz does: turns about twice in each period.
    let period_s = TAU * (model.dynamics.inertia_kg_m2 / model.dynamics.gravity_nm).sqrt();
    let turns = 2.0 * 5.0 / period_s;
    assert!((log.turns() as f64 - turns).abs() < 1.5, "{} turns for {turns}", log.turns());
}

#[test]
fn work_goes_into_weight_and_friction() {
    let up = Segment::Sweep { to_rad: 1.2, speed_rad_s: 0.5, acceleration_rad_s2: 4.0 };
    let segments = vec![up, Segment::Rest { duration_s: 1.0 }];
    let lifted = Trajectory { own: Path { start_rad: 0.2, segments }, ..mixed() };
    let (smooth, rough) = (free_of_friction(), truth());
    let log = alone(&smooth, Wanted::default(), lifted.clone());
    let (first, last) = (1, log.time_s.len() - 2);
    let gained_nm = energy_nm(&smooth, &log, last) - energy_nm(&smooth, &log, first);
    assert!((work_nm(&smooth, &log) / gained_nm - 1.0).abs() < 0.002, "{} for {gained_nm}", work_nm(&smooth, &log));
    let with_friction_nm = work_nm(&rough, &alone(&rough, Wanted::default(), lifted));
    assert!(with_friction_nm > 2.0 * gained_nm, "{with_friction_nm} for {gained_nm}");
}

#[test]
fn friction_that_jumps_holds_the_joint_and_does_not_chatter() {
    let jumping = [
        Model { combination: Combination::Sign, ..truth() },
        Model { joint: tautline::model::Joint { backlash_m: 0.0, ..truth().joint }, ..truth() },
    ];
    for model in jumping {
        let wave = |amplitude_rad| {
            let waves = vec![Wave { amplitude_rad, frequency_hz: 0.5, phase_rad: 0.0 }];
            let segments = vec![Segment::Multisine { duration_s: 8.0, fade_s: 1.0, waves }];
            Trajectory { own: Path { start_rad: 0.7, segments }, ..mixed() }
        };
        // It begins where friction just holds it, so that the first waves push it up. From there friction
        // holds it: no wave moves it by a thousandth of itself ...
        let small = alone(&model, Wanted::default(), wave(0.001));
        let rests = &small.position_rad[3000..];
        assert!(rests.iter().all(|x| (x - rests[0]).abs() < 1e-6), "it creeps");
        // ... and above it turns when the command does: two times a period, none in between.
        let large = alone(&model, Wanted::default(), wave(0.1));
        assert!((6..=8).contains(&large.turns()), "{} turns", large.turns());
        let still = large.position_rad.windows(2).filter(|pair| pair[0] == pair[1]).count();
        assert!(still > 200, "it sticks for {still} samples only");
    }
}

#[test]
fn the_command_line_closes_the_loop() {
    let folder = TempDir::new().unwrap();
    let at = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let simulate = |to: &str, more: &[&str]| {
        let fixed = ["simulate", "--model", "data/elbow/truth/model.json", "-o", to, "--closed-loop", "--quiet"];
        tautline(
            &[&fixed[..], &["--speeds", "2", "--repeats", "1", "--cosines", "1", "--rate-hz", "100"], more].concat(),
        )
    };
    assert!(simulate(&at("a"), &["--motor-inertia-kg-m2", "1e-4", "--torque-limit-nm", "2"]).status.success());
    assert!(tautline(&["validate", &at("a")]).status.success());
    let campaign = Campaign::read(&folder.path().join("a")).unwrap();
    assert_eq!(campaign.trials.len(), 3);
    let log = std::fs::read_to_string(folder.path().join("a/cosine_1.csv")).unwrap();
    assert!(log.starts_with("time_s,position_deg,torque_nm,command_deg\n"));
    let stiff = simulate(&at("b"), &["--stiffness-nm-rad", "400", "--damping-nm-s-rad", "10", "--feedforward"]);
    assert!(stiff.status.success(), "{stiff:?}");
}
