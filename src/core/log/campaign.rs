//! `campaign.toml`: one joint, how its signals were recorded, and the list of its trials.

use super::arm::{Arm, Declared};
use super::captured::Captured;
use super::columns::{Columns, OtherColumn, TorqueFrom, Wanted};
use super::controller::Controller;
use super::entries::Entries;
use super::files::Files;
use super::questions;
use super::read_columns::Given;
use super::uncertainty::Uncertainty;
use crate::document::{Document, Section};
use crate::dynamics::{Dynamics, JointKind};
use crate::model::{Drive, Joint};
use crate::problem::{Problem, Problems, Result, Severity};
use crate::trajectory::Protocol;
use std::ops::Range;
use std::path::{Path, PathBuf};

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
    /// How far what is declared may be off.
    pub uncertainty: Uncertainty,
    /// What is done to the torque signal.
    pub signal: Signal,
    /// How its text logs are written.
    pub files: Files,
    /// Which column holds what.
    pub columns: Columns,
    /// The logs, in the file's order; never empty after reading.
    pub trials: Vec<TrialEntry>,
    /// What the reader should know of `campaign.toml`.
    pub warnings: Vec<Problem>,
    /// When each trial began, s since the campaign did; empty until asked for.
    pub clock_s: Vec<f64>,
}

/// What `campaign.toml` tells, however much of it can be used.
#[derive(Debug)]
pub struct Survey {
    /// The campaign, where units, low-pass and trials are understood; a joint that is not understood counts as one without clearance, which
    /// causes no false findings.
    pub campaign: Option<Campaign>,
    /// Whether all of it is understood, so that the trials can be judged together.
    pub is_whole: bool,
    /// Everything that is wrong with `campaign.toml`, by row.
    pub problems: Vec<Problem>,
    /// The trials whose logs are there to be read.
    pub readable: Vec<TrialEntry>,
    /// All trials whose log is named.
    pub listed: Vec<TrialEntry>,
    /// The folder that holds the logs.
    pub(super) folder: PathBuf,
    /// How its text logs are written.
    pub(super) files: Files,
    /// The columns whose names are given.
    pub(super) columns: Vec<Wanted>,
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

/// A part of a log that holds more than one trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// The log, relative to the campaign's folder.
    pub log: String,
    /// Its data rows, from 0.
    pub rows: Range<usize>,
}

impl Part {
    /// What the trial is called: the log's name with the rows.
    pub fn name(&self) -> String {
        let path = Path::new(&self.log);
        let stem = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let ending = path.extension().map_or_else(String::new, |ending| format!(".{}", ending.to_string_lossy()));
        let name = format!("{stem}_rows_{}_{}{ending}", self.rows.start, self.rows.end);
        path.with_file_name(name).to_string_lossy().into_owned()
    }
}

/// One recorded trial.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialEntry {
    /// Its log, relative to the campaign's folder; a name of its own where it is `part` of one.
    pub file: String,
    /// Where it stands, if its log holds more.
    pub part: Option<Part>,
    /// How the joint was moved.
    pub protocol: Protocol,
    /// Number among the trials that share protocol, speed and trajectory.
    pub repeat: u32,
    /// Name of the trajectory, where one protocol holds several.
    pub trajectory: Option<String>,
    /// How its recording went, where that is told.
    pub capture: Option<Captured>,
    /// The position controller's law in this trial, where it is not the campaign's.
    pub controller: Option<Controller>,
}

impl TrialEntry {
    /// Its log, relative to the campaign's folder.
    pub fn log(&self) -> &str {
        self.part.as_ref().map_or(&self.file, |part| &part.log)
    }

    /// Whether its recording broke off.
    pub fn is_incomplete(&self) -> bool {
        self.capture.as_ref().is_some_and(|capture| capture.incomplete.is_some())
    }
}

