//! Damaged, glitched and copied recordings: each fault is told, mended where a straight line does no harm, refused where nothing
//! helps, and never passes for a good recording.

use crate::campaigns::{identified, plan, record, truth};
use std::fmt::Write;
use std::path::Path;
use std::sync::OnceLock;
use tautline::identify::{Identification, Settings, run};
use tautline::log::{Campaign, Consequence, Finding, Kind, read_trial};
use tautline::model::Status;
use tautline::problem::Problems;
use tautline::simulate::{Plan, Sensors};
use tempfile::TempDir;

/// The bundled elbow's sweeps from this speed on, rad/s: the slow ones are long.
const SLOWEST_RAD_S: f64 = 0.1;

/// One trial's samples: time, s; position, deg; torque as recorded, N m.
type Samples = Vec<[f64; 3]>;

/// A sweep: file, speed in rad/s, number of the repeat, samples.
type Sweep = (String, f64, u32, Samples);

/// The head of the bundled elbow's `campaign.toml`, and its faster sweeps.
fn elbow() -> &'static (String, Vec<Sweep>) {
    static READ: OnceLock<(String, Vec<Sweep>)> = OnceLock::new();
    READ.get_or_init(|| {
        let campaign = Campaign::read(Path::new("data/elbow")).unwrap();
        let text = std::fs::read_to_string("data/elbow/campaign.toml").unwrap();
        let head = text.split("[[trials]]").next().unwrap().to_string();
        let fast = |index: &usize| campaign.trials[*index].protocol.speed_rad_s().is_some_and(|v| v > SLOWEST_RAD_S);
        let read = |index: usize| {
            let log = read_trial(&campaign, index).unwrap();
            let sample = |i: usize| {
                [log.time_s[i], log.position_rad[i].to_degrees(), campaign.signal.torque_sign * log.torque_nm[i]]
            };
            let entry = &campaign.trials[index];
            let file = entry.file.replace(".parquet", ".csv");
            (file, entry.protocol.speed_rad_s().unwrap(), entry.repeat, (0..log.time_s.len()).map(sample).collect())
        };
        (head, (0..campaign.trials.len()).filter(fast).map(read).collect())
    })
}

/// Those sweeps with what `change` makes of each trial's samples, as a campaign; `copies` more entries of each trial.
fn damaged(copies: u32, change: impl Fn(usize, &mut Samples)) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let (head, trials) = elbow();
    let mut toml = head.clone();
    for (index, (file, speed_rad_s, repeat, samples)) in trials.iter().enumerate() {
        let mut samples = samples.clone();
        change(index, &mut samples);
        let mut text = "time_s,position_deg,torque_nm\n".to_string();
        for [time_s, position_deg, torque_nm] in samples {
            writeln!(text, "{time_s},{position_deg},{torque_nm}").unwrap();
        }
        for copy in 0..=copies {
            let file = format!("{copy}_{file}");
            let repeat = repeat + 100 * copy;
            std::fs::write(folder.path().join(&file), &text).unwrap();
            write!(toml, "[[trials]]\nfile = \"{file}\"\nprotocol = \"uniform\"\nspeed_rad_s = {speed_rad_s}\nrepeat = {repeat}\n\n")
                .unwrap();
        }
    }
    std::fs::write(folder.path().join("campaign.toml"), toml).unwrap();
    folder
}

fn healthy() -> &'static Identification {
    static FOUND: OnceLock<Identification> = OnceLock::new();
    FOUND.get_or_init(|| identified(damaged(0, |_, _| ()).path(), Settings::default()))
}

fn refusals(folder: &Path) -> String {
    let found = run(&Campaign::read(folder).unwrap(), Settings::default(), &|| ());
    found.map(|_| ()).unwrap_err().to_string()
}

fn findings(folder: &Path) -> Vec<Finding> {
    let campaign = Campaign::read(folder).unwrap();
    (0..campaign.trials.len()).flat_map(|index| read_trial(&campaign, index).unwrap().findings).collect()
}

fn pinned(found: &Identification) -> Vec<&String> {
    found.model.confidence.iter().filter(|(_, known)| known.status == Status::Pinned).map(|(name, _)| name).collect()
}

