//! `plan.toml`: which motions are to be recorded, how often, with which rests and limits.

use super::cause::Beyond;
use super::limits::Limits;
use crate::document::{Document, Section};
use crate::dynamics::JointKind;
use crate::log::{Protocol, TrialEntry};
use crate::problem::{Problem, Problems, Result};
use crate::trajectory::Trajectory;
use std::collections::BTreeSet;
use std::path::Path;

const FORMAT: &str = "plan/1";
/// The most of anything: more would be a slip of the finger.
const MANY: i64 = 1000;
/// A slower one takes an hour, rad/s.
const SLOWEST_SWEEP_RAD_S: f64 = 0.001;

/// What is to be recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The trials in order.
    pub trials: Vec<PlannedTrial>,
    /// Rest before each trial, s.
    pub rest_s: f64,
}

/// One trial.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannedTrial {
    /// Its place in the campaign's list.
    pub entry: TrialEntry,
    /// Its motion.
    pub trajectory: Trajectory,
}

impl Plan {
    /// Reads a plan for a joint of this `kind`; trajectories lie beside it.
    ///
    /// Errors: everything that is wrong with the file or its trajectories.
    pub fn read(file: &Path, kind: JointKind) -> Result<Self> {
        let folder = file.parent().unwrap_or(Path::new(""));
        Self::of(&Document::open(file)?, folder, kind)
    }

    /// The same from `text`, which is called `file` in messages.
    pub fn parse(file: &Path, text: &str, kind: JointKind) -> Result<Self> {
        Self::of(&Document::from_toml(file, text)?, file.parent().unwrap_or(Path::new("")), kind)
    }

    fn of(document: &Document, folder: &Path, kind: JointKind) -> Result<Self> {
        let mut list = List { trials: Vec::new(), folder, kind, problems: Vec::new() };
        let read = document.read(|root| {
            root.need("format").choice(&[(FORMAT, ())]);
            let rest_s = root.may("rest_s").not_negative().unwrap_or(1.0);
            let repeats = root.may("repeats").whole(1, MANY).unwrap_or(1);
            let motions = root.need("motions").such_as("[[motions]]", "one for each, with its protocol");
            motions.sections(|section| list.read(section, repeats))?;
            if list.trials.is_empty() && list.problems.is_empty() {
                root.reject("motions", "hold no trial", "add `[[motions]]` with its protocol");
            }
            Some(rest_s)
        });
        let problems = match &read {
            Err(Problems(found)) => found.iter().cloned().chain(list.problems).collect(),
            Ok(_) => list.problems,
        };
        let rest_s = Problems(problems).unless_errors(read.unwrap_or_default())?;
        let mut files = BTreeSet::new();
        match list.trials.iter().map(|trial| &trial.entry.file).find(|file| !files.insert(*file)) {
            Some(twice) => {
                let what = format!("two trials would be called {twice}");
                Problem::error(&document.file, what, "name the motions' trajectories differently").alone()
            }
            None => Ok(Self { trials: list.trials, rest_s }),
        }
    }

    /// Checks every motion, commanded every `period_s`, against `limits`; `file` is named in messages.
    ///
    /// Errors: every motion that goes beyond them.
    pub fn check(&self, file: &Path, limits: &Limits, period_s: f64) -> Result<()> {
        let mut told = BTreeSet::new();
        let problems = self.trials.iter().filter_map(|trial| {
            let positions_rad = trial.trajectory.positions_rad(1.0 / period_s);
            let (at, what, Beyond { found, limit }) = limits.first_beyond(&positions_rad, period_s)?;
            let stem = trial.entry.file.rsplit_once('_').map_or("", |(stem, _)| stem).to_string();
            let time_s = at as f64 * period_s;
            let what =
                format!("{stem} goes beyond the limit of {what} after {time_s:.3} s: {found:.4}, allowed {limit:.4}");
            told.insert(stem)
                .then(|| Problem::error(file, what, "change the motion, or the rig's [limits] if the joint can"))
        });
        Problems(problems.collect()).unless_errors(())
    }

