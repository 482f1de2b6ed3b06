//! The noise floor: what no model could explain, because it is not there again when the motion is.
//!
//! From repeats of one motion: half the variance of the difference of their residuals, aligned in time by their positions.
//! Slow differences are taken out (a drift between repeats is no noise), and blocks are combined by their median (a contact in
//! one repeat is no noise either). Without repeats: the density of the raw torque's noise beyond the low-pass, taken for white.

use super::record::{Record, Records};
use crate::log::Signal;
use crate::numerics::filter::LowPass;
use crate::numerics::statistics::{extent, quantile};
use crate::prepare::Trial;

/// Independent samples in a block.
const BLOCK: f64 = 10.0;
/// Independent samples over which slow differences are taken out; that share of white noise goes with them.
const SLOW: f64 = 20.0;
/// Repeats are aligned within so many independent samples.
const LAG_MAX: f64 = 10.0;
/// Repeats that are further apart than this share of the range are not at the same place.
const APART: f64 = 0.02;
/// Fewer blocks tell no floor.
const BLOCKS_MIN: usize = 8;
/// Noise is measured beyond this many times the low-pass ...
const BEYOND: f64 = 2.5;
/// ... and below this share of the rate.
const BELOW: f64 = 0.3;
/// Length of a stretch in which it is measured, s; their median is taken.
const STRETCH_S: f64 = 0.5;

/// The floor and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// RMS, N m, at the declared low-pass.
    pub rms_nm: f64,
    /// Its source.
    pub source: FloorSource,
    /// Standard error of the floor's square as a share of it.
    pub relative_error: f64,
}

/// Where a floor comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FloorSource {
    /// Repeats of one motion.
    Repeats,
    /// The noise beyond the low-pass, taken for white.
    Spectrum,
}

impl FloorSource {
    /// The name used in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Repeats => "repeats",
            Self::Spectrum => "spectrum",
        }
    }
}

/// The floor under `residual_nm`, given at all rows.
pub fn floor(records: &Records, residual_nm: &[f64]) -> Floor {
    let rows = |independent: f64| (independent * records.rows_per_independent).round() as usize;
    let spans = Spans { block: rows(BLOCK), slow: rows(SLOW), lag: rows(LAG_MAX) as isize };
    let mut blocks = Vec::new();
    for (a, first) in records.all.iter().enumerate() {
        for (b, second) in records.all.iter().enumerate().skip(a + 1) {
            if first.repeats.is_some() && first.repeats == second.repeats {
                let [ra, rb] = [a, b].map(|at| &residual_nm[records.ranges[at].clone()]);
                difference_blocks((first, ra), (second, rb), spans, &mut blocks);
            }
        }
    }
    if blocks.len() >= BLOCKS_MIN {
        let rms_nm = (median_square(&mut blocks) / 2.0 / (1.0 - 1.0 / SLOW)).sqrt();
        let relative_error = (std::f64::consts::PI / (BLOCK * blocks.len() as f64)).sqrt();
        return Floor { rms_nm, source: FloorSource::Repeats, relative_error };
    }
    let mut spectral: Vec<f64> =
        records.all.iter().map(|record| record.spectral_floor_nm).filter(|floor| floor.is_finite()).collect();
    let rms_nm = quantile(&mut spectral, 0.5);
    Floor { rms_nm: if rms_nm.is_finite() { rms_nm } else { 0.0 }, source: FloorSource::Spectrum, relative_error: 0.1 }
}

/// The median of mean squares over blocks, corrected to their mean: that of chi-square with k degrees lies at (1 - 2/(9 k))^3.
fn median_square(blocks: &mut [f64]) -> f64 {
    quantile(blocks, 0.5) / (1.0 - 2.0 / (9.0 * BLOCK)).powi(3)
}

/// Lengths in rows.
#[derive(Clone, Copy)]
struct Spans {
    block: usize,
    slow: usize,
    lag: isize,
}

