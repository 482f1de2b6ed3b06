//! `[[trials]]` of `campaign.toml`: which logs there are and how the joint was moved in each.

use super::campaign::{Part, TrialEntry};
use super::captured::Captured;
use super::controller::Controller;
use super::place::{self, Found};
use crate::document::Section;
use crate::dynamics::JointKind;
use crate::limits::{FAULTS_LISTED, shown};
use crate::trajectory::Protocol;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;
use std::path::{Component, Path, PathBuf};

/// The trials, as far as they are understood.
pub(super) struct Entries {
    /// Those whose log is named; one of a protocol that is not understood is taken as free motion.
    pub trials: Vec<TrialEntry>,
    /// Those of them whose log is there to be read, each once.
    pub readable: Vec<TrialEntry>,
    /// Whether `trials` is all of them, all understood.
    pub are_whole: bool,
}

/// What was read so far, with the rows where it stands.
#[derive(Default)]
struct Seen {
    count: usize,
    files: BTreeMap<PathBuf, Vec<Listed>>,
    repeats: BTreeMap<String, Option<u64>>,
    has_unknown_protocol: bool,
    /// Logs that do not exist.
    absent: usize,
}

/// Where a log is listed, and which of its data rows.
struct Listed {
    row: Option<u64>,
    rows: Range<usize>,
}

impl Entries {
    /// Reads the list in `root`; its logs lie in `folder`.
    pub fn read(root: &Section<'_>, folder: &Path, kind: JointKind) -> Self {
        let mut seen = Seen::default();
        let list = root.need("trials").such_as("[[trials]]", "one for each log, with its file and protocol");
        let trials = list.sections(|section| {
            seen.count += 1;
            seen.trial(section, folder, kind)
        });
        if trials.is_some() && seen.count == 0 {
            root.reject("trials", "lists no trial", "add `[[trials]]` with its file and protocol");
        }
        let trials = trials.unwrap_or_default();
        let readable = trials.iter().filter(|(_, is_readable)| *is_readable).map(|(entry, _)| entry.clone()).collect();
        let are_whole = seen.count > 0 && trials.len() == seen.count && !seen.has_unknown_protocol;
        Self { trials: trials.into_iter().map(|(entry, _)| entry).collect(), readable, are_whole }
    }
}

impl Seen {
    /// The trial, if its log is named, and whether that can be read.
    fn trial(&mut self, section: &Section<'_>, folder: &Path, kind: JointKind) -> Option<(TrialEntry, bool)> {
        let means = "the log, CSV or Parquet, by its path from this folder";
        let file = section.need("file").such_as("\"sweep_1.csv\"", means).text();
        let capture = Captured::read(section);
        let may_lack = capture.as_ref().is_some_and(|capture| capture.incomplete.is_some());
        let rows = rows(section);
        let is_readable =
            file.as_ref().is_some_and(|file| self.check_file(section, file, rows.as_ref(), folder, may_lack));
        let protocol = protocol(section, kind);
        let repeat = section.may("repeat").whole(1, u32::MAX.into()).unwrap_or(1);
        let repeat = u32::try_from(repeat).ok()?;
        let trajectory = section.may("trajectory").text();
        self.has_unknown_protocol |= protocol.is_none();
        let protocol_or_free = protocol.unwrap_or(Protocol::Free);
        let part = rows.and_then(|rows| Some(Part { log: file.clone()?, rows }));
        let file = part.as_ref().map_or(file, |part| Some(part.name()));
        let controller = section.may("controller").section(Controller::of_trial);
        let entry =
            TrialEntry { file: file?, part, protocol: protocol_or_free, repeat, trajectory, capture, controller };
        if protocol.is_some() {
            self.check_repeat(section, &entry);
        }
        Some((entry, is_readable))
    }

