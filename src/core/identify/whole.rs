//! Many parameters at once on whole series: Levenberg-Marquardt on measured against predicted, both low-passed.
//!
//! Derivatives are exact: the prediction itself is evaluated over numbers that carry them, several parameters at a time, as many
//! as go through the low-pass side by side.

use super::confidence::interval;
use super::moving::{Free, Limits};
use super::strokes::{Part, Stroke};
use super::together::{Held, Together};
use super::zero::{known, with_declaration};
use crate::model::{Confidence, Model};
use crate::numerics::cluster;
use crate::numerics::dual::{Dual, VARIABLES};
use crate::numerics::marquardt::{Minimum, Residuals, Stopped, minimise};
use crate::numerics::statistics::{HALF_WIDTH, student_t};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::ops::Range;

/// Relative change of cost or parameters at which a fit has converged.
const TOLERANCE: f64 = 1e-8;
/// Evaluations allowed, per parameter.
const PATIENCE: usize = 12;
/// The same for fits that are only compared: those that need more are of curves that do not describe the data.
const PATIENCE_COMPARED: usize = 5;
/// Evaluations, per parameter, after which the best of several starts shows.
const SHORT_RUN: usize = 2;

/// Result of a fit on whole series.
#[derive(Debug, Clone)]
pub struct WholeFit {
    /// The model found.
    pub model: Model,
    /// Residual over the samples fitted, N m.
    pub rmse_nm: f64,
    /// What is known of each free parameter, by dotted name.
    pub confidence: Vec<(String, Confidence)>,
    /// The free parameters.
    pub free: Vec<Free>,
    /// What is known of them together, as they move, by the sandwich over strokes.
    pub together: Together,
    /// How it stopped.
    pub stopped: Stopped,
}

/// Root mean square over all parts (strokes, trials) of their sums of squares and numbers of samples, N m; NaN without any.
pub fn rmse_nm(sums: &[(f64, f64)]) -> f64 {
    let (sum, count) = sums.iter().fold((0.0, 0.0), |(sum, count), part| (sum + part.0, count + part.1));
    (sum / count).sqrt()
}

/// Fits the `free` parameters of `start` to `parts`, each within its bounds, and says what is known of them.
///
/// Of the position's zero the declaration counts as a measurement: the others are fitted with it held at the mean of both.
pub fn fit_whole(parts: &[Part], start: &Model, free: &[Free], limits: &Limits) -> WholeFit {
    let problem = Whole { parts, start, free };
    let minimum = problem.minimum(limits, PATIENCE);
    let Some(at) = free.iter().position(|free| *free == Free::Zero) else {
        return problem.known(&minimum, None, limits);
    };
    let (jacobian, scores) = problem.design(&minimum.parameters);
    let by_zero: Vec<f64> = (0..free.len()).map(|i| f64::from(u8::from(i == at))).collect();
    let half_width_rad = HALF_WIDTH * Together::new(&jacobian, &scores, None).covariance(&by_zero, &by_zero).sqrt();
    let (zero_rad, half_width_rad) = with_declaration(minimum.parameters[at], half_width_rad, limits.zero_rad);
    let mut start = problem.model(&minimum.parameters);
    Free::Zero.write(&mut start, zero_rad);
    let others: Vec<Free> = free.iter().copied().filter(|free| *free != Free::Zero).collect();
    let problem = Whole { parts, start: &start, free: &others };
    problem.known(&problem.minimum(limits, PATIENCE), Some(half_width_rad), limits)
}

/// The model alone of the same fit, with less patience: to be compared with others.
pub fn best_whole(parts: &[Part], start: &Model, free: &[Free], limits: &Limits) -> Model {
    run(parts, start, free, limits, PATIENCE_COMPARED).0
}

/// Which of several starts is ahead after a short run, and where it then is; `None` of none.
pub fn ahead(parts: &[Part], starts: &[Model], free: &[Free], limits: &Limits) -> Option<Model> {
    let runs = starts.iter().map(|start| run(parts, start, free, limits, SHORT_RUN));
    runs.min_by(|a, b| a.1.total_cmp(&b.1)).map(|best| best.0)
}

