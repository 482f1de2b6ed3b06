//! A capture without faults: nothing is lost, and what is recorded is the joint.

use super::{SWEEP, demo, folder, plan, rig, run};
use tautline::capture::drive::{Condition, Control};
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
    let task = Task { rig: &rig, plan: &plan, armed: false, interrupted: &interrupted };
    let outcome = capture(InProcess::new(answers), &task, None, &Arc::new(Mutex::new(Live::default()))).unwrap();
    assert_eq!((outcome.cause, outcome.doubt, outcome.complete), (None, None, 0));
    assert!(words > 1000 && outcome.looked.samples > 1000);
}
