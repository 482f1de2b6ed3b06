//! `plan.toml`: which motions are to be recorded, how often, with which rests and limits.

use super::cause::Beyond;
use super::limits::Limits;
use crate::document::{Document, Section};
use crate::dynamics::JointKind;
use crate::log::TrialEntry;
use crate::problem::{Problem, Problems, Result};
use crate::trajectory::{Trajectory, Uniform, read_all};
use std::collections::BTreeSet;
use std::path::Path;

const FORMAT: &str = "plan/1";
/// The most of anything: more would be a slip of the finger.
const MANY: i64 = 1000;
/// The longest rest before a trial, s.
const LONGEST_REST_S: f64 = 3600.0;
/// A slower one takes an hour, rad/s.
const SLOWEST_SWEEP_RAD_S: f64 = 0.001;
/// No joint here is faster, rad/s.
const FASTEST_SWEEP_RAD_S: f64 = 100.0;

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
            if rest_s > LONGEST_REST_S {
                root.reject("rest_s", format!("is {rest_s}"), format!("expected {LONGEST_REST_S} s at most"));
            }
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

    /// What of the motions is not recorded, in words: a rig moves one joint.
    pub fn left_out(&self) -> impl Iterator<Item = String> {
        let first = self.trials.iter().filter(|trial| trial.entry.repeat == 1);
        let moving = first.map(|trial| &trial.trajectory).filter(|motion| !motion.others.is_empty());
        moving.map(|Trajectory { name, others, .. }| {
            format!("`{name}` moves {} other joints along, which this rig neither drives nor records", others.len())
        })
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
        let has_file = section.keys().any(|key| key == "trajectory");
        let motions = match has_file {
            true => {
                let file = self.folder.join(section.need("trajectory").text()?);
                read_all(&[file]).unwrap_or_else(|Problems(found)| {
                    self.problems.extend(found);
                    Vec::new()
                })
            }
            false => {
                let built_in = [("uniform", true), ("cosine", false)];
                let means = "or `trajectory = \"wide.toml\"`, a file or a folder of them beside the plan";
                match section.need("protocol").such_as("\"uniform\"", means).choice(&built_in)? {
                    true => read_uniform(section)?.trajectories(),
                    false => vec![Trajectory::cascade()],
                }
            }
        };
        for motion in motions {
            // What a file holds is as it stands; the built-in ones are those of a revolute joint.
            let motion = if has_file { motion } else { motion.on(self.kind) };
            let repeats = own_repeats.or(motion.repeats.map(i64::from)).unwrap_or(repeats);
            (1..=repeats).filter_map(|repeat| u32::try_from(repeat).ok()).for_each(|repeat| self.add(&motion, repeat));
        }
        Some(())
    }

    fn add(&mut self, motion: &Trajectory, repeat: u32) {
        let entry = TrialEntry {
            file: format!("{}_{repeat}.csv", motion.name),
            part: None,
            protocol: motion.protocol,
            repeat,
            trajectory: motion.name_in_a_campaign(),
            capture: None,
            controller: None,
        };
        self.trials.push(PlannedTrial { entry, trajectory: motion.clone() });
    }
}

/// Sweeps at one speed, or at many evenly in their logarithm.
fn read_uniform(section: &Section<'_>) -> Option<Uniform> {
    let default = Uniform::default();
    if let Some(speed) = section.may("speed_rad_s").positive() {
        if !(SLOWEST_SWEEP_RAD_S..=FASTEST_SWEEP_RAD_S).contains(&speed) {
            section.reject("speed_rad_s", format!("is {speed}"), "expected 0.001 to 100");
            return None;
        }
        return Some(Uniform { speeds: 1, slowest_rad_s: speed, fastest_rad_s: speed, ..default });
    }
    let speeds = section.may("speeds").whole(1, MANY).and_then(|speeds| usize::try_from(speeds).ok());
    let slowest_rad_s = section.may("slowest_rad_s").positive().unwrap_or(default.slowest_rad_s);
    let fastest_rad_s = section.may("fastest_rad_s").positive().unwrap_or(default.fastest_rad_s);
    if slowest_rad_s < SLOWEST_SWEEP_RAD_S || fastest_rad_s < slowest_rad_s || fastest_rad_s > FASTEST_SWEEP_RAD_S {
        let what = format!("is {slowest_rad_s}, fastest_rad_s {fastest_rad_s}");
        section.reject(
            "slowest_rad_s",
            what,
            "expected 0.001 or more, no more than fastest_rad_s, and that 100 at most",
        );
        return None;
    }
    Some(Uniform { speeds: speeds.unwrap_or(default.speeds), slowest_rad_s, fastest_rad_s, ..default })
}