impl Campaign {
    /// Reads the campaign in `path`: its folder, or its `campaign.toml`.
    ///
    /// Errors: everything that is wrong with the file, by row. The logs themselves are not opened, only looked for: trials that
    /// broke off too early to be used are still among them (`prepare::read_campaign`).
    pub fn read(path: &Path) -> Result<Self> {
        let Survey { campaign, problems, .. } = Survey::read(path)?;
        let is_error = |problem: &Problem| problem.severity == Severity::Error;
        match campaign {
            Some(campaign) if !problems.iter().any(is_error) => Ok(Self { warnings: problems, ..campaign }),
            _ => Err(Problems(problems)),
        }
    }
}

impl Survey {
    /// Reads as much as can be understood of the campaign in `path`: its folder, or its `campaign.toml`.
    ///
    /// Errors: there is no such file, or it is no TOML.
    pub fn read(path: &Path) -> Result<Self> {
        let (folder, file) = match path.is_dir() {
            true => (path.to_path_buf(), path.join("campaign.toml")),
            false => (path.parent().unwrap_or(Path::new("")).to_path_buf(), path.to_path_buf()),
        };
        if !file.is_file() {
            let cure = "name a folder that holds a campaign.toml, or the file itself";
            return Problem::error(&file, "there is no such file", cure).alone();
        }
        let (survey, mut problems) =
            Document::open(&file)?.examine(|root| Some(Self::from_section(root, &folder, &file)));
        problems.extend(questions::open(&file));
        problems.sort_by_key(|problem| problem.row);
        match survey {
            Some(survey) => Ok(Self { problems, ..survey }),
            None => Err(Problems(problems)),
        }
    }

    fn from_section(root: &Section<'_>, folder: &Path, file: &Path) -> Self {
        let format = root.need("format").choice(&[(FORMAT, ())]);
        let files = root.may("files").section(Files::read).unwrap_or_default();
        let mut given = Given { rate_hz: files.rate_hz, gear_ratio: 1.0, ..Given::default() };
        let joint_field = root.need("joint").such_as("[joint]", "a section with name and radii");
        let joint = joint_field.section(|section| read_joint(section, &mut given));
        let kind = given.kind;
        let means = "a section with gravity_nm and inertia_kg_m2";
        let dynamics_field = root.need("dynamics").such_as("[dynamics]", means);
        let means = "a section with torque_sign, lowpass_hz and lowpass_order";
        let signal = root.need("signal").such_as("[signal]", means).section(Signal::read);
        given.controller = root.may("controller").section(Controller::read);
        let means = "a section with time, position and torque";
        let columns = root.need("columns").such_as("[columns]", means);
        let (columns, named) = columns.section(|section| Some(Columns::read(section, given))).unwrap_or_default();
        let others = columns.as_ref().map(|columns| &columns.other_position[..]);
        let dynamics = dynamics_field.section(|section| dynamics(section, folder, kind, others));
        let mut uncertainty = root.may("uncertainty").section(Uncertainty::read).unwrap_or_default();
        let torque_from = columns.as_ref().and_then(|columns| columns.torque_from);
        if torque_from.is_some_and(|from| !from.is_scaled()) {
            uncertainty.torque_scale_percent = f64::INFINITY;
        }
        check_sign(root, signal.as_ref(), torque_from);
        let entries = Entries::read(root, folder, kind);
        check_controllers(root, &entries, torque_from);
        let is_whole = format.is_some()
            && entries.are_whole
            && joint.is_some()
            && dynamics.is_some()
            && signal.is_some_and(|signal| signal.torque_sign.is_finite());
        let campaign = columns.zip(signal).map(|(columns, signal)| Campaign {
            folder: folder.to_path_buf(),
            file: file.to_path_buf(),
            joint: joint.unwrap_or_else(|| unknown_joint(kind)),
            dynamics: dynamics.as_ref().map_or_else(Dynamics::default, |found| found.0),
            arm: dynamics.and_then(|found| found.1),
            uncertainty,
            signal,
            files,
            columns,
            trials: entries.trials.clone(),
            warnings: Vec::new(),
            clock_s: Vec::new(),
        });
        Self {
            campaign,
            is_whole,
            problems: Vec::new(),
            readable: entries.readable,
            listed: entries.trials,
            folder: folder.to_path_buf(),
            files,
            columns: named,
        }
    }
}

