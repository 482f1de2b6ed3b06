//! Which two causes could explain a gap together: all pairs are evaluated as if their torques added up, which takes only small matrices.
//!
//! One cause at a time finds a compromise where two are at work. Here every cause that was fitted or initialised alone gives its prediction
//! and its columns; the residual of a pair is that of both predictions and both sets of columns together.

use super::base::BaseModel;
use super::candidates::{Cause, Hypothesis, Likely, Set, reach, try_one};
use super::criteria::Share;
use super::folds::FOLDS;
use super::gram::{dot, solve, square_left};
use super::mask::Mask;
use super::search::{Forward, Search};
use super::settle::all_but;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Pairs that are fitted in full.
const FOLLOWED: usize = 6;
/// Number of these, the best, that are tried in other forms.
const REFINED: usize = 3;
/// Rows used, at most: beyond that they are decimated.
const ROWS: usize = 30_000;

/// What a hypothesis adds to the base: where its columns begin among all, how many, and their prior deviations.
struct Part<'s> {
    hypothesis: &'s Hypothesis,
    from: usize,
    strides: Vec<f64>,
}

/// The pairs of `hypotheses` that leave least on units held out, best first.
fn promising(base: &BaseModel<'_>, hypotheses: &[Hypothesis]) -> Vec<[Hypothesis; 2]> {
    let (own, residual) = (base.columns.len(), base.columns.len());
    let mut columns: Vec<Vec<f64>> = base.columns.clone();
    columns.push(base.mask.residual_nm(&base.predicted_nm));
    let drawn = |hypothesis: &Hypothesis| {
        let mut model = base.model.clone();
        let moves = hypothesis.put(&mut model, &base.data().extent);
        let passages = base.passages_of(&model);
        let predicted_nm = base.prediction_nm(&model, &passages);
        let mut own = base.columns_of(&model, &passages, &moves);
        // Its prediction beside the base's stands before its columns.
        own.insert(0, predicted_nm.iter().zip(&base.predicted_nm).map(|(p, b)| p - b).collect());
        (own, moves.iter().map(|way| way.stride).collect::<Vec<f64>>())
    };
    let drawn: Vec<(Vec<Vec<f64>>, Vec<f64>)> = hypotheses.par_iter().map(drawn).collect();
    let mut parts = Vec::new();
    for (hypothesis, (added, strides)) in hypotheses.iter().zip(drawn) {
        parts.push(Part { hypothesis, from: columns.len(), strides });
        columns.extend(added);
    }
    let sums = sums_of_folds(&base.mask, &columns);
    let left = |a: &Part<'_>, b: &Part<'_>| {
        let at: Vec<usize> = (0..own).chain(a.columns()).chain(b.columns()).collect();
        let priors = base.moves.iter().map(|way| way.prior);
        let deviations: Vec<f64> = priors.chain(a.strides.iter().chain(&b.strides).copied()).collect();
        let of_fold = sums.iter().map(|(sum, _)| pair_of(sum, &at, residual, [a.from, b.from])).collect::<Vec<_>>();
        (0..FOLDS)
            .map(|fold| {
                let kept = (0..FOLDS).filter(|other| *other != fold);
                let (mut sum, mut rows) = (DMatrix::zeros(at.len() + 1, at.len() + 1), 0);
                kept.for_each(|other| {
                    sum += &of_fold[other];
                    rows += sums[other].1;
                });
                square_left(&of_fold[fold], &solve(&sum, rows, base.mask.prior(&deviations)).x)
            })
            .sum::<f64>()
    };
    let pairs: Vec<(usize, usize)> = (0..parts.len())
        .flat_map(|i| (0..i).map(move |j| (j, i)))
        .filter(|(j, i)| {
            let [a, b] = [j, i].map(|at| parts[*at].hypothesis.cause);
            a.may_stand_beside(b)
        })
        .collect();
    let mut ranked: Vec<(f64, usize, usize)> =
        pairs.into_par_iter().map(|(j, i)| (left(&parts[j], &parts[i]), j, i)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    of_different_causes(ranked.into_iter().map(|(_, j, i)| [parts[j].hypothesis, parts[i].hypothesis]))
}

/// The first of `pairs`, one for each two causes.
fn of_different_causes<'h>(pairs: impl Iterator<Item = [&'h Hypothesis; 2]>) -> Vec<[Hypothesis; 2]> {
    let mut found: Vec<[Hypothesis; 2]> = Vec::new();
    for pair in pairs {
        let same = |known: &[Hypothesis; 2]| causes(&[&known[0], &known[1]]) == causes(&pair);
        if !found.iter().any(same) {
            found.push(pair.map(Hypothesis::clone));
        }
        if found.len() == FOLLOWED {
            break;
        }
    }
    found
}