fn run(parts: &[Part], start: &Model, free: &[Free], limits: &Limits, patience: usize) -> (Model, f64) {
    let problem = Whole { parts, start, free };
    let minimum = problem.minimum(limits, patience);
    (problem.model(&minimum.parameters), minimum.residual_sum)
}

/// What is known of `free` that was found at `moved`, as it moves, within `half`; `alone` were all else known.
fn known_of(free: Free, moved: f64, half: f64, alone: f64, at_bound: bool, limits: &Limits) -> Confidence {
    // Beyond what was searched nothing is known of it.
    let (lowest, highest) = limits.of(free, moved);
    let low = if moved - half < lowest { f64::NEG_INFINITY } else { moved - half };
    let high = if moved + half > highest { f64::INFINITY } else { moved + half };
    let ends = [low, high];
    match free {
        Free::Friction(d, term) if term.is_rate() => {
            let of = |x: f64| d.sign() * x.exp();
            interval(of(moved), ends.map(of), 0.0, HALF_WIDTH, alone, at_bound)
        }
        Free::Curve(_) | Free::Backlash => interval(moved.exp(), ends.map(f64::exp), 0.0, HALF_WIDTH, alone, at_bound),
        Free::Friction(..) | Free::Carried(_) | Free::Zero => {
            interval(moved, ends, 0.0, HALF_WIDTH, alone / moved.abs(), at_bound)
        }
    }
}

struct Whole<'a> {
    parts: &'a [Part<'a>],
    start: &'a Model,
    free: &'a [Free],
}

