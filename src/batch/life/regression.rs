//! A quantity over sessions as a level, what happened to it, and a scatter from session to session.
//!
//! y_i = level + sum of parts_j(i) + e_i, with var e_i = s_i^2 + tau^2: s_i is what the session's own interval claims, tau the
//! scatter between sessions that no session knows of (mounting, a cable that has settled differently). tau^2 is the one with
//! which the weighted squares left are what they should be, n - k (Paule and Mandel, J. Res. NBS 87:377, 1982); 0 where they are
//! less. What other joints scatter counts as further squares, each s^2 + tau_0^2 on average (a moderated variance: Smyth, Stat.
//! Appl. Genet. Mol. Biol. 3:3, 2004).

use crate::numerics::statistics::{HALF_WIDTH, chi_squared_tail, fisher_tail, student_t};
use nalgebra::{DMatrix, DVector};

/// From this many sessions on the scatter between them is estimated; with fewer, only their own intervals are known.
pub(super) const SCATTER_KNOWN_FROM: usize = 5;
/// Halvings of the scatter's range: its variance is then known to 1e-9 of what it can be.
const HALVINGS: usize = 30;
/// Columns that differ by less than this share of their length are collinear.
const APART: f64 = 1e-9;

/// What happened to a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part {
    /// Its level changed at session `at`, at session `until` back again; at a retensioning, or at any other time.
    Jump {
        /// The first session with the new level.
        at: usize,
        /// The first session with the old one again; `None` of a lasting change.
        until: Option<usize>,
        /// Whether the cables were retensioned just before.
        retensioned: bool,
    },
    /// It changes steadily from session `from` on, per day.
    Drift {
        /// The last session before.
        from: usize,
    },
    /// It follows the temperature, per K.
    Temperature,
}

/// What other joints of the fleet say of the scatter between sessions of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alike {
    /// Variance between sessions beyond what they claim.
    pub variance: f64,
    /// Degrees of freedom that it counts for.
    pub freedom: f64,
}

/// A quantity over sessions.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// When each session was, days; the sessions' numbers where dates are not known.
    pub days: Vec<f64>,
    /// What each found.
    pub values: Vec<f64>,
    /// Variance that each session claims of it.
    pub variances: Vec<f64>,
    /// The temperature of each, less their mean, K.
    pub temperatures: Option<Vec<f64>>,
    /// What other joints say of its scatter.
    pub alike: Option<Alike>,
}

impl Course {
    /// What one unit of `part` does at session `i`.
    pub fn column(&self, part: Part, i: usize) -> f64 {
        match part {
            Part::Jump { at, until, .. } => f64::from(i >= at && until.is_none_or(|until| i < until)),
            Part::Drift { from } => (self.days[i] - self.days[from]).max(0.0),
            Part::Temperature => self.temperatures.as_ref().map_or(0.0, |all| all[i]),
        }
    }

    /// Sessions.
    pub fn len(&self) -> usize {
        self.values.len()
    }

    /// Squares that other joints add where the scatter's variance is `variance`, and how many.
    fn alike(&self, variance: f64) -> (f64, f64) {
        let Some(alike) = self.alike else { return (0.0, 0.0) };
        let claimed = self.variances.iter().sum::<f64>() / self.len() as f64;
        (alike.freedom * (claimed + alike.variance) / (claimed + variance), alike.freedom)
    }
}

/// A level and parts, fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// What happened.
    pub parts: Vec<Part>,
    /// The level before, then the size of each part.
    pub sizes: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// The scatter between sessions beyond what they claim, a standard deviation; NaN with too few sessions to say.
    pub scatter: f64,
    /// Weight of each session.
    pub weights: Vec<f64>,
    /// Sum of weighted squares left.
    pub left: f64,
    /// Sessions less what was fitted.
    pub freedom: f64,
    /// Squares of other joints, and how many.
    alike: (f64, f64),
}

