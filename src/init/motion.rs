//! What a recording's motion is: sweeps at constant speed, cosines, free motion, rests; one after the other in one file too.
//!
//! The position is cut at its turning points into strokes. A stroke is at constant speed if most of its travel is passed near
//! its median speed: a cosine passes a fifth of its travel within 5 % of any one speed. Strokes of one kind in a row are one part.

use crate::numerics::statistics::{extent, mean, quantile, reading_noise, root_mean_square};
use std::ops::Range;

/// A turn back by this share of the whole travel ends a stroke.
const TURN_TRAVEL: f64 = 0.05;
/// A joint at rest moves by less than this many times its common step from sample to sample.
const REST_STEPS: f64 = 20.0;
/// Speed is the mean over this share of a stroke's samples either side ...
const WINDOW_SHARE: f64 = 0.01;
/// ... or, where the position is noisy or coarse, over as many as keep its error below this share, ...
const SPEED_ERROR: f64 = 0.01;
/// ... at most this share.
const WINDOW_SHARE_MOST: f64 = 0.08;
/// A speed within this share of the stroke's own counts as that speed.
const SPEED_TOLERANCE: f64 = 0.05;
/// A stroke at constant speed passes this share of its travel at that speed.
const CONSTANT_SHARE: f64 = 0.7;
/// Strokes whose speeds differ by less than this share are of one sweep.
const SAME_SPEED: f64 = 0.06;
/// A stroke shorter than this share of the longest one beside it is a way to where the motion begins, or what is left at its end.
const STUB_TRAVEL: f64 = 0.3;
/// A cosine leaves less than this share of its amplitude; a motion at constant speed leaves 0.075.
const COSINE_MISFIT: f64 = 0.04;
/// This share of a cosine's travel at either end is not compared: the joint may rest there.
const COSINE_ENDS: f64 = 0.03;
/// Half periods that a cosine has at least.
const COSINE_STROKES: usize = 3;
/// Samples by which a motion is fitted or compared at most.
const SAMPLES_COMPARED: usize = 2000;

/// How the joint moves in a part of a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Kind {
    /// Back and forth at one speed, in units of position per second.
    Sweep { speed: f64 },
    /// Cosines: half their travel, and cycles per second of the slowest and the fastest.
    Cosine { amplitude: f64, slowest_hz: f64, fastest_hz: f64 },
    /// Any other motion.
    Free,
    /// None.
    Rest,
}

/// A part of a recording.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Motion {
    pub samples: Range<usize>,
    pub kind: Kind,
}

/// From one turning point to the next.
#[derive(Debug, Clone)]
struct Stroke {
    samples: Range<usize>,
    travel: f64,
    /// Its speed, where it is constant.
    speed: Option<f64>,
}

/// The parts of a motion whose `position` is evenly sampled at `rate_hz`, in order.
pub(super) fn parts(position: &[f64], rate_hz: f64) -> Vec<Motion> {
    let whole = 0..position.len();
    if is_rest(position) {
        return vec![Motion { samples: whole, kind: Kind::Rest }];
    }
    let strokes = strokes(position, rate_hz);
    let longest = strokes.iter().map(|stroke| stroke.travel).fold(0.0, f64::max);
    let runs = runs(&strokes, STUB_TRAVEL * longest);
    // Among other strokes a single one at a speed of its own is no sweep: a sum of sines has nearly straight ones by chance.
    let is_sweep = |run: &Run| run.speed.is_some();
    let is_swept = runs.iter().any(|run| is_sweep(run) && run.strokes >= 2) || runs.iter().all(is_sweep);
    if !is_swept {
        return vec![Motion { samples: whole.clone(), kind: free_or_cosine(position, rate_hz, &strokes) }];
    }
    let mut found: Vec<Motion> = Vec::new();
    for run in runs {
        let samples = run.samples.clone();
        let kind = match run.speed {
            Some(speed) => Kind::Sweep { speed },
            None => {
                let inner: Vec<Stroke> =
                    strokes.iter().filter(|s| samples.contains(&s.samples.start)).cloned().collect();
                let shifted = inner.into_iter().map(|s| {
                    let samples = s.samples.start - samples.start..s.samples.end - samples.start;
                    Stroke { samples, ..s }
                });
                free_or_cosine(&position[samples.clone()], rate_hz, &shifted.collect::<Vec<_>>())
            }
        };
        found.push(Motion { samples, kind });
    }
    if let Some(first) = found.first_mut() {
        first.samples.start = 0;
    }
    if let Some(last) = found.last_mut() {
        last.samples.end = position.len();
    }
    found
}

