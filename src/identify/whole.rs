//! Many parameters at once on whole series: Levenberg-Marquardt on measured against predicted, both low-passed.
//!
//! Friction enters the prediction through y = N / D with N = (r1/r2) G + Bd + K~ (Bu - Bd) and
//! D = 1 - mu_down - K~ (mu_up - mu_down), so its derivatives are exact and cheap:
//! dy/dBu = K~/D, dy/dBd = (1 - K~)/D, dy/dmu_up = K~ y/D, dy/dmu_down = (1 - K~) y/D.
//! The position's zero moves the load: dy/dz = (r1/r2) (dG/dz) / D. The curve's parameter and the clearance move K~ itself; theirs are by difference.

use super::confidence::interval;
use super::moving::{Free, Limits};
use super::strokes::{Part, Stroke};
use super::zero::known;
use crate::model::{Both, Confidence, Direction, Model, Term};
use crate::numerics::cluster;
use crate::numerics::marquardt::{Minimum, Residuals, Stopped, minimise};
use crate::numerics::statistics::{HALF_WIDTH, student_t};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;
use std::array::from_fn;
use std::ops::Range;

/// Relative step of the derivatives by difference.
const STEP: f64 = 1e-4;
/// Relative change of cost or parameters at which a fit has converged.
const TOLERANCE: f64 = 1e-8;
/// Slopes that go through the low-pass side by side.
const TOGETHER: usize = 4;
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
    /// How it stopped.
    pub stopped: Stopped,
}

/// Root mean square over all strokes of their sums of squares and numbers of samples, N m.
pub fn rmse_nm(sums: &[(f64, f64)]) -> f64 {
    let (sum, count) = sums.iter().fold((0.0, 0.0), |(sum, count), part| (sum + part.0, count + part.1));
    (sum / count).sqrt()
}

/// Fits the `free` parameters of `start` to `parts`, each within its bounds, and says what is known of them.
pub fn fit_whole(parts: &[Part], start: &Model, free: &[Free], limits: &Limits) -> WholeFit {
    let problem = Whole { parts, start, free };
    let minimum = problem.minimum(limits, PATIENCE);
    let model = problem.model(&minimum.parameters);
    let confidence = problem.confidence(&minimum, limits);
    let rmse_nm = (minimum.residual_sum / minimum.residual_count as f64).sqrt();
    WholeFit { model, rmse_nm, confidence, stopped: minimum.stopped }
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

    /// Intervals by the sandwich over strokes: errors of one stroke hang together, those of different strokes hardly.
    fn confidence(&self, minimum: &Minimum, limits: &Limits) -> Vec<(String, Confidence)> {
        let errors = self.residuals(&minimum.parameters);
        let jacobian = self.jacobian(&minimum.parameters);
        let strokes = self.strokes();
        let score = |stroke: &Range<usize>| {
            jacobian.rows(stroke.start, stroke.len()).tr_mul(&errors.rows(stroke.start, stroke.len()))
        };
        let scores: Vec<DVector<f64>> = strokes.iter().map(score).collect();
        let bread = minimum.unscaled_covariance.map(|x| if x.is_nan() { 0.0 } else { x });
        let covariance = cluster::covariance(&bread, &scores);
        let sigma = (minimum.residual_sum / minimum.residual_count as f64).sqrt();
        let freedom = cluster::freedom(strokes.len(), self.free.len());
        let t = student_t(freedom);
        let told = |(i, free): (usize, &Free)| {
            let moved = minimum.parameters[i];
            let singular = minimum.unscaled_covariance[(i, i)].is_nan();
            let se = if singular { f64::INFINITY } else { covariance[(i, i)].max(0.0).sqrt() };
            // Were all else known: how far the parameter could move for one sigma over one stroke's worth of samples.
            let rows_per_stroke = errors.len() as f64 / strokes.len().max(1) as f64;
            let alone = match freedom > 0.0 {
                true => sigma * rows_per_stroke.sqrt() / jacobian.column(i).norm(),
                false => f64::INFINITY,
            };
            let ends = [moved - t * se, moved + t * se];
            let confidence = match free {
                Free::Friction(d, term) if term.is_rate() => {
                    let of = |x: f64| d.sign() * x.exp();
                    interval(of(moved), [of(ends[0]), of(ends[1])], 0.0, HALF_WIDTH, alone, minimum.at_bound[i])
                }
                Free::Curve(_) | Free::Backlash => {
                    interval(moved.exp(), [ends[0].exp(), ends[1].exp()], 0.0, HALF_WIDTH, alone, minimum.at_bound[i])
                }
                Free::Zero => known(moved, (t * se).min(limits.zero_rad), limits.zero_rad),
                Free::Friction(..) => interval(moved, ends, 0.0, HALF_WIDTH, alone / moved.abs(), minimum.at_bound[i]),
            };
            (free.name(), confidence)
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
        let trial = part.trial;
        let (k_tilde, _) = trial.k_tilde(model);
        let torque = trial.torque_nm(model, &k_tilde);
        let (torque, k_tilde) = (&torque, &k_tilde);
        let slope = |free: &Free| -> Box<dyn Fn(usize) -> f64 + '_> {
            match free {
                Free::Friction(direction, term) => {
                    let slope = BranchSlope { model, direction: *direction, term: *term };
                    Box::new(move |at| slope.at(trial.series.velocity_rad_s[at], torque[at], k_tilde[at]))
                }
                Free::Zero => {
                    let by_load = ByLoad::new(model);
                    let slope_nm_rad = trial.series.slope_nm_rad(&model.dynamics);
                    Box::new(move |at| by_load.at(slope_nm_rad(at), k_tilde[at]))
                }
                Free::Curve(_) | Free::Backlash => {
                    let mut moved = model.clone();
                    free.write(&mut moved, free.read(model) + STEP);
                    let (k_tilde, _) = trial.k_tilde(&moved);
                    let ahead = trial.torque_nm(&moved, &k_tilde);
                    Box::new(move |at| (ahead[at] - torque[at]) / STEP)
                }
            }
        };
        let columns = self.free.chunks(TOGETHER).flat_map(|group| {
            let slopes: Vec<_> = group.iter().map(slope).collect();
            let together =
                part.low_passed(|at| from_fn::<f64, TOGETHER, _>(|l| slopes.get(l).map_or(0.0, |of| of(at))));
            together.into_iter().take(group.len())
        });
        columns.collect()
    }
}

