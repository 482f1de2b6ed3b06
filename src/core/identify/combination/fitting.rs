//! One curve on the windows: its parameter, the clearance, their intervals.

use super::{CurveFit, CurveKind, NEGLIGIBLE};
use crate::identify::checks::Check;
use crate::identify::confidence::{interval, of_k};
use crate::identify::support::excess;
use crate::identify::windows::Window;
use crate::model::{Combination, Confidence, Model};
use crate::numerics::cluster;
use crate::numerics::line::lowest;
use crate::numerics::statistics::{HALF_WIDTH, root_mean_square, student_t};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Relative error of p, n and X_cl that no amount of data removes: on exact simulated logs thinning, differentiation and the
/// branches' extrapolation to rest leave p off by 0.1 to 0.2 %.
const SYSTEMATIC: f64 = 2e-3;
/// Golden sections: each leaves 0.618 of the log range, and a parabola ends it.
const SECTIONS: usize = 14;
/// Clearances smaller ...
const SMALLER: [f64; 5] = [1.3, 2.0, 5.0, 12.0, 30.0];
/// ... or larger by these factors, ...
const LARGER: [f64; 3] = [1.3, 2.0, 5.0];
/// ... or, where next to none is declared, of this share of a stroke ...
const BACKLASH_PROBE: f64 = 0.01;
/// ... contradict the declared one when they reduce the residual beyond noise by more than this share ...
const BACKLASH_DOUBT: f64 = 0.2;
/// ... and a share of each reversal's sum of squares that is more than this many standard errors over the reversals.
const BACKLASH_CHANCE: f64 = 4.0;
/// Reversals compared for it: their number tells chance from more, and these are enough.
const WINDOWS_COMPARED: usize = 60;
/// Golden sections for the curve at each of those clearances: it is only compared.
const SECTIONS_COMPARED: usize = 8;
/// The reported clearance lies within this factor of the best of those, the largest ratio between two of them, ...
const NEIGHBOUR: f64 = 2.5;
/// ... and is narrowed by as many golden sections.
const SECTIONS_TOLD: usize = 5;

/// All curves are fitted to these.
pub(super) struct Fitting<'a> {
    pub windows: &'a [Window<'a>],
    pub model: &'a Model,
    /// Where X_cl / r2 is looked for; `None` keeps the model's.
    pub backlash_span_rad: Option<(f64, f64)>,
    /// The median stroke between reversals, rad.
    pub stroke_rad: f64,
    /// The coarsest encoder's step where it matters, else 0, rad.
    pub step_rad: f64,
    /// What the model leaves of sliding at constant speed, N m, if that is known: no curve can do better.
    pub noise_nm: Option<f64>,
}

