//! Which parts the history of a quantity has: jumps, at retensionings or at any other time, episodes that end, drift.
//!
//! One criterion decides all: a part is there when chance would explain as much less often than `OUTSIDE`, counting everywhere it
//! was looked for: the kinds of parts, the places at which one of its kind could begin and end, all the quantities of the fleet. A
//! retensioning is a place that is known, so a jump there needs less evidence than one found anywhere. Parts are taken one at a time, the
//! clearest first; after each, every one is moved where another place explains more, and dropped where the others made it needless.

use super::regression::{Course, Fit, Part, SCATTER_KNOWN_FROM};

/// Share of fleets in which nothing happened and anything is found.
pub(super) const OUTSIDE: f64 = 0.05;
/// Kinds of parts: jumps at retensionings, at any time, for some time; drift from the first session on, from a later one on.
const KINDS: f64 = 5.0;
/// Most parts of one quantity.
const PARTS: usize = 12;
/// Columns of which less than this share is their own say nothing.
const OWN: f64 = 1e-6;

/// A search over `course`.
pub(super) struct Search<'a> {
    pub course: &'a Course,
    /// First sessions after retensionings.
    pub retensioned: &'a [usize],
    /// Quantities looked at in the whole fleet.
    pub compared: usize,
}

impl Search<'_> {
    /// The fit with all the parts that are there, `forced` among them; `None` where the sessions cannot tell those apart.
    pub fn run(&self, forced: &[Part]) -> Option<Fit> {
        let mut fit = self.settled(self.start(forced)?, forced);
        while fit.parts.len() < PARTS {
            let Some((more, _)) = self.best(&fit).filter(|(_, odds)| *odds < OUTSIDE) else { break };
            fit = self.settled(more, forced);
        }
        Some(fit)
    }

    /// With steady drift and all retensionings, of which the needless will go: drift that each retensioning takes back shows in
    /// neither alone.
    fn start(&self, forced: &[Part]) -> Option<Fit> {
        let known = self.retensioned.iter().map(|at| Part::Jump { at: *at, until: None, retensioned: true });
        let all: Vec<Part> = forced.iter().copied().chain([Part::Drift { from: 0 }]).chain(known).collect();
        let spare = self.course.len().saturating_sub(all.len());
        let fit = (spare >= SCATTER_KNOWN_FROM).then(|| Fit::new(self.course, &all)).flatten();
        fit.or_else(|| Fit::new(self.course, forced))
    }

    /// `fit` without the parts that are needless, the least first, and with every other one where it explains most.
    fn settled(&self, fit: Fit, forced: &[Part]) -> Fit {
        let mut fit = self.pruned(fit, forced);
        for _ in 0..PARTS {
            let moved = fit.parts.iter().filter(|part| !forced.contains(part)).find_map(|part| {
                let others = Fit::new(self.course, &without(&fit, *part))?;
                let (other, odds) = self.best(&others)?;
                (odds < self.odds(&fit, *part) && other.parts.iter().any(|part| !fit.has(*part))).then_some(other)
            });
            let Some(moved) = moved else { break };
            fit = self.pruned(moved, forced);
        }
        fit
    }

    fn pruned(&self, mut fit: Fit, forced: &[Part]) -> Fit {
        loop {
            let free = fit.parts.iter().copied().filter(|part| !forced.contains(part));
            let least = free.map(|part| (part, self.odds(&fit, part))).max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((part, _)) = least.filter(|(_, odds)| *odds >= OUTSIDE) else { return fit };
            let Some(less) = Fit::new(self.course, &without(&fit, part)) else { return fit };
            fit = less;
        }
    }

    /// Chance times the number of kinds, places and quantities in which a part like `part` was looked for.
    fn odds(&self, fit: &Fit, part: Part) -> f64 {
        let n = self.course.len() as f64;
        let places = match part {
            Part::Temperature | Part::Jump { retensioned: true, .. } | Part::Drift { from: 0 } => 1.0,
            Part::Jump { until: None, .. } => n - 1.0,
            Part::Jump { until: Some(_), .. } => n * (n - 1.0) / 2.0,
            Part::Drift { .. } => n - 2.0,
        };
        fit.chance_of(self.course, part) * KINDS * places * self.compared as f64
    }

    /// `fit` with the part that is clearest beside its own, and that part's odds.
    fn best(&self, fit: &Fit) -> Option<(Fit, f64)> {
        let with = |part: Part| {
            let parts: Vec<Part> = fit.parts.iter().copied().chain([part]).collect();
            let more = Fit::new(self.course, &parts)?;
            let odds = self.odds(&more, part);
            Some((more, odds))
        };
        // Of each kind the one that explains most, with the weights of now.
        let found = Gains::new(self.course, fit).best(self.retensioned);
        found.into_iter().filter_map(with).min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// The parts of `fit` but for `part`.
fn without(fit: &Fit, part: Part) -> Vec<Part> {
    fit.parts.iter().copied().filter(|other| *other != part).collect()
}

/// What each possible part would take off the squares that a fit leaves, by sums over sessions.
struct Gains<'a> {
    course: &'a Course,
    weights: &'a [f64],
    /// Residuals.
    residuals: Vec<f64>,
    /// Columns of the fit, orthonormal with the weights.
    basis: Vec<Vec<f64>>,
}

