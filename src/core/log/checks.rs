//! What would make a log useless, found before anything is computed from it.

use super::campaign::{Signal, TrialEntry};
use super::columns::Wanted;
use super::readings::{Faults, Readings, Rows};
use crate::numerics::filter::LowPass;
use crate::problem::Problem;
use crate::trajectory::Protocol;
use crate::units::Quantity;

/// A pause between samples longer than this many periods is a hole that no interpolation fills. The last digit
/// leaves room for rounded time stamps.
const GAP_PERIODS: f64 = 3.01;
/// Where a recorder counted what it missed, a pause may last this share of a period of the low-pass's cut-off: what is drawn
/// straight across it is then not seen.
const CAPTURED_GAP_PERIODS: f64 = 0.1;
/// The longest gap in a captured trial that does not spoil it, s, where that is more than a few samples.
pub fn longest_gap_s(lowpass_hz: f64) -> f64 {
    CAPTURED_GAP_PERIODS / lowpass_hz
}

/// A log must last this many periods of the low-pass's cut-off; in less there is nothing left to filter.
const CUTOFF_PERIODS_MIN: f64 = 2.0;

/// Checks one log's time stamps, length and sensors, as far as the wanted columns are there; with `signal`, which goes with
/// columns of known unit, its rate and duration too. What is wrong goes to `faults`.
pub(super) fn check(
    readings: &Readings,
    wanted: &[Wanted],
    signal: Option<&Signal>,
    entry: &TrialEntry,
    faults: &mut Faults<'_>,
) {
    let samples = readings.columns.first().map_or(0, Vec::len);
    // An empty table says no more than that its columns are missing.
    if samples == 0 && faults.count() > 0 {
        return;
    }
    if signal.is_some_and(|signal| !enough_samples(faults, samples, signal)) {
        return;
    }
    let column = |quantity| {
        let (index, want) = wanted.iter().enumerate().find(|(_, want)| want.quantity == quantity)?;
        Some((readings.columns[index].as_slice(), want))
    };
    if let Some((time, want)) = column(Quantity::Time) {
        let gap_s = signal.filter(|_| entry.capture.is_some()).map_or(0.0, |s| longest_gap_s(s.lowpass_hz));
        let tell = stamps(faults, time, want, gap_s, &readings.rows);
        if let Some(signal) = signal.filter(|_| tell) {
            rate_and_duration(faults, time, want, signal);
        }
    }
    // A command may well be constant.
    if let Some((torque, want)) = column(Quantity::Torque).filter(|(_, want)| want.controller().is_none()) {
        alive(faults, torque, want, "a sensor that lives never reads so");
    }
    let position = column(Quantity::Position).filter(|_| matches!(entry.protocol, Protocol::Uniform { .. }));
    if let Some((position, want)) = position {
        alive(faults, position, want, "a sweep moves the joint");
    }
}

/// Of a long log the median step is judged by this many of its steps at least, ...
const STEPS_JUDGED: usize = 1 << 14;
/// ... in blocks of as many, spread over it: within a block rounded stamps keep their rhythm (0.3, 0.3, 0.4).
const STEPS_IN_BLOCK: usize = 1 << 10;