impl Fitting<'_> {
    /// What a curve may leave whatever the noise, N m: a small share of the change of friction, or what it changes by within
    /// an encoder's step, for where in the step the joint turned is not known.
    pub fn negligible_nm(&self, fit: &CurveFit) -> f64 {
        /// Places along the curve.
        const PLACES: usize = 50;
        let (sum, count) = self.windows.iter().fold((0.0, 0), |(sum, count), window| {
            (sum + window.change_square_sum(self.model), count + window.judged.len())
        });
        let change_nm = (sum / count as f64).sqrt();
        let off = self.hidden(fit);
        let blur = |i: usize| {
            let at = i as f64 / PLACES as f64;
            fit.curve.share((at + off).min(1.0)) - fit.curve.share(at)
        };
        let blurs: Vec<f64> = (0..PLACES).map(blur).collect();
        change_nm * NEGLIGIBLE.max(root_mean_square(&blurs))
    }

    /// Share of the clearance that an encoder's step hides: the standard deviation of a place within it.
    fn hidden(&self, fit: &CurveFit) -> f64 {
        let backlash_rad = fit.backlash_m / self.model.joint.pulley_radius_m;
        if backlash_rad > 0.0 { (self.step_rad / 12f64.sqrt() / backlash_rad).min(1.0) } else { 0.0 }
    }

    fn sums(&self, curve: &Combination, backlash_rad: f64) -> Vec<f64> {
        let sum = |w: &Window| w.residual_nm(self.model, curve, backlash_rad).iter().map(|r| r * r).sum();
        self.windows.par_iter().map(sum).collect()
    }

    fn cost(&self, curve: &Combination, backlash_rad: f64) -> f64 {
        self.sums(curve, backlash_rad).iter().sum()
    }

    /// One curve's fit, and its sum of squares in each window.
    pub fn fit(&self, kind: CurveKind) -> (CurveFit, Vec<f64>) {
        let at = |backlash_rad: f64| match kind.range() {
            None => (1.0, self.cost(&kind.with(1.0), backlash_rad)),
            Some(range) => golden(range, |x| self.cost(&kind.with(x), backlash_rad)),
        };
        let declared_rad = self.model.joint.backlash_rad();
        let backlash_rad = match self.backlash_span_rad {
            Some(span) if kind != CurveKind::Sign => scan_then_golden(span, |x| at(x).1),
            _ => declared_rad,
        };
        let curve = kind.with(at(backlash_rad).0);
        let window_sums = self.sums(&curve, backlash_rad);
        let residual_sum: f64 = window_sums.iter().sum();
        let spread = |w: &Window| w.spread();
        let samples: usize = self.windows.iter().map(|w| w.judged.len()).sum();
        let fit = CurveFit {
            kind,
            curve,
            backlash_m: backlash_rad * self.model.joint.pulley_radius_m,
            rmse_nm: (residual_sum / samples as f64).sqrt(),
            r_squared: 1.0 - residual_sum / self.windows.iter().map(spread).sum::<f64>(),
        };
        (fit, window_sums)
    }

    /// Intervals of p or n and X_cl by the sandwich over windows, whose errors are independent where samples' are not.
    pub fn confidence(&self, fit: &CurveFit) -> Vec<(String, Confidence)> {
        let mut known = Vec::new();
        if fit.kind == CurveKind::Sign || fit.backlash_m <= 0.0 {
            return known;
        }
        let backlash_rad = fit.backlash_m / self.model.joint.pulley_radius_m;
        let (names, start): (Vec<&str>, Vec<f64>) = match fit.curve {
            Combination::Arctan { p, .. } => {
                (vec!["joint.backlash_m", "combination.p"], vec![backlash_rad.ln(), p.ln()])
            }
            Combination::Power { n } => (vec!["joint.backlash_m", "combination.n"], vec![backlash_rad.ln(), n.ln()]),
            _ => (vec!["joint.backlash_m"], vec![backlash_rad.ln()]),
        };
        let residuals = |q: &[f64]| -> Vec<Vec<f64>> {
            let curve = fit.kind.with(q.get(1).map_or(1.0, |x| x.exp()));
            self.windows.par_iter().map(|w| w.residual_nm(self.model, &curve, q[0].exp())).collect()
        };
        let free: Vec<usize> =
            if self.backlash_span_rad.is_some() { (0..start.len()).collect() } else { (1..start.len()).collect() };
        let freedom = cluster::freedom(self.windows.len(), free.len());
        // With too few windows to tell anything of the errors nothing is shown of the curve.
        let alone = if freedom > 0.0 { 0.0 } else { f64::INFINITY };
        for (i, se) in standard_errors(&residuals, &start, &free) {
            let range = if i == 0 { self.backlash_span_rad } else { fit.kind.range() };
            let at_bound = range.is_some_and(|(low, high)| start[i] - low.ln() < 0.02 || high.ln() - start[i] < 0.02);
            let se = se.hypot(SYSTEMATIC.max(self.hidden(fit)));
            let half = student_t(freedom) * se;
            let scale = if i == 0 { self.model.joint.pulley_radius_m } else { 1.0 };
            let ends = [scale * (start[i] - half).exp(), scale * (start[i] + half).exp()];
            let interval = interval(scale * start[i].exp(), ends, 0.0, HALF_WIDTH, alone, at_bound);
            known.push((names[i].to_string(), interval));
        }
        let p = known.iter().find(|(name, _)| name == "combination.p").map(|(_, of_p)| *of_p);
        known.extend(p.map(|of_p| ("combination.k".to_string(), of_k(of_p))));
        known
    }

    /// Whether the reversals contradict the declared clearance, at which the data support `fit`: another one, the curve fitted
    /// anew, leaves clearly less. `None` where the clearance is estimated.
    ///
    /// Clearly: by more than chance over the reversals, by more than is negligible, and by a share of the residual beyond noise.
    pub fn clearance(&self, fit: &CurveFit, declared_rad: f64) -> Option<Check> {
        if self.backlash_span_rad.is_some() {
            return None;
        }
        let check = |value: f64, failure: String| {
            let concerns = vec!["combination.".to_string(), "joint.backlash_m".to_string()];
            Some(Check { name: "clearance", concerns, value, limit: BACKLASH_CHANCE, failure })
        };
        let negligible_nm2 = self.negligible_nm(fit).powi(2);
        let unexplained_nm2 = fit.rmse_nm.powi(2) - self.noise_nm.map_or(0.0, |noise_nm| noise_nm.powi(2));
        // What is to be gained is negligible: no clearance needs to be tried.
        if unexplained_nm2 <= negligible_nm2 {
            return check(0.0, String::new());
        }
        // Reversals at the top and at the bottom alternate: an odd step takes both.
        let step = self.windows.len().div_ceil(WINDOWS_COMPARED) | 1;
        let some: Vec<Window> = self.windows.iter().step_by(step).cloned().collect();
        let some = Fitting { windows: &some, ..*self };
        let samples = some.windows.iter().map(|w| w.judged.len()).sum::<usize>() as f64;
        let square_nm2 = |sums: &[f64]| total(sums) / samples;
        let here = some.sums(&fit.curve, declared_rad);
        let probe_rad = BACKLASH_PROBE * self.stroke_rad;
        let smaller = SMALLER.map(|step| declared_rad / step);
        let larger = LARGER.map(|step| (declared_rad * step).max(probe_rad));
        let others = smaller.into_iter().chain(larger).map(|at| (at, some.best_sums(fit.kind, at)));
        let (other_rad, there) = others.min_by(|a, b| total(&a.1).total_cmp(&total(&b.1)))?;
        let gained_nm2 = square_nm2(&here) - square_nm2(&there);
        let is_clear = gained_nm2 > negligible_nm2.max(BACKLASH_DOUBT * unexplained_nm2);
        let value = if is_clear { chance(&here, &there).max(0.0) } else { 0.0 };
        if value.is_nan() || value <= BACKLASH_CHANCE {
            return check(value, String::new());
        }
        let (told_rad, told_nm2) = some.told(fit.kind, other_rad, total(&there));
        let mm = |rad: f64| 1e3 * rad * self.model.joint.pulley_radius_m;
        let failure = format!(
            "the reversals ask for a {} clearance than the declared backlash_m = {:.2} mm: one of about {:.2} mm leaves {:.1} mN m \
             after reversals, the declared one {:.1}; correct it, or try --estimate-backlash; until then the curve's parameters do \
             not count as pinned",
            if told_rad < declared_rad { "smaller" } else { "larger" },
            mm(declared_rad),
            mm(told_rad),
            1e3 * (told_nm2 / samples).sqrt(),
            1e3 * square_nm2(&here).sqrt(),
        );
        check(value, failure)
    }

    /// The sums of squares in each window of the curve that is best at a clearance of `backlash_rad`; `kind` is the one that the
    /// declared clearance supports.
    fn best_sums(&self, kind: CurveKind, backlash_rad: f64) -> Vec<f64> {
        // A jump does not know the clearance; a straight line through one does. Otherwise the kind that fits best at a wrong
        // clearance need not be the one that fits best at the right one.
        let kinds: &[CurveKind] =
            if kind == CurveKind::Sign { &[CurveKind::Linear] } else { &[CurveKind::Arctan, CurveKind::Power] };
        let best_of = |kind: &CurveKind| {
            let cost = |log: f64| self.cost(&kind.with(log.exp()), backlash_rad);
            let parameter =
                kind.range().map_or(1.0, |(low, high)| lowest(low.ln(), high.ln(), SECTIONS_COMPARED, cost).0.exp());
            self.sums(&kind.with(parameter), backlash_rad)
        };
        kinds.iter().map(best_of).min_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or_default()
    }

    /// The best clearance near `about_rad`, where the curves leave a sum of squares of `least`, and the sum it leaves.
    fn told(&self, kind: CurveKind, about_rad: f64, least: f64) -> (f64, f64) {
        let (low, high) = ((about_rad / NEIGHBOUR).ln(), (about_rad * NEIGHBOUR).ln());
        let (log, sum) = lowest(low, high, SECTIONS_TOLD, |log| total(&self.best_sums(kind, log.exp())));
        if sum < least { (log.exp(), sum) } else { (about_rad, least) }
    }
}

