//! The noise floor: what no model could explain, because it is not there again when the motion is.
//!
//! From repeats of one motion: half the variance of the difference of their residuals, aligned in time by their positions.
//! Slow differences are taken out (a drift between repeats is no noise), and blocks are combined by their median (a contact in
//! one repeat is no noise either). Without repeats: the density of the raw torque's noise beyond the low-pass, carried on below.

use super::record::{Record, Records};
use crate::log::Signal;
use crate::numerics::filter::LowPass;
use crate::numerics::statistics::{extent, quantile};
use crate::prepare::Trial;

/// Independent samples in a block.
const BLOCK: f64 = 10.0;
/// Independent samples over which slow differences are taken out; that share of white noise goes with them.
const SLOW: f64 = 20.0;
/// The same once the causes are known, and a drift is explained: noise that is not white has its slow part, too.
const BLOCK_LATER: f64 = 40.0;
const SLOW_LATER: f64 = 80.0;
/// Blocks above this multiple of their median hold more than noise.
const STRIKING: f64 = 3.0;
/// However much slow noise there seems to be, the floor rises by no more than this factor: the rest may have a cause.
const RISE_MAX: f64 = 1.25;
/// So much of the rise of its square is uncertain.
const RISE_ERROR: f64 = 0.5;
/// Repeats are aligned within so many independent samples.
const LAG_MAX: f64 = 10.0;
/// Repeats that are further apart than this share of the range are not at the same place.
const APART: f64 = 0.02;
/// Fewer blocks tell no floor.
const BLOCKS_MIN: usize = 8;
/// However many blocks there are, the floor's square is not known better than this share of it: noise differs between trials, and
/// what repeats differ by is not all noise (simulated campaigns scatter by 0.08 about what chance allows).
const SYSTEMATIC: f64 = 0.06;
/// Noise is measured in bands that begin at these multiples of the low-pass ...
const BANDS: [f64; 6] = [1.6, 2.5, 4.0, 6.4, 10.0, 16.0];
/// ... and below this share of the rate.
const BELOW: f64 = 0.35;
/// What a sample keeps of the noise of the one before: so many values tried, so far apart.
const KEEPS: usize = 20;
const KEEP_STEP: f64 = 0.05;
/// Frequencies at which a density is summed.
const FREQUENCIES: usize = 400;
/// Length of a stretch in which it is measured, s; their median is taken.
const STRETCH_S: f64 = 0.5;

/// The floor and where it comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Floor {
    /// RMS, N m, at the declared low-pass.
    pub rms_nm: f64,
    /// RMS of its quick part, N m: slow noise may come on top.
    pub quick_nm: f64,
    /// Its source.
    pub source: FloorSource,
    /// Standard error of the floor's square as a share of it.
    pub relative_error: f64,
}

impl Floor {
    /// The floor's square with its standard error, (N m)^2: what lies above is a gap for all that the floor is not known better.
    pub fn upper_square(&self) -> f64 {
        self.rms_nm * self.rms_nm * (1.0 + self.relative_error)
    }

    /// The same of its quick part.
    pub fn quick_upper_square(&self) -> f64 {
        self.quick_nm * self.quick_nm * (1.0 + self.relative_error)
    }
}

/// Where a floor comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FloorSource {
    /// Repeats of one motion.
    Repeats,
    /// The noise beyond the low-pass, its density carried on below.
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
    let mut blocks = repeats_blocks(records, residual_nm, BLOCK, SLOW);
    if blocks.len() >= BLOCKS_MIN {
        let rms_nm = (median_square(&mut blocks) / 2.0 / (1.0 - 1.0 / SLOW)).sqrt();
        let chance = (std::f64::consts::PI / (BLOCK * blocks.len() as f64)).sqrt();
        let relative_error = chance.hypot(SYSTEMATIC);
        return Floor { rms_nm, quick_nm: rms_nm, source: FloorSource::Repeats, relative_error };
    }
    let mut spectral: Vec<f64> =
        records.all.iter().map(|record| record.spectral_floor_nm).filter(|floor| floor.is_finite()).collect();
    let rms_nm = Some(quantile(&mut spectral, 0.5)).filter(|rms_nm| rms_nm.is_finite()).unwrap_or_default();
    Floor { rms_nm, quick_nm: rms_nm, source: FloorSource::Spectrum, relative_error: 0.1 }
}

/// The floor under `left_nm`, what the causes that were found leave at all rows: slow noise is in it. Without long repeats nothing
/// tells that from a cause but that no fit finds it again on held-out units: `unforeseen_square` is what a flexible one leaves
/// there, (N m)^2.
pub fn settled(records: &Records, left_nm: &[f64], unforeseen_square: f64) -> Floor {
    let fast = floor(records, left_nm);
    let blocks = repeats_blocks(records, left_nm, BLOCK_LATER, SLOW_LATER);
    let whole_square = match blocks.len() >= BLOCKS_MIN {
        true => usual_mean(blocks) / 2.0 / (1.0 - 1.0 / SLOW_LATER),
        false => unforeseen_square,
    };
    let rms_nm = whole_square.sqrt().min(RISE_MAX * fast.rms_nm).max(fast.rms_nm);
    let rise = (rms_nm / fast.rms_nm.max(f64::MIN_POSITIVE)).powi(2) - 1.0;
    Floor { rms_nm, relative_error: fast.relative_error.hypot(RISE_ERROR * rise), ..fast }
}

