//! The base model with its Jacobian: the model to which causes are added, and how its prediction changes as its own parameters move
//! within their confidence.

use super::data::DataSet;
use super::gram::{Gram, Solution};
use super::mask::Mask;
use super::perturbation::Perturbation;
use super::records::{Branches, Passages};
use crate::effects::{Added, Curve, Presliding};
use crate::model::{Combination, Model};
use crate::numerics::dual::VARIABLES;
use rayon::prelude::*;
use std::sync::Arc;

/// A model to start from, what of it moves freely within its confidence, and what that does to the rows that count.
#[derive(Debug, Clone)]
pub struct BaseModel<'d> {
    /// The rows that count.
    pub mask: Arc<Mask<'d>>,
    /// The model.
    pub model: Model,
    /// Its K~.
    pub passages: Passages,
    branches: Branches,
    /// What it predicts, N m.
    pub predicted_nm: Vec<f64>,
    /// What moves along with any cause.
    pub moves: Vec<Perturbation>,
    /// The Jacobian: how the prediction changes at every row per unit of each.
    pub columns: Vec<Vec<f64>>,
    /// Products of the columns over the rows that count.
    gram: Gram,
}

impl<'d> BaseModel<'d> {
    /// `model` with what of it moves.
    pub fn new(mask: &Arc<Mask<'d>>, model: &Model, moves: Vec<Perturbation>) -> Self {
        let records = &mask.data.records;
        let (passages, branches) = (records.passages(model), records.branches(model));
        let predicted_nm = records.predicted_nm(model, &passages, &branches);
        let (model, columns, gram) = (model.clone(), Vec::new(), Gram::default());
        let mut base = Self { mask: mask.clone(), model, passages, branches, predicted_nm, moves, columns, gram };
        base.columns = base.columns_of(&base.model, &base.passages, &base.moves);
        let counted: Vec<Vec<f64>> = base.columns.iter().map(|c| mask.apply(c.iter().copied())).collect();
        let columns: Vec<&[f64]> = counted.iter().map(Vec::as_slice).collect();
        base.gram = Gram::new(&mask.data.folds, &columns, &mask.residual_nm(&base.predicted_nm));
        base
    }

