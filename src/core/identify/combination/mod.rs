//! How friction changes over: `sign`, `linear`, `arctan` (29) and `power` (30) side by side, on the samples after reversals.
//!
//! Prediction and measurement are compared after the same low-pass, so that a fast reversal, which the filter smears, still
//! tells the truth. k of (29) follows from p: K~ must reach 1 when K_f does, hence k = 1 / atan(2 p) (the paper's own
//! 0.752 and 2.011 keep that to 0.2 %).

mod curves;
mod fitting;
mod reach;

pub use curves::{CurveFit, CurveKind};

use super::checks::Check;
use super::confidence::demote;
use super::predicted::Prepared;
use super::support::supported;
use super::windows::{Crossing, Window};
use crate::model::{Confidence, Model};
use fitting::Fitting;
use reach::Reach;

/// A curve whose residual exceeds that of sliding by more than this factor does not describe the change-over, ...
const MISFIT: f64 = 4.0;
/// ... unless its residual is at most this share of the change of friction, or within the error of an encoder's steps.
const NEGLIGIBLE: f64 = 0.01;

/// Settings of this stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settings {
    /// The curve to take whatever the data support, by name.
    pub wanted: Option<CurveKind>,
    /// Whether to find X_cl from the reversals rather than take the campaign's.
    pub estimate_backlash: bool,
}

/// Which samples the curves are judged on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JudgedOn {
    /// Those after reversals, to which they were fitted.
    Reversals,
    /// Whole strokes that the fit did not see.
    UnseenStrokes,
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
    /// What their residuals are of.
    pub judged_on: JudgedOn,
    /// Reversals used.
    pub windows: usize,
    /// Samples in them.
    pub samples: usize,
    /// Points of figure 6.
    pub crossings: Vec<Crossing>,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Checks of the curve and of the clearance; `confidence` is demoted already where one fails.
    pub checks: Vec<Check>,
}

impl CombinationFit {
    /// The fit that the model took.
    pub fn curve(&self) -> &CurveFit {
        &self.curves[self.taken]
    }
}

/// Fits all curves to the reversals in `trials` with the friction of `model`; `noise_nm` is the model's residual in sliding at constant
/// speed, if known. `None` when there is no usable reversal.
pub fn fit_combination(
    trials: &[Prepared],
    model: &Model,
    lowpass_hz: f64,
    settings: Settings,
    noise_nm: Option<f64>,
) -> Option<CombinationFit> {
    let declared_rad = model.joint.backlash_rad();
    let reach = Reach::new(trials, model, settings);
    let all = reach.windows(trials, model, lowpass_hz)?;
    let step_rad = trials.iter().map(|t| t.series.step_rad).fold(0.0, f64::max);
    let (backlash_span_rad, stroke_rad) = (reach.span_rad, reach.stroke_rad);
    let fitting = Fitting { windows: &all, model, backlash_span_rad, stroke_rad, step_rad, noise_nm };
    let (curves, sums): (Vec<CurveFit>, Vec<Vec<f64>>) = CurveKind::ALL.iter().map(|kind| fitting.fit(*kind)).unzip();
    let supported = best_supported(&sums);
    let taken = settings.wanted.and_then(|w| curves.iter().position(|c| c.kind == w)).unwrap_or(supported);
    let backlash_rad = curves[taken].backlash_m / model.joint.pulley_radius_m;
    let mut confidence = fitting.confidence(&curves[taken]);
    let negligible_nm = fitting.negligible_nm(&curves[taken]);
    let mut checks: Vec<Check> = fitting.clearance(&curves[supported], declared_rad).into_iter().collect();
    checks.extend(noise_nm.map(|noise_nm| curve_check(&curves[taken], noise_nm, negligible_nm)));
    let warnings = checks.iter().filter_map(Check::warning).collect();
    if checks.iter().any(|check| !check.passes()) {
        demote(confidence.iter_mut().map(|(_, known)| known));
    }
    Some(CombinationFit {
        windows: all.len(),
        samples: all.iter().map(|w| w.judged.len()).sum(),
        crossings: all.iter().flat_map(|w| w.crossings(model, backlash_rad, lowpass_hz)).collect(),
        curves,
        supported,
        taken,
        judged_on: JudgedOn::Reversals,
        confidence,
        warnings,
        checks,
    })
}

/// The curve wanted, or else arctan, fitted alone: what it takes to compare one friction with another. `None` when there is no
/// usable reversal.
pub fn fit_one(trials: &[&Prepared], model: &Model, lowpass_hz: f64, settings: Settings) -> Option<CurveFit> {
    let reach = Reach::new(trials, model, settings);
    let all = reach.windows(trials, model, lowpass_hz)?;
    let (backlash_span_rad, stroke_rad) = (reach.span_rad, reach.stroke_rad);
    let fitting = Fitting { windows: &all, model, backlash_span_rad, stroke_rad, step_rad: 0.0, noise_nm: None };
    Some(fitting.fit(settings.wanted.unwrap_or(CurveKind::Arctan)).0)
}

/// Whether the curve describes the change-over, where sliding leaves `noise_nm`.
fn curve_check(fit: &CurveFit, noise_nm: f64, negligible_nm: f64) -> Check {
    let value = fit.rmse_nm / noise_nm;
    let limit = MISFIT.max(negligible_nm / noise_nm);
    Check {
        name: "curve_describes",
        concerns: vec!["combination.".into()],
        value,
        limit,
        failure: misfit(fit, noise_nm),
    }
}

fn misfit(fit: &CurveFit, noise_nm: f64) -> String {
    format!(
        "no curve describes the change-over: `{}` leaves {:.1} mN m after reversals where sliding leaves {:.1}; its parameters \
         are not to be read",
        fit.kind.name(),
        1e3 * fit.rmse_nm,
        1e3 * noise_nm
    )
}

/// `curves` already judged on strokes not seen, with the points of figure 6 from `trials` under `model`.
pub fn overlay(
    trials: &[Prepared],
    model: &Model,
    lowpass_hz: f64,
    curves: Vec<CurveFit>,
    supported: usize,
    taken: usize,
) -> CombinationFit {
    let all = Reach::as_declared(trials, model).windows(trials, model, lowpass_hz).unwrap_or_default();
    let crossings = |w: &Window| w.crossings(model, model.joint.backlash_rad(), lowpass_hz);
    CombinationFit {
        windows: all.len(),
        samples: all.iter().map(|w| w.judged.len()).sum(),
        crossings: all.iter().flat_map(crossings).collect(),
        curves,
        supported,
        taken,
        judged_on: JudgedOn::UnseenStrokes,
        confidence: Vec::new(),
        warnings: Vec::new(),
        checks: Vec::new(),
    }
}

/// Which of `CurveKind::ALL` the sums of squares support, given for each curve and each of the same stretches of data:
/// the best, or the simplest without a parameter that is as good.
pub fn best_supported(sums: &[Vec<f64>]) -> usize {
    supported(sums, |i| CurveKind::ALL[i].range().is_none())
}
