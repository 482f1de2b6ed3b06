//! One hypothesis fitted: a model with its causes free, the base within its confidence.
//!
//! Causes move by Gauss-Newton on exact derivatives of the whole prediction, low-pass and all; the base
//! moves little, so its columns are taken once. Fits are scored on held-out units.

use super::base::BaseModel;
use super::bootstrap::{Numbers, Resamples};
use super::folds::FOLDS;
use super::gram::{Gram, Prior, RIDGE, Solution};
use super::mask::Mask;
use super::perturbation::Perturbation;
use super::records::Passages;
use crate::model::Model;
use crate::numerics::statistics::standard_deviation;
use std::sync::Arc;

/// Most Gauss-Newton steps of one fit.
const STEPS: usize = 20;
/// A step that gains less than this share of the cost is the last.
const GAIN_MIN: f64 = 1e-3;
/// A linear step whose cost is this near to the predicted one was the last.
const PREDICTED: f64 = 1e-3;
/// A fit ends where it would not come to what it has to even if each of the steps left gained so many times what the last one did ...
const CATCHING_UP: f64 = 2.0;
/// ... from this step on: the first tells little of a shape.
const TOLD_BY: usize = 2;
/// A fit is at its optimum where one more step promises no more than this share of its cost.
const PROMISED: f64 = 0.01;
/// Prior deviation of what is held at its bound.
const HELD: f64 = 1e-9;
/// Quarterings of a step that makes matters worse ...
const QUARTERINGS: usize = 3;
/// ... after which steps with shapes held at their limits are tried, first as they are, then damped by these shares of each column's own square
/// (Marquardt 1963): where shapes trade with each other the undamped direction is of no use at any length.
const DAMPED: [f64; 5] = [RIDGE, 0.01, 0.1, 1.0, 10.0];

/// A hypothesis fitted to the rows that count.
#[derive(Debug, Clone)]
pub struct Fit<'d> {
    /// The rows that count.
    pub mask: Arc<Mask<'d>>,
    /// The causes at their best, the base as it was.
    pub model: Model,
    /// Perturbations of the causes, about `model`.
    pub moves: Vec<Perturbation>,
    /// Sum of squares of the base's moves, in prior standard deviations.
    pub prior_penalty: f64,
    /// Sum of squares left in each unit when its fold is held out, (N m)^2.
    pub held_out: Vec<f64>,
    /// Where the base's moves ended.
    pub base_x: Vec<f64>,
    /// Whether the last step gained too little for another.
    pub converged: bool,
    /// Products for resampling.
    gram: Gram,
    /// Prior deviations of the gram's columns: the base's, then the causes'.
    deviations: Vec<f64>,
}

impl Fit<'_> {
    /// Whether each effect that it adds to the model as delivered agrees with its name.
    pub fn is_sound(&self) -> bool {
        let data = self.mask.data;
        let mut added = self.model.effects.iter().skip(data.delivered);
        added.all(|added| added.effect.is_itself(&added.parameters, &data.extent))
    }

    /// What the base's moves cost, as a factor of the square left: half a log-likelihood for each of their squares.
    pub fn prior_factor(&self) -> f64 {
        1.0 + self.prior_penalty * self.mask.data.records.rows_per_independent / self.mask.rows().max(1) as f64
    }

    /// Mean square left on held-out units, with what the base's moves cost, (N m)^2.
    pub fn score(&self) -> f64 {
        self.prior_factor() * self.held_out_square()
    }

    /// Mean square left on held-out units, (N m)^2.
    pub fn held_out_square(&self) -> f64 {
        self.held_out.iter().sum::<f64>() / self.mask.rows().max(1) as f64
    }

    /// Cost of its number of parameters on held-out units.
    pub fn numbers(&self) -> Numbers {
        let seen = self.mask.rows().max(1) as f64 * (FOLDS - 1) as f64 / FOLDS as f64;
        let each_square = self.mask.floor_square() * self.mask.data.records.rows_per_independent / seen;
        let effective_dof = self.gram.resolution(self.mask.prior(&self.deviations)).iter().sum();
        Numbers { effective_dof, each_square }
    }

    /// How far the data, rather than a prior, decide each of its moves: from 0 to 1.
    pub fn resolution(&self) -> Vec<f64> {
        self.gram.resolution(self.mask.prior(&self.deviations)).split_off(self.base_x.len())
    }

    /// Standard deviation of each of its moves over the first `count` of `resamples`.
    pub fn deviations(&self, resamples: &Resamples, count: usize) -> Vec<f64> {
        let solve = |i| self.gram.solve_weighted(&resamples.of_units(i), self.mask.prior(&self.deviations)).x;
        let solved: Vec<_> = (0..count).map(solve).collect();
        let of = |at: usize| standard_deviation(&solved.iter().map(|x| x[at]).collect::<Vec<f64>>());
        (0..self.moves.len()).map(|i| of(self.base_x.len() + i)).collect()
    }
}

