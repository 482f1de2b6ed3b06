//! How friction changes over: `sign`, `linear`, `arctan` (29) and `power` (30) side by side, on the samples after reversals.
//!
//! Prediction and measurement are compared after the same low-pass, so that a fast reversal, which the filter smears, still
//! tells the truth. k of (29) follows from p: K~ must reach 1 when K_f does, hence k = 1 / atan(2 p) (the paper's own
//! 0.752 and 2.011 keep that to 0.2 %).

use super::predicted::Prepared;
use super::windows::{Crossing, Window, windows};
use crate::model::{Combination, Confidence, Model};
use crate::numerics::statistics::{mean, standard_deviation, student_t};
use rayon::prelude::*;

/// Range of p searched: from nearly a straight line to nearly a step.
const P_RANGE: (f64, f64) = (0.02, 100.0);
/// Range of n searched, likewise.
const N_RANGE: (f64, f64) = (0.02, 10.0);
/// Golden sections: each leaves 0.618 of the log range, 18 of them 0.15 % of it.
const SECTIONS: usize = 18;
/// A window follows the motion after a reversal for this many clearances.
const REACH_BACKLASHES: f64 = 1.5;
/// When the clearance is estimated, up to this share of the median stroke.
const REACH_STROKE: f64 = 0.5;
/// The smallest clearance looked for, in deadbands of the encoder.
const MIN_DEADBANDS: f64 = 3.0;

/// Settings of this stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settings {
    /// The curve to take whatever the data support, by name.
    pub wanted: Option<CurveKind>,
    /// Whether to find X_cl from the reversals rather than take the campaign's.
    pub estimate_backlash: bool,
}

/// A curve without its parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurveKind {
    /// (20).
    Sign,
    /// (25).
    Linear,
    /// (29).
    Arctan,
    /// (30).
    Power,
}

impl CurveKind {
    /// All, the simplest first.
    pub const ALL: [Self; 4] = [Self::Sign, Self::Linear, Self::Arctan, Self::Power];

    /// The name used in files.
    pub fn name(self) -> &'static str {
        self.with(1.0).name()
    }

    /// The curve with its parameter, p or n, if it has one.
    pub fn with(self, parameter: f64) -> Combination {
        match self {
            Self::Sign => Combination::Sign,
            Self::Linear => Combination::Linear,
            Self::Arctan => Combination::arctan(parameter),
            Self::Power => Combination::Power { n: parameter },
        }
    }

    /// The range of the parameter; `None` for a curve without.
    pub fn range(self) -> Option<(f64, f64)> {
        match self {
            Self::Sign | Self::Linear => None,
            Self::Arctan => Some(P_RANGE),
            Self::Power => Some(N_RANGE),
        }
    }
}

/// One curve's fit.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveFit {
    /// Which.
    pub kind: CurveKind,
    /// With its parameter.
    pub curve: Combination,
    /// X_cl it was fitted with, m.
    pub backlash_m: f64,
    /// Residual on the samples after reversals; on trials that the fit did not see where there are no sweeps. N m.
    pub rmse_nm: f64,
    /// Share of those samples' variance that is explained.
    pub r_squared: f64,
}

/// The stage's result.
#[derive(Debug, Clone)]
pub struct CombinationFit {
    /// All four, simplest first.
    pub curves: Vec<CurveFit>,
    /// The place in `curves` of the one that the data support best.
    pub supported: usize,
    /// The place of the one that the model took.
    pub taken: usize,
    /// What is known of p or n and of X_cl: dotted parameter names.
    pub confidence: Vec<(String, Confidence)>,
    /// Reversals used.
    pub windows: usize,
    /// Samples in them.
    pub samples: usize,
    /// Points of figure 6.
    pub crossings: Vec<Crossing>,
    /// What to distrust.
    pub warnings: Vec<String>,
}

impl CombinationFit {
    /// The fit that the model took.
    pub fn curve(&self) -> &CurveFit {
        &self.curves[self.taken]
    }
}

