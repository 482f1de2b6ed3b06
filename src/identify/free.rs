//! Campaigns without sweeps: friction and combination from free motion.
//!
//! A(v) and B(v) are not to be had: no leg holds one speed. What the motion shows is fitted on whole series instead, in forms
//! of growing size, each judged on trials that its fit never saw (with a single trial, on its other half). What the motion
//! cannot show keeps its neutral value and is marked `flat`.

use super::combination::{CombinationFit, CurveFit, CurveKind, Settings, best_supported, overlay};
use super::moving::{Free, Limits, MAX_BACKLASH};
use super::predicted::Prepared;
use super::whole::{Part, WholeFit, fit_whole, rmse_nm, square_sums};
use crate::model::{Direction, Friction, Model};
use crate::numerics::statistics::{mean, standard_deviation};
use rayon::prelude::*;

/// Starts of the clearance when it is estimated, as shares of the longest stroke: its cost has several valleys.
const BACKLASH_STARTS: [f64; 3] = [0.02, 0.1, 0.3];
/// Start of p and n: the paper's arctan, and nearly a straight line.
const CURVE_START: f64 = 1.5;

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
    /// Each form with its RMSE on samples that its fit did not see, N m.
    pub forms: Vec<(FreeForm, f64)>,
    /// The form taken.
    pub form: FreeForm,
    /// RMSE of the taken form on samples that its fit did not see, N m.
    pub held_out_nm: f64,
    /// The fit on all samples.
    pub fit: WholeFit,
    /// The curves side by side.
    pub combination: CombinationFit,
}

/// A clearance that leaves this much less of the linear curve's error contradicts the declared one.
const DOUBT: f64 = 0.9;

/// Fits `trials`, starting from `model`'s geometry and rigid body; `folds` says which half each trial belongs to.
pub fn fit_free(trials: &[Prepared], folds: &[usize], model: &Model, lowpass_hz: f64, settings: Settings) -> FreeFit {
    let search = Search::new(trials, folds, model, lowpass_hz, settings.estimate_backlash, &CurveKind::ALL);
    let judged: Vec<Vec<(f64, f64)>> =
        CurveKind::ALL.iter().map(|kind| search.held_out(FreeForm::Load, *kind)).collect();
    let sums: Vec<Vec<f64>> = judged.iter().map(|parts| parts.iter().map(|p| p.0).collect()).collect();
    let supported = best_supported(&sums);
    let taken = settings.wanted.and_then(|w| CurveKind::ALL.iter().position(|k| *k == w)).unwrap_or(supported);
    let kind = CurveKind::ALL[taken];
    let warnings =
        if settings.estimate_backlash { None } else { doubt(trials, folds, model, lowpass_hz, &search, kind) };
    let forms: Vec<(FreeForm, Vec<(f64, f64)>)> =
        FreeForm::ALL.iter().map(|form| (*form, search.held_out(*form, kind))).collect();
    let (form, held_out) = &forms[best_form(&forms)];
    let fit = search.fit(&search.all(), *form, kind);
    let spread_nm = spread_nm(trials);
    let curve = |(kind, parts): (&CurveKind, &Vec<(f64, f64)>)| {
        let own = search.fit(&search.all(), FreeForm::Load, *kind).model;
        let rmse_nm = rmse_nm(parts);
        let r_squared = 1.0 - (rmse_nm / spread_nm).powi(2);
        CurveFit { kind: *kind, curve: own.combination, backlash_m: own.joint.backlash_m, rmse_nm, r_squared }
    };
    let curves = CurveKind::ALL.iter().zip(&judged).map(curve).collect();
    let combination = overlay(trials, &fit.model, lowpass_hz, curves, supported, taken);
    FreeFit {
        combination: CombinationFit { warnings: warnings.into_iter().collect(), ..combination },
        forms: forms.iter().map(|(form, sums)| (*form, rmse_nm(sums))).collect(),
        form: *form,
        held_out_nm: rmse_nm(held_out),
        fit,
    }
}

/// A word when free motion contradicts the declared clearance, judged by the curve of `kind`.
fn doubt(
    trials: &[Prepared],
    folds: &[usize],
    model: &Model,
    lowpass_hz: f64,
    declared: &Search,
    kind: CurveKind,
) -> Option<String> {
    // A jump does not know the clearance; a straight line through one does.
    let kind = if kind == CurveKind::Sign { CurveKind::Linear } else { kind };
    let free = Search::new(trials, folds, model, lowpass_hz, true, &[kind]);
    let error = |search: &Search| search.fit(&free.all(), FreeForm::Load, kind).rmse_nm;
    if error(&free) > DOUBT * error(declared) {
        return None;
    }
    let asked_mm = 1e3 * free.start(kind).joint.backlash_m;
    let declared_mm = 1e3 * model.joint.backlash_m;
    Some(format!(
        "the reversals ask for a clearance near {asked_mm:.2} mm, not the declared backlash_m = {declared_mm:.2} mm; try \
         --estimate-backlash"
    ))
}

/// Two halves of a campaign, each fitted and each judged by the other's fit.
struct Search<'a> {
    halves: [Vec<Part<'a>>; 2],
    /// Where the fits of each of `CurveKind::ALL` start.
    starts: Vec<Model>,
    limits: Limits,
    estimate_backlash: bool,
}

