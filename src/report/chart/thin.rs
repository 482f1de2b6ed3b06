//! Fewer points than data, without hiding what they show.

use crate::numerics::statistics::quantile;

/// Samples that a bin needs before its quantiles mean anything.
const BIN_SAMPLES_MIN: usize = 10;

/// At most `wanted` of `0..total`, evenly spaced.
pub fn every(total: usize, wanted: usize) -> impl Iterator<Item = usize> {
    (0..total).step_by(total.div_ceil(wanted.max(1)).max(1))
}

/// At most `wanted` of `points`, as many from each of `stretches` of x between `low` and `high`: what is rare is not lost among
/// what is frequent.
pub fn across(
    points: &[(f64, f64)],
    (low, high): (f64, f64),
    place: impl Fn(f64) -> f64,
    stretches: usize,
    wanted: usize,
) -> Vec<(f64, f64)> {
    let mut held: Vec<Vec<(f64, f64)>> = vec![Vec::new(); stretches];
    for point in points {
        let share = (place(point.0) - low) / (high - low);
        held[((share * stretches as f64) as usize).min(stretches - 1)].push(*point);
    }
    held.iter().flat_map(|mine| every(mine.len(), wanted.div_ceil(stretches)).map(|i| mine[i])).collect()
}

/// The lowest and the highest point of each of `buckets` stretches, in order: no peak is lost.
pub fn envelope(points: &[(f64, f64)], buckets: usize) -> Vec<(f64, f64)> {
    let length = points.len().div_ceil(buckets.max(1)).max(1);
    if length <= 2 {
        return points.to_vec();
    }
    let mut kept = Vec::with_capacity(2 * buckets);
    for bucket in points.chunks(length) {
        let extremes = bucket.iter().enumerate().fold((0, 0), |(low, high), (i, p)| {
            (if p.1 < bucket[low].1 { i } else { low }, if p.1 > bucket[high].1 { i } else { high })
        });
        let (first, last) = (extremes.0.min(extremes.1), extremes.0.max(extremes.1));
        kept.push(bucket[first]);
        if last != first {
            kept.push(bucket[last]);
        }
    }
    kept
}

/// What the values in one stretch of x do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bin {
    /// Where the stretch begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// 10 % of the values lie below.
    pub low: f64,
    /// Half of them do.
    pub median: f64,
    /// 90 % do.
    pub high: f64,
}

impl Bin {
    /// Its middle.
    pub fn middle(&self) -> f64 {
        (self.from + self.to) / 2.0
    }
}

/// `of` along a run of neighbouring bins, from the first one's beginning to the last one's end.
pub fn along(run: &[Bin], of: impl Fn(&Bin) -> f64) -> Vec<(f64, f64)> {
    let middles = run.iter().map(|bin| (bin.middle(), of(bin)));
    let first = run.first().map(|bin| (bin.from, of(bin)));
    let last = run.last().map(|bin| (bin.to, of(bin)));
    first.into_iter().chain(middles).chain(last).collect()
}

/// `points` in `number` stretches of equal width over `low` to `high`, in runs of neighbours: a stretch with too few samples
/// ends a run, so that no line bridges what was not seen.
pub fn bins(points: &[(f64, f64)], (low, high): (f64, f64), number: usize) -> Vec<Vec<Bin>> {
    let width = (high - low) / number as f64;
    if width.is_nan() || width <= 0.0 {
        return Vec::new();
    }
    let mut held: Vec<Vec<f64>> = vec![Vec::new(); number];
    for (x, y) in points {
        let at = ((x - low) / width).floor();
        if at >= 0.0 && at <= number as f64 {
            held[(at as usize).min(number - 1)].push(*y);
        }
    }
    let bin = |(i, values): (usize, &mut Vec<f64>)| {
        (values.len() >= BIN_SAMPLES_MIN).then(|| Bin {
            from: low + i as f64 * width,
            to: low + (i as f64 + 1.0) * width,
            low: quantile(values, 0.1),
            median: quantile(values, 0.5),
            high: quantile(values, 0.9),
        })
    };
    let all: Vec<Option<Bin>> = held.iter_mut().enumerate().map(bin).collect();
    all.split(Option::is_none)
        .filter(|run| !run.is_empty())
        .map(|run| run.iter().flatten().copied().collect())
        .collect()
}

/// The magnitude that all but the share `beyond` of `values` stay below; zero of nothing.
pub fn magnitude(values: impl IntoIterator<Item = f64>, beyond: f64) -> f64 {
    let mut magnitudes: Vec<f64> = values.into_iter().map(f64::abs).filter(|x| x.is_finite()).collect();
    let found = quantile(&mut magnitudes, 1.0 - beyond);
    if found.is_finite() { found } else { 0.0 }
}

/// `points` in runs without what is not finite, each thinned to its share of `buckets` stretches; no peak is lost.
pub fn runs(points: &[(f64, f64)], buckets: usize) -> Vec<Vec<(f64, f64)>> {
    let is_gap = |p: &(f64, f64)| !(p.0.is_finite() && p.1.is_finite());
    let runs = points.split(is_gap).filter(|run| !run.is_empty());
    runs.map(|run| envelope(run, (buckets * run.len()).div_ceil(points.len()))).collect()
}

/// `runs` one after the other, with a point of NaN between them.
pub fn joined(runs: Vec<Vec<(f64, f64)>>) -> Vec<(f64, f64)> {
    runs.join(&(f64::NAN, f64::NAN))
}

/// The lowest point of each of `buckets` stretches: the edge of a band.
pub fn low_edge(points: &[(f64, f64)], buckets: usize) -> Vec<(f64, f64)> {
    edge(points, buckets, |a, b| a < b)
}

/// The highest point of each.
pub fn high_edge(points: &[(f64, f64)], buckets: usize) -> Vec<(f64, f64)> {
    edge(points, buckets, |a, b| a > b)
}

fn edge(points: &[(f64, f64)], buckets: usize, is_farther: impl Fn(f64, f64) -> bool) -> Vec<(f64, f64)> {
    let length = points.len().div_ceil(buckets.max(1)).max(1);
    let farthest = |part: &[(f64, f64)]| {
        let y = part.iter().fold(part[0].1, |y, p| if is_farther(p.1, y) { p.1 } else { y });
        (part[0].0, y)
    };
    points.chunks(length).map(farthest).collect()
}
