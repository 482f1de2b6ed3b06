//! The prediction over a thinned trial, through the same low-pass as the measurement: what every fit on series compares.

use crate::dynamics::Motion;
use crate::effects::{Evaluated, Sample};
use crate::model::{Asked, Direction, Model, Passage, Turn, directions, settle, turns};
use crate::numerics::filter::LowPass;
use crate::numerics::statistics::extent;
use crate::prepare::{REST_S, Series, before_turns, rests};
use std::ops::Range;

/// Around a stretch of a trial, in periods of the low-pass: the filter run on the stretch alone has then forgotten its edges.
pub const PADDING_PERIODS: f64 = 3.0;

/// A thinned trial with what does not change while a model is fitted to it.
#[derive(Debug, Clone)]
pub struct Prepared {
    /// The trial.
    pub series: Series,
    /// The campaign's low-pass, designed for the thinned rate; `None` if that rate cannot carry it.
    lowpass: Option<LowPass>,
    /// Where the motion is cut into strokes: its extremes.
    reversals: Vec<(usize, Direction)>,
    strokes_rad: Vec<f64>,
    /// Where friction that jumps changes over: where the joint leaves the other way, with the rest before.
    turns: Vec<Turn>,
    /// Direction of the motion at each sample.
    moving: Vec<Direction>,
}

impl Prepared {
    /// `series` with a low-pass of `order` at `cutoff_hz`.
    pub fn new(series: Series, order: usize, cutoff_hz: f64) -> Self {
        let lowpass = LowPass::new(order, cutoff_hz, series.rate_hz);
        let reversals = reversals(&series);
        let strokes_rad = strokes_rad(&series, &reversals);
        let Series { position_rad, velocity_rad_s, deadband_rad, .. } = &series;
        let turns = turns(position_rad, |i| velocity_rad_s[i], *deadband_rad);
        let moving = directions(position_rad, &turns, *deadband_rad);
        Self { series, lowpass, reversals, strokes_rad, turns, moving }
    }

