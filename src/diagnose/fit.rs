//! One hypothesis fitted: a model with its causes free, the base within its confidence.
//!
//! Causes move by Gauss-Newton on columns taken by difference through the whole prediction, low-pass and all; the base moves
//! little, so its columns are taken once. What a fit is judged by are units that it never saw.

use super::gram::{Gram, Prior, Solution};
use super::interval::Numbers;
use super::moves::Move;
use super::parts::{FOLDS, Parts};
use super::record::{Branches, Passages, Records};
use crate::effects::{Curve, Extent, Presliding};
use crate::model::{Combination, Model};
use rayon::prelude::*;

/// Most Gauss-Newton steps of one fit.
const STEPS: usize = 6;
/// A step that gains less than this share of the cost is the last.
const GAIN_MIN: f64 = 1e-3;
/// A linear step whose cost is this near to what was foretold was the last.
const FORETOLD: f64 = 1e-3;
/// Quarterings of a step that makes matters worse.
const QUARTERINGS: usize = 3;

/// What all fits on one campaign share.
#[derive(Debug)]
pub struct Bench<'a> {
    /// The recordings.
    pub records: &'a Records,
    /// Measured y at the rows, N m.
    pub measured_nm: Vec<f64>,
    /// What is held out.
    pub parts: &'a Parts,
    /// Over what range the campaign moves.
    pub extent: Extent,
    /// Rows that count; those in a burst do not.
    pub used: Vec<bool>,
    /// How many of them each unit has.
    pub unit_rows: Vec<usize>,
    /// The noise floor, N m.
    pub floor_nm: f64,
}

/// A model to start from, what of it moves freely within its confidence, and what that does.
#[derive(Debug, Clone)]
pub struct Ground {
    /// The model.
    pub model: Model,
    /// Its K~.
    pub passages: Passages,
    branches: Branches,
    /// What it predicts, N m.
    pub predicted_nm: Vec<f64>,
    /// What moves along with any cause, and its columns.
    pub moves: Vec<Move>,
    /// How the prediction changes per unit of each.
    pub columns: Vec<Vec<f64>>,
    /// Their products.
    gram: Gram,
}

/// A hypothesis fitted.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The causes at their best, the base as it was.
    pub model: Model,
    /// Moves of the causes, about `model`.
    pub moves: Vec<Move>,
    /// What is left, the base at its best, over all rows: square, its surprise, and the noise it was weighed with.
    pub cost: Cost,
    /// Sum of squares left in each unit when its fold is held out, (N m)^2.
    pub held_out: Vec<f64>,
    /// Products for resampling.
    pub gram: Gram,
    /// Prior deviations of the gram's columns: the ground's, then the causes'.
    pub deviations: Vec<f64>,
    /// Where the ground's moves ended.
    pub ground_x: Vec<f64>,
    /// Whether the last step still gained.
    pub converged: bool,
}

/// How good a fit is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Mean square left over the rows, (N m)^2.
    pub mean_square: f64,
    /// Sum of squares of base moves in standard deviations.
    pub surprise: f64,
}

impl Fit {
    /// Whether each of its effects is what it is called, by all that can be seen over `extent`.
    pub fn is_sound(&self, extent: &Extent) -> bool {
        self.model.effects.iter().all(|added| added.effect.is_itself(&added.parameters, extent))
    }
}