impl<'a> Gains<'a> {
    fn new(course: &'a Course, fit: &'a Fit) -> Self {
        let n = course.len();
        let mut gains = Self { course, weights: &fit.weights, residuals: course.values.clone(), basis: Vec::new() };
        let columns = std::iter::once(vec![1.0; n])
            .chain(fit.parts.iter().map(|part| (0..n).map(|i| course.column(*part, i)).collect()));
        for mut column in columns {
            // Twice is enough for orthogonality to rounding (Kahan; Parlett, The Symmetric Eigenvalue Problem, 6.9).
            for _ in 0..2 {
                for of in &gains.basis {
                    let share = gains.product(of, &column);
                    column.iter_mut().zip(of).for_each(|(x, q)| *x -= share * q);
                }
            }
            let length = gains.product(&column, &column).sqrt();
            column.iter_mut().for_each(|x| *x /= length);
            gains.basis.push(column);
        }
        for of in &gains.basis {
            let share = gains.product(of, &gains.residuals);
            gains.residuals.iter_mut().zip(of).for_each(|(r, q)| *r -= share * q);
        }
        gains
    }

    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        self.weights.iter().zip(a).zip(b).map(|((w, a), b)| w * a * b).sum()
    }

    /// Of jumps at retensionings, of jumps at any time, of episodes and of drifts the one that gains most.
    fn best(&self, retensioned: &[usize]) -> Vec<Part> {
        let n = self.course.len();
        let jump = |at: usize, until: Option<usize>| Part::Jump { at, until, retensioned: false };
        let known = retensioned.iter().map(|at| Part::Jump { at: *at, until: None, retensioned: true });
        let free = |at: &usize| !retensioned.contains(at);
        let sums = self.sums();
        let of_jump = |part: &Part| match *part {
            Part::Jump { at, until, .. } => self.gain_between(&sums, at, until.unwrap_or(n)),
            _ => 0.0,
        };
        let episodes = (1..n).flat_map(|at| (at + 1..n).map(move |until| jump(at, Some(until))));
        let drifts = (0..n.saturating_sub(2).max(1)).map(|from| Part::Drift { from });
        let most = |a: &(Part, f64), b: &(Part, f64)| a.1.total_cmp(&b.1);
        let gain = |part: Part| (part, of_jump(&part));
        [
            known.map(gain).max_by(most),
            (1..n).filter(free).map(|at| gain(jump(at, None))).max_by(most),
            episodes.map(gain).max_by(most),
            drifts.map(|part| (part, self.gain(part))).max_by(most),
            Some((Part::Drift { from: 0 }, self.gain(Part::Drift { from: 0 }))),
        ]
        .into_iter()
        .flatten()
        .filter(|(_, gain)| *gain > 0.0)
        .map(|(part, _)| part)
        .collect()
    }

    fn gain(&self, part: Part) -> f64 {
        let column: Vec<f64> = (0..self.course.len()).map(|i| self.course.column(part, i)).collect();
        let whole = self.product(&column, &column);
        let own = whole - self.basis.iter().map(|q| self.product(q, &column).powi(2)).sum::<f64>();
        if own > OWN * whole { self.product(&column, &self.residuals).powi(2) / own } else { 0.0 }
    }

    /// Up to each session: sums of the weights, of the residuals, of each column of the basis, weighted.
    fn sums(&self) -> Vec<Vec<f64>> {
        let up_to = |of: &dyn Fn(usize) -> f64| {
            let mut sum = 0.0;
            let rest = (0..self.course.len()).map(|i| {
                sum += self.weights[i] * of(i);
                sum
            });
            std::iter::once(0.0).chain(rest).collect::<Vec<f64>>()
        };
        let basis = self.basis.iter().map(|q| up_to(&|i| q[i]));
        [up_to(&|_| 1.0), up_to(&|i| self.residuals[i])].into_iter().chain(basis).collect()
    }

    /// Of a column that is 1 from session `at` to before `until`.
    fn gain_between(&self, sums: &[Vec<f64>], at: usize, until: usize) -> f64 {
        let sum = |of: &Vec<f64>| of[until] - of[at];
        let whole = sum(&sums[0]);
        let own = whole - sums[2..].iter().map(|q| sum(q).powi(2)).sum::<f64>();
        if own > OWN * whole { sum(&sums[1]).powi(2) / own } else { 0.0 }
    }
}
