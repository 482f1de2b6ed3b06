//! A recorded campaign: `campaign.toml` -> `Campaign`; trial by trial, a CSV or Parquet log -> `Log` in SI.

mod arm;
mod blanks;
mod campaign;
mod captured;
mod checks;
mod clock;
mod columns;
mod controller;
mod csv_file;
mod dialect;
mod entries;
mod files;
mod health;
pub mod mixed;
mod parquet_file;
mod parquet_pages;
mod place;
mod questions;
mod raw;
mod read_columns;
mod readings;
mod resample;
mod samples;
mod source;
mod stamp;
pub mod table;
mod uncertainty;
mod velocity;
mod written;

pub use crate::trajectory::Protocol;
pub use arm::{Arm, Place};
pub use campaign::{Campaign, Part, Signal, Survey, TrialEntry};
pub use captured::Captured;
pub use checks::longest_gap_s;
pub use clock::{clock_s, is_one_recording, span_s};
pub use columns::{Column, Columns, FromCurrent, OtherColumn, ReferenceColumn, TorqueFrom};
pub use controller::{Controller, Damped};
pub use files::Files;
pub use health::{Consequence, Finding, Fingerprint, Kind, copies, refuse_copies};
pub use questions::MARK;
pub use raw::{Raw, raw};
pub use samples::{Sample, Samples};
pub use uncertainty::{POSITION_ZERO_RAD, Uncertainty};

use crate::import::is_text;
use crate::problem::{Problem, Problems, Result};
use crate::units::{Quantity, Unit};
use columns::Wanted;
use readings::{Faults, Readings};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Where [`Columns::wanted`] puts the columns that every log has.
const TIME: usize = 0;
const POSITION: usize = 1;
const TORQUE: usize = 2;

/// One trial as recorded, in SI, evenly sampled, free of gaps. For a prismatic joint `_rad` is m and `_nm` is N.
#[derive(Debug, Clone, PartialEq)]
pub struct Log {
    /// The file it came from.
    pub file: PathBuf,
    /// Sample rate, Hz.
    pub rate_hz: f64,
    /// Time stamps, s.
    pub time_s: Vec<f64>,
    /// Position of the joint, rad.
    pub position_rad: Vec<f64>,
    /// y: the recorded torque times `torque_sign`, N m.
    pub torque_nm: Vec<f64>,
    /// Recorded velocity, rad/s.
    pub velocity_rad_s: Option<Vec<f64>>,
    /// Measured load at the joint, N m.
    pub load_torque_nm: Option<Vec<f64>>,
    /// Interaction torque measured independently, N m.
    pub reference_torque_nm: Option<Vec<f64>>,
    /// Motor current, A.
    pub current_a: Option<Vec<f64>>,
    /// Temperature, degC.
    pub temperature_degc: Option<Vec<f64>>,
    /// Commanded position of the joint, rad.
    pub command_rad: Option<Vec<f64>>,
    /// Positions of coupled joints, rad or m.
    pub other_position_rad: Vec<Vec<f64>>,
    /// Samples at which the torque sensor was at the end of its range.
    pub clipped: Vec<Range<usize>>,
    /// Samples that no fit and no figure may see, in order: those clipped, and those at which a sensor was stuck.
    pub set_aside: Vec<Range<usize>>,
    /// What is wrong with its signals; `warnings` tells it too.
    pub findings: Vec<Finding>,
    /// What tells this recording from others.
    pub fingerprint: Fingerprint,
    /// What the reader should know of this log.
    pub warnings: Vec<Problem>,
}

impl Log {
    /// The stretches set aside because a sensor was stuck, not clipped.
    pub fn stuck(&self) -> Vec<Range<usize>> {
        let is_clipped =
            |stretch: &&Range<usize>| self.clipped.iter().any(|run| run.start < stretch.end && stretch.start < run.end);
        self.set_aside.iter().filter(|stretch| !is_clipped(stretch)).cloned().collect()
    }
}

/// Reads trial `index` of `campaign`, which must be in its list: parsed, checked, put on an even grid, in SI.
///
/// Errors: every fault of the file that makes it unusable, with row, column and cure.
pub fn read_trial(campaign: &Campaign, index: usize) -> Result<Log> {
    match examine_trial(campaign, index) {
        (Some(log), problems) => Problems(problems).unless_errors(log),
        (None, problems) => Err(Problems(problems)),
    }
}

/// The same, with everything that is wrong with the file, and the log even where only single cells are, drawn straight
/// across them: its motion can then still be looked at.
pub fn examine_trial(campaign: &Campaign, index: usize) -> (Option<Log>, Vec<Problem>) {
    let entry = &campaign.trials[index];
    let file = campaign.folder.join(entry.log());
    let wanted = wanted(campaign, entry);
    let mut faults = Faults::of(&file);
    let mut recorded = match read_columns(&file, &campaign.files, entry, &wanted, &mut faults) {
        Ok(recorded) => recorded,
        Err(Problems(problems)) => return (None, problems),
    };
    let in_cells = faults.count();
    checks::check(&recorded, &wanted, Some(&campaign.signal), entry, &mut faults);
    // Where a time is missing, the order of the others could not be judged before it was bridged.
    let rises = |recorded: &Readings| recorded.columns[TIME].windows(2).all(|pair| pair[0] < pair[1]);
    let is_usable = faults.count() == in_cells && (in_cells == 0 || recorded.bridge_holes() && rises(&recorded));
    let mut problems = faults.into_problems();
    let log = is_usable.then(|| log_of(file, recorded, wanted.clone(), campaign));
    if let Some(log) = &log {
        let refused = log.findings.iter().filter(|finding| finding.consequence == Consequence::Refuse);
        problems.extend(refused.map(|finding| finding.problem(&log.file)));
        problems.extend(velocity::check(log, &wanted, campaign.joint.kind));
    }
    (log, problems)
}