impl Bench<'_> {
    /// From now on the rows that are `used` count.
    pub fn count(&mut self, used: Vec<bool>) {
        self.unit_rows = self.parts.rows(&used);
        self.used = used;
    }

    /// Rows that count.
    pub fn rows(&self) -> usize {
        self.unit_rows.iter().sum()
    }

    /// What the base's moves cost a fit, as a factor of the square left: half a log-likelihood for each of their squares.
    pub fn surprise_factor(&self, fit: &Fit) -> f64 {
        1.0 + fit.cost.surprise * self.records.rows_per_independent / self.rows().max(1) as f64
    }

    /// What the numbers of `fit` cost it on units that it never saw.
    pub fn numbers(&self, fit: &Fit) -> Numbers {
        let seen = self.rows().max(1) as f64 * (FOLDS - 1) as f64 / FOLDS as f64;
        let floor_square = self.floor_nm * self.floor_nm;
        let each_square = floor_square * self.records.rows_per_independent / seen;
        Numbers { decided: fit.gram.decided(self.prior(&fit.deviations)), each_square }
    }

    pub(super) fn prior<'d>(&'d self, deviations: &'d [f64]) -> Prior<'d> {
        Prior {
            deviations,
            rows: &self.unit_rows,
            floor_square: self.floor_nm * self.floor_nm,
            rows_per_independent: self.records.rows_per_independent,
        }
    }

    /// Measured less `predicted_nm`, N m.
    pub fn residual_nm(&self, predicted_nm: &[f64]) -> Vec<f64> {
        self.measured_nm.iter().zip(predicted_nm).map(|(y, p)| y - p).collect()
    }

    /// The same, 0 where a row does not count.
    pub(super) fn counted_nm(&self, predicted_nm: &[f64]) -> Vec<f64> {
        let left = |((y, p), used): ((&f64, &f64), &bool)| if *used { y - p } else { 0.0 };
        self.measured_nm.iter().zip(predicted_nm).zip(&self.used).map(left).collect()
    }

    /// Its mean square with what the base's moves cost.
    fn cost_of(&self, solution: &Solution) -> f64 {
        let cost = Cost { mean_square: solution.square / self.rows().max(1) as f64, surprise: solution.surprise };
        self.objective(cost, (self.floor_nm * self.floor_nm).max(cost.mean_square))
    }

    /// What is minimised, in the unit of a mean square: the square left and what the base's moves cost.
    fn objective(&self, cost: Cost, noise_square: f64) -> f64 {
        let independent = self.rows() as f64 / self.records.rows_per_independent;
        cost.mean_square + noise_square * cost.surprise / independent.max(1.0)
    }

    /// `model` with what of it moves: the columns by difference.
    pub fn ground(&self, model: &Model, moves: Vec<Move>) -> Ground {
        let (passages, branches) = (self.records.passages(model), self.records.branches(model));
        let predicted_nm = self.records.predicted_nm(model, &passages, &branches);
        let mut ground = Ground {
            model: model.clone(),
            passages,
            branches,
            predicted_nm,
            moves,
            columns: Vec::new(),
            gram: Gram::default(),
        };
        ground.columns = self.columns(&ground, model, &ground.passages, &ground.predicted_nm, &ground.moves);
        let columns: Vec<&[f64]> = ground.columns.iter().map(Vec::as_slice).collect();
        ground.gram = Gram::new(self.parts, &columns, &self.counted_nm(&ground.predicted_nm));
        ground
    }

    /// What `model`, like the ground's but for causes, predicts, N m.
    pub(super) fn predicted_nm(&self, ground: &Ground, model: &Model, passages: &Passages) -> Vec<f64> {
        match model.friction == ground.model.friction {
            true => self.records.predicted_nm(model, passages, &ground.branches),
            false => self.records.predicted_nm(model, passages, &self.records.branches(model)),
        }
    }

    /// How the prediction changes per unit of each move.
    pub(super) fn columns(
        &self,
        ground: &Ground,
        model: &Model,
        passages: &Passages,
        predicted_nm: &[f64],
        moves: &[Move],
    ) -> Vec<Vec<f64>> {
        let column = |way: &Move| {
            if let Some(added) = way.added(model) {
                let column = self.records.added_nm(model, &added, passages, &ground.branches);
                return column.iter().zip(&self.used).map(|(c, used)| if *used { *c } else { 0.0 }).collect();
            }
            let mut moved = model.clone();
            way.apply(&mut moved, way.probe);
            let ahead = match way.changes_passage(model) {
                true => self.predicted_nm(ground, &moved, &self.records.passages(&moved)),
                false => self.predicted_nm(ground, &moved, passages),
            };
            let slope = |((a, p), used): ((&f64, &f64), &bool)| if *used { (a - p) / way.probe } else { 0.0 };
            ahead.iter().zip(predicted_nm).zip(&self.used).map(slope).collect()
        };
        moves.par_iter().map(column).collect()
    }

    /// The ground alone, nothing added.
    pub fn rest(&self, ground: &Ground) -> Fit {
        self.finish(ground, ground.model.clone(), Vec::new(), &ground.predicted_nm, Vec::new(), true)
    }

    /// What the ground leaves, its moves at their best, N m.
    pub fn rest_residual_nm(&self, ground: &Ground) -> Vec<f64> {
        let (gram, deviations) = self.gram(ground, &[], &ground.predicted_nm, 0);
        let x = gram.solve(self.prior(&deviations)).x;
        let mut left = self.residual_nm(&ground.predicted_nm);
        for (column, x) in ground.columns.iter().zip(x.iter()) {
            left.iter_mut().zip(column).for_each(|(r, c)| *r -= x * c);
        }
        left
    }

    /// How well `model`, the ground's with something added, would do with `moves` taken for linear: for choosing a start.
    /// Returns the cost, and the numbers of the moves.
    pub fn glance(&self, ground: &Ground, model: &Model, moves: &[Move]) -> (f64, Vec<f64>) {
        let changes = curve_of(model) != curve_of(&ground.model);
        let passages = if changes { self.records.passages(model) } else { ground.passages.clone() };
        let predicted_nm = self.predicted_nm(ground, model, &passages);
        let columns = self.columns(ground, model, &passages, &predicted_nm, moves);
        self.weigh(ground, &columns, &predicted_nm)
    }

    /// The cost with `columns` free beside the ground's, and their numbers.
    pub fn weigh(&self, ground: &Ground, columns: &[Vec<f64>], predicted_nm: &[f64]) -> (f64, Vec<f64>) {
        let (gram, deviations) = self.gram(ground, columns, predicted_nm, columns.len());
        let solution = gram.solve(self.prior(&deviations));
        (self.cost_of(&solution), solution.x.rows(ground.moves.len(), columns.len()).iter().copied().collect())
    }

    fn gram(&self, ground: &Ground, columns: &[Vec<f64>], predicted_nm: &[f64], free: usize) -> (Gram, Vec<f64>) {
        let deviations =
            ground.moves.iter().map(|way| way.prior).chain(std::iter::repeat_n(f64::INFINITY, free)).collect();
        let own: Vec<&[f64]> = ground.columns.iter().map(Vec::as_slice).collect();
        let added: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        (ground.gram.beside(self.parts, &own, &added, &self.counted_nm(predicted_nm)), deviations)
    }

    /// Fits `model`, the ground's with causes added, by `moves`, from where they are.
    pub fn fit(&self, ground: &Ground, model: Model, moves: Vec<Move>) -> Fit {
        let mut model = model;
        let is_linear = moves.iter().all(|way| way.is_linear);
        let passing =
            moves.iter().any(|way| way.changes_passage(&model)) || curve_of(&model) != curve_of(&ground.model);
        let passages_of = |model: &Model| if passing { self.records.passages(model) } else { ground.passages.clone() };
        let mut passages = passages_of(&model);
        let mut predicted_nm = self.predicted_nm(ground, &model, &passages);
        let (mut cost, _) = self.weigh(ground, &[], &predicted_nm);
        let mut converged = false;
        let mut columns = Vec::new();
        for _ in 0..STEPS {
            columns = self.columns(ground, &model, &passages, &predicted_nm, &moves);
            let (gram, deviations) = self.gram(ground, &columns, &predicted_nm, moves.len());
            let solution = gram.solve(self.prior(&deviations));
            let foretold = self.cost_of(&solution);
            let x = &solution.x;
            let x: Vec<f64> = x.rows(ground.moves.len(), moves.len()).iter().copied().collect();
            let over = x.iter().zip(&moves).map(|(x, way)| x.abs() / way.stride).fold(1.0, f64::max);
            let mut share = 1.0 / over;
            let mut better = None;
            for _ in 0..QUARTERINGS {
                let mut tried = model.clone();
                moves.iter().zip(&x).for_each(|(way, x)| way.apply(&mut tried, share * x));
                let tried_passages = passages_of(&tried);
                let tried_nm = self.predicted_nm(ground, &tried, &tried_passages);
                let (tried_cost, _) = self.weigh(ground, &[], &tried_nm);
                if tried_cost < cost {
                    better = Some((tried, tried_passages, tried_nm, tried_cost));
                    break;
                }
                share /= 4.0;
            }
            let Some((tried, tried_passages, tried_nm, tried_cost)) = better else {
                converged = true;
                break;
            };
            let gain = (cost - tried_cost) / cost;
            (model, passages, predicted_nm, cost) = (tried, tried_passages, tried_nm, tried_cost);
            if gain < GAIN_MIN || (is_linear && (cost - foretold).abs() < FORETOLD * cost) {
                converged = true;
                break;
            }
        }
        if !is_linear {
            columns = self.columns(ground, &model, &passages, &predicted_nm, &moves);
        }
        self.finish(ground, model, moves, &predicted_nm, columns, converged)
    }

    fn finish(
        &self,
        ground: &Ground,
        model: Model,
        moves: Vec<Move>,
        predicted_nm: &[f64],
        columns: Vec<Vec<f64>>,
        converged: bool,
    ) -> Fit {
        let (gram, mut deviations) = self.gram(ground, &columns, predicted_nm, columns.len());
        // About the optimum a shape's step is believed within its stride only.
        for (deviation, way) in deviations.iter_mut().skip(ground.moves.len()).zip(&moves) {
            *deviation = way.stride;
        }
        let solution = gram.solve(self.prior(&deviations));
        let held_out = gram.held_out(self.parts, self.prior(&deviations));
        let mean_square = solution.square / self.rows().max(1) as f64;
        let ground_x = solution.x.rows(0, ground.moves.len()).iter().copied().collect();
        let cost = Cost { mean_square, surprise: solution.surprise };
        Fit { model, moves, cost, held_out, gram, deviations, ground_x, converged }
    }
}

/// What decides where friction stands.
fn curve_of(model: &Model) -> (Combination, f64, Option<Curve>, Option<Presliding>) {
    (model.combination, model.joint.backlash_m, model.added_curve(), model.presliding())
}