/// The median of the steps between time stamps in consecutive rows, in their unit; `None` if there are no two of them.
pub(super) fn median_period(time: &[f64]) -> Option<f64> {
    let mut steps = Vec::with_capacity(time.len());
    for block in in_blocks(time) {
        steps.extend(block.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| step.is_finite()));
    }
    let middle = steps.len() / 2;
    (!steps.is_empty()).then(|| *steps.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// The stretches of `time` by which its median step is judged: all of it, or blocks spread evenly over a long log.
fn in_blocks(time: &[f64]) -> impl Iterator<Item = &[f64]> {
    let apart = (time.len() / STEPS_JUDGED).max(1);
    let block = if apart > 1 { STEPS_IN_BLOCK } else { time.len().max(1) };
    (0..time.len()).step_by(apart * block).map(move |start| &time[start..(start + block + 1).min(time.len())])
}

/// SciPy's `sosfiltfilt`, whose edges ours equal, mirrors that many samples at each end and needs one more.
fn enough_samples(faults: &mut Faults<'_>, samples: usize, signal: &Signal) -> bool {
    let padding = LowPass::padding(signal.lowpass_order);
    if samples <= padding {
        faults.add("too few samples", |file| {
            let what = format!(
                "has {samples} samples; a low-pass of order {} needs more than {padding}",
                signal.lowpass_order
            );
            Problem::error(file, what, "record longer, or delete this trial from campaign.toml")
        });
    }
    samples > padding
}

/// Two consecutive time stamps, ignoring empty cells between them.
struct Step {
    from: f64,
    to: f64,
    /// The later one's sample.
    sample: usize,
    /// Rows from one to the other.
    rows: usize,
}

fn steps(time: &[f64]) -> impl Iterator<Item = Step> {
    let known = |last: usize| (last..time.len()).find(|sample| time[*sample].is_finite());
    let mut last = known(0);
    std::iter::from_fn(move || {
        let from = last?;
        last = known(from + 1);
        last.map(|sample| Step { from: time[from], to: time[sample], sample, rows: sample - from })
    })
}

/// Time stamps that do not grow, and gaps of more than a few periods that are longer than `gap_s` too; whether the stamps tell
/// a rate.
fn stamps(faults: &mut Faults<'_>, time: &[f64], want: &Wanted, gap_s: f64, rows: &Rows) -> bool {
    let period = median_period(time);
    // Nearly all logs have nothing to tell: one look at every step decides.
    let most = GAP_PERIODS * period.unwrap_or(0.0);
    if time.windows(2).all(|pair| pair[1] > pair[0] && pair[1] - pair[0] <= most) {
        return period.is_some();
    }
    let before = faults.count();
    for step in steps(time).filter(|step| step.to <= step.from) {
        faults.add("time that does not grow", |file| {
            let what = format!("{} {unit} comes after {} {unit}", step.to, step.from, unit = want.column.unit.name());
            Problem::error(file, what, "time must grow with every row: delete repeated rows, sort the others")
                .at_row(rows.of(step.sample))
                .in_column(&want.column.name)
        });
    }
    let Some(period) = period.filter(|_| faults.count() == before) else { return false };
    let periods = |step: &Step| (step.to - step.from) / (period * step.rows as f64);
    let longest = GAP_PERIODS.max(gap_s / (period * want.factor()));
    for step in steps(time).filter(|step| periods(step) > longest) {
        faults.add("a gap before them", |file| {
            let gap_s = (step.to - step.from) * want.column.unit.factor();
            let what = format!("a gap of {gap_s:.6} s before this row: {:.1} sample periods", periods(&step));
            Problem::error(file, what, "split the log here into two trials, or record it without drop-outs")
                .at_row(rows.of(step.sample))
                .in_column(&want.column.name)
        });
    }
    true
}

fn rate_and_duration(faults: &mut Faults<'_>, time: &[f64], want: &Wanted, signal: &Signal) {
    let known = || time.iter().enumerate().filter(|(_, stamp)| stamp.is_finite());
    let (Some((first, start)), Some((last, end))) = (known().next(), known().next_back()) else { return };
    let rate_hz = (last - first) as f64 / ((end - start) * want.factor());
    let duration_s = (time.len() - 1) as f64 / rate_hz;
    let lowpass_hz = signal.lowpass_hz;
    let unit = want.column.unit.name();
    let mut fault = |kind, what: String, cure: String| {
        let cure = format!("in campaign.toml correct the unit of time (now `{unit}`) or lowpass_hz, or {cure}");
        faults.add(kind, |file| Problem::error(file, what, cure).in_column(&want.column.name));
    };
    if lowpass_hz >= rate_hz / 2.0 {
        let what = format!("sampled at {rate_hz:.6} Hz, too slowly for a low-pass at {lowpass_hz} Hz");
        fault("too slow", what, format!("record faster than {} Hz", 2.0 * lowpass_hz));
    }
    let least_s = CUTOFF_PERIODS_MIN / lowpass_hz;
    if duration_s < least_s {
        let what = format!("lasts {duration_s:.6} s, too short for a low-pass at {lowpass_hz} Hz");
        fault("too short", what, format!("record for {least_s:.3} s or longer"));
    }
}

/// A column that never changes comes from a sensor that is not connected.
fn alive(faults: &mut Faults<'_>, column: &[f64], want: &Wanted, why: &str) {
    let mut known = column.iter().filter(|reading| reading.is_finite());
    let Some(first) = known.next() else { return };
    if known.all(|reading| reading == first) {
        faults.add("a dead sensor", |file| {
            let what = format!("reads {first} {} throughout; {why}", want.column.unit.name());
            Problem::error(file, what, "check the sensor's plug and the recorder's channel")
                .in_column(&want.column.name)
        });
    }
}
