//! Oscillations of a residual at one frequency in time: mains hum folded into the band, a resonance, a base that sways. They do not repeat with
//! the motion, and still they are not noise: a line in the spectrum that stands out of its neighbourhood.

use super::criteria::Decision;
use super::data::DataSet;
use super::policy::Policy;
use super::records::Records;
use crate::numerics::statistics::quantile;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::ops::Range;

/// Longest stretch that is taken as one, in periods of the low-pass: a frequency that wanders a little stays one line.
const STRETCH_PERIODS: f64 = 400.0;
/// Rows that a stretch must have.
const ROWS_MIN: usize = 32;
/// Frequencies per width 1/T of a line in a stretch of length T.
const FINENESS: f64 = 4.0;
/// Half the width of a line behind the window that tapers a stretch, in 1/T, and how far its neighbourhood reaches.
const WIDTH: f64 = 2.0;
const NEIGHBOURHOOD: f64 = 8.0;
/// Most of them.
const MOST: usize = 3;
/// Frequencies are the same within so many 1/T, beside the errors of both.
const RESOLVED: f64 = 0.5;
/// The error of the motion's own frequency, in 1/T; a multiple's is as many times as large.
const OF_MOTION: f64 = 0.05;

/// One oscillation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Oscillation {
    /// Hz.
    pub frequency_hz: f64,
    /// Its power over the median of its neighbourhood.
    pub prominence: f64,
    /// Its share of the residual's mean square.
    pub share: f64,
}

impl Oscillation {
    /// The rule by which it is one.
    pub fn decision(&self, policy: &Policy) -> Decision {
        let Self { prominence, .. } = *self;
        Decision {
            rule: "oscillation",
            subject: "remainder",
            value: prominence,
            limit: policy.oscillation_prominence,
            outcome: "no noise",
        }
    }
}

/// Rows of one record that are analysed together, with when each was, s.
struct Stretch {
    rows: Range<usize>,
    time_s: Vec<f64>,
}

/// The oscillations of `residual_nm`, at the rows of `data`, that are not in step with a motion to and fro, and the residual without them,
/// N m.
pub fn without_oscillations(data: &DataSet, residual_nm: &[f64]) -> (Vec<Oscillation>, Vec<f64>) {
    let policy = &data.policy;
    let stretches = Stretches::new(policy, &data.records);
    let (of_motion, _) = stretches.lines(data.records.rows(|record, i| record.own[i].velocity), &|_| true);
    // What a motion to and fro brings about comes at its multiples, whatever the joint lacks.
    let is_multiple = |hz: f64, of: &Oscillation| {
        let order = (hz / of.frequency_hz).round();
        let apart_hz = (hz - order * of.frequency_hz).abs();
        let within = RESOLVED + OF_MOTION * order;
        (1.0..=policy.oscillation_orders).contains(&order) && apart_hz * stretches.length_s < within
    };
    stretches.lines(residual_nm.to_vec(), &|hz| !of_motion.iter().any(|line| is_multiple(hz, line)))
}

/// All of them, with how fine a spectrum they give.
struct Stretches<'p> {
    policy: &'p Policy,
    all: Vec<Stretch>,
    /// The usual length, s.
    length_s: f64,
    /// Between the frequencies that are looked at, up to the low-pass, Hz.
    step_hz: f64,
    lowpass_hz: f64,
}

impl<'p> Stretches<'p> {
    fn new(policy: &'p Policy, records: &Records) -> Self {
        let longest_s = STRETCH_PERIODS / records.lowpass_hz;
        let mut all: Vec<Stretch> = Vec::new();
        for (record, range) in records.all.iter().zip(&records.ranges) {
            let time_s: Vec<f64> = record.rows.iter().map(|i| record.time_s[*i]).collect();
            let duration_s = time_s.last().zip(time_s.first()).map_or(0.0, |(last, first)| last - first);
            let length = time_s.len().div_ceil((duration_s / longest_s).ceil().max(1.0) as usize).max(1);
            let parts = time_s.chunks(length).enumerate().filter(|(_, part)| part.len() >= ROWS_MIN);
            all.extend(parts.map(|(at, part)| {
                let from = range.start + at * length;
                Stretch { rows: from..from + part.len(), time_s: part.to_vec() }
            }));
        }
        let mut lengths_s: Vec<f64> =
            all.iter().map(|stretch| stretch.time_s[stretch.time_s.len() - 1] - stretch.time_s[0]).collect();
        let length_s = if all.is_empty() { 0.0 } else { quantile(&mut lengths_s, 0.5) };
        Self { policy, all, length_s, step_hz: 1.0 / (FINENESS * length_s), lowpass_hz: records.lowpass_hz }
    }

    /// The lines of `series` at frequencies that `counts` lets through, the strongest first, and what is left without them.
    fn lines(&self, mut series: Vec<f64>, counts: &dyn Fn(f64) -> bool) -> (Vec<Oscillation>, Vec<f64>) {
        let square = |series: &[f64]| series.iter().map(|r| r * r).sum::<f64>();
        let (mut found, whole) = (Vec::new(), square(&series));
        while found.len() < MOST {
            let Some((frequency_hz, prominence)) = self.strongest(&series, counts) else { break };
            let before = square(&series);
            self.all.iter().for_each(|stretch| subtract(stretch, frequency_hz, &mut series));
            found.push(Oscillation { frequency_hz, prominence, share: (before - square(&series)) / whole });
        }
        (found, series)
    }