    /// How long the trials take without rests and moves between them, s.
    pub fn duration_s(&self, period_s: f64) -> f64 {
        self.trials.iter().map(|trial| trial.trajectory.samples(1.0 / period_s) as f64 * period_s).sum()
    }
}

/// The trials as they are read.
struct List<'f> {
    trials: Vec<PlannedTrial>,
    folder: &'f Path,
    kind: JointKind,
    problems: Vec<Problem>,
}

impl List<'_> {
    fn read(&mut self, section: &Section<'_>, repeats: i64) -> Option<()> {
        let own_repeats = section.may("repeats").whole(1, MANY);
        let protocol = section.need("protocol").choice(&["uniform", "cosine", "free"].map(|name| (name, name)));
        match protocol.unwrap_or_default() {
            "uniform" => {
                let speeds_rad_s = speeds_rad_s(section)?;
                for speed_rad_s in speeds_rad_s {
                    let motion = Trajectory::sweep(speed_rad_s).on(self.kind);
                    let stem = format!("sweep_{speed_rad_s:.4}");
                    self.add(&stem, Protocol::Uniform { speed_rad_s }, own_repeats.unwrap_or(repeats), motion, None);
                }
            }
            "" => section.keys().for_each(|key| section.may(key).ignore()),
            name => {
                let protocol = if name == "cosine" { Protocol::Cosine } else { Protocol::Free };
                let file = match protocol {
                    Protocol::Cosine => section.may("trajectory"),
                    _ => section.need("trajectory").such_as("\"wide.toml\"", "a trajectory/1 file beside the plan"),
                };
                match file.text() {
                    Some(file) => self.add_file(&file, protocol, own_repeats, repeats),
                    None if protocol == Protocol::Cosine => {
                        let motion = Trajectory::cascade().on(self.kind);
                        self.add("cosine", protocol, own_repeats.unwrap_or(repeats), motion, None);
                    }
                    None => return None,
                }
            }
        }
        Some(())
    }

    fn add_file(&mut self, file: &str, protocol: Protocol, own_repeats: Option<i64>, repeats: i64) {
        match Trajectory::read(&self.folder.join(file)) {
            Ok(motion) => {
                let repeats = own_repeats.or(motion.repeats.map(i64::from)).unwrap_or(repeats);
                let name = motion.name.clone();
                self.add(&name, protocol, repeats, motion, Some(&name));
            }
            Err(Problems(found)) => self.problems.extend(found),
        }
    }

    fn add(&mut self, stem: &str, protocol: Protocol, repeats: i64, trajectory: Trajectory, name: Option<&str>) {
        for repeat in (1..=repeats).filter_map(|repeat| u32::try_from(repeat).ok()) {
            let file = format!("{stem}_{repeat}.csv");
            let entry = TrialEntry { file, protocol, repeat, trajectory: name.map(str::to_string), capture: None };
            self.trials.push(PlannedTrial { entry, trajectory: trajectory.clone() });
        }
    }
}

/// The speeds of sweeps: one, or many evenly in their logarithm, to a tenth of a mrad/s as `simulate` has them.
fn speeds_rad_s(section: &Section<'_>) -> Option<Vec<f64>> {
    if let Some(speed_rad_s) = section.may("speed_rad_s").positive() {
        return Some(vec![speed_rad_s]);
    }
    let speeds = section.may("speeds").whole(1, MANY).unwrap_or(20);
    let slowest = section.may("slowest_rad_s").positive().unwrap_or(0.02);
    let fastest = section.may("fastest_rad_s").positive().unwrap_or(0.4);
    if slowest < SLOWEST_SWEEP_RAD_S || fastest < slowest {
        let what = format!("is {slowest}, fastest_rad_s {fastest}");
        section.reject("slowest_rad_s", what, "expected 0.001 or more, and no more than fastest_rad_s");
        return None;
    }
    let ratio: f64 = fastest / slowest;
    let share = |i: i64| i as f64 / (speeds.max(2) - 1) as f64;
    Some((0..speeds).map(|i| (slowest * ratio.powf(share(i)) * 1e4).round() / 1e4).collect())
}
