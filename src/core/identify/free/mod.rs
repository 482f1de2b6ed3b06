//! Campaigns without sweeps: friction and combination from free motion.
//!
//! A(v) and B(v) cannot be identified: no leg holds one speed. What the motion shows is fitted on whole series instead, in forms
//! of growing size with every curve, each validated on held-out strokes. What the motion cannot show keeps its
//! neutral value and is marked `flat`.

mod choice;
mod clearance;
mod halves;
mod search;

use super::checks::Check;
use super::combination::{CombinationFit, CurveFit, CurveKind, Settings, overlay};
use super::moving::{Free, Limits, MAX_BACKLASH};
use super::predicted::Prepared;
use super::whole::{WholeFit, rmse_nm};
use crate::model::{Confidence, Direction, Drive, Model, Term};
use crate::numerics::statistics::{extent, standard_deviation};
use crate::problem::Result;
use choice::Choice;
use clearance::{Question, doubt, limit_warning};
use halves::Halves;
use rayon::prelude::*;
use search::{Search, start};
use std::path::Path;

/// A form of friction, the smallest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FreeForm {
    /// a_j and d.
    Viscous,
    /// And mu_c: friction that grows with the load carried.
    Load,
    /// And the effect of friction that grows with the load's size, whichever way it acts: what a gear loses.
    Carried,
    /// And one exponential, b_j and c_j.
    Stribeck,
}

impl FreeForm {
    /// All, the smallest first.
    pub const ALL: [Self; 4] = [Self::Viscous, Self::Load, Self::Carried, Self::Stribeck];

    /// In words.
    pub fn name(self, is_loaded: bool) -> &'static str {
        match (self, is_loaded) {
            (Self::Viscous, _) | (Self::Load, false) => "Coulomb and viscous",
            (Self::Load, true) => "Coulomb, viscous and load",
            (Self::Carried, _) => "Coulomb, viscous, load and the load's size",
            (Self::Stribeck, true) => "Coulomb, viscous, load and one Stribeck term",
            (Self::Stribeck, false) => "Coulomb, viscous and one Stribeck term",
        }
    }

    /// Its parameters; without a load that changes, mu_c is only a factor of all the others.
    fn parameters(self, is_loaded: bool) -> &'static [Term] {
        match (self, is_loaded) {
            (Self::Viscous, _) | (Self::Load, false) => &[Term::Coulomb, Term::Viscous],
            (Self::Load, true) | (Self::Carried, _) => &[Term::Load, Term::Coulomb, Term::Viscous],
            (Self::Stribeck, true) => {
                &[Term::Load, Term::Coulomb, Term::JointStribeck, Term::JointDecay, Term::Viscous]
            }
            (Self::Stribeck, false) => &[Term::Coulomb, Term::JointStribeck, Term::JointDecay, Term::Viscous],
        }
    }
}

/// The result on free motion.
#[derive(Debug, Clone)]
pub struct FreeFit {
    /// Each form with the curve taken, and its RMSE on strokes that its fit did not see, N m.
    pub forms: Vec<(FreeForm, f64)>,
    /// Whether the load changes along the motion; else mu_c cannot be identified.
    pub is_loaded: bool,
    /// The form taken.
    pub form: FreeForm,
    /// RMSE of the taken form and curve on strokes that their fit did not see, N m.
    pub held_out_nm: f64,
    /// The fit on all samples.
    pub fit: WholeFit,
    /// The fit that tells what A and B(v) are known to: with a load that changes never without mu_c, which the form taken may
    /// leave at 0.
    pub of_functions: WholeFit,
    /// The curves side by side, with the form taken.
    pub combination: CombinationFit,
}

impl FreeFit {
    /// The share of the load's size by which friction grows in `direction`, and what is known of it; nothing where the form taken has none.
    pub fn share_of_load(&self, direction: Direction) -> Option<(f64, Confidence)> {
        let free = Free::Carried(direction);
        let (_, known) = self.fit.confidence.iter().find(|(name, _)| *name == free.name())?;
        Some((free.read(&self.fit.model), *known))
    }
}