    /// Samples.
    pub fn len(&self) -> usize {
        self.series.torque_nm.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// `signal`, sampled as the series is, through the low-pass.
    pub fn low_pass(&self, signal: &[f64]) -> Vec<f64> {
        self.lowpass.as_ref().map_or_else(|| signal.to_vec(), |filter| filter.zero_phase(signal))
    }

    /// The same in place, of `L` signals side by side.
    pub fn low_pass_together<const L: usize>(&self, signals: &mut [[f64; L]]) {
        if let Some(filter) = &self.lowpass {
            filter.zero_phase_together(signals);
        }
    }

    /// Direction of the motion at each sample: that by which friction jumps.
    pub fn moving(&self) -> &[Direction] {
        &self.moving
    }

    /// K~ of every sample for `model`'s curve and backlash, and the first sample from which it is known.
    pub fn k_tilde<S: Evaluated>(&self, model: &Model<S>) -> (Vec<S>, usize) {
        let backlash_rad = model.joint.backlash_rad();
        let deadband_rad = self.series.deadband_rad;
        let (direction, known_from) = settle(&self.series.position_rad, backlash_rad.value(), deadband_rad);
        let start_rad = self.series.position_rad.first().copied().unwrap_or(0.0);
        let mut state = Passage::after(model, direction, start_rad, deadband_rad);
        let samples = self.series.position_rad.iter().zip(&self.moving);
        (samples.map(|(x, moving)| state.step(*x, Some(*moving))).collect(), known_from)
    }

    /// y predicted by `model` at any sample, friction combined by `k_tilde` there, before the low-pass, N m. Of effects it has at most
    /// friction that goes with the load, which knows no acceleration.
    pub fn torque_nm<S: Evaluated<Given = f64>>(&self, model: &Model<S>) -> impl Fn(usize, S) -> S {
        let load_nm = self.series.joint_torque_nm(&model.dynamics);
        move |i, k_tilde| {
            let velocity = self.series.velocity_rad_s[i];
            if model.effects.is_empty() {
                return model.torque_nm(load_nm(i), velocity, k_tilde).torque_nm;
            }
            let (time_s, position) = (self.series.time_s[i], self.series.position_rad[i]);
            let own = Motion { position, velocity, acceleration: 0.0 };
            let sample = Sample { time_s, elapsed_s: time_s, own, others: &[] };
            model.driven_nm(&sample, Asked { torque_nm: load_nm(i), slope_nm_rad: S::from(0.0) }, k_tilde).torque_nm
        }
    }

    /// Measured less predicted, both through the low-pass, N m, and the first sample from which K~ is known.
    pub fn residual_nm(&self, model: &Model) -> (Vec<f64>, usize) {
        let (k_tilde, known_from) = self.k_tilde(model);
        let torque_nm = self.torque_nm(model);
        let raw: Vec<f64> = k_tilde.iter().enumerate().map(|(i, k)| torque_nm(i, *k)).collect();
        let predicted = self.low_pass(&raw);
        (self.series.torque_nm.iter().zip(&predicted).map(|(y, p)| y - p).collect(), known_from)
    }

    /// Samples at which friction that jumps is not known: at rest, about a rest before a turn, and within twice [`REST_S`] of any other rest, whose
    /// edges are not still for as long and which the low-pass mixes with what is beside it.
    pub fn undecided(&self) -> Vec<bool> {
        let Series { position_rad, rate_hz, deadband_rad, .. } = &self.series;
        let mut undecided = rests(position_rad, *rate_hz, *deadband_rad);
        let mut pauses = undecided.clone();
        for Turn { rest, .. } in &self.turns {
            let before = pauses[..rest.start].iter().rev().take_while(|rests| **rests).count();
            let after = pauses[rest.end..].iter().take_while(|rests| **rests).count();
            pauses[rest.start - before..rest.end + after].fill(false);
        }
        let beside = (2.0 * REST_S * rate_hz) as usize;
        for (i, undecided) in undecided.iter_mut().enumerate() {
            *undecided |= pauses[i.saturating_sub(beside)..(i + beside + 1).min(pauses.len())].contains(&true);
        }
        if let Some(lowpass) = &self.lowpass {
            let before_turn = before_turns(&self.turns, self.len(), lowpass);
            undecided.iter_mut().zip(before_turn).for_each(|(undecided, before)| *undecided |= before);
        }
        undecided
    }

    /// Samples at which the joint turns, with the direction it turns to.
    pub fn reversals(&self) -> &[(usize, Direction)] {
        &self.reversals
    }

    /// How far it goes from one reversal to the next, rad; of a motion without a whole stroke, its range.
    pub fn strokes_rad(&self) -> &[f64] {
        &self.strokes_rad
    }

    /// The motion cut at its reversals, with where each stroke goes; what comes before the first reversal is one too.
    pub fn strokes(&self) -> Vec<(Range<usize>, Direction)> {
        let turns = self.reversals();
        let positions = &self.series.position_rad;
        let falls = positions.last() < positions.first();
        let alone = if falls { Direction::Down } else { Direction::Up };
        let begin = turns.first().map_or(alone, |(_, direction)| direction.opposite());
        let starts = std::iter::once((0, begin)).chain(turns.iter().copied());
        let ends = turns.iter().map(|(at, _)| *at).chain([self.len()]);
        starts.zip(ends).map(|((start, direction), end)| (start..end, direction)).collect()
    }
}

fn reversals(series: &Series) -> Vec<(usize, Direction)> {
    let positions = &series.position_rad;
    let Some(first) = positions.first() else { return Vec::new() };
    let (mut extreme_rad, mut at, mut direction) = (*first, 0, None);
    let mut turns = Vec::new();
    for (i, x) in positions.iter().enumerate() {
        let onward = |d: Direction| (x - extreme_rad) * d.sign();
        match direction {
            Some(d) if onward(d) >= 0.0 => (extreme_rad, at) = (*x, i),
            Some(d) if onward(d) >= -series.deadband_rad => {}
            _ if (x - extreme_rad).abs() > series.deadband_rad => {
                let turned = if *x > extreme_rad { Direction::Up } else { Direction::Down };
                if direction.is_some() {
                    turns.push((at, turned));
                }
                direction = Some(turned);
                (extreme_rad, at) = (*x, i);
            }
            _ => {}
        }
    }
    turns
}

fn strokes_rad(series: &Series, turns: &[(usize, Direction)]) -> Vec<f64> {
    if turns.len() < 2 {
        let (low, high) = extent(&series.position_rad);
        return vec![(high - low).max(0.0)];
    }
    turns.windows(2).map(|pair| (series.position_rad[pair[1].0] - series.position_rad[pair[0].0]).abs()).collect()
}
