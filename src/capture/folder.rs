//! The folder of a campaign being captured: what is recorded, as what, and where to go on.
//!
//! | file | what it holds |
//! |---|---|
//! | `campaign.toml` | the campaign, replaced as one at the beginning and end of every trial |
//! | `rig.toml`, `plan.toml` | copies of what it was captured by |
//! | `capture.log` | what happened when |
//! | `evidence.jsonl` | of each trial: late and missed cycles, the devices' clocks, port error counters, emergency messages |
//! | `drive_faults.jsonl` | what each drive remembers of its faults, before the trials and after a stop |
//! | `*.csv` | the trials |

use super::origin::{Origin, today_s};
use super::recorder::EXTRAS;
use super::rig::Rig;
use crate::dynamics::JointKind;
use crate::log::{Campaign, Captured, Column, Columns, Files, TrialEntry, Uncertainty};
use crate::problem::{Problem, Result};
use crate::units::Unit;
use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What an incomplete trial is said to have broken off by until its end is known.
const UNKNOWN: &str = "its end was not recorded: killed, without power, or without room on the disk";

/// The campaign.
const CAMPAIGN: &str = "campaign.toml";
/// What happened when.
const NOTES: &str = "capture.log";
/// What the bus told of itself, a line for each trial.
const EVIDENCE: &str = "evidence.jsonl";

/// What the drives remember of their faults, a line for each drive.
const FAULTS: &str = "drive_faults.jsonl";

/// A campaign's folder, being filled.
#[derive(Debug)]
pub struct Folder {
    /// Where it is.
    pub path: PathBuf,
    campaign: Campaign,
    notes: File,
    origin: Origin,
    /// Columns that this rig records besides those that all do.
    extras: Vec<&'static str>,
}

impl Folder {
    /// Makes `path` for a capture by `rig`; `texts` are the files kept beside the logs, by name.
    ///
    /// Errors: it exists, or cannot be written.
    pub fn create(path: &Path, rig: &Rig, texts: &[(&str, &str)]) -> Result<Self> {
        if path.exists() {
            let cure = "name another, or go on with a capture by --resume";
            return Problem::error(path, "exists already", cure).alone();
        }
        let made = || -> io::Result<Self> {
            std::fs::create_dir_all(path)?;
            texts.iter().try_for_each(|(name, text)| replace(path, name, text))?;
            let campaign = campaign(path, rig, Vec::new());
            let mut folder = Self {
                path: path.to_path_buf(),
                campaign,
                notes: notes(path)?,
                origin: Origin::now(),
                extras: extras(rig),
            };
            folder.note("capture begins")?;
            folder.note(&folder.origin.to_line())?;
            Ok(folder)
        };
        made().or_else(|error| {
            Self::abandon(path);
            unwritable(path, &error)
        })
    }

    /// Opens `path`, which a capture has left, to go on; `texts` must be what it was captured by.
    ///
    /// Errors: it is no such folder, or of another rig or plan.
    pub fn resume(path: &Path, rig: &Rig, texts: &[(&str, &str)]) -> Result<Self> {
        for (name, text) in texts {
            let file = path.join(name);
            match std::fs::read_to_string(&file) {
                Ok(found) if found == *text => {}
                Ok(_) => {
                    let what = "is not what the capture began with";
                    return Problem::error(&file, what, "resume with the same rig and plan, or capture anew").alone();
                }
                Err(error) => {
                    let what = format!("cannot be read: {error}");
                    return Problem::error(&file, what, "--resume goes on with a folder that a capture has left")
                        .alone();
                }
            }
        }
        // Before its first trial a capture has no campaign.
        let trials = if path.join(CAMPAIGN).exists() { listed(path)? } else { Vec::new() };
        let opened = || -> io::Result<Self> {
            let recorded_s = trials.iter().filter_map(|trial| last_time_s(&path.join(&trial.file))).fold(0.0, f64::max);
            let origin = Origin::of_notes(&std::fs::read_to_string(path.join(NOTES))?, recorded_s);
            let campaign = campaign(path, rig, trials);
            let mut folder =
                Self { path: path.to_path_buf(), campaign, notes: notes(path)?, origin, extras: extras(rig) };
            let (elapsed_s, clock) = folder.origin.elapsed();
            folder.note(&format!("capture goes on, {elapsed_s:.1} s after it began, by {clock}"))?;
            Ok(folder)
        };
        opened().or_else(|error| unwritable(path, &error))
    }

    /// Takes `path` away again, of a capture that did not start; where anything was recorded it stays as it is.
    pub fn abandon(path: &Path) {
        if path.join(CAMPAIGN).exists() {
            return;
        }
        for name in ["rig.toml", "plan.toml", NOTES] {
            let _ = std::fs::remove_file(path.join(name));
        }
        let _ = std::fs::remove_dir(path);
    }