/// Mean squares of what repeats differ by, in blocks, slow differences taken out.
fn repeats_blocks(records: &Records, residual_nm: &[f64], block: f64, slow: f64) -> Vec<f64> {
    let rows = |independent: f64| (independent * records.rows_per_independent).round() as usize;
    let spans = Spans { block: rows(block), slow: rows(slow), lag: rows(LAG_MAX) as isize };
    let mut blocks = Vec::new();
    for (a, first) in records.all.iter().enumerate() {
        for (b, second) in records.all.iter().enumerate().skip(a + 1) {
            if first.repeats.is_some() && first.repeats == second.repeats {
                let [ra, rb] = [a, b].map(|at| &residual_nm[records.ranges[at].clone()]);
                difference_blocks((first, ra), (second, rb), spans, &mut blocks);
            }
        }
    }
    blocks
}

/// The mean over blocks but for those that stand out: a contact in one repeat.
fn usual_mean(mut blocks: Vec<f64>) -> f64 {
    let most = STRIKING * quantile(&mut blocks, 0.5);
    blocks.retain(|square| *square <= most);
    blocks.iter().sum::<f64>() / blocks.len().max(1) as f64
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

/// RMS that the noise found beyond the low-pass would have within it, N m; NaN where the rate leaves no room.
///
/// The noise is taken for a first-order process, white at best: its density's fall over the bands beyond the low-pass is carried on
/// below. In each band the median over stretches counts, for a reversal is no noise.
///
/// What a motion makes of the torque beyond the low-pass is no noise either, and a short one reverses in every stretch: the torque
/// less `predicted_nm` is looked at too, and the lower of both counts.
pub(super) fn spectral_nm(trial: &Trial, predicted_nm: &[f64], signal: &Signal) -> f64 {
    let raw_nm = &trial.log.torque_nm;
    let left_nm: Vec<f64> = raw_nm.iter().zip(predicted_nm).map(|(y, predicted)| y - predicted).collect();
    carried_below_nm(raw_nm, trial.log.rate_hz, signal).min(carried_below_nm(&left_nm, trial.log.rate_hz, signal))
}

/// The noise in `series_nm` beyond the low-pass, carried on below, N m.
fn carried_below_nm(series_nm: &[f64], rate_hz: f64, signal: &Signal) -> f64 {
    let order = signal.lowpass_order;
    let edges: Vec<f64> =
        BANDS.iter().map(|factor| factor * signal.lowpass_hz).filter(|edge_hz| *edge_hz < BELOW * rate_hz).collect();
    let levels: Option<Vec<Vec<f64>>> =
        edges.iter().map(|edge_hz| Some(LowPass::new(order, *edge_hz, rate_hz)?.zero_phase(series_nm))).collect();
    let Some(mut levels) = levels.filter(|levels| !levels.is_empty()) else { return f64::NAN };
    levels.push(series_nm.to_vec());
    let stretch = ((STRETCH_S * rate_hz) as usize).max(8);
    let band = |pair: &[Vec<f64>]| {
        let folds = pair[0].chunks_exact(stretch).zip(pair[1].chunks_exact(stretch));
        let square = |(a, b): (&[f64], &[f64])| a.iter().zip(b).map(|(a, b)| (b - a) * (b - a)).sum::<f64>();
        quantile(&mut folds.map(|part| square(part) / stretch as f64).collect::<Vec<f64>>(), 0.5)
    };
    let squares: Vec<f64> = levels.windows(2).map(band).collect();
    let gain = |edge_hz: f64, hz: f64| passed(order, edge_hz, hz, rate_hz);
    let within = |keep: f64, i: usize| {
        mean_density(keep, rate_hz, |hz| {
            let upper = edges.get(i + 1).map_or(1.0, |edge_hz| gain(*edge_hz, hz));
            (upper - gain(edges[i], hz)).powi(2)
        })
    };
    let fit = |keep: f64| {
        let logs: Vec<f64> = squares.iter().enumerate().map(|(i, square)| (square / within(keep, i)).ln()).collect();
        let mean = logs.iter().sum::<f64>() / logs.len() as f64;
        (logs.iter().map(|l| (l - mean) * (l - mean)).sum::<f64>(), mean.exp())
    };
    let keeps = (0..KEEPS).map(|i| i as f64 * KEEP_STEP);
    let best = keeps.map(|keep| (keep, fit(keep))).min_by(|a, b| a.1.0.total_cmp(&b.1.0));
    best.map_or(f64::NAN, |(keep, (_, power))| {
        (power * mean_density(keep, rate_hz, |hz| gain(signal.lowpass_hz, hz).powi(2))).sqrt()
    })
}

/// Share of an amplitude at `hz` that passes a zero-phase Butterworth low-pass, as the bilinear transform has it.
fn passed(order: usize, edge_hz: f64, hz: f64, rate_hz: f64) -> f64 {
    let warped = |f: f64| (std::f64::consts::PI * f / rate_hz).tan();
    1.0 / (1.0 + (warped(hz) / warped(edge_hz)).powi(2 * order as i32))
}

/// Mean over all frequencies of the density of a process of which each sample keeps the share `keep` of the one before, times
/// what `weight` lets through.
fn mean_density(keep: f64, rate_hz: f64, weight: impl Fn(f64) -> f64) -> f64 {
    let density = |hz: f64| 1.0 / (1.0 - 2.0 * keep * (std::f64::consts::TAU * hz / rate_hz).cos() + keep * keep);
    let at = |i: usize| (i as f64 + 0.5) / FREQUENCIES as f64 * rate_hz / 2.0;
    (0..FREQUENCIES).map(|i| density(at(i)) * weight(at(i))).sum::<f64>() / FREQUENCIES as f64
}
