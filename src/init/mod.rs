//! Files as labs have them -> a draft of `campaign.toml`: columns, units, motions; what no data can tell stands as a question.
//!
//! | file | what it finds |
//! |---|---|
//! | `vocabulary` | the words that columns are named with |
//! | `names` | what a column's name says |
//! | `measure` | what a reading of 1 is |
//! | `columns` | which column holds what |
//! | `motion` | sweeps, cosines, free motion, rests |
//! | `physics` | what friction and gravity say of sign and zero |
//! | `trials` | the list of trials, repeats numbered |
//! | `answers` | answers to its questions |
//! | `text` | the draft as text |

mod answers;
mod columns;
mod guess;
mod measure;
mod motion;
mod names;
mod physics;
mod text;
mod trials;
mod vocabulary;

pub use answers::Answers;
pub use columns::{Choice, Chosen, Known};
pub use measure::Measure;
pub use physics::Hints;
pub use text::{Draft, Question, draft};
pub use trials::DraftTrial;

use crate::dynamics::JointKind;
use crate::import::{self, Series, without_missing_rows, without_repeated_rows};
use crate::log::{Files, raw};
use crate::problem::{Problem, Result};
use crate::units::Quantity;
use std::path::{Path, PathBuf};

/// A file as it was found.
#[derive(Debug, Clone)]
pub struct Source {
    /// Where it is.
    pub path: PathBuf,
    /// What it will be called in the campaign.
    pub name: String,
    /// How it is written, for people.
    pub form: String,
    /// Its columns of numbers on one clock.
    pub columns: Vec<Series>,
    /// What a row of units says of each.
    pub units: Vec<String>,
    /// Whether a campaign can hold it as it is.
    pub is_table: bool,
    /// Rows that repeated the row before and were dropped.
    pub repeated: usize,
    /// Rows without a reading of a chosen column that were dropped.
    pub missing: usize,
}

impl Source {
    /// Whether a campaign takes it as it is.
    pub fn stays(&self) -> bool {
        self.is_table && self.repeated == 0 && self.missing == 0
    }

    /// What its log is called in a campaign: as it is, or as the Parquet that is made of it.
    pub fn log_name(&self) -> String {
        match self.stays() {
            true => self.name.clone(),
            false => Path::new(&self.name).with_extension("parquet").to_string_lossy().into_owned(),
        }
    }
}

/// What all files together tell.
#[derive(Debug, Clone)]
pub struct Survey {
    /// The files.
    pub sources: Vec<Source>,
    /// Which column holds what.
    pub chosen: Chosen,
    /// The trials.
    pub trials: Vec<DraftTrial>,
    /// What friction and gravity say.
    pub hints: Hints,
    /// Sample rate of the files, Hz; 0 where no column holds time and none was given.
    pub rate_hz: f64,
}

/// Reads `path`, which will be called `name`.
///
/// Errors: it cannot be read, or holds no columns of numbers.
pub fn read(path: &Path, name: &str) -> Result<Source> {
    let (columns, units, form, is_table) = match import::read(path)? {
        Some(all) => {
            let clock = longest_clock(&all);
            let columns: Vec<Series> = all.into_iter().filter(|series| series.clock == clock).collect();
            let form = path.extension().map_or(String::new(), |e| e.to_string_lossy().to_ascii_uppercase());
            (columns, Vec::new(), form, false)
        }
        None => {
            let raw = raw(path, &Files::default())?;
            (raw.columns, raw.units, raw.form, true)
        }
    };
    if columns.len() < 2 {
        let what = format!("holds {} columns of numbers; a position and a torque are needed", columns.len());
        let cure = match path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("mat")) {
            true => "save each signal as a vector, the fields of a structure with `save -struct`, or all with `-v7.3`",
            false => "name logs with a column for each signal",
        };
        return Problem::error(path, what, cure).alone();
    }
    Ok(Source {
        path: path.to_path_buf(),
        name: name.to_string(),
        form,
        columns,
        units,
        is_table,
        repeated: 0,
        missing: 0,
    })
}