impl Survey {
    /// Everything that is wrong with the log of `entry` by itself, where what `campaign.toml` says of units or low-pass is not
    /// understood: its columns, numbers, time stamps, dead sensors.
    pub fn problems_of(&self, entry: &TrialEntry) -> Vec<Problem> {
        let file = self.folder.join(entry.log());
        let mut faults = Faults::of(&file);
        match read_columns(&file, &self.files, entry, &self.columns, &mut faults) {
            Ok(recorded) => {
                checks::check(&recorded, &self.columns, None, entry, &mut faults);
                faults.into_problems()
            }
            Err(Problems(problems)) => problems,
        }
    }
}

/// The columns of `entry`, with its own controller where it has one.
fn wanted(campaign: &Campaign, entry: &TrialEntry) -> Vec<Wanted> {
    let mut wanted = campaign.columns.wanted();
    if let (Some(own), Some(TorqueFrom::Controller(law))) = (entry.controller, &mut wanted[TORQUE].torque_from) {
        *law = own;
    }
    wanted
}

fn read_columns(
    file: &Path,
    files: &Files,
    entry: &TrialEntry,
    wanted: &[Wanted],
    faults: &mut Faults<'_>,
) -> Result<Readings> {
    let rows = entry.part.as_ref().map(|part| &part.rows);
    if is_text(file) {
        return csv_file::read(file, files, rows, entry.is_incomplete(), wanted, faults);
    }
    match file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("parquet")) {
        true => parquet_file::read(file, rows, wanted, faults),
        false => {
            let cure = "save it as .csv or .parquet; `tautline import` reads MATLAB, ROS 2 and TwinCAT Scope";
            Problem::error(file, "is of an unsupported log format", cure).alone()
        }
    }
}

fn log_of(file: PathBuf, mut recorded: Readings, mut wanted: Vec<Wanted>, campaign: &Campaign) -> Log {
    // Repeats of one motion share their command.
    let unique = if wanted[TORQUE].controller().is_some() { POSITION } else { TORQUE };
    let fingerprint = Fingerprint::of(&recorded.columns[unique]);
    let mut findings = health::mend(&mut recorded, &wanted);
    let (mut columns, rate_hz, mut warnings) = resample::onto_even_grid(&file, recorded.columns, &wanted[TIME]);
    if let Some(controller) = wanted[TORQUE].controller().copied() {
        controller.drive(campaign.joint.transmission(), &mut columns, &wanted, rate_hz);
        wanted[TORQUE] = controller.driven(&wanted[TORQUE], torque_unit(campaign));
    }
    let examined = health::examine(&mut columns, rate_hz, &wanted, &recorded.rows);
    findings.extend(examined.findings);
    let told = findings.iter().filter(|finding| finding.consequence != Consequence::Refuse);
    warnings.extend(told.map(|finding| finding.problem(&file)));
    for (column, want) in columns.iter_mut().zip(&wanted) {
        let sign = if want.quantity == Quantity::Torque { campaign.signal.torque_sign } else { 1.0 };
        scale(column, sign * want.factor(), sign * want.offset_si());
    }
    let log = assemble(file, rate_hz, columns, &wanted);
    let (clipped, set_aside) = (examined.clipped, examined.set_aside);
    Log { clipped, set_aside, findings, fingerprint, warnings, ..log }
}

/// Unit of the torque at the motor: N for a slide, except with a screw, whose motor gives N m.
fn torque_unit(campaign: &Campaign) -> Unit {
    if campaign.joint.reads_force() { Unit::Newton } else { Unit::NewtonMetre }
}

fn scale(column: &mut [f64], factor: f64, offset: f64) {
    if factor != 1.0 {
        column.iter_mut().for_each(|reading| *reading *= factor);
    }
    if offset != 0.0 {
        column.iter_mut().for_each(|value| *value += offset);
    }
}

/// Puts each column in its place.
fn assemble(file: PathBuf, rate_hz: f64, columns: Vec<Vec<f64>>, wanted: &[Wanted]) -> Log {
    let mut log = Log {
        file,
        rate_hz,
        time_s: Vec::new(),
        position_rad: Vec::new(),
        torque_nm: Vec::new(),
        velocity_rad_s: None,
        load_torque_nm: None,
        reference_torque_nm: None,
        current_a: None,
        temperature_degc: None,
        command_rad: None,
        other_position_rad: Vec::new(),
        clipped: Vec::new(),
        set_aside: Vec::new(),
        findings: Vec::new(),
        fingerprint: Fingerprint::default(),
        warnings: Vec::new(),
    };
    for (column, want) in columns.into_iter().zip(wanted) {
        match want.quantity {
            Quantity::Time => log.time_s = column,
            Quantity::Position => log.position_rad = column,
            Quantity::Torque => log.torque_nm = column,
            Quantity::Velocity => log.velocity_rad_s = Some(column),
            Quantity::LoadTorque => log.load_torque_nm = Some(column),
            Quantity::ReferenceTorque => log.reference_torque_nm = Some(column),
            Quantity::Current => log.current_a = Some(column),
            Quantity::Temperature => log.temperature_degc = Some(column),
            Quantity::Command => log.command_rad = Some(column),
            Quantity::OtherPosition => log.other_position_rad.push(column),
        }
    }
    log
}