    /// The strongest frequency of `series` that counts, Hz, and how far it stands out of its neighbourhood; nothing where it does not.
    fn strongest(&self, series: &[f64], counts: &dyn Fn(f64) -> bool) -> Option<(f64, f64)> {
        let count = if self.length_s > 0.0 { (self.lowpass_hz / self.step_hz) as usize } else { 0 };
        let hz = |k: usize| k as f64 * self.step_hz;
        let power: Vec<f64> = (0..=count)
            .into_par_iter()
            .map(|k| self.all.iter().map(|stretch| stretch.power(series, hz(k))).sum())
            .collect();
        let [width, around] = [WIDTH, NEIGHBOURHOOD].map(|widths| (widths * FINENESS) as usize);
        let first = ((self.policy.oscillation_periods * FINENESS) as usize).max(1);
        let best = (first..count).filter(|k| counts(hz(*k))).max_by(|a, b| power[*a].total_cmp(&power[*b]))?;
        let near = best.saturating_sub(around)..(best + around + 1).min(power.len());
        let mut neighbours: Vec<f64> = near.filter(|k| k.abs_diff(best) > width).map(|k| power[k]).collect();
        let prominence = power[best] / quantile(&mut neighbours, 0.5);
        // The top of the parabola through the logarithms of three powers.
        let [a, b, c] = [best - 1, best, best + 1].map(|k| power[k].max(f64::MIN_POSITIVE).ln());
        let bend = a - 2.0 * b + c;
        let offset = if bend < 0.0 { ((a - c) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 };
        (prominence >= self.policy.oscillation_prominence).then_some((hz(best) + offset * self.step_hz, prominence))
    }
}

/// Takes the best sine and cosine of `frequency_hz`, and with them a constant that is left in, out of the residual along `stretch`.
fn subtract(stretch: &Stretch, frequency_hz: f64, residual_nm: &mut [f64]) {
    let columns = DMatrix::from_fn(stretch.time_s.len(), 3, |row, column| {
        let angle = TAU * frequency_hz * (stretch.time_s[row] - stretch.time_s[0]);
        [angle.cos(), angle.sin(), 1.0][column]
    });
    let part_nm = &mut residual_nm[stretch.rows.clone()];
    let normal = columns.tr_mul(&columns);
    let Some(cholesky) = normal.cholesky() else { return };
    let mut x = cholesky.solve(&columns.tr_mul(&DVector::from_column_slice(part_nm)));
    x[2] = 0.0;
    part_nm.iter_mut().zip((columns * x).iter()).for_each(|(r, fitted)| *r -= fitted);
}

impl Stretch {
    /// Power of `residual_nm` along it at `frequency_hz`, tapered by Hann's window, its mean left out.
    fn power(&self, residual_nm: &[f64], frequency_hz: f64) -> f64 {
        let (part_nm, n) = (&residual_nm[self.rows.clone()], self.time_s.len());
        let mean_nm = part_nm.iter().sum::<f64>() / n as f64;
        // A row follows the other evenly but where some are set aside: the phase is carried on from one to the next.
        let (mut sine, mut cosine) = (0.0, 0.0);
        let (mut step_s, mut turn, mut phase) = (0.0, (0.0, 1.0), (0.0f64, 1.0f64));
        let mut taper = (0.0f64, 1.0f64);
        let taper_turn = (TAU / (n - 1) as f64).sin_cos();
        for (i, r) in part_nm.iter().enumerate() {
            if i > 0 {
                let since_s = self.time_s[i] - self.time_s[i - 1];
                if (since_s - step_s).abs() > 1e-9 {
                    step_s = since_s;
                    turn = (TAU * frequency_hz * step_s).sin_cos();
                }
                phase = turned(phase, turn);
                taper = turned(taper, taper_turn);
            }
            let weighted = (r - mean_nm) * (1.0 - taper.1);
            sine += weighted * phase.0;
            cosine += weighted * phase.1;
        }
        (sine * sine + cosine * cosine) / n as f64
    }
}

/// Sine and cosine of the sum of two angles.
fn turned((sin_a, cos_a): (f64, f64), (sin_b, cos_b): (f64, f64)) -> (f64, f64) {
    (sin_a * cos_b + cos_a * sin_b, cos_a * cos_b - sin_a * sin_b)
}

#[cfg(test)]
mod tests {
    use super::{Oscillation, without_oscillations};
    use crate::diagnose::data::tests::bundled;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};
    use std::f64::consts::TAU;

    #[test]
    fn a_hum_that_beats_is_two_oscillations_and_noise_is_none() {
        let (data, _) = bundled();
        let mut random = ChaCha8Rng::seed_from_u64(7);
        let time_s = data.records.rows(|record, i| record.time_s[i]);
        let noise_nm: Vec<f64> = time_s.iter().map(|_| StandardNormal.sample(&mut random)).collect();
        assert_eq!(without_oscillations(&data, &noise_nm).0, []);
        let hum = |t: &f64| (TAU * 4.8 * t).sin() + 0.8 * (TAU * 6.1 * t + 1.0).sin();
        let humming_nm: Vec<f64> = noise_nm.iter().zip(&time_s).map(|(noise, t)| noise + hum(t)).collect();
        let (found, left_nm) = without_oscillations(&data, &humming_nm);
        let [Oscillation { frequency_hz: first, share, .. }, Oscillation { frequency_hz: second, .. }] = found[..]
        else {
            panic!("{found:?}")
        };
        assert!((first - 4.8).abs() < 0.02 && (second - 6.1).abs() < 0.02, "{first} {second} Hz");
        assert!((share - 0.5 / 1.82).abs() < 0.02, "{share}");
        let off = left_nm.iter().zip(&noise_nm).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / time_s.len() as f64;
        assert!(off < 0.02, "{off}");
    }
}