/// Fits all curves to the reversals in `trials` with the friction of `model`; `None` when there is no usable reversal.
pub fn fit_combination(
    trials: &[Prepared],
    model: &Model,
    lowpass_hz: f64,
    settings: Settings,
) -> Option<CombinationFit> {
    let stroke_rad = median_stroke_rad(trials);
    let declared_rad = model.joint.backlash_rad();
    let reach_rad = if settings.estimate_backlash {
        (REACH_STROKE * stroke_rad).max(REACH_BACKLASHES * declared_rad)
    } else {
        (REACH_BACKLASHES * declared_rad).min(stroke_rad)
    };
    let all: Vec<Window> =
        trials.par_iter().flat_map_iter(|trial| windows(trial, model, reach_rad, lowpass_hz)).collect();
    if all.is_empty() {
        return None;
    }
    let deadband_rad = trials.iter().map(|t| t.series.deadband_rad).fold(0.0, f64::max);
    let span = settings.estimate_backlash.then(|| ((MIN_DEADBANDS * deadband_rad).max(1e-3 * reach_rad), reach_rad));
    let fitting = Fitting { windows: &all, model, backlash_span_rad: span };
    let (curves, sums): (Vec<CurveFit>, Vec<Vec<f64>>) = CurveKind::ALL.iter().map(|kind| fitting.fit(*kind)).unzip();
    let supported = best_supported(&sums);
    let taken = settings.wanted.and_then(|w| curves.iter().position(|c| c.kind == w)).unwrap_or(supported);
    let backlash_rad = curves[taken].backlash_m / model.joint.pulley_radius_m;
    let (confidence, warnings) = fitting.confidence(&curves[taken], declared_rad);
    Some(CombinationFit {
        windows: all.len(),
        samples: all.iter().map(|w| w.judged.len()).sum(),
        crossings: all.iter().flat_map(|w| w.crossings(model, backlash_rad, lowpass_hz)).collect(),
        curves,
        supported,
        taken,
        confidence,
        warnings,
    })
}

/// `curves` already judged, with the points of figure 6 that `model` makes of `trials`.
pub fn overlay(
    trials: &[Prepared],
    model: &Model,
    lowpass_hz: f64,
    curves: Vec<CurveFit>,
    supported: usize,
    taken: usize,
) -> CombinationFit {
    let reach_rad = (REACH_BACKLASHES * model.joint.backlash_rad()).min(median_stroke_rad(trials));
    let all: Vec<Window> =
        trials.par_iter().flat_map_iter(|trial| windows(trial, model, reach_rad, lowpass_hz)).collect();
    let crossings = |w: &Window| w.crossings(model, model.joint.backlash_rad(), lowpass_hz);
    CombinationFit {
        windows: all.len(),
        samples: all.iter().map(|w| w.judged.len()).sum(),
        crossings: all.iter().flat_map(crossings).collect(),
        curves,
        supported,
        taken,
        confidence: Vec::new(),
        warnings: Vec::new(),
    }
}

fn median_stroke_rad(trials: &[Prepared]) -> f64 {
    let mut strokes: Vec<f64> = Vec::new();
    for trial in trials {
        let turns = trial.reversals();
        let at = |i: usize| trial.series.position_rad[turns[i].0];
        strokes.extend((1..turns.len()).map(|i| (at(i) - at(i - 1)).abs()));
        if turns.len() < 2 {
            let (low, high) =
                trial.series.position_rad.iter().fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
            strokes.push((high - low).max(0.0));
        }
    }
    crate::numerics::statistics::quantile(&mut strokes, 0.5)
}

/// Which of `CurveKind::ALL` the sums of squares support, given for each curve and each of the same stretches of data:
/// the best, or the simplest without a parameter that is no worse by more than one standard error over the stretches.
pub fn best_supported(sums: &[Vec<f64>]) -> usize {
    let total = |i: &usize| sums[*i].iter().sum::<f64>();
    let best = (0..sums.len()).min_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or(0);
    let as_good = |i: &usize| {
        let excess: Vec<f64> = sums[*i].iter().zip(&sums[best]).map(|(a, b)| a - b).collect();
        let error = standard_deviation(&excess) / (excess.len() as f64).sqrt();
        CurveKind::ALL[*i].range().is_none() && mean(&excess) <= error
    };
    (0..best).find(as_good).unwrap_or(best)
}

struct Fitting<'a> {
    windows: &'a [Window<'a>],
    model: &'a Model,
    /// Where X_cl / r2 is looked for; `None` keeps the model's.
    backlash_span_rad: Option<(f64, f64)>,
}

