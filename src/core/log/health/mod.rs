//! The health of a log's signals: every fault that a log shows by itself, found once for all commands.
//!
//! Single bad readings are interpolated; bad stretches are set aside, so that no fit and no figure uses them; faults that spoil the whole
//! log are refused; and faults that cannot be corrected but leave the log usable take the status `pinned` from the identified parameters.
//! Each finding is reported with its column, row and size.
//!
//! [`mend`] sees the readings as recorded, [`examine`] the same on an even grid in time.

mod bounds;
mod clipped;
mod copies;
mod glitch;
mod quantised;
mod stuck;

pub use copies::{Fingerprint, copies, refuse_copies};

use super::columns::Wanted;
use super::readings::{Readings, Rows};
use super::{POSITION, TIME, TORQUE};
use crate::problem::Problem;
use std::ops::Range;
use std::path::Path;

/// Above this share of readings that are glitches or drop-outs a straight line across them is no longer harmless.
const GLITCHES_MAX: f64 = 0.05;
/// Above this share of readings that are stuck, the rest is not worth much.
const STUCK_MAX: f64 = 0.5;
/// A stuck stretch no longer than this, s, is a lost frame or two; a straight line replaces it.
const BRIDGED_S: f64 = 0.02;

/// From here on a size is written with an exponent.
const LEGIBLE: f64 = 1e6;

/// What is wrong with a signal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Single readings far from those on both sides.
    Glitch,
    /// Single readings that drop to one constant.
    Dropout,
    /// One reading, repeated while the joint moves.
    Stuck,
    /// Readings at the end of the sensor's range.
    Clipped,
    /// Readings outside anything that a joint or its sensor shows.
    OutOfBounds,
    /// Steps far larger than the noise.
    Quantised,
}

/// What follows from a finding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Consequence {
    /// The log cannot be used.
    Refuse,
    /// Straight lines replace the readings.
    Bridge,
    /// The readings, and what the low-pass carries of them into their surroundings, are in no fit and no figure.
    SetAside,
    /// No parameter that is identified from the log is called pinned.
    Demote,
}

/// One thing that is wrong with one signal of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is.
    pub kind: Kind,
    /// What follows.
    pub consequence: Consequence,
    /// The column's name.
    pub column: String,
    /// The first row of the file that it concerns.
    pub row: u64,
    /// How many samples it concerns.
    pub samples: usize,
    /// How many the log has.
    pub of_samples: usize,
    /// How large it is, in `unit`: a glitch's height, the constant of a drop-out, of a stuck or clipped sensor, the farthest
    /// reading out of bounds, a step.
    pub size: f64,
    /// The column's unit.
    pub unit: &'static str,
}

impl Finding {
    fn new(kind: Kind, want: &Wanted, rows: &Rows, first: usize, samples: [usize; 2], size: f64) -> Self {
        let [samples, of_samples] = samples;
        let share = samples as f64 / of_samples as f64;
        let consequence = match kind {
            Kind::Glitch | Kind::Dropout if share <= GLITCHES_MAX => Consequence::Bridge,
            Kind::Stuck if share > STUCK_MAX => Consequence::Refuse,
            Kind::Stuck | Kind::Clipped => Consequence::SetAside,
            Kind::Quantised => Consequence::Demote,
            Kind::Glitch | Kind::Dropout | Kind::OutOfBounds => Consequence::Refuse,
        };
        let (column, unit) = (want.column.name.clone(), want.column.unit.name());
        Self { kind, consequence, column, row: rows.of(first), samples, of_samples, size, unit }
    }

    /// The same, as the reader of `file` is told it.
    pub fn problem(&self, file: &Path) -> Problem {
        let Self { samples, size, unit, .. } = self;
        let percent = 100.0 * *samples as f64 / self.of_samples as f64;
        let count = if *samples == 1 { "1 sample".to_string() } else { format!("{samples} samples") };
        let share = format!("{count} ({percent:.2} % of the log)");
        let what = match self.kind {
            Kind::Glitch => {
                let size = if *size < LEGIBLE { format!("{size:.4}") } else { format!("{size:.3e}") };
                format!("glitches of up to {size} {unit} in {share}: single readings far from those on both sides")
            }
            Kind::Dropout => format!("drops out to {size} {unit} in {share}"),
            Kind::Stuck => format!("stays at one reading, such as {size} {unit}, while the joint moves, in {share}"),
            Kind::Clipped => format!("reads exactly {size} {unit} in {share}: the sensor clips"),
            Kind::OutOfBounds => {
                format!("reads {size:e} {unit}, which no joint or sensor shows; such readings: {share}")
            }
            Kind::Quantised => format!(
                "changes in steps of {size:.4} {unit}, far larger than its noise: means over many samples are no more exact \
                 than single ones"
            ),
        };
        let cure = match (self.consequence, self.kind) {
            (Consequence::Bridge, _) => {
                "straight lines between the readings beside them replace these; check the sensor's plug, cable and shielding"
            }
            (Consequence::SetAside, Kind::Clipped) => {
                "these samples and those beside them are left out; record with a wider range or less load"
            }
            (Consequence::SetAside, _) => {
                "these samples and those beside them are left out; check the sensor's channel and the recorder"
            }
            (Consequence::Demote, _) => {
                "no parameter is called pinned; record with a smaller range or a finer resolution of the sensor"
            }
            (Consequence::Refuse, Kind::OutOfBounds) => {
                "correct these rows or the column's unit in campaign.toml, or delete this trial from it"
            }
            (Consequence::Refuse, _) => {
                "too many to be mended: check the sensor's plug, cable and channel, and record the trial again"
            }
        };
        let problem = match self.consequence {
            Consequence::Refuse => Problem::error(file, what, cure),
            _ => Problem::warning(file, what, cure),
        };
        problem.at_row(self.row).in_column(&self.column)
    }
}

