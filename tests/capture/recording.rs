//! What is on the disk, whatever happens.

use super::{AT, SWEEP, demo, folder, plan, rig, run};
use std::fs;
use tautline::bus::{Fault, When};
use tautline::capture::recorder::{Recorder, Sample};
use tautline::log::{Campaign, Captured, read_trial};
use tempfile::TempDir;

#[test]
fn a_capture_that_broke_off_goes_on_with_the_next_trial() {
    let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
    let path = out.path().join("c");
    let mut bus = demo();
    bus.inject(Fault::Drive { code: 0x2310 }, When::Cycle(*AT));
    let broken = run(bus, &rig, &plan, Some(folder(&path, &rig, false))).outcome;
    assert_eq!((broken.complete, broken.cause.map(|cause| cause.name())), (0, Some("drive_fault")));
    let resumed = run(demo(), &rig, &plan, Some(folder(&path, &rig, true))).outcome;
    assert_eq!((resumed.complete, resumed.before, resumed.broken_before, resumed.cause), (1, 1, 1, None));
    let campaign = Campaign::read(&path).unwrap();
    let incomplete: Vec<bool> = campaign.trials.iter().map(|trial| trial.is_incomplete()).collect();
    assert_eq!(incomplete, [true, false]);
    assert!((0..2).all(|index| read_trial(&campaign, index).is_ok()));
    // What the bus told of itself, trial by trial.
    let evidence = fs::read_to_string(path.join("evidence.jsonl")).unwrap();
    let lines: Vec<serde_json::Value> = evidence.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let trials: Vec<&str> = lines.iter().map(|line| line["trial"].as_str().unwrap()).collect();
    assert_eq!(trials, ["sweep_0.4000_1.csv", "sweep_0.4000_2.csv"]);
    assert_eq!(lines[0]["devices"][0]["emergencies"], serde_json::json!([0x2310]));
    let device = &lines[1]["devices"][1];
    assert_eq!((&device["device"], &device["emergencies"]), (&"`torque terminal`".into(), &serde_json::json!([])));
    assert!(
        device["clock_difference_ns"].as_u64().unwrap() < 1000
            && device["receive_errors"].as_array().unwrap().len() == 4
    );
}

#[test]
fn a_recording_cut_anywhere_opens() {
    let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
    let path = out.path().join("c");
    let mut bus = demo();
    bus.inject(Fault::Lost { frames: 10 }, When::Cycle(*AT + 500));
    run(bus, &rig, &plan, Some(folder(&path, &rig, false)));
    let log = path.join("sweep_0.4000_1.csv");
    let whole = fs::read(&log).unwrap();
    let rows = |bytes: &[u8]| bytes.iter().filter(|byte| **byte == b'\n').count() - 1;
    for cut in [whole.len() - 1, whole.len() - 7, whole.len() - 60, whole.len() - 131, whole.len() / 2] {
        // As a killed process leaves it, and as a power cut does.
        for tail in [&b""[..], &[0; 512]] {
            fs::write(&log, [&whole[..cut], tail].concat()).unwrap();
            let campaign = Campaign::read(&path).unwrap();
            assert_eq!(read_trial(&campaign, 0).unwrap().time_s.len(), rows(&whole[..cut]), "cut at {cut}");
        }
    }
    // What is too short for anything is left out, and said.
    fs::write(&log, &whole[..2000]).unwrap();
    let refused = tautline::prepare::read_campaign(&path).unwrap_err().to_string();
    assert!(refused.contains("broke off too early"), "{refused}");
}

#[test]
fn resuming_by_another_plan_is_refused() {
    let (rig, out) = (rig(), TempDir::new().unwrap());
    let path = out.path().join("c");
    drop(folder(&path, &rig, false));
    let other = [("rig.toml", super::RIG), ("plan.toml", "format = \"plan/1\"")];
    let refused = tautline::capture::folder::Folder::resume(&path, &rig, &other).unwrap_err().to_string();
    assert!(refused.contains("not what the capture began with"), "{refused}");
    let twice = tautline::capture::folder::Folder::create(&path, &rig, &other).unwrap_err().to_string();
    assert!(twice.contains("--resume"), "{twice}");
}

/// `/dev/full` is a disk without room.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_stops_the_joint_and_is_named() {
    let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
    let path = out.path().join("c");
    let folder = folder(&path, &rig, false);
    std::os::unix::fs::symlink("/dev/full", path.join("sweep_0.4000_2.csv")).unwrap();
    let outcome = run(demo(), &rig, &plan, Some(folder)).outcome;
    assert_eq!((outcome.complete, outcome.cause.map(|cause| cause.name())), (1, Some("recording")));
    assert!(outcome.unwritten.unwrap().contains("No space left"));
    let campaign = Campaign::read(&path).unwrap();
    assert!(!campaign.trials[0].is_incomplete() && read_trial(&campaign, 0).is_ok());
}

/// A disk that is away holds nothing up: the drive must still be told to stop. A pipe that nobody reads is such a disk.
#[test]
#[cfg(target_os = "linux")]
fn a_disk_that_hangs_holds_nothing_up() {
    let (rig, plan, out) = (rig(), plan(SWEEP), TempDir::new().unwrap());
    let path = out.path().join("c");
    let folder = folder(&path, &rig, false);
    let entry = plan.trials[0].entry.clone();
    let log = path.join(&entry.file);
    assert!(std::process::Command::new("mkfifo").arg(&log).status().unwrap().success());
    let (done, is_done) = std::sync::mpsc::channel();
    let thread = std::thread::spawn(move || {
        let mut recorder = Recorder::new(folder, false);
        recorder.begin(entry);
        for cycle in 0..10_000 {
            recorder.record(Sample { cycle, ..SAMPLE });
        }
        recorder.note("stopped".to_string());
        recorder.end(Captured::default());
        done.send(recorder.failed()).unwrap();
        recorder.finish()
    });
    // Long enough for any machine; a recorder that waits for the disk never comes.
    let failed = is_done.recv_timeout(std::time::Duration::from_secs(60)).expect("the recorder waits for the disk");
    assert_eq!(failed.as_deref(), Some("the disk is too slow"));
    drop(fs::File::open(&log).unwrap());
    thread.join().unwrap();
    assert!(fs::read_to_string(path.join("capture.log")).unwrap().contains("stopped"));
}

const SAMPLE: Sample = Sample {
    time_s: 0.0,
    cycle: 0,
    state: "moving",
    working_counter: 4,
    position_rad: 0.0,
    torque_nm: 0.0,
    command_rad: 0.0,
    bus_time_s: 0.0,
    status_word: 0,
    sensor_status: 0,
    sensor_counts: 0.0,
    drive_torque_nm: 0.0,
    extras: [None; 2],
};
