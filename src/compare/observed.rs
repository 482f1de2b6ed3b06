//! A and B(v) of two models as whitened differences, and what each possible cause does to them.
//!
//! The observations are the relative change of A in each direction and the differences of B at the speeds that both models know, with the
//! covariance that both identifications give them: what A and B take alike from an error of A or of the zero is one error. Each
//! possible cause moves them along a column of its own:
//!
//! | cause | A | B(v) |
//! |---|---|---|
//! | Coulomb friction | 0 | 1 |
//! | viscous friction | 0 | v |
//! | Stribeck friction | 0 | the exponentials of the earlier model |
//! | load coefficient, one direction | 1 | B before: both go as 1 / (1 - mu_c) (18), (19) |
//! | gain of the sensor, or both load coefficients | 1, both | B before, both |
//! | gravity, or a spring about the joint | 1, both | 0, or one level in both |
//! | torque offset | 0 | 1, both |
//!
//! A mass that is not where the others are adds a cosine to their sine, a spring with a rest position of its own a level: gravity
//! is tried with and without one.
//!
//! `selection` takes causes from them.

use super::cause::{CauseKind, Measure};
use crate::model::{Both, Direction, Level, Model};
use nalgebra::{Cholesky, DMatrix, DVector};

/// What a cause's second number must explain of chi squared to count: of two numbers chance explains 9.21 once in a hundred times,
/// of one 6.63.
const SECOND_NUMBER: f64 = 2.58;
/// Differences below this share of A or B count as zero, however small the scatter.
const IMMATERIAL: f64 = 1e-3;
/// Speeds compared in one direction at most: those of the later model, thinned.
const SPEEDS: usize = 24;
/// Where the earlier model has no Stribeck term: the share of the fastest speed at which a typical one has fallen to 1/e.
const STRIBECK_SHARE: f64 = 0.15;

/// What a cause does.
pub(super) struct Column {
    pub kind: CauseKind,
    pub direction: Option<Direction>,
    /// Whitened, per unit of `change`.
    whitened: DVector<f64>,
    /// Whitened, per N m of the level that comes with it.
    level: Option<DVector<f64>>,
    pub measure: Measure,
}

/// Whitened differences, and what each cause does to them.
pub(super) struct Observed {
    difference: DVector<f64>,
    pub columns: Vec<Column>,
    /// What a cause must explain of chi squared.
    pub explains: f64,
}

/// The rows of one direction.
struct Rows {
    direction: Direction,
    /// Relative change of A, where a load shows A in both.
    relative_a: Option<f64>,
    /// What each error that A and B share, of the model before, then of that after, adds to it.
    shared_a: Vec<f64>,
    /// Speed, B before, difference, variance of its own.
    levels: Vec<(f64, f64, f64, f64)>,
    /// What each shared error adds to every level, N m.
    shared_b: Vec<f64>,
}

impl Rows {
    /// `None` where one of the models knows nothing of `direction`.
    fn new(direction: Direction, models: [&Model; 2]) -> Option<Self> {
        let [before, after] = models.map(|model| model.functions.branches.of(direction).as_ref());
        let (before, after) = (before?, after?);
        let [was, is] = models.map(|model| model.functions.errors(direction));
        let ratio = after.a_nm / before.a_nm;
        let is_known = ratio.is_finite() && before.a_se_nm.is_finite() && after.a_se_nm.is_finite();
        let relative_a = is_known.then_some(ratio - 1.0);
        let by_before = was.iter().map(|error| -ratio * error.a_nm / before.a_nm);
        let shared_a = by_before.chain(is.iter().map(|error| error.a_nm / before.a_nm)).collect();
        let shared_b = was.iter().map(|error| -error.b_nm).chain(is.iter().map(|error| error.b_nm)).collect();
        let step = after.levels.len().div_ceil(SPEEDS).max(1);
        let level = |level: &Level| {
            let earlier = before.at(level.speed_rad_s)?;
            let immaterial_nm = IMMATERIAL * earlier.b_nm.abs().max(level.b_nm.abs());
            let variance = earlier.se_nm.powi(2) + level.se_nm.powi(2) + immaterial_nm.powi(2);
            let known =
                variance.is_finite() && variance > 0.0 && before.common_se_nm.hypot(after.common_se_nm).is_finite();
            known.then_some((level.speed_rad_s, earlier.b_nm, level.b_nm - earlier.b_nm, variance))
        };
        let levels = after.levels.iter().step_by(step).filter_map(level).collect();
        Some(Self { direction, relative_a, shared_a, levels, shared_b })
    }