/// Whether the joint stands still, except for noise.
pub(super) fn is_rest(position: &[f64]) -> bool {
    let (low, high) = extent(position);
    let mut steps: Vec<f64> = position.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|s| *s > 0.0).collect();
    steps.is_empty() || high - low < REST_STEPS * quantile(&mut steps, 0.5)
}

fn strokes(position: &[f64], rate_hz: f64) -> Vec<Stroke> {
    let (low, high) = extent(position);
    let turns = turning_points(position, TURN_TRAVEL * (high - low));
    let noise = reading_noise(position);
    turns.windows(2).map(|pair| stroke(position, noise, rate_hz, pair[0]..pair[1])).collect()
}

/// The first sample, each sample at which the joint turns back by more than `back`, and the last.
fn turning_points(position: &[f64], back: f64) -> Vec<usize> {
    let mut turns = vec![0];
    let (mut highest, mut lowest) = (0, 0);
    let mut rising: Option<bool> = None;
    for (at, now) in position.iter().enumerate() {
        if *now > position[highest] {
            highest = at;
        }
        if *now < position[lowest] {
            lowest = at;
        }
        if rising != Some(false) && position[highest] - now > back {
            if rising.is_some() || highest > 0 {
                turns.push(highest);
            }
            rising = Some(false);
            lowest = at;
            highest = at;
        } else if rising != Some(true) && now - position[lowest] > back {
            if rising.is_some() || lowest > 0 {
                turns.push(lowest);
            }
            rising = Some(true);
            highest = at;
            lowest = at;
        }
    }
    turns.push(position.len().saturating_sub(1));
    turns.dedup();
    turns
}

/// One stroke of a `position` whose readings are off by `noise`.
fn stroke(position: &[f64], noise: f64, rate_hz: f64, samples: Range<usize>) -> Stroke {
    let at = |i: usize| position[i];
    let travel = (at(samples.end) - at(samples.start)).abs();
    // Over 2 half samples the joint moves by 2 half travel / n, and the difference of two readings is off by sqrt(2) noise.
    let needed = noise / (2f64.sqrt() * SPEED_ERROR * travel);
    let half = ((needed.clamp(WINDOW_SHARE, WINDOW_SHARE_MOST) * samples.len() as f64) as usize).max(1);
    if samples.len() < 8 * half || travel == 0.0 {
        return Stroke { samples, travel, speed: None };
    }
    let inner = samples.start + half..samples.end - half;
    let steps: Vec<(f64, f64)> = inner
        .step_by((samples.len() / SAMPLES_COMPARED).max(1))
        .map(|i| ((at(i + half) - at(i - half)).abs() * rate_hz / (2 * half) as f64, (at(i + 1) - at(i - 1)).abs()))
        .collect();
    // The speed at which half of the travel is passed, rests and ramps counting little.
    let mut sorted = steps.clone();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let whole: f64 = sorted.iter().map(|step| step.0).sum();
    let mut passed = 0.0;
    let middle = sorted.iter().find(|step| {
        passed += step.0;
        passed >= whole / 2.0
    });
    let speed = middle.map_or(0.0, |step| step.0);
    let near: Vec<f64> =
        steps.iter().map(|step| step.0).filter(|step| (step / speed - 1.0).abs() <= SPEED_TOLERANCE).collect();
    let is_constant = speed > 0.0 && near.iter().sum::<f64>() >= CONSTANT_SHARE * whole;
    Stroke { samples, travel, speed: is_constant.then(|| mean(&near)) }
}

/// Strokes in a row that belong together.
struct Run {
    samples: Range<usize>,
    speed: Option<f64>,
    strokes: usize,
    travel: f64,
}