/// A step of a fit: a model with what it predicts.
struct Point {
    model: Model,
    passages: Passages,
    predicted_nm: Vec<f64>,
    cost: f64,
}

impl<'d> BaseModel<'d> {
    /// The base alone, nothing added.
    pub fn alone(&self) -> Fit<'d> {
        self.fit_at(self.model.clone(), Vec::new(), &self.predicted_nm, &[], true)
    }

    /// Fits `model`, the base's with causes added, by `moves`, from where they are.
    pub fn fit(&self, model: Model, moves: Vec<Perturbation>) -> Fit<'d> {
        self.fit_to_reach(f64::INFINITY, model, moves)
    }

    /// The same, given up once it is clear that its cost will not fall to `reach`.
    pub fn fit_to_reach(&self, reach: f64, model: Model, moves: Vec<Perturbation>) -> Fit<'d> {
        let is_linear = moves.iter().all(|way| way.is_linear);
        let is_passing = moves.iter().any(|way| way.changes_passage(&model));
        let point = |model: Model| {
            let passages = match is_passing {
                true => self.mask.data.records.passages(&model),
                false => self.passages_of(&model),
            };
            let predicted_nm = self.prediction_nm(&model, &passages);
            let cost = self.cost_beside(&[], &predicted_nm).0;
            Point { model, passages, predicted_nm, cost }
        };
        let columns_at = |at: &Point| self.columns_of(&at.model, &at.passages, &moves);
        let mut now = point(model);
        let (mut converged, mut columns, mut is_behind) = (false, Vec::new(), false);
        for step in 1..=STEPS {
            (columns, is_behind) = (columns_at(&now), false);
            let (better, promised) = self.step_from(&now, &columns, &moves, point);
            let Some(better) = better else {
                converged = true;
                break;
            };
            let gained = now.cost - better.cost;
            let gain = gained / now.cost;
            (now, is_behind) = (better, true);
            let catching_up = CATCHING_UP * (STEPS - step) as f64 * gained;
            if step >= TOLD_BY && now.cost - catching_up > reach {
                break;
            }
            if gain < GAIN_MIN || (is_linear && (now.cost - promised).abs() < PREDICTED * now.cost) {
                converged = true;
                break;
            }
        }
        if is_behind && !is_linear {
            columns = columns_at(&now);
        }
        self.fit_at(now.model, moves, &now.predicted_nm, &columns, converged)
    }

    /// The `point` that one step of `moves`, whose `columns` are at hand, leads to from `now`, and the cost that the full step promises; none where no
    /// step gains.
    fn step_from(
        &self,
        now: &Point,
        columns: &[Vec<f64>],
        moves: &[Perturbation],
        point: impl Fn(Model) -> Point,
    ) -> (Option<Point>, f64) {
        let (gram, mut deviations) = self.gram_beside(columns, &now.predicted_nm);
        let full = self.solve_within_bounds(&gram, (&mut deviations, RIDGE), (&now.model, moves), |way| way.is_linear);
        let promised = self.cost_of(&full);
        let led_by = |solution: &Solution, share: f64| {
            let x = &solution.x.as_slice()[self.moves.len()..];
            let over = x.iter().zip(moves).map(|(x, way)| x.abs() / way.stride).fold(1.0, f64::max);
            let mut tried = now.model.clone();
            moves.iter().zip(x).for_each(|(way, x)| way.apply(&mut tried, share / over * x));
            point(tried)
        };
        let shorter = |quarterings: i32| led_by(&full, 0.25f64.powi(quarterings));
        let held = |ridge: f64| {
            let bounds = (&mut deviations.clone()[..], ridge);
            led_by(&self.solve_within_bounds(&gram, bounds, (&now.model, moves), |_| true), 1.0)
        };
        let gains = |best: &Option<Point>| best.as_ref().is_some_and(|to| now.cost - to.cost > GAIN_MIN * now.cost);
        let is_near = now.cost - promised <= PROMISED * now.cost;
        let mut best = (0..QUARTERINGS as i32).map(shorter).find(|tried| tried.cost < now.cost);
        // A promise that is not kept leads beyond a limit, or along a valley that is curved.
        for ridge in DAMPED {
            if is_near || gains(&best) {
                break;
            }
            let least = best.as_ref().map_or(now.cost, |to| to.cost);
            best = Some(held(ridge)).filter(|to| to.cost < least).or(best);
        }
        (best, promised)
    }

    /// The best coefficients of `gram`, whose columns have these prior `deviations` and this [`Prior::ridge`]; what of the `moves` may be held, is at
    /// its bound in `model` and would pass it is held there, and its deviation set accordingly.
    fn solve_within_bounds(
        &self,
        gram: &Gram,
        (deviations, ridge): (&mut [f64], f64),
        (model, moves): (&Model, &[Perturbation]),
        may_be_held: impl Fn(&Perturbation) -> bool,
    ) -> Solution {
        loop {
            let solution = gram.solve(Prior { ridge, ..self.mask.prior(deviations) });
            let own = self.moves.len();
            let is_stopped =
                |at: &usize| may_be_held(&moves[*at]) && moves[*at].is_stopped(model, solution.x[own + at]);
            let stopped: Vec<usize> =
                (0..moves.len()).filter(|at| deviations[own + at] > HELD).filter(is_stopped).collect();
            if stopped.is_empty() {
                return solution;
            }
            stopped.into_iter().for_each(|at| deviations[own + at] = HELD);
        }
    }

    /// The fit at `model`, whose causes are at their best.
    fn fit_at(
        &self,
        model: Model,
        moves: Vec<Perturbation>,
        predicted_nm: &[f64],
        columns: &[Vec<f64>],
        converged: bool,
    ) -> Fit<'d> {
        let (gram, mut deviations) = self.gram_beside(columns, predicted_nm);
        // Near the optimum a step of a shape parameter is valid only within its stride.
        for (deviation, way) in deviations.iter_mut().skip(self.moves.len()).zip(&moves) {
            *deviation = way.stride;
        }
        let reached = self.cost_beside(&[], predicted_nm).0;
        let is_kept = |solution: &Solution| reached - self.cost_of(solution) <= PROMISED * reached;
        // At its limit a shape is still a number that other units would have set otherwise, unless too much is promised beyond.
        let mut free = deviations.clone();
        let beyond = self.solve_within_bounds(&gram, (&mut free, RIDGE), (&model, &moves), |way| way.is_linear);
        let solution = match is_kept(&beyond) {
            true => {
                deviations = free;
                beyond
            }
            false => self.solve_within_bounds(&gram, (&mut deviations, RIDGE), (&model, &moves), |_| true),
        };
        let mut held_out = gram.held_out(&self.mask.data.folds, self.mask.prior(&deviations));
        // What one more step of the causes promises counts for nothing where none kept it.
        let is_there = is_kept(&solution);
        if !is_there {
            let promised = self.cost_of(&solution).max(f64::MIN_POSITIVE);
            held_out.iter_mut().for_each(|square| *square *= reached / promised);
        }
        let base_x = solution.x.rows(0, self.moves.len()).iter().copied().collect();
        let (mask, prior_penalty) = (self.mask.clone(), solution.prior_penalty);
        Fit { mask, model, moves, prior_penalty, held_out, base_x, converged: converged && is_there, gram, deviations }
    }
}