fn difference_blocks((a, ra): (&Record, &[f64]), (b, rb): (&Record, &[f64]), spans: Spans, blocks: &mut Vec<f64>) {
    let [qa, qb] = [a, b].map(|record| record.rows.iter().map(|i| record.own[*i].position).collect::<Vec<f64>>());
    if ra.len() < 2 * spans.slow || rb.len() < 2 * spans.slow {
        return;
    }
    // Rows of both records are counted from their own first; what lies between is part of the lag.
    let offset = b.rows[0] as isize - a.rows[0] as isize;
    let base = offset / (a.rows.get(1).map_or(1, |next| next - a.rows[0]).max(1)) as isize;
    let apart = |lag: isize| {
        let (mut sum, mut count) = (0.0, 0usize);
        for i in (0..qa.len()).step_by(5) {
            if let Some(q) = usize::try_from(i as isize + lag).ok().and_then(|j| qb.get(j)) {
                sum += (q - qa[i]) * (q - qa[i]);
                count += 1;
            }
        }
        if count * 10 > qa.len() { sum / count as f64 } else { f64::INFINITY }
    };
    let lags = (-spans.lag..=spans.lag).map(|lag| lag - base);
    let Some(lag) = lags.min_by(|x, y| apart(*x).total_cmp(&apart(*y))) else { return };
    let (low, high) = extent(&qa);
    let limit = APART * (high - low);
    let pair = |i: usize| {
        let j = usize::try_from(i as isize + lag).ok()?;
        let near = (qb.get(j)? - qa[i]).abs() <= limit;
        near.then(|| ra[i] - rb[j])
    };
    let differences: Vec<Option<f64>> = (0..qa.len()).map(pair).collect();
    for run in differences.split(Option::is_none) {
        let run: Vec<f64> = run.iter().flatten().copied().collect();
        if run.len() < spans.slow {
            continue;
        }
        let fast = without_slow(&run, spans.slow);
        blocks.extend(fast.chunks_exact(spans.block).map(mean_square));
    }
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|d| d * d).sum::<f64>() / values.len() as f64
}

/// `values` less their running mean over `slow` of them.
fn without_slow(values: &[f64], slow: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(values.len() + 1);
    sums.push(0.0);
    for v in values {
        sums.push(sums[sums.len() - 1] + v);
    }
    let mean = |i: usize| {
        let from = i.saturating_sub(slow / 2).min(values.len() - slow);
        (sums[from + slow] - sums[from]) / slow as f64
    };
    values.iter().enumerate().map(|(i, v)| v - mean(i)).collect()
}

/// RMS that white noise of the density found beyond the low-pass would have within it, N m; NaN where the rate leaves no room.
pub(super) fn spectral_nm(trial: &Trial, signal: &Signal) -> f64 {
    let rate_hz = trial.log.rate_hz;
    let beyond_hz = (BEYOND * signal.lowpass_hz).min(BELOW * rate_hz);
    if beyond_hz < 1.2 * signal.lowpass_hz {
        return f64::NAN;
    }
    let passes = |hz: f64| LowPass::new(signal.lowpass_order, hz, rate_hz);
    let (Some(within), Some(beyond)) = (passes(signal.lowpass_hz), passes(beyond_hz)) else { return f64::NAN };
    let slow = beyond.zero_phase(&trial.log.torque_nm);
    let fast: Vec<f64> = trial.log.torque_nm.iter().zip(&slow).map(|(y, s)| y - s).collect();
    let stretch = ((STRETCH_S * rate_hz) as usize).max(4);
    let mut squares: Vec<f64> =
        fast.chunks_exact(stretch).map(|part| part.iter().map(|y| y * y).sum::<f64>() / stretch as f64).collect();
    let impulse = |filter: &LowPass| {
        let n = (20.0 * rate_hz / signal.lowpass_hz) as usize;
        let mut signal = vec![0.0; n];
        signal[n / 2] = 1.0;
        filter.zero_phase(&signal)
    };
    let (h_within, h_beyond) = (impulse(&within), impulse(&beyond));
    let energy = |h: &[f64]| h.iter().map(|x| x * x).sum::<f64>();
    let middle = h_beyond.len() / 2;
    // White noise less its slow part has this share of its variance: |1 - H|^2 = 1 - 2 h(0) + sum of h^2.
    let left = 1.0 - 2.0 * h_beyond[middle] + energy(&h_beyond);
    (quantile(&mut squares, 0.5) / left * energy(&h_within)).sqrt()
}
