//! Which two causes could explain a gap together: all pairs looked at as if their torques added up, a matter of small matrices.
//!
//! One cause at a time finds a compromise where two are at work. Here every cause that was fitted or begun alone gives its
//! prediction and its columns; what a pair would leave is what both predictions and both sets of columns leave.

use super::candidates::{Cause, Sketch};
use super::fit::{Bench, Ground};
use super::gram::{solve, square_left};
use super::parts::FOLDS;
use nalgebra::DMatrix;
use rayon::prelude::*;

/// Pairs that are fitted in full.
const FOLLOWED: usize = 6;
/// Rows looked at: every so-manieth where there are more.
const ROWS: usize = 30_000;

/// What a sketch adds to the ground: where its columns begin among all, how many, and how far they are believed.
struct Part<'s> {
    sketch: &'s Sketch,
    from: usize,
    strides: Vec<f64>,
}

/// The pairs of `sketches` that leave least on units held out, best first.
pub fn promising(bench: &Bench<'_>, ground: &Ground, sketches: &[Sketch]) -> Vec<[Sketch; 2]> {
    let (own, residual) = (ground.columns.len(), ground.columns.len());
    let mut columns: Vec<Vec<f64>> = ground.columns.clone();
    columns.push(bench.counted_nm(&ground.predicted_nm));
    let drawn = |sketch: &Sketch| {
        let mut model = ground.model.clone();
        let moves = sketch.put(&mut model, bench);
        let passages = bench.records.passages(&model);
        let predicted_nm = bench.predicted_nm(ground, &model, &passages);
        let mut own = bench.columns(ground, &model, &passages, &predicted_nm, &moves);
        // Its prediction beside the ground's stands before its columns.
        let change = |((p, g), used): ((&f64, &f64), &bool)| if *used { p - g } else { 0.0 };
        own.insert(0, predicted_nm.iter().zip(&ground.predicted_nm).zip(&bench.used).map(change).collect());
        (own, moves.iter().map(|way| way.stride).collect::<Vec<f64>>())
    };
    let drawn: Vec<(Vec<Vec<f64>>, Vec<f64>)> = sketches.par_iter().map(drawn).collect();
    let mut parts = Vec::new();
    for (sketch, (added, strides)) in sketches.iter().zip(drawn) {
        parts.push(Part { sketch, from: columns.len(), strides });
        columns.extend(added);
    }
    let sums = sums_of_folds(bench, &columns);
    let left = |a: &Part<'_>, b: &Part<'_>| {
        let at: Vec<usize> = (0..own).chain(a.columns()).chain(b.columns()).collect();
        let priors = ground.moves.iter().map(|way| way.prior);
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
                square_left(&of_fold[fold], &solve(&sum, rows, bench.prior(&deviations)).x)
            })
            .sum::<f64>()
    };
    let pairs: Vec<(usize, usize)> = (0..parts.len())
        .flat_map(|i| (0..i).map(move |j| (j, i)))
        .filter(|(j, i)| parts[*j].sketch.cause != parts[*i].sketch.cause)
        .collect();
    let mut ranked: Vec<(f64, usize, usize)> =
        pairs.into_par_iter().map(|(j, i)| (left(&parts[j], &parts[i]), j, i)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut found: Vec<[Sketch; 2]> = Vec::new();
    for (_, j, i) in ranked {
        let pair = [parts[j].sketch, parts[i].sketch];
        let same = |known: &[Sketch; 2]| causes(&[&known[0], &known[1]]) == causes(&pair);
        if !found.iter().any(same) {
            found.push(pair.map(Sketch::clone));
        }
        if found.len() == FOLLOWED {
            break;
        }
    }
    found
}

impl Part<'_> {
    fn columns(&self) -> std::ops::Range<usize> {
        self.from + 1..self.from + 1 + self.strides.len()
    }
}

fn causes(pair: &[&Sketch; 2]) -> [Cause; 2] {
    let [a, b] = pair.map(|sketch| sketch.cause);
    [a.min(b), a.max(b)]
}

/// Products of all `columns`, summed over the units of each fold, with the rows that count in them.
fn sums_of_folds(bench: &Bench<'_>, columns: &[Vec<f64>]) -> Vec<(DMatrix<f64>, usize)> {
    let stride = bench.used.len().div_ceil(ROWS).max(1);
    let of_fold = |fold: usize| {
        let units = || bench.parts.units.iter().enumerate().filter(move |(at, _)| bench.parts.fold[*at] == fold);
        let rows: Vec<usize> =
            units().flat_map(|(_, unit)| unit.clone()).filter(|i| bench.used[*i] && i % stride == 0).collect();
        let thinned = DMatrix::from_fn(rows.len(), columns.len(), |row, column| columns[column][rows[row]]);
        (thinned.tr_mul(&thinned) * stride as f64, rows.len() * stride)
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