#[cfg(test)]
mod tests {
    use super::BaseModel;
    use crate::diagnose::data::tests::bundled;
    use crate::diagnose::mask::Mask;
    use crate::diagnose::parameter_ref::ParameterRef;
    use crate::diagnose::perturbation::{Mode, Perturbation, of_effect};
    use crate::effects::{Added, find};
    use crate::model::Model;

    #[test]
    fn what_would_pass_its_bound_is_held_there_and_the_others_go_where_they_would_go_without_it() {
        let (mut data, mut model) = bundled();
        model.dynamics.inertia_kg_m2 = 0.0;
        let [inertia, gravity] = [ParameterRef::Inertia, ParameterRef::Gravity]
            .map(|parameter| Perturbation::of(vec![(parameter, Mode::Add(1.0))], f64::INFINITY));
        // Recordings of a joint with negative inertia.
        let (passages, branches) = (data.records.passages(&model), data.records.branches(&model));
        let varied = Perturbation::varied(&model, std::slice::from_ref(&inertia));
        let [column, ..] = data.records.slopes_nm(&varied, Some(&passages), Some(&branches));
        data.measured_nm.iter_mut().zip(&column).for_each(|(y, per_unit)| *y -= 0.5 * per_unit);
        let mask = Mask::new(&data, data.scored(&model), 0.01);
        let base = BaseModel::new(&mask, &model, Vec::new());
        let both = base.fit(model.clone(), vec![inertia, gravity.clone()]);
        let alone = base.fit(model.clone(), vec![gravity]);
        assert_eq!(both.model.dynamics.inertia_kg_m2, 0.0);
        assert!(both.resolution()[0] < 1e-6 && both.resolution()[1] > 0.9, "{:?}", both.resolution());
        let [both_nm, alone_nm] = [&both, &alone].map(|fit| fit.model.dynamics.gravity_nm);
        assert!((both_nm / alone_nm - 1.0).abs() < 1e-6, "{both_nm} and {alone_nm}");
        assert!((both.score() / alone.score() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_shape_stays_at_its_limit_while_the_others_go_to_their_best_and_no_step_is_credited_that_was_not_taken() {
        let (mut data, model) = bundled();
        let (low, high) = data.extent.position_rad;
        let with_stop = |stiffness_nm: f64, reach: f64, exponent: f64| {
            let mut model = model.clone();
            let position_rad = high - reach * (high - low);
            let parameters = vec![1.0, stiffness_nm, position_rad, exponent, 0.0];
            model.effects.push(Added { effect: find("end_stop").unwrap(), parameters });
            model
        };
        // A stop with a softer start than any of the library's.
        let truth = with_stop(8.0, 0.45, 5.0);
        data.measured_nm =
            data.records.predicted_nm(&truth, &data.records.passages(&truth), &data.records.branches(&truth));
        let mask = Mask::new(&data, data.scored(&model), 1e-3);
        let base = BaseModel::new(&mask, &model, Vec::new());
        let start = with_stop(0.5, 0.2, 2.0);
        let at = start.effects.len() - 1;
        let fit = base.fit(start.clone(), of_effect(&start, at, &data.extent));
        let square_of = |model: &Model| BaseModel::new(&mask, model, Vec::new()).alone().held_out_square();
        let (reached, without) = (square_of(&fit.model), square_of(&model));
        assert_eq!(fit.model.effects[at].parameters[3], 3.0);
        assert!(reached < 0.003 * without, "{reached} of {without}");
        assert!(fit.score() >= 0.99 * reached, "{} where the model leaves {reached}", fit.score());
    }
}