    fn count(&self) -> usize {
        usize::from(self.relative_a.is_some()) + self.levels.len()
    }

    /// The difference of each row, its variance of its own, and what each shared error adds to it.
    fn rows(&self) -> impl Iterator<Item = (f64, f64, &[f64])> {
        let of_a = self.relative_a.map(|change| (change, IMMATERIAL.powi(2), self.shared_a.as_slice()));
        of_a.into_iter().chain(self.levels.iter().map(|level| (level.2, level.3, self.shared_b.as_slice())))
    }
}

impl Observed {
    /// Of two models, where a cause must explain `explains` of chi squared; `None` where they share neither A nor a speed.
    pub fn new(before: &Model, after: &Model, explains: f64) -> Option<Self> {
        let rows: Vec<Rows> = Direction::BOTH.into_iter().filter_map(|d| Rows::new(d, [before, after])).collect();
        let count: usize = rows.iter().map(Rows::count).sum();
        if count == 0 {
            return None;
        }
        let mut place = Both { up: 0, down: 0 };
        let mut at = 0;
        for of in &rows {
            *place.of_mut(of.direction) = at;
            at += of.count();
        }
        let all: Vec<(f64, f64, &[f64])> = rows.iter().flat_map(Rows::rows).collect();
        let difference = DVector::from_iterator(count, all.iter().map(|row| row.0));
        let covariance = DMatrix::from_fn(count, count, |i, j| {
            let shared: f64 = all[i].2.iter().zip(all[j].2).map(|(a, b)| a * b).sum();
            shared + if i == j { all[i].1 } else { 0.0 }
        });
        let cholesky = Cholesky::new(covariance)?;
        let whiten = |values: DVector<f64>| cholesky.l().solve_lower_triangular(&values);
        let columns = columns(&rows, &place, count, before);
        let columns = columns.into_iter().filter_map(|column| {
            let whitened = whiten(column.whitened)?;
            let level = column.level.and_then(whiten);
            (whitened.norm() > 0.0).then_some(Column { whitened, level, ..column })
        });
        Some(Self { columns: columns.collect(), difference: whiten(difference)?, explains })
    }

    /// Chi squared left by the causes at `taken`, with what their second numbers must explain added; their sizes and the sizes'
    /// covariance. `None` without causes, where they cannot be told apart, or where one is a level alone, beside a load that did not
    /// change.
    pub fn left(&self, taken: &[usize]) -> Option<(f64, DVector<f64>, DMatrix<f64>)> {
        if taken.is_empty() {
            return None;
        }
        let sizes = taken.iter().map(|i| &self.columns[*i].whitened);
        let levels: Vec<&DVector<f64>> = taken.iter().filter_map(|i| self.columns[*i].level.as_ref()).collect();
        let design = DMatrix::from_columns(&sizes.chain(levels.iter().copied()).cloned().collect::<Vec<_>>());
        let gram = design.tr_mul(&design);
        let scale = gram.diagonal().map(f64::sqrt);
        let scaled = gram.map_with_location(|i, j, product| product / scale[i] / scale[j]);
        /// Columns that differ by less than this share of their length are collinear.
        const APART: f64 = 1e-4;
        if scaled.symmetric_eigenvalues().min() < APART {
            return None;
        }
        let inverse = gram.try_inverse()?;
        let sizes = &inverse * design.tr_mul(&self.difference);
        let is_seen = |at: usize| {
            self.columns[taken[at]].level.is_none() || sizes[at].powi(2) > self.explains * inverse[(at, at)]
        };
        let left = (&self.difference - &design * &sizes).norm_squared() + SECOND_NUMBER * levels.len() as f64;
        (0..taken.len()).all(is_seen).then_some((left, sizes, inverse))
    }