/// That `found` is what the healthy campaign gives, to `share` of the half width of each interval.
#[track_caller]
fn assert_unmoved(found: &Identification, share: f64) {
    for name in pinned(healthy()).into_iter().filter(|name| name.starts_with("friction")) {
        let (good, now) = (healthy().model.confidence[name], found.model.confidence[name]);
        let moved = ((now.low + now.high) - (good.low + good.high)).abs() / (good.high - good.low);
        assert!(moved < share, "{name} moved by {moved} of its half width");
    }
}

#[test]
fn one_reading_of_100_nm_is_told_and_moves_nothing() {
    for height in [100.0, 1e6, 1e155, -3.0] {
        let folder = damaged(0, |trial, samples| {
            if trial == 4 {
                samples[300][2] += height;
            }
        });
        let found = identified(folder.path(), Settings::default());
        let told: Vec<&String> = found.warnings.iter().filter(|w| w.contains("glitches of up to")).collect();
        assert_eq!(told.len(), 1, "{:?}", found.warnings);
        assert!(
            told[0].contains("row 302") && told[0].contains("`torque_nm`") && told[0].contains("1 sample"),
            "{told:?}"
        );
        assert_unmoved(&found, 0.02);
    }
}

#[test]
fn one_position_of_100_deg_too_many_is_told_and_moves_nothing() {
    let folder = damaged(0, |trial, samples| {
        if trial == 4 {
            samples[300][1] += 100.0;
        }
    });
    let found = identified(folder.path(), Settings::default());
    assert!(
        found.warnings.iter().any(|w| w.contains("row 302") && w.contains("`position_deg`")),
        "{:?}",
        found.warnings
    );
    assert_eq!(found.legs.len(), healthy().legs.len(), "no seventh leg");
    assert_unmoved(&found, 0.02);
}

#[test]
fn a_stretch_that_no_sensor_shows_is_refused_for_what_it_is() {
    let folder = damaged(0, |trial, samples| {
        if trial == 4 {
            samples[300..330].iter_mut().for_each(|sample| sample[2] = 1e6);
        }
    });
    let refused = refusals(folder.path());
    assert!(refused.contains("which no joint or sensor shows") && refused.contains("row 302"), "{refused}");
    assert!(!refused.contains("torque_sign"), "{refused}");
}

#[test]
fn a_torque_that_is_stuck_for_an_eighth_of_each_sweep_is_set_aside() {
    let folder = damaged(0, |_, samples| {
        let (start, length) = (samples.len() / 5, samples.len() / 8);
        let held = samples[start][2];
        samples[start..start + length].iter_mut().for_each(|sample| sample[2] = held);
    });
    let trials = elbow().1.len();
    let found = findings(folder.path());
    assert_eq!(found.iter().filter(|one| one.kind == Kind::Stuck && one.column == "torque_nm").count(), trials);
    let found = identified(folder.path(), Settings::default());
    assert_unmoved(&found, 1.0);
}

#[test]
fn a_position_that_is_stuck_while_the_joint_moves_is_told() {
    let folder = damaged(0, |_, samples| {
        let start = samples.len() / 5;
        let held = samples[start][1];
        samples[start..start + 40].iter_mut().for_each(|sample| sample[1] = held);
    });
    let found = findings(folder.path());
    assert!(
        found.iter().filter(|one| one.kind == Kind::Stuck && one.column == "position_deg").count() >= 20,
        "{found:?}"
    );
}

#[test]
fn readings_that_drop_to_zero_are_replaced() {
    let folder = damaged(0, |_, samples| samples.iter_mut().step_by(50).for_each(|sample| sample[2] = 0.0));
    let found = identified(folder.path(), Settings::default());
    assert!(found.warnings.iter().any(|w| w.contains("drops out to 0 N m")), "{:?}", found.warnings);
    assert_unmoved(&found, 0.5);
}

#[test]
fn many_glitches_are_refused() {
    let folder = damaged(0, |_, samples| samples.iter_mut().step_by(12).for_each(|sample| sample[2] = 5.0));
    assert!(refusals(folder.path()).contains("too many to be mended"));
}

