//! The position that a reading tells, and the travel back below which nothing counts as a reversal.
//!
//! K_f needs the position without the ringing that a filter leaves at a corner, so as recorded. But a coarse encoder stands
//! still and jumps: with 4096 counts per turn a clearance of 20 mrad is 13 steps, and friction changes most in the first; low-passed, steps
//! leave a speed whose sign changes with each of them where the joint is slow. Where it jumps, though, it tells the position exactly: half
//! way between two counts. And between all motions that would have been read the same, the smoothest is the likely one: what rounding leaves in
//! an acceleration grows with the bandwidth to the power of 2.5, and an inertia that is fitted to it comes out too small.

use crate::numerics::statistics::{deviation_by_median, mean};
use std::f64::consts::FRAC_1_SQRT_2;

/// A reversal counts once the joint came back by this many standard deviations of the position's noise: two samples at
/// rest, the extremes of hundreds, differ by 6.
const DEADBAND_SIGMAS: f64 = 8.0;
/// The same of an encoder without other noise, in steps: between its jumps the position is made of them.
const DEADBAND_STEPS: f64 = 0.5;
/// The noise of the steps alone is 0.3 of a step (uniform within it): up to this share of one there is no other.
const STEPS_ALONE: f64 = 0.5;
/// Changes are one step of an encoder within this share of it: a table rounds them.
const ONE_STEP: f64 = 0.2;
/// Of changes of fewer steps than this ...
const FEW_STEPS: f64 = 10.5;
/// ... so many are whole numbers of steps, ...
const WHOLE_SHARE: f64 = 0.95;
/// ... within this share of one, where the position moves in steps.
const WHOLE: f64 = 0.1;
/// There, so many changes are of a single step beside a sample without change: as many of any motion that is slow somewhere, none of one that
/// is of constant speed between its corners.
const LONE_MIN: usize = 10;
/// A motion would have been read as it was if it is nowhere further from the reading, in steps: half a step, and a tenth for what noise adds ...
const READ_ALIKE: f64 = 0.6;
/// ... but at this share of the readings; ...
const READ_OTHERWISE_SHARE: f64 = 0.01;
/// ... and a narrower filter moves no larger share by as much: it would round corners that the readings show.
const MOVED_SHARE: f64 = 0.002;
/// Most halvings of the power that the motion's low-pass lets through.
const NARROWINGS: i32 = 16;

/// What a reading tells.
pub struct Position {
    /// What an encoder's jumps say of the position, rad; `None` where it is as recorded.
    pub between_jumps_rad: Option<Vec<f64>>,
    /// The deadband, rad.
    pub deadband_rad: f64,
    /// The encoder's step where it matters, else 0, rad.
    pub step_rad: f64,
}

impl Position {
    /// Of a position as recorded and the same filtered, rad. What the filter took out tells the noise; the median resists
    /// the corners, where it takes out motion.
    pub fn new(raw_rad: &[f64], filtered_rad: &[f64]) -> Self {
        // Every 7th sample is enough for a median and keeps it cheap.
        let mut taken: Vec<f64> = raw_rad.iter().zip(filtered_rad).step_by(7).map(|(r, f)| (r - f).abs()).collect();
        let sigma_rad = deviation_by_median(&mut taken);
        match encoder_step_rad(raw_rad) {
            Some(step_rad) if sigma_rad <= STEPS_ALONE * step_rad => Self {
                between_jumps_rad: Some(between_jumps(raw_rad, step_rad)),
                deadband_rad: (DEADBAND_SIGMAS * sigma_rad).min(DEADBAND_STEPS * step_rad),
                step_rad,
            },
            _ => Self {
                between_jumps_rad: None,
                deadband_rad: if sigma_rad.is_finite() { DEADBAND_SIGMAS * sigma_rad } else { 0.0 },
                step_rad: 0.0,
            },
        }
    }
}

/// Changes from one of `raw_rad` to the next of more than `above_rad`, rad.
pub fn changes_rad(raw_rad: &[f64], above_rad: f64) -> impl Iterator<Item = f64> {
    raw_rad.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(move |change| *change > above_rad)
}

