//! A capture without faults: nothing is lost, and what is recorded is the joint.

use super::{SWEEP, demo, folder, plan, rig, run, truth};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tautline::bus::{Bus, Joint, Terminal, drive};
use tautline::capture::drive::{Condition, Control};
use tautline::capture::in_process::InProcess;
use tautline::capture::operator::Agrees;
use tautline::capture::plan::Plan;
use tautline::capture::rig::Rig;
use tautline::capture::session::{Task, capture};
use tautline::dynamics::{Direction, JointKind};
use tautline::identify::Settings;
use tautline::log::{Campaign, read_trial};
use tempfile::TempDir;

#[test]
fn every_cycle_of_a_trial_is_recorded_and_follows_the_command() {
    let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
    let path = out.path().join("c");
    let watched = run(demo(), &rig, &plan, Some(folder(&path, &rig, false)));
    let outcome = &watched.outcome;
    assert_eq!((outcome.cause.clone(), outcome.complete, outcome.counts.missed), (None, 2, 0));
    let campaign = Campaign::read(&path).unwrap();
    for (index, trial) in plan.trials.iter().enumerate() {
        let log = read_trial(&campaign, index).unwrap();
        let command = trial.trajectory.positions_rad(1000.0);
        assert_eq!(log.time_s.len(), command.len());
        assert!((log.rate_hz - 1000.0).abs() < 0.01, "{}", log.rate_hz);
        let off = log.position_rad.iter().zip(&command).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < rig.limits.lag_rad, "off by {off} rad");
    }
    // The operator's last sight of the drive: no voltage asked for, no torque given.
    assert_eq!(watched.control.last(), Some(&Control::DisableVoltage.word()));
    assert!(!Condition::of(*watched.status.last().unwrap()).has_torque());
}

#[test]
fn without_arming_no_word_that_gives_torque_is_sent() {
    use std::sync::atomic::AtomicBool;
    use std::sync::{Arc, Mutex};
    use tautline::capture::in_process::InProcess;
    use tautline::capture::session::{Live, Task, capture};
    let (rig, plan, mut bus) = (rig(), plan(SWEEP), demo());
    let mut words = 0;
    let answers = |now_ns: u64, frame: &[u8]| {
        let replies: Vec<_> = bus.send(now_ns, frame).into_iter().map(|r| (r.at_ns, r.frame)).collect();
        let word = bus.devices()[0].object(0x6040, 0).unwrap_or_default();
        assert_eq!(word.first(), Some(&0), "a control word other than 0");
        words += 1;
        replies
    };
    let interrupted = AtomicBool::new(false);
    let task = Task { rig: &rig, plan: &plan, armed: false, interrupted: &interrupted, operator: &Agrees };
    let outcome = capture(InProcess::new(answers), &task, None, &Arc::new(Mutex::new(Live::default()))).unwrap();
    assert_eq!((outcome.cause, outcome.doubt, outcome.complete), (None, None, 0));
    assert!(words > 1000 && outcome.looked.samples > 1000);
}

/// The demo's joint hangs at -0.018 rad, held by friction.
#[test]
fn a_joint_that_hangs_beside_its_range_is_led_into_it() {
    let rig = Rig::parse(Path::new("rig.toml"), &super::RIG.replace("low_rad = -0.1", "low_rad = 0.0")).unwrap();
    let outcome = run(demo(), &rig, &plan(SWEEP), None).outcome;
    assert_eq!((outcome.cause, outcome.complete), (None, 2));
    // Farther away than its lag it is not taken over.
    let rig = Rig::parse(Path::new("rig.toml"), &super::RIG.replace("low_rad = -0.1", "low_rad = 0.04")).unwrap();
    let watched = run(demo(), &rig, &plan(SWEEP), None);
    assert_eq!(watched.outcome.cause.map(|cause| cause.name()), Some("position"));
    assert!(!watched.control.contains(&Control::Enable.word()));
}

/// A bus without distributed clocks, and one of another cycle, of which the drive is told.
#[test]
fn other_buses_do_too() {
    for (before, after, between) in [("clocks = true", "clocks = false", 1), ("cycle_us = 1000", "cycle_us = 2000", 2)]
    {
        let rig = Rig::parse(Path::new("rig.toml"), &super::RIG.replace(before, after)).unwrap();
        let watched = run(demo(), &rig, &plan(SWEEP), None);
        assert_eq!((watched.outcome.cause, watched.outcome.complete), (None, 2), "{after}");
        let told = format!("time between targets: {between} x 10^-3 s");
        assert!(watched.outcome.report.contains(&told), "{:?}", watched.outcome.report);
    }
}