impl Fitting<'_> {
    fn sums(&self, curve: &Combination, backlash_rad: f64) -> Vec<f64> {
        let sum = |w: &Window| w.residual_nm(self.model, curve, backlash_rad).iter().map(|r| r * r).sum();
        self.windows.par_iter().map(sum).collect()
    }

    fn cost(&self, curve: &Combination, backlash_rad: f64) -> f64 {
        self.sums(curve, backlash_rad).iter().sum()
    }

    fn fit(&self, kind: CurveKind) -> (CurveFit, Vec<f64>) {
        let at = |backlash_rad: f64| match kind.range() {
            None => (1.0, self.cost(&kind.with(1.0), backlash_rad)),
            Some(range) => golden(range, SECTIONS, |x| self.cost(&kind.with(x), backlash_rad)),
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

    /// Intervals of p or n and X_cl by the sandwich over windows, whose errors are independent where samples' are not; and
    /// a word when the reversals contradict the declared clearance.
    fn confidence(&self, fit: &CurveFit, declared_rad: f64) -> (Vec<(String, Confidence)>, Vec<String>) {
        let mut known = Vec::new();
        let mut warnings = Vec::new();
        if fit.kind == CurveKind::Sign || fit.backlash_m <= 0.0 {
            return (known, warnings);
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
        for (i, se) in standard_errors(&residuals, &start, &free) {
            let range = if i == 0 { self.backlash_span_rad } else { fit.kind.range() };
            let at_bound = range.is_some_and(|(low, high)| start[i] - low.ln() < 0.02 || high.ln() - start[i] < 0.02);
            let half = student_t(self.windows.len() as f64 - free.len() as f64) * se;
            let scale = if i == 0 { self.model.joint.pulley_radius_m } else { 1.0 };
            let ends = [scale * (start[i] - half).exp(), scale * (start[i] + half).exp()];
            let interval = super::friction::interval(scale * start[i].exp(), ends, 0.0, half / se, 0.0, at_bound);
            known.push((names[i].to_string(), interval));
        }
        if let Some((_, Confidence { low, high, cv, status })) = known.iter().find(|(name, _)| name == "combination.p")
        {
            let of_k = |p: f64| 1.0 / (2.0 * p).atan();
            let k = Confidence { low: of_k(*high), high: of_k(*low), cv: *cv, status: *status };
            known.push(("combination.k".to_string(), k));
        }
        warnings.extend(self.doubt(fit, declared_rad));
        (known, warnings)
    }

    /// A word when another clearance leaves much less than the declared one, the curve fitted anew to each.
    fn doubt(&self, fit: &CurveFit, declared_rad: f64) -> Option<String> {
        if self.backlash_span_rad.is_some() {
            return None;
        }
        let cost = |backlash_rad: f64| match fit.kind.range() {
            None => self.cost(&fit.curve, backlash_rad),
            Some(range) => golden(range, SECTIONS, |x| self.cost(&fit.kind.with(x), backlash_rad)).1,
        };
        let here = self.cost(&fit.curve, declared_rad);
        let words = [("smaller", 1.0 / BACKLASH_STEP), ("larger", BACKLASH_STEP)];
        let better = words.into_iter().find(|(_, factor)| cost(declared_rad * factor) < BACKLASH_DOUBT * here)?;
        Some(format!(
            "the reversals ask for a {} clearance than the declared backlash_m = {:.2} mm; try --estimate-backlash",
            better.0,
            1e3 * fit.backlash_m
        ))
    }
}

/// A clearance smaller or larger by this factor ...
const BACKLASH_STEP: f64 = 1.3;
/// ... that leaves less than this share of the sum of squares contradicts the declared one.
const BACKLASH_DOUBT: f64 = 0.8;

/// Standard errors of the `free` parameters, clustered by window: errors of one reversal hang together.
fn standard_errors(residuals: &dyn Fn(&[f64]) -> Vec<Vec<f64>>, start: &[f64], free: &[usize]) -> Vec<(usize, f64)> {
    use nalgebra::{DMatrix, DVector};
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
    let (mut hessian, mut meat) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
    for (w, errors) in here.iter().enumerate() {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let score = DVector::from_fn(n, |i, _| dot(&slopes[i][w], errors));
        hessian += DMatrix::from_fn(n, n, |i, j| dot(&slopes[i][w], &slopes[j][w]));
        meat += &score * score.transpose();
    }
    let Some(inverse) = hessian.try_inverse() else {
        return free.iter().map(|i| (*i, f64::INFINITY)).collect();
    };
    let small_sample = here.len() as f64 / (here.len() as f64 - n as f64).max(1.0);
    let covariance = &inverse * meat * &inverse * small_sample;
    free.iter().enumerate().map(|(k, i)| (*i, covariance[(k, k)].max(0.0).sqrt())).collect()
}

/// The place in the log of `range` with the least cost by golden section, and that cost.
fn golden((low, high): (f64, f64), sections: usize, cost: impl Fn(f64) -> f64) -> (f64, f64) {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    let (mut a, mut b) = (low.ln(), high.ln());
    let (mut c, mut d) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut fc, mut fd) = (cost(c.exp()), cost(d.exp()));
    for _ in 0..sections {
        if fc < fd {
            (b, d, fd) = (d, c, fc);
            c = b - GOLDEN * (b - a);
            fc = cost(c.exp());
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + GOLDEN * (b - a);
            fd = cost(d.exp());
        }
    }
    if fc < fd { (c.exp(), fc) } else { (d.exp(), fd) }
}

/// A coarse scan first, for the cost over X_cl need not have a single valley; then golden section in the best one.
fn scan_then_golden((low, high): (f64, f64), cost: impl Fn(f64) -> f64 + Sync) -> f64 {
    const SCAN: usize = 12;
    let at = |i: usize| low * (high / low).powf(i as f64 / (SCAN - 1) as f64);
    let costs: Vec<f64> = (0..SCAN).into_par_iter().map(|i| cost(at(i))).collect();
    let best = (0..SCAN).min_by(|a, b| costs[*a].total_cmp(&costs[*b])).unwrap_or(0);
    golden((at(best.saturating_sub(1)), at((best + 1).min(SCAN - 1))), SECTIONS, cost).0
}