/// dy by the torque that the load asks of the joint: (r1/r2) / D.
struct ByLoad {
    transmission: f64,
    mu: Both<f64>,
}

impl ByLoad {
    fn new(model: &Model) -> Self {
        Self { transmission: model.joint.transmission(), mu: Both::make(|d| model.friction.of(d).mu_c) }
    }

    /// For a change of the load of `slope_nm_rad` at K~ `k`.
    fn at(&self, slope_nm_rad: f64, k: f64) -> f64 {
        self.transmission * slope_nm_rad / (1.0 - self.mu.down - k * (self.mu.up - self.mu.down))
    }
}

struct BranchSlope<'a> {
    model: &'a Model,
    direction: Direction,
    term: Term,
}

impl BranchSlope<'_> {
    /// dy by the parameter as it moves, at speed `v`, predicted torque `y` and K~ `k`.
    fn at(&self, v: f64, y: f64, k: f64) -> f64 {
        let (r1, r2) = (self.model.joint.winch_radius_m, self.model.joint.pulley_radius_m);
        let friction = self.model.friction.of(self.direction);
        let (mu_up, mu_down) = (self.model.friction.up.mu_c, self.model.friction.down.mu_c);
        let share = if self.direction == Direction::Up { k } else { 1.0 - k };
        let weight = share / (1.0 - mu_down - k * (mu_up - mu_down));
        let speed = self.direction.sign() * v.abs();
        let term = |b: f64, rate: f64| b * (-rate * speed).exp();
        let by_branch = match self.term {
            Term::Load => return weight * y,
            Term::Coulomb => 1.0,
            Term::CableStribeck => term(1.0, friction.c_c * r2),
            Term::CableDecay => -friction.c_c * r2 * speed * term(friction.b_c, friction.c_c * r2),
            Term::JointStribeck => term(1.0, friction.c_j),
            Term::JointDecay => -friction.c_j * speed * term(friction.b_j, friction.c_j),
            Term::Viscous => speed,
        };
        weight * r1 * by_branch
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
