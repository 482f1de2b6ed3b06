//! What repeats of one motion differ by: their residuals, aligned in time by their positions, without slow differences.

use super::mask::Mask;
use super::record::Record;
use crate::numerics::statistics::{extent, median_of_squares, quantile};

/// Fewer blocks do not determine a level.
pub const BLOCKS_MIN: usize = 8;
/// Blocks are compared with noise in so many parts, by the mean speed of each; as a whole where a part would have too few.
const SPEEDS: usize = 3;
/// Slow differences are averaged over this many blocks and removed.
const SLOW_BLOCKS: f64 = 2.0;
/// Repeats are aligned within this many independent samples.
const LAG_MAX: f64 = 10.0;

/// The differences between all repeats.
#[derive(Debug)]
pub struct Differences {
    /// Independent samples in a block.
    block: f64,
    /// The same in rows.
    rows: usize,
    /// Stretches in which both repeats are at the same place, without the rows that do not count: the speed at each row, rad/s, and by what they
    /// differ there, N m.
    runs: Vec<Vec<(f64, f64)>>,
}

impl Differences {
    /// Of `residual_nm`, at all rows, where both repeats count, in blocks of `block` independent samples.
    pub fn of(mask: &Mask<'_>, residual_nm: &[f64], block: f64) -> Self {
        let (records, apart) = (&mask.data.records, mask.data.policy.same_place_share);
        let rows = |independent: f64| (independent * records.rows_per_independent).round() as usize;
        let spans = Spans { slow: rows(SLOW_BLOCKS * block), lag: rows(LAG_MAX) as isize, apart };
        let mut runs = Vec::new();
        for (a, first) in records.all.iter().enumerate() {
            for (b, second) in records.all.iter().enumerate().skip(a + 1) {
                if first.repeats.is_some() && first.repeats == second.repeats {
                    let of_rows = |at: usize| {
                        records.ranges[at].clone().map(|i| mask.counts(i).then_some(residual_nm[i])).collect()
                    };
                    let [ra, rb]: [Vec<Option<f64>>; 2] = [a, b].map(of_rows);
                    add_runs((first, &ra), (second, &rb), spans, &mut runs);
                }
            }
        }
        Self { block, rows: rows(block), runs }
    }

    /// Their mean squares in blocks, (N m)^2, the slowest block first.
    pub fn blocks(&self) -> Vec<f64> {
        let speed_and_square = |block: &[(f64, f64)]| {
            let mean = |of: fn(&(f64, f64)) -> f64| block.iter().map(of).sum::<f64>() / block.len() as f64;
            (mean(|(speed, _)| *speed), mean(|(_, d)| d * d))
        };
        let of_run = |run: &Vec<(f64, f64)>| run.chunks_exact(self.rows).map(speed_and_square).collect::<Vec<_>>();
        let mut blocks: Vec<(f64, f64)> = self.runs.iter().flat_map(of_run).collect();
        blocks.sort_by(|a, b| a.0.total_cmp(&b.0));
        blocks.into_iter().map(|(_, square)| square).collect()
    }

    /// Mean square of what one of two repeats has, by the median over blocks, (N m)^2; nothing of few blocks.
    pub fn usual_square(&self) -> Option<f64> {
        Some(self.usual_squares(1)?[0])
    }

    /// The same in each of `parts`, from the slowest blocks to the fastest; nothing where a part has few.
    fn usual_squares(&self, parts: usize) -> Option<Vec<f64>> {
        let mut blocks = self.blocks();
        let each = blocks.len().div_ceil(parts).max(1);
        let usual = |part: &mut [f64]| self.of_one(quantile(part, 0.5) / median_of_squares(self.block));
        (blocks.len() >= parts * BLOCKS_MIN).then(|| blocks.chunks_mut(each).map(usual).collect())
    }

    /// By how much they exceed what the noise beyond the low-pass would give within it, `beyond_nm`, and the encoder, RMS, in the part of the speeds
    /// where that is most: a chatter shows where the joint is slow, a rumble where it is fast. Nothing without such noise, or of few blocks.
    pub fn over(&self, of_encoder: &Self, beyond_nm: f64) -> Option<f64> {
        let by_speed = |parts: usize| Some((self.usual_squares(parts)?, of_encoder.usual_squares(parts)?));
        let (own, of_encoder) = by_speed(SPEEDS).or_else(|| by_speed(1))?;
        let factor = |(own, of_encoder): (&f64, &f64)| (own / (beyond_nm * beyond_nm + of_encoder)).sqrt();
        (beyond_nm > 0.0).then(|| own.iter().zip(&of_encoder).map(factor).fold(0.0, f64::max))
    }

    /// The speed, rad/s, and the square, (N m)^2, at each row.
    pub fn by_speed(&self) -> Vec<(f64, f64)> {
        self.runs.iter().flatten().map(|(speed, d)| (*speed, d * d)).collect()
    }

    /// The mean square of white noise in one repeat where that of the differences is `square`, (N m)^2: both differ, and of their noise some
    /// went with the slow differences.
    pub fn of_one(&self, square: f64) -> f64 {
        square / 2.0 / (1.0 - 1.0 / (SLOW_BLOCKS * self.block))
    }
}

/// Lengths in rows, and how far apart repeats may be, as a share of the range.
#[derive(Clone, Copy)]
struct Spans {
    slow: usize,
    lag: isize,
    apart: f64,
}

/// Adds the runs of two records, each with its residual at the rows that count.
fn add_runs(
    (a, ra): (&Record, &[Option<f64>]),
    (b, rb): (&Record, &[Option<f64>]),
    spans: Spans,
    runs: &mut Vec<Vec<(f64, f64)>>,
) {
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
    let limit = spans.apart * (high - low);
    let near = |i: usize| {
        let j = usize::try_from(i as isize + lag).ok()?;
        ((qb.get(j)? - qa[i]).abs() <= limit).then_some((i, j))
    };
    let pairs: Vec<Option<(usize, usize)>> = (0..qa.len()).map(near).collect();
    for run in pairs.split(Option::is_none) {
        // A run goes on beyond rows that do not count, such as a contact's.
        let difference = |(i, j): &(usize, usize)| Some((a.own[a.rows[*i]].velocity.abs(), ra[*i]? - rb[*j]?));
        let (speeds, run): (Vec<f64>, Vec<f64>) = run.iter().flatten().filter_map(difference).unzip();
        if run.len() < spans.slow {
            continue;
        }
        runs.push(speeds.into_iter().zip(without_slow(&run, spans.slow)).collect());
    }
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