    /// Differences compared.
    pub fn count(&self) -> usize {
        self.difference.len()
    }

    /// Chi squared of an unchanged joint.
    pub fn chi_squared(&self) -> f64 {
        self.difference.norm_squared()
    }
}

/// What each cause does to the rows, not yet whitened.
fn columns(rows: &[Rows], place: &Both<usize>, count: usize, before: &Model) -> Vec<Column> {
    let mut columns = Vec::new();
    let (mut gain, mut gravity, mut offset) = (DVector::zeros(count), DVector::zeros(count), DVector::zeros(count));
    for of in rows {
        let first = *place.of(of.direction);
        let levels = first + usize::from(of.relative_a.is_some());
        let over_levels = |value: &dyn Fn(f64, f64) -> f64| {
            let mut column = DVector::zeros(count);
            for (i, (speed, b_nm, ..)) in of.levels.iter().enumerate() {
                column[levels + i] = value(*speed, *b_nm);
            }
            column
        };
        let speeds = || of.levels.iter().map(|level| level.0);
        let (slowest, fastest) = (speeds().fold(f64::INFINITY, f64::min), speeds().fold(0.0, f64::max));
        let stribeck = stribeck_shape(before, of.direction, slowest, fastest);
        let before_nm = of.levels.iter().map(|level| level.1.abs()).fold(0.0, f64::max);
        let torque = Measure::Torque { before_nm };
        let mut add = |kind, whitened: DVector<f64>, measure| {
            columns.push(Column { kind, direction: Some(of.direction), whitened, level: None, measure });
        };
        offset += over_levels(&|_, _| 1.0);
        add(CauseKind::Coulomb, over_levels(&|_, _| 1.0), torque);
        if of.levels.len() > 1 {
            add(CauseKind::Viscous, over_levels(&|v, _| v / fastest), torque);
        }
        if of.levels.len() > 2 {
            add(CauseKind::Stribeck, over_levels(&|v, _| stribeck(v)), torque);
        }
        let mut scaled = over_levels(&|_, b_nm| b_nm);
        if of.relative_a.is_some() {
            scaled[first] = 1.0;
            gravity[first] = 1.0;
            gain += &scaled;
            add(CauseKind::LoadCoefficient, scaled, Measure::Load { mu_c: before.friction.of(of.direction).mu_c });
        }
    }
    let both = |kind, whitened, level, measure| Column { kind, direction: None, whitened, level, measure };
    if rows.iter().filter(|of| of.relative_a.is_some()).count() == 2 {
        columns.push(both(CauseKind::Gain, gain, None, Measure::Share));
        columns.push(both(CauseKind::Gravity, gravity.clone(), None, Measure::Share));
        columns.push(both(CauseKind::Gravity, gravity, Some(offset.clone()), Measure::Share));
    }
    if rows.iter().filter(|of| !of.levels.is_empty()).count() == 2 {
        columns.push(both(CauseKind::Offset, offset, None, Measure::Torque { before_nm: 0.0 }));
    }
    columns
}

/// The Stribeck term of `before` over speed, 1 at `slowest_rad_s`.
fn stribeck_shape(before: &Model, direction: Direction, slowest_rad_s: f64, fastest_rad_s: f64) -> impl Fn(f64) -> f64 {
    let branch = *before.friction.of(direction);
    let r2 = before.joint.pulley_radius_m;
    let at =
        move |v: f64| branch.b_c * (-(branch.c_c * r2).abs() * v).exp() + branch.b_j * (-branch.c_j.abs() * v).exp();
    // Two terms of opposite signs may cancel at the slowest speed.
    let usual = move |v: f64| (-v / (STRIBECK_SHARE * fastest_rad_s)).exp();
    let falls = at(slowest_rad_s).abs() > 2.0 * at(fastest_rad_s).abs();
    move |v| if falls { at(v) / at(slowest_rad_s) } else { usual(v) / usual(slowest_rad_s) }
}
