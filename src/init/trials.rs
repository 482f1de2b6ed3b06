//! Files -> trials: split where time has gaps and where the motion changes, speeds of repeats made one, repeats numbered.

use super::columns::Chosen;
use super::motion::{Kind, is_repeat, parts};
use super::{Source, values};
use crate::dynamics::JointKind;
use crate::import::stretches;
use crate::trajectory::Protocol;
use crate::units::Quantity;
use std::ops::Range;

/// What lasts less than this is no trial, s.
const SHORTEST_S: f64 = 1.0;
/// Speeds, amplitudes and frequencies that differ by less than this share are the same, in different files.
const SAME: f64 = 0.03;
/// Significant digits of a speed that is declared: far finer than the 5 % within which a leg must keep it.
const SPEED_DIGITS: i32 = 3;

/// One trial of a draft.
#[derive(Debug, Clone, PartialEq)]
pub struct DraftTrial {
    /// Its file's place among the sources.
    pub source: usize,
    /// Its rows, where it is not the whole file.
    pub rows: Option<Range<usize>>,
    /// How the joint moves.
    pub protocol: Protocol,
    /// Number among the repeats of one motion.
    pub repeat: u32,
    /// Name of the motion, where one protocol holds several.
    pub trajectory: Option<String>,
    /// What was found, for people.
    pub found: String,
}

struct Found {
    source: usize,
    samples: Range<usize>,
    is_whole: bool,
    kind: Kind,
    position: Vec<f64>,
}

/// The trials of `sources`, and the sample rate, Hz; what is too short for one goes to the notes of `chosen`.
pub(super) fn list(sources: &[Source], chosen: &mut Chosen, rate_hz: Option<f64>) -> (Vec<DraftTrial>, f64) {
    let mut all: Vec<Found> = Vec::new();
    let mut found_hz = 0.0;
    for (at, source) in sources.iter().enumerate() {
        let position = chosen.of(Quantity::Position).and_then(|choice| values(source, choice));
        let time = chosen.of(Quantity::Time).and_then(|choice| values(source, choice));
        let Some(position) = position else { continue };
        let (stretches, rate) = match &time {
            Some(time) => {
                let found = stretches(time);
                let rate = found.first().map_or(0.0, |first| rate(time, first));
                (found, rate)
            }
            None => (std::iter::once(0..position.len()).collect(), rate_hz.unwrap_or(0.0)),
        };
        found_hz = if found_hz == 0.0 { rate } else { found_hz };
        for stretch in stretches {
            // Without a rate speeds are per sample, and only their ratios mean something.
            let hz = if rate > 0.0 { rate } else { 1.0 };
            for part in parts(&position[stretch.clone()], hz) {
                let samples = stretch.start + part.samples.start..stretch.start + part.samples.end;
                if rate > 0.0 && (samples.len() as f64) < SHORTEST_S * rate {
                    let rows = format!("rows {} to {} of {}", samples.start, samples.end, source.name);
                    chosen.notes.push(format!("{rows} are no trial: shorter than {SHORTEST_S} s"));
                    continue;
                }
                let is_whole = samples == (0..position.len());
                let position = position[samples.clone()].to_vec();
                all.push(Found { source: at, samples, is_whole, kind: part.kind, position });
            }
        }
    }
    (number(all, chosen.kind), found_hz)
}

/// The rate of `time` (s) in its first stretch, Hz; 0 where it does not grow.
fn rate(time: &[f64], first: &Range<usize>) -> f64 {
    let span_s = time[first.end - 1] - time[first.start];
    if span_s > 0.0 { (first.len() - 1) as f64 / span_s } else { 0.0 }
}

/// Names protocols and trajectories, and numbers repeats.
fn number(all: Vec<Found>, kind: JointKind) -> Vec<DraftTrial> {
    let speeds = common(all.iter().filter_map(|found| match found.kind {
        Kind::Sweep { speed } => Some(speed),
        _ => None,
    }));
    // The motions, each with its first recording.
    let mut motions: Vec<usize> = Vec::new();
    let mut counts: Vec<(String, u32)> = Vec::new();
    let mut trials = Vec::new();
    for (at, found) in all.iter().enumerate() {
        let same = |first: &&usize| {
            let (a, b) = (&all[**first], found);
            std::mem::discriminant(&a.kind) == std::mem::discriminant(&b.kind) && is_repeat(&a.position, &b.position)
        };
        let motion = motions.iter().find(same).copied().unwrap_or(at);
        if motion == at {
            motions.push(at);
        }
        let (protocol, words, key) = protocol(found.kind, kind, &speeds, motion);
        let rows = (!found.is_whole).then(|| found.samples.clone());
        let repeat = next_repeat(&mut counts, key);
        trials.push((
            DraftTrial { source: found.source, rows, protocol, repeat, trajectory: None, found: words },
            motion,
        ));
    }
    name_trajectories(&mut trials, &all);
    trials.into_iter().map(|(trial, _)| trial).collect()
}