/// The step of the encoder, rad; `None` where the position does not move in steps.
fn encoder_step_rad(raw_rad: &[f64]) -> Option<f64> {
    let smallest_rad = changes_rad(raw_rad, 0.0).min_by(f64::total_cmp)?;
    let is_single = |change: f64| change > 0.0 && change < (1.0 + ONE_STEP) * smallest_rad;
    let single: Vec<f64> = changes_rad(raw_rad, 0.0).filter(|change| is_single(*change)).collect();
    let step_rad = mean(&single);
    let is_lone = |four: &&[f64]| is_single((four[2] - four[1]).abs()) && (four[0] == four[1] || four[2] == four[3]);
    let lone = raw_rad.windows(4).filter(is_lone).count();
    let few = || changes_rad(raw_rad, 0.0).map(|change| change / step_rad).filter(|steps| *steps < FEW_STEPS);
    let whole = few().filter(|steps| (steps - steps.round()).abs() < WHOLE).count();
    (lone >= LONE_MIN && whole as f64 >= WHOLE_SHARE * few().count() as f64).then_some(step_rad)
}

/// Straight lines between the jumps of an encoder of step `step_rad`; where it jumps back, the crest that the jumps before
/// and after make likely. A reading that wavers between two counts is a flat line.
fn between_jumps(raw_rad: &[f64], step_rad: f64) -> Vec<f64> {
    let jumps = jumps(raw_rad, step_rad);
    let (Some(first), Some(last)) = (jumps.first(), jumps.last()) else { return raw_rad.to_vec() };
    let mut out = Vec::with_capacity(raw_rad.len());
    out.resize(first.at.ceil() as usize, first.position_rad);
    for (k, pair) in jumps.windows(2).enumerate() {
        let [from, to] = [pair[0], pair[1]];
        let outer = k.checked_sub(1).and_then(|before| Some([*jumps.get(before)?, *jumps.get(k + 2)?]));
        let crest = if from.position_rad == to.position_rad { crest([from, to], outer, step_rad) } else { Crest::None };
        let between = out.len()..to.at.ceil() as usize;
        for (i, reading_rad) in between.clone().zip(&raw_rad[between]) {
            let share = (i as f64 - from.at) / (to.at - from.at);
            let line_rad = from.position_rad + (to.position_rad - from.position_rad) * share;
            out.push(match crest {
                Crest::None => line_rad,
                Crest::Parabola(height_rad) => line_rad + height_rad * 4.0 * share * (1.0 - share),
                Crest::Rest => *reading_rad,
            });
        }
    }
    out.resize(raw_rad.len(), last.position_rad);
    out
}

/// What `low_passed` makes of the position at the lowest cut-off, from `cutoff_hz` down, at which an encoder of step `step_rad` would still
/// have read `raw_rad`, rad; `None` where there is no filter of that cut-off.
pub fn smoothed(
    raw_rad: &[f64],
    step_rad: f64,
    cutoff_hz: f64,
    low_passed: impl Fn(f64) -> Option<Vec<f64>>,
) -> Option<Vec<f64>> {
    let widest_rad = low_passed(cutoff_hz)?;
    let apart = |a: &[f64], b: &[f64]| {
        let is_apart = |(a, b): &(&f64, &f64)| (*a - *b).abs() > READ_ALIKE * step_rad;
        a.iter().zip(b).filter(is_apart).count() as f64 / a.len() as f64
    };
    let is_read_alike = |smooth_rad: &Vec<f64>| {
        apart(raw_rad, smooth_rad) <= READ_OTHERWISE_SHARE && apart(&widest_rad, smooth_rad) <= MOVED_SHARE
    };
    let narrower = (1..=NARROWINGS).map_while(|halvings| low_passed(cutoff_hz * FRAC_1_SQRT_2.powi(halvings)));
    let smoothest_rad = narrower.take_while(is_read_alike).last();
    Some(smoothest_rad.unwrap_or(widest_rad))
}

/// A place where the position is known.
#[derive(Clone, Copy)]
struct Jump {
    /// Time, samples.
    at: f64,
    /// Position, rad.
    position_rad: f64,
}

