//! One input -> one reader, the one that `FUZZ_READER` names. A panic, an abort, more than 1 GB or more than 2 s is a finding; so is a
//! reading that is not finite.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use tautline::batch::Batch;
use tautline::check::Baseline;
use tautline::dynamics::{Chain, JointKind};
use tautline::effects::Added;
use tautline::evaluate::fitted;
use tautline::import;
use tautline::interaction::{Settings, Stream, stream_of};
use tautline::log::{Campaign, Samples, examine_trial};
use tautline::model::Model;
use tautline::trajectory::Trajectory;

/// What a reader makes of a file of any bytes.
type Reader = fn(&Path);

/// Name, what its file is called, the reader.
const READERS: [(&str, &str, Reader); 17] = [
    ("csv", "a.csv", |file| trial(file, "csv", "")),
    ("csv_cut", "a.csv", |file| trial(file, "csv", "incomplete = \"power cut\"\n")),
    ("parquet", "a.parquet", |file| trial(file, "parquet", "")),
    ("mat5", "a.mat", imported),
    ("mat73", "a.mat", imported),
    ("mcap", "a.mcap", imported),
    ("scope", "a.txt", imported),
    ("campaign", "campaign.toml", |file| drop(Campaign::read(file))),
    ("model", "model.json", |file| drop(Model::read(file))),
    ("effects", "effects.txt", |file| drop(text(file).map(|text| Added::parse(&text)))),
    ("baseline", "baseline.json", |file| drop(Baseline::read(file))),
    ("trajectory", "a.toml", |file| drop(Trajectory::read(file))),
    ("plan", "plan.toml", |file| drop(tautline::capture::plan::Plan::read(file, JointKind::Revolute))),
    ("limits", "limits.toml", |file| drop(tautline::excite::Limits::read(file))),
    ("rig", "rig.toml", |file| drop(tautline::capture::rig::Rig::read(file))),
    ("batch", "batch.toml", |file| drop(Batch::read(&[file.to_path_buf()]))),
    ("urdf", "a.urdf", |file| drop(Chain::read(file, "elbow_flexion"))),
];

const CAMPAIGN: &str = r#"format = "campaign/1"
[joint]
name = "elbow"
winch_radius_m = 0.012
pulley_radius_m = 0.040
backlash_m = 0.0008
[dynamics]
gravity_nm = 0.6916
[signal]
torque_sign = -1
lowpass_hz = 5.0
lowpass_order = 4
[columns]
time = { name = "time", unit = "ms" }
position = { name = "position", unit = "deg" }
torque = { name = "torque", unit = "N m" }
[[trials]]
protocol = "free"
"#;

fn text(file: &Path) -> Option<String> {
    String::from_utf8(std::fs::read(file).ok()?).ok()
}

/// Reads a log as the only trial of a campaign.
fn trial(file: &Path, extension: &str, more: &str) {
    let folder = file.parent().expect("lies in a folder");
    let campaign = folder.join("campaign.toml");
    if !campaign.exists() {
        std::fs::write(&campaign, format!("{CAMPAIGN}file = \"a.{extension}\"\n{more}")).expect("writes");
    }
    let Ok(campaign) = Campaign::read(&campaign) else { return };
    let (log, _) = examine_trial(&campaign, 0);
    for column in log.iter().flat_map(|log| [&log.time_s, &log.position_rad, &log.torque_nm]) {
        assert!(column.iter().all(|value| value.is_finite()), "a reading is not finite");
    }
}

/// Imports a file, and picks its first columns.
fn imported(file: &Path) {
    let Ok(Some(all)) = import::read(file) else { return };
    let names: Vec<&str> = all.iter().take(3).map(|series| series.name.as_str()).collect();
    if let Ok(picked) = import::picked(file, &all, &names) {
        assert!(picked.columns.iter().flatten().all(|value| value.is_finite()), "a reading is not finite");
    }
}

/// A stream of `interaction --follow`, as it is before its first sample.
fn followed() -> &'static (Campaign, Stream) {
    static MADE: OnceLock<(Campaign, Stream)> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = PathBuf::from(std::env::var("FUZZ_CAMPAIGN").expect("FUZZ_CAMPAIGN names a folder"));
        let campaign = Campaign::read(&folder).expect("reads");
        let model = Model::read(&folder.join("model.json")).expect("reads");
        let (campaign, model, _) = fitted(&campaign, &model).expect("fits");
        let stream = stream_of(&campaign, &model, Settings::default(), None, &|| ()).expect("is quiet");
        (campaign.into_owned(), stream)
    })
}

fn follow(data: &[u8]) {
    let (campaign, stream) = followed();
    let mut stream = stream.clone();
    for sample in Samples::new(campaign, data).into_iter().flatten() {
        let Ok(sample) = sample else { break };
        stream.step(&sample);
    }
}

fn one(data: &[u8]) {
    static CHOSEN: OnceLock<(PathBuf, Option<Reader>)> = OnceLock::new();
    let (file, reader) = CHOSEN.get_or_init(|| {
        let name = std::env::var("FUZZ_READER").expect("FUZZ_READER names a reader");
        let folder = PathBuf::from(std::env::var("FUZZ_FOLDER").expect("FUZZ_FOLDER names a folder"));
        match READERS.into_iter().find(|(known, ..)| *known == name) {
            Some((_, file, reader)) => (folder.join(file), Some(reader)),
            None => {
                assert_eq!(name, "follow", "no such reader");
                (folder, None)
            }
        }
    });
    match reader {
        Some(reader) => {
            std::fs::write(file, data).expect("writes");
            reader(file);
        }
        None => follow(data),
    }
}

fuzz_target!(|data: &[u8]| one(data));