impl Whole<'_> {
    fn model(&self, parameters: &[f64]) -> Model {
        let mut model = self.start.clone();
        for (free, x) in self.free.iter().zip(parameters) {
            free.write(&mut model, *x);
        }
        model
    }

    fn minimum(&self, limits: &Limits, patience: usize) -> Minimum {
        let from: Vec<f64> = self.free.iter().map(|f| f.read(self.start)).collect();
        let bounds: Vec<(f64, f64)> = self.free.iter().zip(&from).map(|(f, x)| limits.of(*f, *x)).collect();
        minimise(self, &from, &bounds, patience, TOLERANCE)
    }

    fn count(&self) -> usize {
        self.parts.iter().map(Part::count).sum()
    }

    /// What the fit that ended at `minimum` knows, the zero of the position held within `zero_half_width_rad` beside it.
    fn known(&self, minimum: &Minimum, zero_half_width_rad: Option<f64>, limits: &Limits) -> WholeFit {
        let model = self.model(&minimum.parameters);
        let mut free = self.free.to_vec();
        free.extend(zero_half_width_rad.map(|_| Free::Zero));
        let all = Whole { parts: self.parts, start: &model, free: &free };
        let parameters: Vec<f64> = free.iter().map(|free| free.read(&model)).collect();
        let (jacobian, scores) = all.design(&parameters);
        let held = zero_half_width_rad.map(|half| Held { at: self.free.len(), se: half / HALF_WIDTH });
        let mut confidence = self.confidence(minimum, &jacobian, &scores, held.as_ref(), limits);
        let zero_rad = model.dynamics.position_zero_rad;
        confidence.extend(zero_half_width_rad.map(|half| (Free::Zero.name(), known(zero_rad, half, limits.zero_rad))));
        WholeFit {
            rmse_nm: (minimum.residual_sum / minimum.residual_count as f64).sqrt(),
            confidence,
            together: Together::new(&jacobian, &scores, held),
            free,
            model,
            stopped: minimum.stopped,
        }
    }

    /// J, and J'e of each stroke: errors of one stroke hang together, those of different strokes hardly.
    fn design(&self, parameters: &[f64]) -> (DMatrix<f64>, Vec<DVector<f64>>) {
        let (errors, jacobian) = (self.residuals(parameters), self.jacobian(parameters));
        let score = |stroke: Range<usize>| {
            jacobian.rows(stroke.start, stroke.len()).tr_mul(&errors.rows(stroke.start, stroke.len()))
        };
        let scores = self.strokes().into_iter().map(score).collect();
        (jacobian, scores)
    }

    /// Intervals by the sandwich over strokes, and by what a parameter `held` beside may be off by.
    fn confidence(
        &self,
        minimum: &Minimum,
        jacobian: &DMatrix<f64>,
        scores: &[DVector<f64>],
        held: Option<&Held>,
        limits: &Limits,
    ) -> Vec<(String, Confidence)> {
        let n = self.free.len();
        let bread = minimum.unscaled_covariance.map(|x| if x.is_nan() { 0.0 } else { x });
        let scores: Vec<DVector<f64>> = scores.iter().map(|score| score.rows(0, n).into_owned()).collect();
        let covariance = cluster::covariance(&bread, &scores);
        let own = jacobian.columns(0, n);
        let moved = held.map_or_else(
            || DVector::zeros(n),
            |held| &bread * own.tr_mul(&jacobian.column(held.at)) * (HALF_WIDTH * held.se),
        );
        let sigma = (minimum.residual_sum / minimum.residual_count as f64).sqrt();
        let freedom = cluster::freedom(scores.len(), n);
        // With all other parameters known: how far one could move for one sigma over one stroke's worth of samples.
        let rows_per_stroke = jacobian.nrows() as f64 / scores.len().max(1) as f64;
        let told = |(i, free): (usize, &Free)| {
            let singular = minimum.unscaled_covariance[(i, i)].is_nan();
            let se = if singular { f64::INFINITY } else { covariance[(i, i)].max(0.0).sqrt() };
            let alone = match freedom > 0.0 {
                true => sigma * rows_per_stroke.sqrt() / own.column(i).norm(),
                false => f64::INFINITY,
            };
            let half = (student_t(freedom) * se).hypot(moved[i]);
            (free.name(), known_of(*free, minimum.parameters[i], half, alone, minimum.at_bound[i], limits))
        };
        self.free.iter().enumerate().map(told).collect()
    }

    /// Rows of each stroke.
    fn strokes(&self) -> Vec<Range<usize>> {
        let mut offset = 0;
        let rows = |stroke: &Stroke| {
            let start = offset;
            offset += stroke.rows.len();
            start..offset
        };
        self.parts.iter().flat_map(|part| &part.strokes).map(rows).collect()
    }

    /// Derivative of the low-passed prediction of `part` by each free parameter.
    fn slopes(&self, part: &Part, model: &Model) -> Vec<Vec<f64>> {
        let (held, _) = part.trial.k_tilde(model);
        let columns = self.free.chunks(VARIABLES).flat_map(|group| {
            let mut moving = model.over::<Dual>();
            for (at, free) in group.iter().enumerate() {
                free.write(&mut moving, Dual::variable(free.read(model), at));
            }
            let passage = group.iter().any(|free| free.moves_passage()).then(|| part.trial.k_tilde(&moving).0);
            let k_tilde = |i: usize| passage.as_ref().map_or(Dual::from(held[i]), |k_tilde| k_tilde[i]);
            let torque_nm = part.trial.torque_nm(&moving);
            part.low_passed(|i| torque_nm(i, k_tilde(i)).slopes).into_iter().take(group.len())
        });
        columns.collect()
    }
}

impl Residuals for Whole<'_> {
    fn residuals(&self, parameters: &[f64]) -> DVector<f64> {
        let model = self.model(parameters);
        let all: Vec<Vec<f64>> = self.parts.par_iter().map(|part| part.residual_nm(&model)).collect();
        DVector::from_iterator(self.count(), all.into_iter().flatten())
    }

    fn jacobian(&self, parameters: &[f64]) -> DMatrix<f64> {
        let model = self.model(parameters);
        let all: Vec<Vec<Vec<f64>>> = self.parts.par_iter().map(|part| self.slopes(part, &model)).collect();
        let columns = (0..self.free.len()).flat_map(|i| all.iter().flat_map(move |part| part[i].iter().copied()));
        DMatrix::from_iterator(self.count(), self.free.len(), columns)
    }
}