/// A bus on which no device has a clock: the stack's exchange that spreads the time of a clock never comes back from one.
#[test]
fn a_bus_without_any_clock_runs_where_the_rig_asks_for_none() {
    let bus = || {
        let devices = vec![drive(0).without_clock(), Terminal::default().device(0).without_clock()];
        Bus::new(devices).with_joint(Joint::new(truth(), 0.0, 0.005, 1))
    };
    let plan = plan(&SWEEP.replace("repeats = 2", "repeats = 1"));
    let rig = Rig::parse(Path::new("rig.toml"), &super::RIG.replace("clocks = true", "clocks = false")).unwrap();
    let outcome = run(bus(), &rig, &plan, None).outcome;
    assert_eq!((outcome.cause, outcome.complete), (None, 1));
    let (mut bus, interrupted) = (bus(), AtomicBool::new(false));
    let answers = move |now_ns: u64, frame: &[u8]| {
        bus.send(now_ns, frame).into_iter().map(|reply| (reply.at_ns, reply.frame)).collect()
    };
    let task = Task { rig: &super::rig(), plan: &plan, armed: true, interrupted: &interrupted, operator: &Agrees };
    let refused = capture(InProcess::new(answers), &task, None, &Arc::default()).unwrap_err();
    assert!(refused.0.contains("a bus without clocks takes `clocks = false`"), "{refused:?}");
}

/// In velocity and torque mode the position loop is ours.
#[test]
fn the_other_modes_follow_too() {
    let slow = SWEEP.replace("speed_rad_s = 0.4", "speed_rad_s = 0.3").replace("repeats = 2", "repeats = 1");
    for (mode, gains) in
        [("csv", "{ position_per_s = 20.0 }"), ("cst", "{ stiffness_nm_rad = 60.0, damping_nm_s_rad = 1.5 }")]
    {
        let text = super::RIG.replace("mode = \"csp\"", &format!("mode = \"{mode}\"\ngains = {gains}"));
        let rig = Rig::parse(Path::new("rig.toml"), &text).unwrap();
        let outcome = run(demo(), &rig, &plan(&slow), None).outcome;
        assert_eq!((outcome.cause, outcome.complete), (None, 1), "{mode}");
    }
}

/// The whole way: a plan, the wire, a recording, the joint's friction as it is.
#[test]
fn what_is_captured_identifies_the_joint() {
    let text = "format = \"plan/1\"\nrest_s = 0.1\n
        [[motions]]\nprotocol = \"uniform\"\nspeeds = 8\nslowest_rad_s = 0.1\nfastest_rad_s = 0.4\n
        [[motions]]\ntrajectory = \"short.toml\"\n";
    let cosine = "format = \"trajectory/1\"\nprotocol = \"cosine\"\nstart_rad = 0.4\n
        [[segments]]\nkind = \"cosine\"\nlow_rad = 0.4\nhigh_rad = 1.0\nperiod_s = 8.0\nperiods = 3\n";
    let out = TempDir::new().unwrap();
    std::fs::write(out.path().join("short.toml"), cosine).unwrap();
    std::fs::write(out.path().join("plan.toml"), text).unwrap();
    let (rig, path) = (rig(), out.path().join("c"));
    let plan = Plan::read(&out.path().join("plan.toml"), JointKind::Revolute).unwrap();
    let outcome = run(demo(), &rig, &plan, Some(folder(&path, &rig, false))).outcome;
    assert_eq!((outcome.cause, outcome.complete, outcome.counts.missed), (None, 9, 0));
    let found = crate::campaigns::identified(&path, Settings::default());
    let truth = crate::campaigns::truth();
    for direction in [Direction::Up, Direction::Down] {
        let [found, truth] = [&found.model, &truth].map(|model| *model.friction.of(direction));
        // A few times what the intervals are wide.
        assert!((found.mu_c - truth.mu_c).abs() < 0.003, "mu_c {} and not {}", found.mu_c, truth.mu_c);
        for speed_rad_s in [0.1, 0.2, 0.4] {
            let [b, known] = [found, truth].map(|friction| friction.unloaded_nm(direction, speed_rad_s, 0.012, 0.04));
            assert!((b - known).abs() < 0.003, "B({speed_rad_s}) is {b} N m and not {known}");
        }
    }
}