/// Strokes at one speed in a row, and those at none; what travels less than `stub` goes with its neighbour.
fn runs(strokes: &[Stroke], stub: f64) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut waiting: Option<usize> = None;
    for stroke in strokes {
        let is_stub = stroke.travel < stub;
        let joins = |run: &Run| match (run.speed, stroke.speed) {
            (Some(a), Some(b)) => (a / b - 1.0).abs() <= SAME_SPEED,
            (None, None) => true,
            _ => false,
        };
        match runs.last_mut() {
            Some(run) if is_stub => run.samples.end = stroke.samples.end,
            None if is_stub => waiting = waiting.or(Some(stroke.samples.start)),
            Some(run) if joins(run) => {
                let share = stroke.travel / (run.travel + stroke.travel);
                run.speed = run.speed.zip(stroke.speed).map(|(a, b)| a + share * (b - a));
                run.travel += stroke.travel;
                run.samples.end = stroke.samples.end;
                run.strokes += 1;
            }
            _ => {
                let start = waiting.take().unwrap_or(stroke.samples.start);
                let samples = start..stroke.samples.end;
                runs.push(Run { samples, speed: stroke.speed, strokes: 1, travel: stroke.travel });
            }
        }
    }
    runs
}

/// A motion that is no sweep: cosines if its strokes go from one end to the other and each is half a cosine.
fn free_or_cosine(position: &[f64], rate_hz: f64, strokes: &[Stroke]) -> Kind {
    let (low, high) = extent(position);
    let whole: Vec<&Stroke> = strokes.iter().filter(|stroke| stroke.travel > 0.9 * (high - low)).collect();
    if whole.len() < COSINE_STROKES || strokes.len() > whole.len() + 2 {
        return Kind::Free;
    }
    // The way to where the cosines begin may have run into the first of them, the way back into the last.
    let halves: Vec<Option<f64>> = whole.iter().map(|stroke| half_period(&position[stroke.samples.clone()])).collect();
    let is_cosine = halves[1..halves.len() - 1].iter().all(Option::is_some);
    let halves: Vec<f64> = halves.into_iter().flatten().collect();
    if !is_cosine || halves.len() < COSINE_STROKES {
        return Kind::Free;
    }
    let frequencies: Vec<f64> = halves.iter().map(|samples| rate_hz / (2.0 * samples)).collect();
    let (slowest_hz, fastest_hz) = extent(&frequencies);
    Kind::Cosine { amplitude: (high - low) / 2.0, slowest_hz, fastest_hz }
}

/// Samples that half a cosine from the first to the last of `position` takes, whatever rests before and after it; `None` where it
/// is no cosine.
fn half_period(position: &[f64]) -> Option<f64> {
    let (first, last) = (*position.first()?, *position.last()?);
    let share = |i: usize| (position[i] - first) / (last - first);
    let begin = (0..position.len()).find(|i| share(*i) > COSINE_ENDS)?;
    let end = (begin..position.len()).rev().find(|i| share(*i) < 1.0 - COSINE_ENDS)?;
    let from = (1.0 - 2.0 * share(begin)).acos();
    let to = (1.0 - 2.0 * share(end)).acos();
    let phase = |i: usize| from + (to - from) * (i - begin) as f64 / (end - begin).max(1) as f64;
    let step = ((end - begin) / SAMPLES_COMPARED).max(1);
    let errors: Vec<f64> = (begin..=end).step_by(step).map(|i| 2.0 * share(i) - 1.0 + phase(i).cos()).collect();
    let samples = std::f64::consts::PI * (end - begin) as f64 / (to - from);
    (root_mean_square(&errors) < COSINE_MISFIT).then_some(samples)
}

