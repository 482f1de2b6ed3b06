//! `campaign.toml`: one joint, how its signals were recorded, and the list of its trials.

use super::arm::{Arm, Declared};
use super::columns::Columns;
use crate::document::{Document, Section};
use crate::dynamics::{Dynamics, JointKind};
use crate::model::Joint;
use crate::problem::{Problem, Result};
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

const FORMAT: &str = "campaign/1";
/// Highest order of low-pass: beyond it a filter rings more than it separates.
const ORDER_MAX: i64 = 12;

/// One joint, recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    /// The folder that holds the logs.
    pub folder: PathBuf,
    /// Path of `campaign.toml`.
    pub file: PathBuf,
    /// The joint's geometry.
    pub joint: Joint,
    /// Its gravity and inertia; both 0 where `arm` holds them.
    pub dynamics: Dynamics,
    /// The whole chain that it belongs to, where the campaign names a URDF.
    pub arm: Option<Arm>,
    /// What is done to the torque signal.
    pub signal: Signal,
    /// Which column holds what.
    pub columns: Columns,
    /// The logs, in the file's order; never empty after reading.
    pub trials: Vec<TrialEntry>,
}

/// What is done to the recorded torque.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Signal {
    /// y = this times the recorded torque: 1 or -1.
    pub torque_sign: f64,
    /// Cut-off of the zero-phase Butterworth low-pass, Hz.
    pub lowpass_hz: f64,
    /// Its order in one direction, 1 to 12.
    pub lowpass_order: usize,
}

/// One recorded trial.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialEntry {
    /// Its log, relative to the campaign's folder.
    pub file: String,
    /// How the joint was moved.
    pub protocol: Protocol,
    /// Number among the trials that share protocol, speed and trajectory.
    pub repeat: u32,
    /// Name of the trajectory, where one protocol holds several.
    pub trajectory: Option<String>,
}

/// How the joint was moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Protocol {
    /// Sweeps back and forth at one speed.
    Uniform {
        /// The speed, rad/s (m/s for a prismatic joint); positive.
        speed_rad_s: f64,
    },
    /// Cascaded cosines.
    Cosine,
    /// A person or an obstacle acts on the joint.
    Interaction,
    /// Anything else.
    Free,
}

impl Protocol {
    /// The declared speed of a sweep, rad/s; `None` for other protocols.
    pub fn speed_rad_s(self) -> Option<f64> {
        match self {
            Self::Uniform { speed_rad_s } => Some(speed_rad_s),
            _ => None,
        }
    }

    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform { .. } => "uniform",
            Self::Cosine => "cosine",
            Self::Interaction => "interaction",
            Self::Free => "free",
        }
    }
}

impl Campaign {
    /// Reads the campaign in `path`: its folder, or its `campaign.toml`.
    ///
    /// Errors: everything that is wrong with the file, by row. The logs themselves are not opened, only looked for.
    pub fn read(path: &Path) -> Result<Self> {
        let (folder, file) = match path.is_dir() {
            true => (path.to_path_buf(), path.join("campaign.toml")),
            false => (path.parent().unwrap_or(Path::new("")).to_path_buf(), path.to_path_buf()),
        };
        if !file.is_file() {
            let cure = "name a folder that holds a campaign.toml, or the file itself";
            return Problem::error(&file, "there is no such file", cure).alone();
        }
        Document::open(&file)?.read(|root| Self::from_section(root, &folder, &file))
    }

    fn from_section(root: &Section<'_>, folder: &Path, file: &Path) -> Option<Self> {
        let format = root.need("format").choice(&[(FORMAT, ())]);
        let joint = root.need("joint").section(Joint::read);
        let signal = root.need("signal").section(signal);
        let kind = joint.as_ref().map(|joint| joint.kind).unwrap_or_default();
        let columns = root.need("columns").section(|section| Columns::from_section(section, kind));
        let dynamics = root.need("dynamics").section(|section| dynamics(section, folder, kind, columns.as_ref()));
        let (mut seen, mut count) = (BTreeMap::new(), 0);
        let trials = root.need("trials").sections(|section| {
            count += 1;
            trial(section, folder, &mut seen)
        });
        if trials.is_some() && count == 0 {
            root.reject("trials", "lists no trial", "add `[[trials]]` with its file and protocol");
        }
        let (folder, file) = (folder.to_path_buf(), file.to_path_buf());
        format?;
        let (joint, (dynamics, arm), signal) = (joint?, dynamics?, signal?);
        Some(Self { folder, file, joint, dynamics, arm, signal, columns: columns?, trials: trials? })
    }
}