/// The clock that most columns share.
fn longest_clock(all: &[Series]) -> usize {
    let count = |clock: usize| all.iter().filter(|series| series.clock == clock).count();
    all.iter().map(|series| series.clock).max_by_key(|clock| (count(*clock), usize::MAX - clock)).unwrap_or(0)
}

/// Finds columns and motions in `sources`, at least one, with what is `known`.
///
/// Errors: files whose columns differ.
pub fn survey(mut sources: Vec<Source>, known: &Known) -> Result<Survey> {
    let first = &sources[0];
    let mut chosen = columns::choose(&first.columns, &first.units, known);
    if let Some(joint) = known.joint.as_ref().filter(|joint| !chosen.joints.contains(joint)) {
        let cure = format!("the files hold: {}", chosen.joints.join(", "));
        return Problem::error(&first.path, format!("holds no position of a joint `{joint}`"), cure).alone();
    }
    for source in &sources[1..] {
        let has = |name: &str| source.columns.iter().any(|series| series.name == name);
        if let Some(lacking) = chosen.columns.iter().find(|choice| !has(&choice.name)) {
            let what = format!("has no column `{}`, as {} has it", lacking.name, first.path.display());
            return Problem::error(&source.path, what, "make a campaign of files with the same columns").alone();
        }
    }
    mend(&mut sources, &mut chosen);
    let (trials, found_hz) = trials::list(&sources, &mut chosen, known.rate_hz);
    let recordings = recordings(&sources, &chosen, &trials);
    let hints = physics::hints(&recordings, chosen.kind == JointKind::Revolute);
    Ok(Survey { sources, chosen, trials, hints, rate_hz: found_hz })
}

/// Drops rows that repeat, and, where time tells what is lacking, rows without a reading; notes how many.
fn mend(sources: &mut [Source], chosen: &mut Chosen) {
    let is_chosen = |name: &str| chosen.columns.iter().any(|choice| choice.name == name);
    for source in sources.iter_mut() {
        source.repeated += without_repeated_rows(&mut source.columns, time_name(chosen));
        if !chosen.lacks_time {
            source.missing += without_missing_rows(&mut source.columns, is_chosen);
        }
    }
    for source in sources.iter() {
        let (name, Source { repeated, missing, .. }) = (source.path.display(), source);
        if *repeated > 0 {
            chosen.notes.push(format!("{name} repeats {repeated} rows, which are dropped"));
        }
        if *missing > 0 {
            chosen.notes.push(format!("{name} lacks a reading in {missing} rows, which are dropped"));
        }
    }
}

/// The name of the column of time, if there is one.
fn time_name(chosen: &Chosen) -> Option<&str> {
    chosen.of(Quantity::Time).map(|choice| choice.name.as_str())
}

/// Position and torque (or current, or how far the command is ahead) in SI of each sweep, or where there is none of each trial: in cosines friction that changes with
/// speed looks like gravity.
fn recordings(sources: &[Source], chosen: &Chosen, trials: &[DraftTrial]) -> Vec<(Vec<f64>, Vec<f64>)> {
    let torque = chosen.of(Quantity::Torque).or(chosen.of(Quantity::Current)).or(chosen.of(Quantity::Command));
    let has_sweeps = trials.iter().any(|trial| trial.protocol.speed_rad_s().is_some());
    let pair = |trial: &DraftTrial| {
        let source = &sources[trial.source];
        let (position, mut torque) = (values(source, chosen.of(Quantity::Position)?)?, values(source, torque?)?);
        if chosen.is_position_alone() {
            // A controller pulls as the joint is behind its command.
            torque.iter_mut().zip(&position).for_each(|(command, position)| *command -= position);
        }
        let rows = trial.rows.clone().unwrap_or(0..position.len());
        Some((position[rows.clone()].to_vec(), torque[rows].to_vec()))
    };
    trials.iter().filter(|trial| !has_sweeps || trial.protocol.speed_rad_s().is_some()).filter_map(pair).collect()
}

/// The column of `choice` in a file, in SI.
fn values(source: &Source, choice: &Choice) -> Option<Vec<f64>> {
    let series = source.columns.iter().find(|series| series.name == choice.name)?;
    Some(series.values.iter().map(|value| value * choice.measure.factor()).collect())
}