impl<'a> Search<'a> {
    fn new(
        trials: &'a [Prepared],
        folds: &[usize],
        model: &Model,
        lowpass_hz: f64,
        estimate_backlash: bool,
        kinds: &[CurveKind],
    ) -> Self {
        let limits = Limits::new(trials, model);
        let widest_rad = if estimate_backlash { MAX_BACKLASH * limits.stroke_rad } else { model.joint.backlash_rad() };
        let part = |trial, samples| Part::new(trial, samples, widest_rad, lowpass_hz);
        let halves = match trials {
            [single] => {
                let middle = single.len() / 2;
                [vec![part(single, 0..middle)], vec![part(single, middle..single.len())]]
            }
            _ => [0, 1].map(|fold| {
                let mine = trials.iter().zip(folds).filter(|(_, f)| **f == fold);
                mine.map(|(trial, _)| part(trial, 0..trial.len())).collect()
            }),
        };
        let start = start(trials, model);
        let with_curve = |kind: &CurveKind| Model { combination: kind.with(CURVE_START), ..start.clone() };
        let starts: Vec<Model> = CurveKind::ALL.iter().map(with_curve).collect();
        let mut search = Self { halves, starts, limits, estimate_backlash };
        if estimate_backlash {
            let start = |kind: &CurveKind| {
                if kinds.contains(kind) { search.with_backlash(*kind) } else { search.start(*kind).clone() }
            };
            search.starts = CurveKind::ALL.par_iter().map(start).collect();
        }
        search
    }

    fn all(&self) -> Vec<Part<'a>> {
        self.halves.iter().flatten().cloned().collect()
    }

    fn start(&self, kind: CurveKind) -> &Model {
        &self.starts[CurveKind::ALL.iter().position(|k| *k == kind).unwrap_or(0)]
    }

    /// The best of fits from several clearances: whence all others with this curve start.
    fn with_backlash(&self, kind: CurveKind) -> Model {
        let fit = |share: &f64| {
            let mut start = self.start(kind).clone();
            start.joint.backlash_m = share * self.limits.stroke_rad * self.limits.pulley_radius_m;
            self.fit_from(start, &self.all(), FreeForm::Load, kind)
        };
        let fits: Vec<WholeFit> = BACKLASH_STARTS.par_iter().map(fit).collect();
        let best = fits.into_iter().min_by(|a, b| a.rmse_nm.total_cmp(&b.rmse_nm));
        best.map_or_else(|| self.start(kind).clone(), |fit| fit.model)
    }

    fn fit(&self, parts: &[Part], form: FreeForm, kind: CurveKind) -> WholeFit {
        self.fit_from(self.start(kind).clone(), parts, form, kind)
    }

    fn fit_from(&self, mut from: Model, parts: &[Part], form: FreeForm, kind: CurveKind) -> WholeFit {
        let mut free: Vec<Free> = Vec::new();
        for direction in Direction::BOTH {
            free.extend(form.parameters().iter().map(|i| Free::Friction(direction, *i)));
            let branch = from.friction.of_mut(direction);
            if form == FreeForm::Viscous {
                branch.mu_c = 0.0;
            }
            if form == FreeForm::Stribeck {
                branch.b_j = 0.2 * branch.a_j;
                branch.c_j = direction.sign() * 10.0 / self.limits.speed_rad_s;
            }
        }
        free.extend(kind.range().map(|_| Free::Curve));
        if self.estimate_backlash && kind != CurveKind::Sign {
            free.push(Free::Backlash);
        }
        fit_whole(parts, &from, &free, &self.limits)
    }

    /// Sum of squares and count of every part, by the fit of the other half.
    fn held_out(&self, form: FreeForm, kind: CurveKind) -> Vec<(f64, f64)> {
        let judge = |fitted: usize, judged: usize| {
            square_sums(&self.halves[judged], &self.fit(&self.halves[fitted], form, kind).model)
        };
        let (first, second) = rayon::join(|| judge(1, 0), || judge(0, 1));
        first.into_iter().chain(second).collect()
    }
}

/// The best form, or the smallest that is no worse by more than one standard error over the parts.
fn best_form(forms: &[(FreeForm, Vec<(f64, f64)>)]) -> usize {
    let best = (0..forms.len()).min_by(|a, b| rmse_nm(&forms[*a].1).total_cmp(&rmse_nm(&forms[*b].1))).unwrap_or(0);
    let as_good = |i: &usize| {
        let excess: Vec<f64> = forms[*i].1.iter().zip(&forms[best].1).map(|(a, b)| a.0 - b.0).collect();
        mean(&excess) <= standard_deviation(&excess) / (excess.len() as f64).sqrt()
    };
    (0..best).find(as_good).unwrap_or(best)
}

/// Standard deviation of the measured torque, N m.
fn spread_nm(trials: &[Prepared]) -> f64 {
    let all: Vec<f64> = trials.iter().flat_map(|t| t.series.torque_nm.iter().copied()).collect();
    standard_deviation(&all)
}

/// Coulomb friction from the mean torque beyond the load in each direction; of the rest a little, for a parameter that
/// starts at its bound has no slope to leave it by.
fn start(trials: &[Prepared], model: &Model) -> Model {
    let mut start = model.clone();
    for direction in Direction::BOTH {
        let (mut sum, mut count) = (0.0, 0.0);
        for trial in trials {
            let series = &trial.series;
            for ((y, load), v) in series.torque_nm.iter().zip(&series.joint_torque_nm).zip(&series.velocity_rad_s) {
                if v * direction.sign() > 0.0 {
                    sum += y - model.joint.transmission() * load;
                    count += 1.0;
                }
            }
        }
        let mean_n = if count > 0.0 { sum / count / model.joint.winch_radius_m } else { 0.0 };
        *start.friction.of_mut(direction) =
            Friction { mu_c: 0.05, a_j: mean_n, d: 0.01 * mean_n.abs(), ..Friction::default() };
    }
    start
}