impl Fit {
    /// Of `course` with `parts`; `None` where the sessions cannot tell them apart.
    pub fn new(course: &Course, parts: &[Part]) -> Option<Self> {
        let n = course.len();
        let freedom = n as f64 - parts.len() as f64 - 1.0;
        let with = |variance: f64| {
            let weights: Vec<f64> = course.variances.iter().map(|own| 1.0 / (own + variance)).collect();
            Some(Self { alike: course.alike(variance), ..Self::weighted(course, parts, weights)? })
        };
        if n < SCATTER_KNOWN_FROM {
            let fit = Self { scatter: f64::NAN, alike: (0.0, 0.0), ..with(0.0)? };
            return Some(fit).filter(|_| freedom >= 0.0);
        }
        if freedom < 1.0 {
            return None;
        }
        let claimed = with(0.0)?;
        let is_more = |fit: &Self| fit.left + fit.alike.0 > freedom + fit.alike.1;
        if !is_more(&claimed) {
            return Some(claimed);
        }
        let mean = course.values.iter().sum::<f64>() / n as f64;
        let own = course.values.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / freedom;
        let (mut low, mut high) = (0.0, own.max(course.alike.map_or(0.0, |alike| alike.variance)));
        for _ in 0..HALVINGS {
            let middle = (low + high) / 2.0;
            *(if is_more(&with(middle)?) { &mut low } else { &mut high }) = middle;
        }
        Some(Self { scatter: high.sqrt(), ..with(high)? })
    }

    fn weighted(course: &Course, parts: &[Part], weights: Vec<f64>) -> Option<Self> {
        let n = course.len();
        let value = |i: usize, j: usize| if j == 0 { 1.0 } else { course.column(parts[j - 1], i) };
        let design = DMatrix::from_fn(n, parts.len() + 1, |i, j| weights[i].sqrt() * value(i, j));
        let target = DVector::from_fn(n, |i, _| weights[i].sqrt() * course.values[i]);
        let length = DVector::from_fn(parts.len() + 1, |j, _| design.column(j).norm());
        let scaled = DMatrix::from_fn(n, parts.len() + 1, |i, j| design[(i, j)] / length[j]);
        let gram = scaled.tr_mul(&scaled);
        // An eigenvalue that is not a number is no independence either.
        let least = gram.clone().symmetric_eigenvalues().min();
        if least.is_nan() || least <= APART {
            return None;
        }
        let inverse = gram.try_inverse()?;
        let covariance = DMatrix::from_fn(length.len(), length.len(), |i, j| inverse[(i, j)] / length[i] / length[j]);
        let sizes = &covariance * design.tr_mul(&target);
        let left = (target - &design * &sizes).norm_squared();
        let freedom = n as f64 - parts.len() as f64 - 1.0;
        Some(Self { parts: parts.to_vec(), sizes, covariance, scatter: 0.0, weights, left, freedom, alike: (0.0, 0.0) })
    }

    /// Chance that a part that never was would explain as much as `part` does beside the others: Fisher's F, the scatter counted
    /// as no less than the sessions claim; chi squared where only their claims are known.
    pub fn chance_of(&self, course: &Course, part: Part) -> f64 {
        let others: Vec<Part> = self.parts.iter().copied().filter(|other| *other != part).collect();
        let Some(without) = Self::weighted(course, &others, self.weights.clone()) else { return 1.0 };
        let gained = (without.left - self.left).max(0.0);
        let (left, freedom) = (self.left + self.alike.0, self.freedom + self.alike.1);
        match self.scatter.is_nan() {
            true => chi_squared_tail(gained, 1.0),
            false => fisher_tail(gained / (left.max(freedom) / freedom), 1.0, freedom),
        }
    }

    /// Half of a 95 % interval in standard errors.
    pub fn half_widths(&self) -> f64 {
        if self.scatter.is_nan() { HALF_WIDTH } else { student_t(self.freedom + self.alike.1) }
    }

    /// The sum of the level and the parts with these `factors`, and its standard error.
    pub fn combined(&self, factors: &[f64]) -> (f64, f64) {
        let g = DVector::from_row_slice(factors);
        (self.sizes.dot(&g), (&self.covariance * &g).dot(&g).max(0.0).sqrt())
    }

    /// The value fitted at session `i` of `course`, the temperature's part left out, as factors for [`Self::combined`].
    pub fn factors(&self, course: &Course, i: usize) -> Vec<f64> {
        let factor = |part: &Part| if *part == Part::Temperature { 0.0 } else { course.column(*part, i) };
        std::iter::once(1.0).chain(self.parts.iter().map(factor)).collect()
    }

    /// Whether `part` was taken.
    pub fn has(&self, part: Part) -> bool {
        self.parts.contains(&part)
    }
}