    /// Columns that this rig records besides those that all do.
    pub(super) fn extras(&self) -> impl Iterator<Item = &'static str> {
        self.extras.iter().copied()
    }

    /// What is recorded, whole or not.
    pub fn trials(&self) -> &[TrialEntry] {
        &self.campaign.trials
    }

    /// When the first run began.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// A trial begins.
    pub(super) fn begin(&mut self, entry: TrialEntry) -> io::Result<()> {
        let capture = Some(Captured { incomplete: Some(UNKNOWN.to_string()), ..Captured::default() });
        self.note(&format!("{} begins", entry.file))?;
        self.campaign.trials.push(TrialEntry { capture, ..entry });
        self.write().inspect_err(|_| drop(self.campaign.trials.pop()))
    }

    /// The last trial that began ends.
    pub(super) fn end(&mut self, captured: Captured) -> io::Result<()> {
        let Some(entry) = self.campaign.trials.last_mut() else { return Ok(()) };
        let how = captured.incomplete.clone().map_or("complete".to_string(), |why| format!("incomplete: {why}"));
        let (late, missed) = (captured.late_cycles, captured.missed_cycles);
        let line = format!("{} {how}; {late} cycles late, {missed} missed", entry.file);
        entry.capture = Some(captured);
        self.write()?;
        self.note(&line)
    }

    /// A line of `evidence.jsonl`.
    pub(super) fn evidence(&mut self, line: &str) -> io::Result<()> {
        self.append(EVIDENCE, line)
    }

    /// A line of `drive_faults.jsonl`.
    pub(super) fn drive_faults(&mut self, line: &str) -> io::Result<()> {
        self.append(FAULTS, line)
    }

    fn append(&self, name: &str, line: &str) -> io::Result<()> {
        let mut file = OpenOptions::new().create(true).append(true).open(self.path.join(name))?;
        writeln!(file, "{line}")
    }

    /// A line of `capture.log`, with the time of day in s since 1970 (UTC). It is not waited for: rows may be coming.
    pub(super) fn note(&mut self, line: &str) -> io::Result<()> {
        writeln!(self.notes, "{:.3} {line}", today_s())
    }

    fn write(&self) -> io::Result<()> {
        replace(&self.path, CAMPAIGN, &self.campaign.to_toml())
    }
}

fn extras(rig: &Rig) -> Vec<&'static str> {
    EXTRAS.iter().filter(|(role, _)| rig.drive.inputs.place(role).is_some()).map(|(_, column)| *column).collect()
}

/// The trials of the campaign in `path`, also those that are too short to be used.
fn listed(path: &Path) -> Result<Vec<TrialEntry>> {
    Ok(crate::log::Survey::read(path)?.listed)
}

/// The time of the last whole row of a log, s.
fn last_time_s(log: &Path) -> Option<f64> {
    let text = std::fs::read_to_string(log).ok()?;
    let (whole, _) = text.rsplit_once('\n')?;
    whole.lines().next_back()?.split(',').next()?.parse().ok()
}

fn unwritable<T>(path: &Path, error: &io::Error) -> Result<T> {
    Problem::unwritable(path, "cannot be written", error).alone()
}

fn notes(path: &Path) -> io::Result<File> {
    OpenOptions::new().create(true).append(true).open(path.join(NOTES))
}

/// Writes `text` to `name` in `folder` so that either the old or the new stands there, whatever happens.
fn replace(folder: &Path, name: &str, text: &str) -> io::Result<()> {
    let mut new = tempfile::Builder::new().prefix(".tautline-").tempfile_in(folder)?;
    new.write_all(text.as_bytes())?;
    new.as_file().sync_all()?;
    #[cfg(unix)]
    new.as_file().set_permissions(std::os::unix::fs::PermissionsExt::from_mode(0o644))?;
    new.persist(folder.join(name))?;
    // The name itself must reach the disk too.
    File::open(folder)?.sync_all()
}

fn campaign(path: &Path, rig: &Rig, trials: Vec<TrialEntry>) -> Campaign {
    let column = |name: &str, unit| Column::new(name, unit);
    let (angle, torque) = match rig.joint.kind {
        JointKind::Revolute => (Unit::Radian, Unit::NewtonMetre),
        JointKind::Prismatic => (Unit::Metre, Unit::Newton),
    };
    Campaign {
        folder: path.to_path_buf(),
        file: path.join(CAMPAIGN),
        joint: rig.joint.clone(),
        dynamics: rig.dynamics,
        arm: None,
        uncertainty: Uncertainty::default(),
        signal: rig.signal,
        files: Files::default(),
        columns: Columns {
            time: column("time_s", Unit::Second),
            position: column("position_rad", angle),
            torque: column("torque_nm", torque),
            rate_hz: None,
            torque_from: None,
            command: None,
            velocity: None,
            current: None,
            temperature: None,
            load_torque: None,
            reference_torque: None,
            other_position: Vec::new(),
        },
        trials,
        warnings: Vec::new(),
        clock_s: Vec::new(),
    }
}