/// The protocol of a motion of `moves` of a joint of this `kind`, in words, and the key by which its repeats are counted: the nearest of the
/// common `speeds` for a sweep, else the number of the `motion`.
fn protocol(moves: Kind, kind: JointKind, speeds: &[f64], motion: usize) -> (Protocol, String, String) {
    let is_angle = kind == JointKind::Revolute;
    let (unit, scale) = if is_angle { ("deg", 180.0 / std::f64::consts::PI) } else { ("mm", 1e3) };
    let free = format!("free {motion}");
    match moves {
        Kind::Sweep { speed } if is_angle => {
            let nearest = speeds.iter().copied().min_by(|a, b| (a - speed).abs().total_cmp(&(b - speed).abs()));
            let speed_rad_s = nearest.unwrap_or(speed);
            let words = format!("sweep at {:.4} deg/s", speed_rad_s * scale);
            (Protocol::Uniform { speed_rad_s }, words, format!("{speed_rad_s}"))
        }
        Kind::Sweep { speed } => (Protocol::Free, format!("sweep at {:.4} mm/s", speed * scale), free),
        Kind::Cosine { amplitude, slowest_hz, fastest_hz } => {
            let words = format!("cosines of {:.2} {unit}, {slowest_hz:.3} to {fastest_hz:.3} Hz", amplitude * scale);
            (Protocol::Cosine, words, format!("cosine {motion}"))
        }
        Kind::Free => (Protocol::Free, "free motion".to_string(), free),
        Kind::Rest => (Protocol::Free, "the joint is at rest".to_string(), free),
    }
}

/// The number of the next repeat counted under `key`, from 1.
fn next_repeat(counts: &mut Vec<(String, u32)>, key: String) -> u32 {
    if let Some((_, count)) = counts.iter_mut().find(|(known, _)| *known == key) {
        *count += 1;
        return *count;
    }
    counts.push((key, 1));
    1
}

/// Names motions: cosines where there are several, free motions where one is repeated.
fn name_trajectories(trials: &mut [(DraftTrial, usize)], all: &[Found]) {
    let of = |is: fn(&Kind) -> bool, trials: &[(DraftTrial, usize)]| {
        let mut motions: Vec<usize> = trials.iter().map(|(_, motion)| *motion).filter(|m| is(&all[*m].kind)).collect();
        motions.sort_unstable();
        motions.dedup();
        motions
    };
    let cosines = of(|kind| matches!(kind, Kind::Cosine { .. }), trials);
    for (number, motion) in cosines.iter().enumerate().filter(|_| cosines.len() > 1) {
        let named = trials.iter_mut().filter(|(_, m)| m == motion);
        named.for_each(|(trial, _)| trial.trajectory = Some(format!("cosine_{}", number + 1)));
    }
    let others = of(|kind| !matches!(kind, Kind::Cosine { .. }), trials);
    let mut number = 0;
    for motion in others {
        let is_free = |(trial, m): &(DraftTrial, usize)| *m == motion && trial.protocol == Protocol::Free;
        if trials.iter().filter(|trial| is_free(trial)).count() > 1 {
            number += 1;
            let named = trials.iter_mut().filter(|trial| is_free(trial));
            named.for_each(|(trial, _)| trial.trajectory = Some(format!("motion_{number}")));
        }
    }
}

/// Speeds, those nearly alike made one, to a few digits.
fn common(speeds: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut speeds: Vec<f64> = speeds.collect();
    speeds.sort_by(f64::total_cmp);
    let groups = speeds.chunk_by(|a, b| (b / a - 1.0).abs() <= SAME);
    groups.map(|group| digits(group.iter().sum::<f64>() / group.len() as f64, SPEED_DIGITS)).collect()
}

/// `value` to `digits` significant digits.
pub(super) fn digits(value: f64, digits: i32) -> f64 {
    format!("{value:.*e}", (digits - 1).max(0) as usize).parse().unwrap_or(value)
}