/// The single-joint form, or the whole chain; `columns` are those read so far.
fn dynamics(
    section: &Section<'_>,
    folder: &Path,
    kind: JointKind,
    columns: Option<&Columns>,
) -> Option<(Dynamics, Option<Arm>)> {
    if section.keys().any(|key| key == "urdf") {
        let declared = Declared::read(section, folder)?;
        let arm = declared.arm(section, kind, &columns?.other_position)?;
        return Some((Dynamics { gravity_nm: 0.0, inertia_kg_m2: 0.0 }, Some(arm)));
    }
    let gravity_nm = section.need("gravity_nm").number();
    let inertia_kg_m2 = section.may("inertia_kg_m2").not_negative();
    Some((Dynamics { gravity_nm: gravity_nm?, inertia_kg_m2: inertia_kg_m2.unwrap_or(0.0) }, None))
}

fn signal(section: &Section<'_>) -> Option<Signal> {
    let torque_sign = section.need("torque_sign").number();
    if let Some(sign) = torque_sign.filter(|sign| sign.abs() != 1.0) {
        section.reject("torque_sign", format!("is {sign}"), "expected 1 or -1");
    }
    let lowpass_hz = section.need("lowpass_hz").positive();
    let order = section.need("lowpass_order").whole(1, ORDER_MAX);
    Some(Signal { torque_sign: torque_sign?, lowpass_hz: lowpass_hz?, lowpass_order: usize::try_from(order?).ok()? })
}

/// Reads one trial; `seen` holds the logs named so far and the rows that name them.
fn trial(section: &Section<'_>, folder: &Path, seen: &mut BTreeMap<PathBuf, Option<u64>>) -> Option<TrialEntry> {
    let file = section.need("file").text();
    if let Some(file) = &file {
        check_file(section, file, folder, seen);
    }
    let protocol = protocol(section);
    let repeat = section.may("repeat").whole(1, u32::MAX.into()).unwrap_or(1);
    let trajectory = section.may("trajectory").text();
    Some(TrialEntry { file: file?, protocol: protocol?, repeat: u32::try_from(repeat).ok()?, trajectory })
}

fn protocol(section: &Section<'_>) -> Option<Protocol> {
    // The speed is filled in below.
    let sweep = Protocol::Uniform { speed_rad_s: f64::NAN };
    let all = [sweep, Protocol::Cosine, Protocol::Interaction, Protocol::Free];
    let protocol = section.need("protocol").choice(&all.map(|protocol| (protocol.name(), protocol)));
    match protocol {
        Some(Protocol::Uniform { .. }) => {
            section.need("speed_rad_s").positive().map(|speed_rad_s| Protocol::Uniform { speed_rad_s })
        }
        Some(other) => {
            if section.may("speed_rad_s").number().is_some() {
                let what = format!("is given on a `{}` trial", other.name());
                section.reject("speed_rad_s", what, "delete it; only a uniform trial has one speed");
            }
            Some(other)
        }
        None => {
            section.may("speed_rad_s").positive();
            None
        }
    }
}

fn check_file(section: &Section<'_>, file: &str, folder: &Path, seen: &mut BTreeMap<PathBuf, Option<u64>>) {
    let parts: Vec<Component<'_>> = Path::new(file).components().filter(|part| *part != Component::CurDir).collect();
    if !parts.iter().all(|part| matches!(part, Component::Normal(_))) {
        let cure = "move the log into the folder of campaign.toml and name it by its path from there";
        section.reject("file", format!("`{file}` lies outside the campaign"), cure);
    } else if !folder.join(file).is_file() {
        let cure = suggest_file(file, folder).unwrap_or("add the log, or delete this trial".to_string());
        section.reject("file", format!("there is no file `{file}`"), cure);
    }
    // An unnamed file would stand for the folder; it was reported as missing above.
    match seen.entry(parts.iter().collect()) {
        std::collections::btree_map::Entry::Occupied(first) => {
            let place = first.get().map_or(String::new(), |row| format!(" in row {row}"));
            section.reject("file", format!("`{file}` is listed already{place}"), "delete one of the two trials");
        }
        std::collections::btree_map::Entry::Vacant(place) => {
            place.insert(section.row());
        }
    }
}

fn suggest_file(file: &str, folder: &Path) -> Option<String> {
    let names: Vec<String> =
        std::fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    let near = crate::document::nearest(file, names.iter().map(String::as_str))?;
    Some(format!("did you mean `{near}`?"))
}