fn total(sums: &[f64]) -> f64 {
    sums.iter().sum()
}

/// The mean share by which `sums` of the same windows are larger than `others`, in standard errors; NaN of a single window.
///
/// Shares rather than sums: a window may hold one reversal or a whole cascade, slow or smeared by the low-pass, and such
/// differences between windows would pass for chance.
fn chance(sums: &[f64], others: &[f64]) -> f64 {
    let shares: Vec<f64> = sums.iter().zip(others).map(|(a, b)| (a - b) / (a + b).max(f64::MIN_POSITIVE)).collect();
    let (gain, error) = excess(&shares, &vec![0.0; shares.len()]);
    gain / error
}

/// Standard errors of the `free` parameters, clustered by window: errors of one reversal hang together.
fn standard_errors(residuals: &dyn Fn(&[f64]) -> Vec<Vec<f64>>, start: &[f64], free: &[usize]) -> Vec<(usize, f64)> {
    const STEP: f64 = 1e-3;
    let here = residuals(start);
    let slopes: Vec<Vec<Vec<f64>>> = free
        .iter()
        .map(|i| {
            let moved = |by: f64| {
                let mut q = start.to_vec();
                q[*i] += by;
                residuals(&q)
            };
            let (ahead, behind) = (moved(STEP), moved(-STEP));
            let slope = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(x, y)| (x - y) / (2.0 * STEP)).collect();
            ahead.iter().zip(&behind).map(slope).collect()
        })
        .collect();
    let n = free.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let score = |(w, errors): (usize, &Vec<f64>)| DVector::from_fn(n, |i, _| dot(&slopes[i][w], errors));
    let scores: Vec<DVector<f64>> = here.iter().enumerate().map(score).collect();
    let normal = |i: usize, j: usize| slopes[i].iter().zip(&slopes[j]).map(|(a, b)| dot(a, b)).sum();
    let Some(bread) = DMatrix::from_fn(n, n, normal).try_inverse() else {
        return free.iter().map(|i| (*i, f64::INFINITY)).collect();
    };
    let covariance = cluster::covariance(&bread, &scores);
    free.iter().enumerate().map(|(k, i)| (*i, covariance[(k, k)].max(0.0).sqrt())).collect()
}

/// The place in `range` with the least cost, looked for in its logarithm, and that cost.
fn golden((low, high): (f64, f64), cost: impl Fn(f64) -> f64) -> (f64, f64) {
    let (log, least) = lowest(low.ln(), high.ln(), SECTIONS, |log| cost(log.exp()));
    (log.exp(), least)
}

/// A coarse scan first, for the cost over X_cl need not have a single valley; then golden section in the best one.
fn scan_then_golden((low, high): (f64, f64), cost: impl Fn(f64) -> f64 + Sync) -> f64 {
    const SCAN: usize = 12;
    let at = |i: usize| low * (high / low).powf(i as f64 / (SCAN - 1) as f64);
    let costs: Vec<f64> = (0..SCAN).into_par_iter().map(|i| cost(at(i))).collect();
    let best = (0..SCAN).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
    golden((at(best.saturating_sub(1)), at((best + 1).min(SCAN - 1))), cost).0
}