    /// The recordings.
    pub fn data(&self) -> &'d DataSet {
        self.mask.data
    }

    /// The same rows and products above another floor.
    pub fn above(self, floor_nm: f64) -> Self {
        Self { mask: self.mask.above(floor_nm), ..self }
    }

    /// K~ for `model`, this one's with causes added.
    pub(super) fn passages_of(&self, model: &Model) -> Passages {
        match curve_of(model) == curve_of(&self.model) {
            true => self.passages.clone(),
            false => self.mask.data.records.passages(model),
        }
    }

    /// What `model`, this one's with causes added, predicts, N m.
    pub(super) fn prediction_nm(&self, model: &Model, passages: &Passages) -> Vec<f64> {
        let records = &self.mask.data.records;
        match model.friction == self.model.friction {
            true => records.predicted_nm(model, passages, &self.branches),
            false => records.predicted_nm(model, passages, &records.branches(model)),
        }
    }

    /// How the prediction of `model` changes at every row per unit of each of `moves`, exactly.
    pub(super) fn columns_of(&self, model: &Model, passages: &Passages, moves: &[Perturbation]) -> Vec<Vec<f64>> {
        let records = &self.mask.data.records;
        let is_own_friction = model.friction == self.model.friction;
        let known = if is_own_friction { &self.branches } else { &records.branches(model) };
        let alike = |way: &Perturbation| (way.only_adds(model), way.changes_passage(model));
        let together = |group: &[Perturbation]| {
            let varied = Perturbation::varied(model, group);
            let columns = match alike(&group[0]) {
                (Some(at), false) => records.added_nm(model, &varied.effects[at], passages, known),
                (_, changes_passage) => {
                    let branches = (!group.iter().any(Perturbation::changes_branches)).then_some(known);
                    records.slopes_nm(&varied, (!changes_passage).then_some(passages), branches)
                }
            };
            columns.into_iter().take(group.len()).collect::<Vec<Vec<f64>>>()
        };
        let groups: Vec<&[Perturbation]> =
            moves.chunk_by(|a, b| alike(a) == alike(b)).flat_map(|group| group.chunks(VARIABLES)).collect();
        groups.into_par_iter().flat_map(together).collect()
    }

    /// What the base leaves at every row, its moves at their best on the rows that count, N m.
    pub fn residual_nm(&self) -> Vec<f64> {
        let (gram, deviations) = self.gram_beside(&[], &self.predicted_nm);
        let x = gram.solve(self.mask.prior(&deviations)).x;
        let mut left = self.mask.data.residual_nm(&self.predicted_nm);
        for (column, x) in self.columns.iter().zip(x.iter()) {
            left.iter_mut().zip(column).for_each(|(r, c)| *r -= x * c);
        }
        left
    }

    /// The cost with `columns` free beside the base's own, and their coefficients.
    pub fn cost_beside(&self, columns: &[Vec<f64>], predicted_nm: &[f64]) -> (f64, Vec<f64>) {
        let (gram, deviations) = self.gram_beside(columns, predicted_nm);
        let solution = gram.solve(self.mask.prior(&deviations));
        (self.cost_of(&solution), solution.x.rows(self.moves.len(), columns.len()).iter().copied().collect())
    }

    /// The cost of `model`, this one's with `added` as its last effect, `moves` taken as linear, and their coefficients: for choosing a
    /// start.
    pub fn linearised_cost(&self, model: &Model, added: &Added, moves: &[Perturbation]) -> (f64, Vec<f64>) {
        let passages = self.passages_of(model);
        let predicted_nm = match added.is_idle() {
            true => self.predicted_nm.clone(),
            false => self.prediction_nm(model, &passages),
        };
        let columns = self.columns_of(model, &passages, moves);
        self.cost_beside(&columns, &predicted_nm)
    }

    /// Mean square left in the rows that count, with all free that makes `model` of this one's: its causes as a whole and each of their
    /// `moves`, (N m)^2.
    pub fn square_left(&self, model: &Model, moves: &[Perturbation]) -> f64 {
        let passages = self.passages_of(model);
        let predicted_nm = self.prediction_nm(model, &passages);
        let mut columns = self.columns_of(model, &passages, moves);
        columns.push(predicted_nm.iter().zip(&self.predicted_nm).map(|(with, without)| with - without).collect());
        let (gram, deviations) = self.gram_beside(&columns, &self.predicted_nm);
        gram.solve(self.mask.prior(&deviations)).square / self.mask.rows().max(1) as f64
    }

    /// Products of the base's columns, `columns` and the residual of `predicted_nm`, with the columns' prior deviations.
    pub(super) fn gram_beside(&self, columns: &[Vec<f64>], predicted_nm: &[f64]) -> (Gram, Vec<f64>) {
        let free = std::iter::repeat_n(f64::INFINITY, columns.len());
        let deviations = self.moves.iter().map(|way| way.prior).chain(free).collect();
        // Where the other factor is 0 the base's own need not be.
        let own: Vec<&[f64]> = self.columns.iter().map(Vec::as_slice).collect();
        let counted: Vec<Vec<f64>> = columns.iter().map(|c| self.mask.apply(c.iter().copied())).collect();
        let added: Vec<&[f64]> = counted.iter().map(Vec::as_slice).collect();
        (self.gram.beside(&self.mask.data.folds, &own, &added, &self.mask.residual_nm(predicted_nm)), deviations)
    }

    /// What a fit minimises, in the unit of a mean square: the square left, and what the base's moves cost.
    pub(super) fn cost_of(&self, solution: &Solution) -> f64 {
        let mask = &self.mask;
        let mean_square = solution.square / mask.rows().max(1) as f64;
        let independent = mask.rows() as f64 / mask.data.records.rows_per_independent;
        mean_square + mask.floor_square().max(mean_square) * solution.prior_penalty / independent.max(1.0)
    }
}

/// What decides where friction stands.
fn curve_of(model: &Model) -> (Combination, f64, Option<Curve>, Option<Presliding>) {
    (model.combination, model.joint.backlash_m, model.added_curve(), model.presliding())
}

#[cfg(test)]
mod tests {
    use super::BaseModel;
    use crate::diagnose::data::tests::bundled;
    use crate::diagnose::mask::Mask;
    use crate::diagnose::perturbation::within_confidence;

    #[test]
    fn rows_set_aside_have_no_part_in_what_the_base_leaves_elsewhere() {
        let (mut data, model) = bundled();
        let aside = 500..900;
        let left_nm = |data: &_| {
            let mask = Mask::new(data, data.scored(&model), 0.01).without([aside.clone()]);
            BaseModel::new(&mask, &model, within_confidence(&model)).residual_nm()
        };
        let as_recorded_nm = left_nm(&data);
        // As if the joint had been pushed there.
        data.measured_nm[aside.clone()].iter_mut().for_each(|y| *y += 1.0);
        let pushed_nm = left_nm(&data);
        for (row, (before, after)) in as_recorded_nm.iter().zip(&pushed_nm).enumerate() {
            let added_nm = if aside.contains(&row) { 1.0 } else { 0.0 };
            assert!((after - before - added_nm).abs() < 1e-9, "row {row}: {before} then {after}");
        }
    }
}