/// Half way between two counts where the reading changed by one step; by more, the two readings themselves: the motion is
/// then so fast that a step is little.
fn jumps(raw_rad: &[f64], step_rad: f64) -> Vec<Jump> {
    let mut jumps: Vec<Jump> = Vec::new();
    for (i, pair) in raw_rad.windows(2).enumerate().filter(|(_, pair)| pair[0] != pair[1]) {
        if (pair[1] - pair[0]).abs() < 1.5 * step_rad {
            jumps.push(Jump { at: i as f64 + 0.5, position_rad: (pair[0] + pair[1]) / 2.0 });
            continue;
        }
        if jumps.last().is_none_or(|last| last.at < i as f64) {
            jumps.push(Jump { at: i as f64, position_rad: pair[0] });
        }
        jumps.push(Jump { at: i as f64 + 1.0, position_rad: pair[1] });
    }
    jumps
}

/// What the joint did between a jump and the same jump back.
enum Crest {
    /// Nothing that shows.
    None,
    /// It turned, so far beyond the jump, rad.
    Parabola(f64),
    /// It rested before it turned.
    Rest,
}

/// Between the jumps `there_and_back` it turned on the parabola through them and the `outer` ones, if those are one step below. A parabola
/// that reached the next step would have caused a further jump, so such a stretch is a rest.
fn crest(there_and_back: [Jump; 2], outer: Option<[Jump; 2]>, step_rad: f64) -> Crest {
    let Some(outer) = outer else { return Crest::Rest };
    let height_rad = outer.map(|jump| there_and_back[0].position_rad - jump.position_rad);
    let is_step = |rad: f64| (rad.abs() / step_rad - 1.0).abs() < ONE_STEP;
    if height_rad[0] * height_rad[1] <= 0.0 || !height_rad.iter().all(|rad| is_step(*rad)) {
        return Crest::None;
    }
    let time = |[from, to]: [Jump; 2]| to.at - from.at;
    let share = time(there_and_back).powi(2) / (time(outer).powi(2) - time(there_and_back).powi(2));
    if share < 1.0 { Crest::Parabola(height_rad[0] * share) } else { Crest::Rest }
}

#[cfg(test)]
mod tests {
    use super::{Position, between_jumps, encoder_step_rad, smoothed};
    use crate::numerics::difference::acceleration;
    use crate::numerics::filter::LowPass;

    const STEP_RAD: f64 = 1e-3;
    const RATE_HZ: f64 = 200.0;

    /// Read in steps.
    fn read(rad: &[f64], step_rad: f64) -> Vec<f64> {
        rad.iter().map(|x| (x / step_rad).round() * step_rad).collect()
    }