/// Replaces glitches and drop-outs of position and torque, as recorded, by straight lines; all that was found in them.
pub(super) fn mend(recorded: &mut Readings, wanted: &[Wanted]) -> Vec<Finding> {
    let [first, .., last] = recorded.columns[TIME][..] else { return Vec::new() };
    // The mean: only how many samples a glitch may last depends on it.
    let rate_hz = (recorded.columns[TIME].len() - 1) as f64 / ((last - first) * wanted[TIME].factor());
    let mut findings = Vec::new();
    for column in [POSITION, TORQUE] {
        let want = &wanted[column];
        let [_, position, torque, ..] = &mut recorded.columns[..] else { break };
        let glitches = match column {
            POSITION => glitch::mend(position, rate_hz, None),
            _ => glitch::mend(torque, rate_hz, Some(&glitch::Corners::of(position, rate_hz))),
        };
        let signal = &recorded.columns[column];
        if let Some(first) = glitches.runs.first() {
            let (kind, size) = glitches.constant.map_or((Kind::Glitch, glitches.largest), |at| (Kind::Dropout, at));
            let samples = [glitches.samples(), signal.len()];
            findings.push(Finding::new(kind, want, &recorded.rows, first.start, samples, size));
        }
        let outside = if column == POSITION { bounds::position } else { bounds::torque };
        if let Some(run) = outside(signal, want.factor()) {
            let far = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
            let size = signal[run.clone()].iter().copied().fold(0.0, far);
            let samples = [run.len(), signal.len()];
            findings.push(Finding::new(Kind::OutOfBounds, want, &recorded.rows, run.start, samples, size));
        }
    }
    findings
}

/// What the even grid shows.
#[derive(Debug, Default)]
pub(super) struct Examined {
    /// All that was found.
    pub findings: Vec<Finding>,
    /// The samples at an end of the torque sensor's range.
    pub clipped: Vec<Range<usize>>,
    /// All samples that no fit and no figure may see, in order.
    pub set_aside: Vec<Range<usize>>,
}

/// Looks for clipped, stuck and quantised signals in `columns`, evenly sampled at `rate_hz`; stuck positions, and torques stuck
/// for a frame or two, are replaced by straight lines.
pub(super) fn examine(columns: &mut [Vec<f64>], rate_hz: f64, wanted: &[Wanted], rows: &Rows) -> Examined {
    let mut out = Examined::default();
    let samples = columns[TORQUE].len();
    let equal = clipped::equal_runs(&columns[TORQUE]);
    let ends = clipped::find(&columns[POSITION], &columns[TORQUE], rate_hz, &equal);
    for end in &ends {
        let count = [end.runs.iter().map(Range::len).sum(), samples];
        out.findings.push(Finding::new(Kind::Clipped, &wanted[TORQUE], rows, end.runs[0].start, count, end.reading));
    }
    out.clipped = clipped::merge(ends);
    let stuck = stuck::torque(&columns[POSITION], &columns[TORQUE], rate_hz, equal);
    let frozen = stuck::position(&columns[POSITION]);
    for (column, runs) in [(POSITION, &frozen), (TORQUE, &stuck)] {
        let Some(longest) = runs.iter().max_by_key(|run| run.len()) else { continue };
        let (count, size) = ([runs.iter().map(Range::len).sum(), samples], columns[column][longest.start]);
        out.findings.push(Finding::new(Kind::Stuck, &wanted[column], rows, runs[0].start, count, size));
    }
    if let Some(step) = quantised::step(&columns[POSITION], &columns[TORQUE], rate_hz) {
        out.findings.push(Finding::new(Kind::Quantised, &wanted[TORQUE], rows, 0, [samples; 2], step));
    }
    let is_brief = |run: &&Range<usize>| run.len() as f64 <= BRIDGED_S * rate_hz;
    frozen.iter().for_each(|run| glitch::bridge(&mut columns[POSITION], run));
    stuck.iter().filter(is_brief).for_each(|run| glitch::bridge(&mut columns[TORQUE], run));
    let long = stuck.into_iter().chain(frozen).filter(|run| !is_brief(&run));
    out.set_aside = glitch::joined(out.clipped.iter().cloned().chain(long).collect());
    out
}