/// Fits `trials`, starting from `model`'s geometry and rigid body; `folds` says which half each trial belongs to where whole
/// trials are held out.
/// `zero_rad` is how far the zero of the position may be off: it is fitted once form and curve are chosen.
///
/// Errors: too few strokes to fit and to judge; `campaign` is the file named.
pub fn fit_free(
    trials: &[Prepared],
    folds: &[usize],
    model: &Model,
    lowpass_hz: f64,
    settings: Settings,
    zero_rad: f64,
    campaign: &Path,
) -> Result<FreeFit> {
    let limits = Limits::new(trials, model, zero_rad);
    let estimate_backlash = settings.estimate_backlash;
    let widest_rad = if estimate_backlash { MAX_BACKLASH * limits.stroke_rad } else { model.joint.backlash_rad() };
    let halves = Halves::new(trials, folds, widest_rad, lowpass_hz, campaign)?;
    let is_loaded = is_loaded(trials, model);
    let start = start(trials, model, is_loaded);
    let forms = forms(trials, model, is_loaded);
    let search =
        Search { halves: &halves, start: &start, limits: &limits, estimate_backlash, is_loaded, forms: &forms };
    let choice = Choice::new(&search, settings.wanted);
    let Choice { form, kind, .. } = choice;
    let fit = search.fit(kind, form, choice.judged(kind, form));
    let of_functions = match form {
        FreeForm::Viscous if is_loaded => search.fit(kind, FreeForm::Load, choice.judged(kind, FreeForm::Load)),
        _ => fit.clone(),
    };
    let spread_nm = spread_nm(trials);
    let curve = |other: &CurveKind| {
        let judged = choice.judged(*other, form);
        let rmse_nm = rmse_nm(&judged.sums);
        let r_squared = 1.0 - (rmse_nm / spread_nm).powi(2);
        let model = if *other == kind { fit.model.clone() } else { search.model(*other, form, judged) };
        CurveFit { kind: *other, curve: model.combination, backlash_m: model.joint.backlash_m, rmse_nm, r_squared }
    };
    let curves = CurveKind::ALL.par_iter().map(curve).collect();
    let mut combination = overlay(trials, &fit.model, lowpass_hz, curves, choice.supported as usize, kind as usize);
    let asked = Question { kind, form, folds, lowpass_hz, campaign };
    if estimate_backlash {
        combination.warnings.extend(limit_warning(&fit, &limits));
    } else {
        combination.checks.extend(doubt(trials, &search, &asked));
        combination.warnings.extend(combination.checks.iter().filter_map(Check::warning));
    }
    Ok(FreeFit {
        forms: forms
            .iter()
            .filter(|form| is_loaded || **form != FreeForm::Load)
            .map(|form| (*form, rmse_nm(&choice.judged(kind, *form).sums)))
            .collect(),
        is_loaded,
        held_out_nm: rmse_nm(&choice.judged(kind, form).sums),
        form,
        fit,
        of_functions,
        combination,
    })
}

/// The forms worth trying. The size of the load is distinguishable from the load where that changes sign; a cable's load term is the
/// paper's.
fn forms(trials: &[Prepared], model: &Model, is_loaded: bool) -> Vec<FreeForm> {
    /// Share of the largest load that must act the other way, too.
    const BOTH_WAYS: f64 = 0.2;
    let (low, high) = extent(&loads_nm(trials, model));
    let acts_both_ways = (-low).min(high) > BOTH_WAYS * (-low).max(high);
    let is_carried = is_loaded && acts_both_ways && model.joint.drive != Drive::Cable;
    FreeForm::ALL.into_iter().filter(|form| is_carried || *form != FreeForm::Carried).collect()
}

/// Whether the load at the joint varies by a large enough share of the measured torque to separate friction in proportion to it from the
/// rest.
fn is_loaded(trials: &[Prepared], model: &Model) -> bool {
    /// Share of the measured torque's spread.
    const SEEN: f64 = 0.01;
    model.joint.transmission() * standard_deviation(&loads_nm(trials, model)) > SEEN * spread_nm(trials)
}

/// The load at the joint at all samples, N m.
fn loads_nm(trials: &[Prepared], model: &Model) -> Vec<f64> {
    let load = |trial: &Prepared| {
        let of = trial.series.joint_torque_nm(&model.dynamics);
        (0..trial.series.torque_nm.len()).map(of).collect::<Vec<f64>>()
    };
    trials.iter().flat_map(load).collect()
}

/// Standard deviation of the measured torque, N m.
fn spread_nm(trials: &[Prepared]) -> f64 {
    let all: Vec<f64> = trials.iter().flat_map(|t| t.series.torque_nm.iter().copied()).collect();
    standard_deviation(&all)
}