/// Whether two motions are the same except for noise: as long as each other, and never far apart.
pub(super) fn is_repeat(a: &[f64], b: &[f64]) -> bool {
    let (short, long) = (a.len().min(b.len()), a.len().max(b.len()));
    if short < 2 || (long - short) as f64 > 0.03 * long as f64 {
        return false;
    }
    let (low, high) = extent(a);
    let step = (short / SAMPLES_COMPARED).max(1);
    let squares: f64 = (0..short).step_by(step).map(|i| (a[i] - b[i]).powi(2)).sum();
    let count = short.div_ceil(step);
    (squares / count as f64).sqrt() < 0.04 * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const RATE_HZ: f64 = 200.0;

    /// Back and forth over 1.2 rad at each of `speeds`, `times` each.
    fn sweeps(speeds: &[f64], times: usize) -> Vec<f64> {
        let mut q = vec![0.1];
        for speed in speeds {
            for _ in 0..times {
                let steps = (1.2 / speed * RATE_HZ) as usize;
                let from = q[q.len() - 1];
                q.extend((1..=steps).map(|i| from + speed * i as f64 / RATE_HZ));
                let top = q[q.len() - 1];
                q.extend((1..=steps).map(|i| top - speed * i as f64 / RATE_HZ));
            }
        }
        q
    }

    #[test]
    fn sweeps_cosines_and_rests_are_told_apart() {
        let found = parts(&sweeps(&[0.3], 2), RATE_HZ);
        assert!(
            matches!(found[..], [Motion { kind: Kind::Sweep { speed }, .. }] if (speed - 0.3).abs() < 0.003),
            "{found:?}"
        );

        let cosine: Vec<f64> = (0..4000).map(|i| 0.6 - 0.5 * (TAU * 0.25 * i as f64 / RATE_HZ).cos()).collect();
        let found = parts(&cosine, RATE_HZ);
        assert!(
            matches!(found[..], [Motion { kind: Kind::Cosine { amplitude, fastest_hz, .. }, .. }]
                if (amplitude - 0.5).abs() < 0.01 && (fastest_hz - 0.25).abs() < 0.005),
            "{found:?}"
        );

        let sum = |i: usize| {
            let t = TAU * i as f64 / RATE_HZ;
            0.3 * (0.11 * t).sin() + 0.2 * (0.31 * t).sin() + 0.1 * (0.73 * t).cos()
        };
        let found = parts(&(0..6000).map(sum).collect::<Vec<_>>(), RATE_HZ);
        assert!(matches!(found[..], [Motion { kind: Kind::Free, .. }]), "{found:?}");

        let still: Vec<f64> = (0..2000).map(|i| 0.4 + 1e-5 * ((i * 7919 % 13) as f64)).collect();
        assert_eq!(parts(&still, RATE_HZ)[0].kind, Kind::Rest);
    }

    #[test]
    fn cosines_may_begin_and_end_at_rest() {
        let still = |at: f64| vec![at; 300];
        let cosine = (0..4000).map(|i| 0.6 - 0.5 * (TAU * 0.25 * i as f64 / RATE_HZ).cos());
        let found = parts(&[still(0.1), cosine.collect(), still(0.1)].concat(), RATE_HZ);
        assert!(
            matches!(found[..], [Motion { kind: Kind::Cosine { slowest_hz, fastest_hz, .. }, .. }]
                if (slowest_hz - 0.25).abs() < 0.005 && (fastest_hz - 0.25).abs() < 0.005),
            "{found:?}"
        );
    }

    #[test]
    fn sweeps_are_found_under_noise_and_in_coarse_steps() {
        // An encoder of 4096 counts with 1.5 counts of noise, at 50 Hz.
        let count = TAU / 4096.0;
        let coarse = |(i, q): (usize, &f64)| {
            let noise = ((i * 7919 % 101) as f64 / 50.0 - 1.0) * 2.6;
            (q / count + noise).round() * count
        };
        for speed in [0.05, 0.3] {
            let exact: Vec<f64> = sweeps(&[speed], 2).into_iter().step_by(4).collect();
            let found = parts(&exact.iter().enumerate().map(coarse).collect::<Vec<_>>(), RATE_HZ / 4.0);
            assert!(
                matches!(found[..], [Motion { kind: Kind::Sweep { speed: s }, .. }] if (s / speed - 1.0).abs() < 0.02),
                "{found:?}"
            );
        }
    }

    #[test]
    fn sweeps_at_several_speeds_in_one_recording_are_parts_of_it() {
        let found = parts(&sweeps(&[0.05, 0.1, 0.4], 1), RATE_HZ);
        let speeds: Vec<f64> = found
            .iter()
            .filter_map(|part| match part.kind {
                Kind::Sweep { speed } => Some((speed * 100.0).round() / 100.0),
                _ => None,
            })
            .collect();
        assert_eq!(speeds, [0.05, 0.1, 0.4], "{found:?}");
        assert!(found.windows(2).all(|pair| pair[0].samples.end == pair[1].samples.start));
    }
}