/// The joint in its `section`; what it says of the columns goes into `given`.
fn read_joint(section: &Section<'_>, given: &mut Given) -> Option<Joint> {
    let kind = Joint::read_kind(section);
    let drive = Joint::read_drive(section, kind);
    (given.kind, given.turns_motor) = (kind, drive == Drive::Screw);
    given.torque_constant_nm_a = section.may("torque_constant_nm_a").positive();
    if drive == Drive::Cable {
        given.gear_ratio = section.may("gear_ratio").positive().unwrap_or(1.0);
    }
    Joint::read(section, kind)
}

/// A trial's controller needs one of the campaign: without its stiffness the torques of the trials have no common scale.
fn check_controllers(root: &Section<'_>, entries: &Entries, torque_from: Option<TorqueFrom>) {
    let is_given = entries.trials.iter().any(|entry| entry.controller.is_some());
    if is_given && !torque_from.is_some_and(|from| from.is_scaled()) {
        let cure = "add [controller] with stiffness_nm_rad for the other trials, and a column `command`";
        root.reject("controller", "is given of a trial, and not of the campaign", cure);
    }
}

/// A controller pulls towards its command: no sign is to be declared.
fn check_sign(root: &Section<'_>, signal: Option<&Signal>, torque_from: Option<TorqueFrom>) {
    let is_controller = matches!(torque_from, Some(TorqueFrom::Controller(_)));
    if is_controller && signal.is_some_and(|signal| signal.torque_sign == -1.0) {
        let what =
            "has torque_sign = -1, but the torque follows from the command: a controller pulls the joint towards it";
        root.reject("signal", what, "write torque_sign = 1");
    }
}

fn unknown_joint(kind: JointKind) -> Joint {
    Joint { name: String::new(), kind, drive: Drive::Cable, winch_radius_m: 1.0, pulley_radius_m: 1.0, backlash_m: 0.0 }
}

/// The single-joint form, or the whole chain, whose other joints stand in the columns `others`.
fn dynamics(
    section: &Section<'_>,
    folder: &Path,
    kind: JointKind,
    others: Option<&[OtherColumn]>,
) -> Option<(Dynamics, Option<Arm>)> {
    if section.keys().any(|key| key == "urdf") {
        let declared = Declared::read(section, folder)?;
        let arm = declared.arm(section, kind, others?)?;
        return Some((Dynamics::default(), Some(arm)));
    }
    let means = "the gravity torque about the joint at 90 deg, N m";
    let gravity_nm = section.need("gravity_nm").such_as("0.6916", means).number();
    let inertia_kg_m2 = section.may("inertia_kg_m2").not_negative();
    let inertia_kg_m2 = inertia_kg_m2.unwrap_or(0.0);
    Some((Dynamics { gravity_nm: gravity_nm?, inertia_kg_m2, ..Dynamics::default() }, None))
}

impl Signal {
    /// Reads `[signal]`; a torque sign that is not understood is NaN, and reported.
    pub fn read(section: &Section<'_>) -> Option<Self> {
        let means =
            "1 or -1, so that y = torque_sign * recorded torque grows with gravity's torque when the joint moves up";
        let torque_sign = section.need("torque_sign").such_as("-1", means).number();
        if let Some(sign) = torque_sign.filter(|sign| sign.abs() != 1.0) {
            section.reject("torque_sign", format!("is {sign}"), format!("expected {means}"));
        }
        let torque_sign = torque_sign.filter(|sign| sign.abs() == 1.0).unwrap_or(f64::NAN);
        let means = "cut-off of the low-pass on the torque, Hz";
        let lowpass_hz = section.need("lowpass_hz").such_as("5.0", means).positive();
        let means = "order of the low-pass, 1 to 12";
        let order = section.need("lowpass_order").such_as("4", means).whole(1, ORDER_MAX);
        Some(Self { torque_sign, lowpass_hz: lowpass_hz?, lowpass_order: usize::try_from(order?).ok()? })
    }
}
