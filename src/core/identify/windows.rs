//! Where friction changes over: the stretches of a campaign around its reversals.

use super::predicted::{PADDING_PERIODS, Prepared};
use crate::model::{Both, Combination, Direction, Model, Transition, settle};
use crate::numerics::statistics::mean;
use std::ops::Range;

/// The stretch goes on after the transition for as long as the low-pass smears it, in periods of the low-pass.
const SMEAR_PERIODS: f64 = 0.5;

/// A stretch of one trial that holds one or more transitions.
#[derive(Debug, Clone)]
pub struct Window<'a> {
    trial: &'a Prepared,
    padded: Range<usize>,
    /// Samples judged.
    pub judged: Range<usize>,
    start: Direction,
    /// (r1/r2) G + Bd of each padded sample, N m, ...
    base_nm: Vec<f64>,
    /// ... Bu - Bd, N m, ...
    change_nm: Vec<f64>,
    /// ... and the measured torque in the judged samples.
    measured_nm: &'a [f64],
}

/// One sample inside a transition, as in the paper's figure 6: the share of the friction's change done against that of the
/// displacement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Where the motion goes.
    pub direction: Direction,
    /// (K_f + 1)/2 upwards, (1 - K_f)/2 downwards: both from 0 to 1.
    pub share_of_travel: f64,
    /// K~ upwards, 1 - K~ downwards, as measured.
    pub share_of_change: f64,
}

/// The windows of `trial`: from each reversal until the joint has gone on by `reach_rad`.
pub fn windows<'a>(trial: &'a Prepared, model: &Model, reach_rad: f64, lowpass_hz: f64) -> Vec<Window<'a>> {
    let n = trial.len();
    let (_, known_from) = settle(&trial.series.position_rad, model.joint.backlash_rad(), trial.series.deadband_rad);
    let pad = (PADDING_PERIODS / lowpass_hz * trial.series.rate_hz) as usize;
    let smear = (SMEAR_PERIODS / lowpass_hz * trial.series.rate_hz) as usize;
    let turns = trial.reversals();
    let mut ranges: Vec<(Range<usize>, Direction)> = Vec::new();
    for (k, (at, direction)) in turns.iter().enumerate() {
        let next = turns.get(k + 1).map_or(n, |turn| turn.0);
        let from = trial.series.position_rad[*at];
        let gone = |i: &usize| (trial.series.position_rad[*i] - from).abs() >= reach_rad;
        let end = ((*at..next).find(gone).unwrap_or(next) + smear).min(n);
        match ranges.last_mut() {
            // Nearer than the padding: one window, for its state is carried through both.
            Some((last, _)) if *at < last.end + 2 * pad => last.end = end,
            _ if *at < known_from + pad => {}
            _ => ranges.push((*at..end, *direction)),
        }
    }
    let cut = |(judged, direction)| Window::new(trial, model, judged, direction, pad);
    ranges.into_iter().map(cut).filter(|window| window.is_in_range()).collect()
}

impl<'a> Window<'a> {
    fn new(trial: &'a Prepared, model: &Model, judged: Range<usize>, turns_to: Direction, pad: usize) -> Self {
        let padded = judged.start.saturating_sub(pad)..(judged.end + pad).min(trial.len());
        let branch = |direction, i: usize| model.branch_nm(direction, trial.series.velocity_rad_s[i]);
        let load_nm = trial.series.joint_torque_nm(&model.dynamics);
        let rigid = |i: usize| model.joint.transmission() * load_nm(i);
        Self {
            base_nm: padded.clone().map(|i| rigid(i) + branch(Direction::Down, i)).collect(),
            change_nm: padded.clone().map(|i| branch(Direction::Up, i) - branch(Direction::Down, i)).collect(),
            measured_nm: &trial.series.torque_nm[judged.clone()],
            trial,
            padded,
            judged,
            start: turns_to.opposite(),
        }
    }

    fn is_in_range(&self) -> bool {
        self.trial.series.in_range[self.judged.clone()].iter().all(|ok| *ok)
    }

    fn states(&self, curve: &Combination, backlash_rad: f64) -> impl Iterator<Item = Transition> + '_ {
        let positions = &self.trial.series.position_rad[self.padded.clone()];
        let mut state = Transition::after(self.start, positions[0]);
        let (curve, deadband_rad) = (*curve, self.trial.series.deadband_rad);
        positions.iter().map(move |x| {
            state.step(*x, &curve, backlash_rad, deadband_rad);
            state
        })
    }

    /// Sum of squares of the measured torque about its mean in the window, (N m)^2.
    pub fn spread(&self) -> f64 {
        let middle = mean(self.measured_nm);
        self.measured_nm.iter().map(|y| (y - middle).powi(2)).sum()
    }

    /// Sum over the window of the square of what friction changes by between the branches, (N m)^2.
    pub fn change_square_sum(&self, model: &Model) -> f64 {
        let Both { up, down } = &model.friction;
        let skip = self.judged.start - self.padded.start;
        let changes = self.base_nm.iter().zip(&self.change_nm).skip(skip).take(self.judged.len());
        changes.map(|(base, change)| ((base + change) / up.loss() - base / down.loss()).powi(2)).sum()
    }

    /// Predicted less measured, both through the low-pass, in the judged samples, N m.
    pub fn residual_nm(&self, model: &Model, curve: &Combination, backlash_rad: f64) -> Vec<f64> {
        // As [`crate::model::Passage`] has it along a whole trial.
        let k_tilde: Vec<f64> = match curve {
            Combination::Sign => self.trial.moving()[self.padded.clone()].iter().map(|to| to.k_tilde()).collect(),
            _ => self.states(curve, backlash_rad).map(|state| state.k_tilde).collect(),
        };
        let torque = k_tilde.into_iter().zip(self.base_nm.iter().zip(&self.change_nm));
        let torque: Vec<f64> =
            torque.map(|(k_tilde, (base, change))| model.balance_nm(*base, k_tilde * change, k_tilde)).collect();
        let filtered = self.trial.low_pass(&torque);
        let skip = self.judged.start - self.padded.start;
        filtered[skip..].iter().zip(self.measured_nm).map(|(p, y)| p - y).collect()
    }

    /// The samples inside transitions; none where the motion is so fast that the low-pass would have smeared them.
    pub fn crossings(&self, model: &Model, backlash_rad: f64, lowpass_hz: f64) -> Vec<Crossing> {
        let skip = self.judged.start - self.padded.start;
        let states: Vec<Transition> =
            self.states(&Combination::Linear, backlash_rad).skip(skip).take(self.judged.len()).collect();
        let inside = states.iter().filter(|s| !s.is_stable()).count() as f64;
        if inside < 2.0 / lowpass_hz * self.trial.series.rate_hz {
            return Vec::new();
        }
        let crossing = |(i, state): (usize, &Transition)| {
            let (base, change, y) = (self.base_nm[skip + i], self.change_nm[skip + i], self.measured_nm[i]);
            let k_tilde = model.k_tilde_at(y, base, change);
            let (direction, share) = (state.direction(), (state.k_f + 1.0) / 2.0);
            let rotated = |x: f64| if direction == Direction::Up { x } else { 1.0 - x };
            Crossing { direction, share_of_travel: rotated(share), share_of_change: rotated(k_tilde) }
        };
        states.iter().enumerate().filter(|(_, s)| !s.is_stable()).map(crossing).collect()
    }
}