#[test]
fn a_torque_in_coarse_steps_pins_nothing() {
    let folder = damaged(0, |_, samples| samples.iter_mut().for_each(|s| s[2] = 0.2 * (s[2] / 0.2).round()));
    let found = identified(folder.path(), Settings::default());
    assert!(found.warnings.iter().any(|w| w.contains("steps of 0.2000 N m")), "{:?}", found.warnings);
    assert!(pinned(&found).is_empty() && !pinned(healthy()).is_empty(), "{:?}", pinned(&found));
}

#[test]
fn a_drift_in_each_trial_pins_nothing() {
    let folder = damaged(0, |_, samples| samples.iter_mut().for_each(|s| s[2] += 0.002 * s[0]));
    let found = identified(folder.path(), Settings::default());
    let told: Vec<&String> = found.warnings.iter().filter(|w| w.contains("drifts within the trials")).collect();
    assert!(told.len() == 1 && pinned(&found).is_empty(), "{:?}", found.warnings);
    assert!(healthy().warnings.iter().all(|w| !w.contains("drifts")), "{:?}", healthy().warnings);
}

#[test]
fn copies_of_a_trial_are_refused_by_all_that_judge_trials_together() {
    let folder = damaged(1, |_, _| ());
    let copied = |text: &str| {
        assert!(text.contains("holds the same recording as `0_sweep_"), "{text}");
        assert_eq!(text.matches("holds the same recording").count(), elbow().1.len(), "{text}");
    };
    copied(&refusals(folder.path()));
    let (campaign, model) = (Campaign::read(folder.path()).unwrap(), &healthy().model);
    let text = |problems: Problems| problems.to_string();
    copied(&text(tautline::diagnose::run(&campaign, model, &|_| ()).unwrap_err()));
    let settings = tautline::evaluate::Settings { sweeps: true, ..Default::default() };
    copied(&text(tautline::evaluate::run(&campaign, model, &settings, &|| ()).unwrap_err()));
}

#[test]
fn copies_that_are_shifted_cut_or_stretched_in_time_are_copies() {
    let changes: [fn(&mut Samples); 3] = [
        |samples| samples.iter_mut().for_each(|s| s[0] += 1000.0),
        |samples| drop(samples.drain(..7)),
        |samples| samples.iter_mut().for_each(|s| s[0] *= 1.001),
    ];
    for change in changes {
        let folder = damaged(0, |trial, samples| {
            if trial == 3 {
                *samples = elbow().1[4].3.clone();
                change(samples);
            }
        });
        let refused = refusals(folder.path());
        assert_eq!(refused.matches("holds the same recording").count(), 1, "{refused}");
    }
}

/// Healthy recordings of many kinds.
#[test]
fn what_is_healthy_is_not_called_damaged() {
    let sensors = |torque_noise_nm: f64, encoder_counts: f64| Sensors { torque_noise_nm, encoder_counts };
    let short = || Plan { speeds: 3, slowest_rad_s: 0.1, repeats: 2, ..plan() };
    let plans = [
        short(),
        Plan { sensors: sensors(0.02, 4096.0), ..short() },
        Plan { sensors: sensors(0.001, 524_288.0), rate_hz: 50.0, cosines: 1, ..short() },
        Plan { sensors: sensors(0.1, 0.0), rate_hz: 1000.0, ..short() },
        Plan { sensors: sensors(0.02, 0.0), tracking_error_rad: 0.002, ..short() },
        Plan { sensors: sensors(0.005, 4096.0), interactions: 1, rate_hz: 100.0, speeds: 2, repeats: 1, ..short() },
    ];
    for plan in plans {
        let folder = record(&truth(), &plan);
        let found = findings(folder.path());
        assert!(found.is_empty(), "{plan:?}: {found:?}");
        let found = identified(folder.path(), Settings::default());
        assert!(found.warnings.iter().all(|w| !w.contains("drifts within")), "{plan:?}: {:?}", found.warnings);
    }
}

#[test]
fn the_bundled_recordings_are_healthy() {
    for folder in ["data/elbow", "data/arm", "data/davinci_l4"] {
        let found = findings(Path::new(folder));
        assert!(found.iter().all(|one| one.consequence != Consequence::Refuse), "{folder}: {found:?}");
        assert!(found.is_empty(), "{folder}: {found:?}");
    }
}