impl<'d> Search<'d, '_> {
    /// Pairs that promise much where causes are as they were alone, and that are enough to be named in the place of what `way` has chosen;
    /// `reached` is what another pair is known to leave, (N m)^2.
    pub fn pairs(&self, way: &Forward<'d>, reached: f64) -> Vec<Set<'d>> {
        let likely = promising(&self.first, &way.opening.hypotheses);
        let mut best = reached;
        let fitted = |pair: &[Hypothesis; 2]| {
            let fitted = self.together_to_reach(reach(self.start, best), pair);
            best = best.min(fitted.1.score());
            fitted
        };
        let mut fitted: Vec<_> = likely.iter().map(fitted).collect();
        fitted.sort_by(|a, b| a.1.score().total_cmp(&b.1.score()));
        fitted.retain(|(_, fit)| fit.score() <= reach(self.start, best));
        fitted.truncate(REFINED);
        let refined = fitted
            .into_iter()
            .map(|pair| self.refined(pair, &way.opening.likely))
            .filter(|(_, fit)| fit.is_sound() && self.is_material(fit, &way.fit, Share::Further));
        refined.collect()
    }

    /// Each of `pair` tried anew beside the other as it stands: alone it may have taken a form that is not its own.
    fn refined(&self, mut pair: Set<'d>, likely: &Likely) -> Set<'d> {
        for at in 0..pair.0.len() {
            let base = self.base_beside(&all_but(&pair.0, at));
            let anew = try_one(&base, pair.0[at].cause, likely).and_then(|tried| tried.hypothesis());
            let Some(anew) = anew else { continue };
            let mut chosen = pair.0.clone();
            chosen[at] = anew;
            let other = self.together(&chosen);
            if other.1.score() < pair.1.score() {
                pair = other;
            }
        }
        pair
    }
}

impl Part<'_> {
    fn columns(&self) -> std::ops::Range<usize> {
        self.from + 1..self.from + 1 + self.strides.len()
    }
}

fn causes(pair: &[&Hypothesis; 2]) -> [Cause; 2] {
    let [a, b] = pair.map(|hypothesis| hypothesis.cause);
    [a.min(b), a.max(b)]
}

/// Products of all `columns`, summed over the units of each fold, with the rows that count in them.
fn sums_of_folds(mask: &Mask<'_>, columns: &[Vec<f64>]) -> Vec<(DMatrix<f64>, usize)> {
    let folds = &mask.data.folds;
    let stride = mask.data.measured_nm.len().div_ceil(ROWS).max(1);
    let of_fold = |fold: usize| {
        let units = || folds.units.iter().enumerate().filter(move |(at, _)| folds.fold[*at] == fold);
        let rows: Vec<usize> =
            units().flat_map(|(_, unit)| unit.clone()).filter(|i| mask.counts(*i) && i % stride == 0).collect();
        let thinned: Vec<Vec<f64>> = columns.iter().map(|column| rows.iter().map(|i| column[*i]).collect()).collect();
        let lower = |a: usize, b: usize| if b <= a { stride as f64 * dot(&thinned[a], &thinned[b]) } else { 0.0 };
        let mut sums = DMatrix::from_fn(columns.len(), columns.len(), lower);
        sums.fill_upper_triangle_with_lower_triangle();
        (sums, rows.len() * stride)
    };
    (0..FOLDS).into_par_iter().map(of_fold).collect()
}

/// Products of the columns `at` and, last, of what `residual` leaves beside the predictions `changes`.
fn pair_of(sum: &DMatrix<f64>, at: &[usize], residual: usize, changes: [usize; 2]) -> DMatrix<f64> {
    let signed = [(residual, 1.0), (changes[0], -1.0), (changes[1], -1.0)];
    let with = |column: usize| signed.iter().map(|(i, sign)| sign * sum[(*i, column)]).sum::<f64>();
    let n = at.len();
    DMatrix::from_fn(n + 1, n + 1, |a, b| match (a < n, b < n) {
        (true, true) => sum[(at[a], at[b])],
        (true, false) => with(at[a]),
        (false, true) => with(at[b]),
        (false, false) => signed.iter().map(|(i, sign)| sign * with(*i)).sum(),
    })
}
