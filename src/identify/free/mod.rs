//! Campaigns without sweeps: friction and combination from free motion.
//!
//! A(v) and B(v) are not to be had: no leg holds one speed. What the motion shows is fitted on whole series instead, in forms
//! of growing size with every curve, each judged on strokes that its fit never saw. What the motion cannot show keeps its
//! neutral value and is marked `flat`.

mod clearance;
mod halves;
mod search;

use super::combination::{CombinationFit, CurveFit, CurveKind, Settings, best_supported, overlay};
use super::moving::{Limits, MAX_BACKLASH};
use super::predicted::Prepared;
use super::support::supported;
use super::whole::{WholeFit, rmse_nm};
use crate::model::Model;
use crate::numerics::statistics::standard_deviation;
use crate::problem::Result;
use halves::Halves;
use rayon::prelude::*;
use search::{Judged, Search, start};
use std::path::Path;

/// A form of friction, the smallest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FreeForm {
    /// a_j and d.
    Viscous,
    /// And mu_c: friction that grows with the load carried.
    Load,
    /// And one exponential, b_j and c_j.
    Stribeck,
}

impl FreeForm {
    /// All, the smallest first.
    pub const ALL: [Self; 3] = [Self::Viscous, Self::Load, Self::Stribeck];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Viscous => "Coulomb and viscous",
            Self::Load => "Coulomb, viscous and load",
            Self::Stribeck => "Coulomb, viscous, load and one Stribeck term",
        }
    }

    fn parameters(self) -> &'static [usize] {
        match self {
            Self::Viscous => &[1, 6],
            Self::Load => &[0, 1, 6],
            Self::Stribeck => &[0, 1, 4, 5, 6],
        }
    }
}

/// The result on free motion.
#[derive(Debug, Clone)]
pub struct FreeFit {
    /// Each form with the curve taken, and its RMSE on strokes that its fit did not see, N m.
    pub forms: Vec<(FreeForm, f64)>,
    /// The form taken.
    pub form: FreeForm,
    /// RMSE of the taken form and curve on strokes that their fit did not see, N m.
    pub held_out_nm: f64,
    /// The fit on all samples.
    pub fit: WholeFit,
    /// The curves side by side, with the form taken.
    pub combination: CombinationFit,
}

/// Fits `trials`, starting from `model`'s geometry and rigid body.
///
/// Errors: too few strokes to fit and to judge; `campaign` is the file named.
pub fn fit_free(
    trials: &[Prepared],
    model: &Model,
    lowpass_hz: f64,
    settings: Settings,
    campaign: &Path,
) -> Result<FreeFit> {
    let limits = Limits::new(trials, model);
    let estimate_backlash = settings.estimate_backlash;
    let widest_rad = if estimate_backlash { MAX_BACKLASH * limits.stroke_rad } else { model.joint.backlash_rad() };
    let halves = Halves::new(trials, widest_rad, lowpass_hz, campaign)?;
    let start = start(trials, model);
    let search = Search { halves: &halves, start: &start, limits: &limits, estimate_backlash };
    let judged: Vec<Vec<Judged>> =
        CurveKind::ALL.par_iter().map(|kind| search.judge(*kind, &FreeForm::ALL)).collect();
    let choice = choose(&judged, settings.wanted);
    let Choice { form, taken, .. } = choice;
    let fit = |kind: CurveKind| search.fit(kind, FreeForm::ALL[form], &judged[kind as usize][form].models);
    let fits: Vec<WholeFit> = CurveKind::ALL.par_iter().map(|kind| fit(*kind)).collect();
    let spread_nm = spread_nm(trials);
    let curve = |(kind, fit): (&CurveKind, &WholeFit)| {
        let rmse_nm = rmse_nm(&judged[*kind as usize][form].sums);
        let r_squared = 1.0 - (rmse_nm / spread_nm).powi(2);
        let curve = fit.model.combination;
        CurveFit { kind: *kind, curve, backlash_m: fit.model.joint.backlash_m, rmse_nm, r_squared }
    };
    let curves = CurveKind::ALL.iter().zip(&fits).map(curve).collect();
    let fit = fits[taken].clone();
    let mut combination = overlay(trials, &fit.model, lowpass_hz, curves, choice.supported, taken);
    let at = clearance::Question { kind: CurveKind::ALL[taken], form: FreeForm::ALL[form], lowpass_hz, campaign };
    combination.warnings.extend(if estimate_backlash {
        clearance::limit_warning(&fit, &limits)
    } else {
        clearance::doubt(trials, &search, &at)
    });
    Ok(FreeFit {
        forms: FreeForm::ALL.iter().zip(&judged[taken]).map(|(form, j)| (*form, rmse_nm(&j.sums))).collect(),
        form: FreeForm::ALL[form],
        held_out_nm: rmse_nm(&judged[taken][form].sums),
        fit,
        combination,
    })
}

/// Places of the form in `FreeForm::ALL` and of the curves in `CurveKind::ALL`.
struct Choice {
    form: usize,
    supported: usize,
    taken: usize,
}

/// The form and the curve that support each other: the curve judged with that form, the form with that curve.
fn choose(judged: &[Vec<Judged>], wanted: Option<CurveKind>) -> Choice {
    let mut form = FreeForm::ALL.len() - 1;
    loop {
        let curves: Vec<Vec<f64>> = judged.iter().map(|forms| forms[form].squares()).collect();
        let supported_curve = best_supported(&curves);
        let taken = wanted.map_or(supported_curve, |kind| kind as usize);
        let forms: Vec<Vec<f64>> = judged[taken].iter().map(Judged::squares).collect();
        let supported_form = supported(&forms, |_| true);
        // A form never grows again, so that this ends.
        if supported_form >= form {
            return Choice { form, supported: supported_curve, taken };
        }
        form = supported_form;
    }
}

/// Standard deviation of the measured torque, N m.
fn spread_nm(trials: &[Prepared]) -> f64 {
    let all: Vec<f64> = trials.iter().flat_map(|t| t.series.torque_nm.iter().copied()).collect();
    standard_deviation(&all)
}