    /// Reports a log that lies outside the campaign's folder, is absent, or is listed already; false of such. The log of a trial
    /// that broke off before its first row `may_lack`.
    fn check_file(
        &mut self,
        section: &Section<'_>,
        file: &str,
        rows: Option<&Range<usize>>,
        folder: &Path,
        may_lack: bool,
    ) -> bool {
        let found = place::find(folder, file);
        match &found {
            Found::Here => {}
            Found::Linked(real) => {
                let (what, cure) = place::of_link(file, real);
                section.doubt("file", what, cure);
            }
            Found::Outside => {
                let cure = "move the log into the folder of campaign.toml and name it by its path from there";
                section.reject("file", format!("`{file}` lies outside the campaign"), cure);
            }
            Found::Absent("does not exist") if may_lack => {
                let what = format!("there is no file `{}`: the trial broke off before its first row", shown(file));
                section.doubt("file", what, "");
            }
            Found::Absent("does not exist") => {
                self.absent += 1;
                // The folder is searched for the first of them only.
                let near = if self.absent <= FAULTS_LISTED { suggest_file(file, folder) } else { None };
                let cure = near.unwrap_or("add the log, or delete this trial".to_string());
                section.reject("file", format!("there is no file `{}`", shown(file)), cure);
            }
            Found::Absent(what) => {
                section.reject("file", format!("`{file}` {what}"), "name the log, or delete this trial");
            }
        }
        let parts = Path::new(file).components().filter(|part| *part != Component::CurDir);
        let rows = rows.cloned().unwrap_or(0..usize::MAX);
        let listed = self.files.entry(parts.collect()).or_default();
        let same = listed.iter().find(|other| other.rows.start < rows.end && rows.start < other.rows.end);
        if let Some(first) = same {
            let shared =
                if first.rows.end == usize::MAX || rows.end == usize::MAX { "" } else { " with some of these rows" };
            let what = format!("`{file}` is listed already{shared}{}", in_row(first.row));
            section.reject("file", what, "delete one of the two trials, or give each its own `rows`");
            return false;
        }
        listed.push(Listed { row: section.row(), rows });
        matches!(found, Found::Here | Found::Linked(_))
    }

    /// Repeats differ in their number. Trials of free motion or with a person are repeats only where they name one
    /// trajectory.
    fn check_repeat(&mut self, section: &Section<'_>, entry: &TrialEntry) {
        let is_planned = matches!(entry.protocol, Protocol::Uniform { .. } | Protocol::Cosine);
        if !is_planned && entry.trajectory.is_none() {
            return;
        }
        let TrialEntry { protocol, repeat, trajectory, .. } = entry;
        match self.repeats.entry(format!("{protocol:?} {trajectory:?} {repeat}")) {
            Entry::Occupied(first) => {
                let key = if section.keys().any(|key| key == "repeat") { "repeat" } else { "file" };
                let same = if protocol.speed_rad_s().is_some() { "protocol, speed" } else { "protocol" };
                let what = format!("has {same}, trajectory and repeat ({repeat}) of the trial{}", in_row(*first.get()));
                section.doubt(key, what, "number the repeats of one motion 1, 2, 3 ..., or name their trajectories");
            }
            Entry::Vacant(place) => {
                place.insert(section.row());
            }
        }
    }
}

/// The part of its log that a trial is: data rows from 0, the end excluded.
fn rows(section: &Section<'_>) -> Option<Range<usize>> {
    let rows = section.may("rows").wholes(0, i64::MAX)?;
    match rows[..] {
        [start, end] if start < end => Some(usize::try_from(start).ok()?..usize::try_from(end).ok()?),
        _ => {
            let what = format!("is {rows:?}");
            section.reject("rows", what, "expected [first, end], data rows counted from 0, the end excluded");
            None
        }
    }
}

fn in_row(row: Option<u64>) -> String {
    row.map_or(String::new(), |row| format!(" in row {row}"))
}

fn protocol(section: &Section<'_>, kind: JointKind) -> Option<Protocol> {
    // The speed is filled in below.
    let sweep = Protocol::Uniform { speed_rad_s: f64::NAN };
    let all = [sweep, Protocol::Cosine, Protocol::Interaction, Protocol::Free];
    let protocol = section.need("protocol").choice(&all.map(|protocol| (protocol.name(), protocol)));
    match protocol {
        Some(Protocol::Uniform { .. }) if kind == JointKind::Prismatic => {
            let what = "is `uniform` on a prismatic joint: without an angle there is no y = A sin(theta) + B";
            section.reject("protocol", what, "write `free` and delete speed_rad_s");
            section.may("speed_rad_s").ignore();
            None
        }
        Some(Protocol::Uniform { .. }) => {
            let speed = section.need("speed_rad_s").such_as("0.1", "the sweep's speed, rad/s");
            speed.positive().map(|speed_rad_s| Protocol::Uniform { speed_rad_s })
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

fn suggest_file(file: &str, folder: &Path) -> Option<String> {
    let names: Vec<String> =
        std::fs::read_dir(folder).ok()?.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
    let near = crate::document::nearest(file, names.iter().map(String::as_str))?;
    Some(format!("did you mean `{near}`?"))
}