    /// 5 s of a motion.
    fn motion(position_rad: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..1000).map(|i| position_rad(f64::from(i) / RATE_HZ)).collect()
    }

    /// Turns slowly and goes quickly, several steps a sample.
    fn slow_and_quick(t: f64) -> f64 {
        0.5 * (1.3 * t).sin() + 0.04 * (7.1 * t).cos()
    }

    fn largest(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn an_encoder_has_steps_at_any_speed_and_nothing_else_has() {
        let truth = motion(slow_and_quick);
        for step_rad in [1e-2, STEP_RAD, 1e-4] {
            // A table rounds what it holds.
            let rounded = read(&read(&truth, step_rad), 1e-3 * step_rad);
            let found_rad = encoder_step_rad(&rounded).unwrap();
            assert!((found_rad / step_rad - 1.0).abs() < 1e-3, "{found_rad} of {step_rad}");
        }
        assert_eq!(encoder_step_rad(&truth), None);
        assert_eq!(encoder_step_rad(&[1.0; 100]), None);
        assert_eq!(encoder_step_rad(&[]), None);
        let sweep = motion(|t| 0.1 * (t % 2.0 - 1.0).abs());
        assert_eq!(encoder_step_rad(&sweep), None);
        let drifting: Vec<f64> = truth.iter().enumerate().map(|(i, x)| x + 1e-6 * i as f64).collect();
        assert_eq!(encoder_step_rad(&drifting), None);
    }

    #[test]
    fn between_its_jumps_a_slow_joint_is_where_it_was_even_if_it_is_quick_elsewhere() {
        let truth = motion(slow_and_quick);
        let raw = read(&truth, STEP_RAD);
        let Position { between_jumps_rad, deadband_rad, step_rad } = Position::new(&raw, &truth);
        assert!((step_rad / STEP_RAD - 1.0).abs() < 1e-9 && deadband_rad <= 0.5 * STEP_RAD * (1.0 + 1e-9));
        let told = between_jumps_rad.unwrap();
        // Slower than a step in two samples: there a reading is half a step off, a line between two jumps a tenth.
        let slow: Vec<usize> = (10..990usize).filter(|&i| (truth[i + 1] - truth[i]).abs() < 0.5 * STEP_RAD).collect();
        let off = |of: &[f64]| slow.iter().map(|i| (of[*i] - truth[*i]).powi(2)).sum::<f64>().sqrt();
        assert!(slow.len() > 20 && off(&told) < 0.5 * off(&raw), "{} of {}", off(&told), off(&raw));
    }

    #[test]
    fn a_turn_between_two_jumps_is_found_where_it_was() {
        // 0.6 steps beyond the last jump, at 2 s.
        let truth = motion(|t| (5.1 - 40.0 * (t - 2.0).powi(2)) * STEP_RAD);
        let told = between_jumps(&read(&truth, STEP_RAD), STEP_RAD);
        let top = (0..truth.len()).max_by(|a, b| told[*a].total_cmp(&told[*b])).unwrap();
        assert!(top.abs_diff(400) <= 2, "{top}");
        assert!(largest(&told[350..450], &truth[350..450]) < 0.15 * STEP_RAD);
    }

    #[test]
    fn a_motion_is_as_smooth_as_its_readings_allow_and_no_smoother() {
        let wave = |hz: f64, i: i32| 0.3 * (std::f64::consts::TAU * hz * f64::from(i) / RATE_HZ).sin();
        let inner = 100..3900;
        let off = |rad: &[f64], truth: &[f64]| {
            let of = |rad: &[f64]| acceleration(rad, RATE_HZ)[inner.clone()].to_vec();
            of(rad).iter().zip(of(truth)).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        for hz in [0.21, 0.53, 1.9] {
            let truth: Vec<f64> = (0..4000).map(|i| wave(hz, i)).collect();
            let step_rad = 2.0 * STEP_RAD;
            let raw = read(&truth, step_rad);
            let between = between_jumps(&raw, step_rad);
            let low_passed = |cutoff_hz: f64| Some(LowPass::new(4, cutoff_hz, RATE_HZ)?.zero_phase(&between));
            let [smooth, wide] = [smoothed(&raw, step_rad, 40.0, low_passed), low_passed(40.0)].map(Option::unwrap);
            let [left, before] = [&smooth, &wide].map(|rad| off(rad, &truth));
            assert!(left < 0.2 * before, "{hz} Hz: {left} of {before}");
            let moved_rad = largest(&smooth[inner.clone()], &truth[inner.clone()]);
            assert!(moved_rad < 0.6 * step_rad, "{hz} Hz: {moved_rad}");
        }
        // Steps that hide nothing leave the filter as it is.
        let truth = motion(slow_and_quick);
        let low_passed = |cutoff_hz: f64| Some(LowPass::new(4, cutoff_hz, RATE_HZ)?.zero_phase(&truth));
        assert_eq!(smoothed(&truth, 1e-9, 40.0, low_passed).unwrap(), low_passed(40.0).unwrap());
        assert_eq!(smoothed(&truth, 1e-9, RATE_HZ, low_passed), None);
    }

    #[test]
    fn a_reading_noisier_than_its_steps_is_kept() {
        let truth = motion(slow_and_quick);
        let noise = |i: usize| STEP_RAD * (((i * 7919) % 101) as f64 / 25.0 - 2.0);
        let raw = read(&truth.iter().enumerate().map(|(i, x)| x + noise(i)).collect::<Vec<_>>(), STEP_RAD);
        let found = Position::new(&raw, &truth);
        assert!(found.between_jumps_rad.is_none() && found.deadband_rad > STEP_RAD);
    }
}
