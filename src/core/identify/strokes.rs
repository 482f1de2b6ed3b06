//! Whole series as fits and judgements use them: stroke by stroke, thinned, each filtered with as much around it as it needs.

use super::predicted::{PADDING_PERIODS, Prepared};
use crate::model::{Direction, Model, settle};
use rayon::prelude::*;
use std::ops::Range;

/// Residuals per period of the low-pass: they are smooth, more would say the same again.
const ROWS_PER_PERIOD: f64 = 5.0;

/// The motion from one reversal to the next.
#[derive(Debug, Clone)]
pub struct Stroke {
    /// Where it goes.
    pub direction: Direction,
    /// Places of the residuals.
    pub rows: Vec<usize>,
    /// The samples that the low-pass needs for them.
    padded: Range<usize>,
}

/// The strokes of one trial that a fit or a judgement uses.
#[derive(Debug, Clone)]
pub struct Part<'a> {
    /// The trial.
    pub trial: &'a Prepared,
    /// In order of time.
    pub strokes: Vec<Stroke>,
    /// The samples that the strokes need: those of neighbours in one piece.
    stretches: Vec<Range<usize>>,
}

impl<'a> Part<'a> {
    /// All strokes of `trial`, of each the samples whose sensor was in range and whose K~ is known for a clearance of
    /// `backlash_rad` or less, thinned to what the low-pass leaves; strokes of less than a period of it are left out. Without a
    /// clearance friction jumps: samples at which that is [undecided](Prepared::undecided) are left out.
    pub fn new(trial: &'a Prepared, backlash_rad: f64, lowpass_hz: f64) -> Self {
        let period = trial.series.rate_hz / lowpass_hz;
        let step = ((period / ROWS_PER_PERIOD) as usize).max(1);
        let pad = (PADDING_PERIODS * period) as usize;
        let (_, known_from) = settle(&trial.series.position_rad, backlash_rad, trial.series.deadband_rad);
        let undecided = if backlash_rad > 0.0 { Vec::new() } else { trial.undecided() };
        let usable = |i: &usize| *i >= known_from && trial.series.in_range[*i] && undecided.get(*i) != Some(&true);
        let stroke = |(samples, direction): (Range<usize>, Direction)| {
            let padded = samples.start.saturating_sub(pad)..(samples.end + pad).min(trial.len());
            let first = samples.start.next_multiple_of(step);
            Stroke { direction, rows: (first..samples.end).step_by(step).filter(usable).collect(), padded }
        };
        let strokes = trial.strokes().into_iter().map(stroke);
        Self::of(trial, strokes.filter(|s| s.rows.len() as f64 >= ROWS_PER_PERIOD).collect())
    }

    /// These `strokes` of `trial`, in order of time.
    pub fn of(trial: &'a Prepared, strokes: Vec<Stroke>) -> Self {
        let mut stretches: Vec<Range<usize>> = Vec::new();
        for stroke in &strokes {
            match stretches.last_mut() {
                Some(last) if stroke.padded.start <= last.end => last.end = stroke.padded.end,
                _ => stretches.push(stroke.padded.clone()),
            }
        }
        Self { trial, strokes, stretches }
    }

    /// Whether a stroke goes in `direction`.
    pub fn moves(&self, direction: Direction) -> bool {
        self.strokes.iter().any(|stroke| stroke.direction == direction)
    }

    /// Residuals.
    pub fn count(&self) -> usize {
        self.strokes.iter().map(|stroke| stroke.rows.len()).sum()
    }

    /// Each of `L` signals, given together for each sample, through the low-pass, at the rows.
    pub fn low_passed<const L: usize>(&self, signals: impl Fn(usize) -> [f64; L]) -> [Vec<f64>; L] {
        let mut rows = self.strokes.iter().flat_map(|stroke| &stroke.rows).peekable();
        let mut out: [Vec<f64>; L] = std::array::from_fn(|_| Vec::with_capacity(self.count()));
        for stretch in &self.stretches {
            let mut filtered: Vec<[f64; L]> = stretch.clone().map(&signals).collect();
            self.trial.low_pass_together(&mut filtered);
            while let Some(i) = rows.next_if(|i| **i < stretch.end) {
                out.iter_mut().zip(filtered[i - stretch.start]).for_each(|(out, x)| out.push(x));
            }
        }
        out
    }

    /// Predicted less measured at the rows, both through the low-pass, N m.
    pub fn residual_nm(&self, model: &Model) -> Vec<f64> {
        let (k_tilde, _) = self.trial.k_tilde(model);
        let series = &self.trial.series;
        let torque_nm = self.trial.torque_nm(model);
        let torque = |i: usize| [torque_nm(i, k_tilde[i])];
        let rows = self.strokes.iter().flat_map(|stroke| &stroke.rows);
        let [predicted_nm] = self.low_passed(torque);
        predicted_nm.iter().zip(rows).map(|(p, i)| p - series.torque_nm[*i]).collect()
    }
}

/// Sum of squares and number of samples of each stroke, trial by trial.
pub fn square_sums(parts: &[Part], model: &Model) -> Vec<Vec<(f64, f64)>> {
    let of = |part: &Part| {
        let residual = part.residual_nm(model);
        let mut rest = residual.as_slice();
        let sum = |stroke: &Stroke| {
            let (mine, others) = rest.split_at(stroke.rows.len());
            rest = others;
            (mine.iter().map(|r| r * r).sum(), mine.len() as f64)
        };
        part.strokes.iter().map(sum).collect()
    };
    parts.par_iter().map(of).collect()
}
