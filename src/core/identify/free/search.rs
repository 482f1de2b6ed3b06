//! Fits of one form with one curve: on each half, judged by the other; and on all strokes.

use super::FreeForm;
use super::halves::Halves;
use crate::effects::friction_of_load;
use crate::identify::combination::CurveKind;
use crate::identify::moving::{Free, Limits};
use crate::identify::predicted::Prepared;
use crate::identify::strokes::square_sums;
use crate::identify::whole::{WholeFit, ahead, best_whole, fit_whole};
use crate::model::{Direction, Friction, Model};

/// Starts of the clearance when it is estimated, as shares of the longest stroke: its cost has several valleys.
const BACKLASH_STARTS: [f64; 3] = [0.02, 0.1, 0.3];
/// Start of p and n: the paper's arctan, and nearly a straight line.
const CURVE_START: f64 = 1.5;

/// One form with one curve, judged.
#[derive(Debug, Clone)]
pub struct Judged {
    /// The fit of each half.
    pub models: [Model; 2],
    /// Sum of squares and number of samples of every stroke, by the fit that did not see it.
    pub sums: Vec<(f64, f64)>,
}

impl Judged {
    /// The sums of squares alone.
    pub fn squares(&self) -> Vec<f64> {
        self.sums.iter().map(|sum| sum.0).collect()
    }
}

/// What all fits share.
pub struct Search<'a> {
    /// The strokes.
    pub halves: &'a Halves<'a>,
    /// Where fits start.
    pub start: &'a Model,
    /// Bounds.
    pub limits: &'a Limits,
    /// Whether X_cl is free.
    pub estimate_backlash: bool,
    /// Whether the load changes along the motion.
    pub is_loaded: bool,
    /// The forms to try, the smallest first.
    pub forms: &'a [FreeForm],
}

impl Search<'_> {
    /// The load form with the curve of `kind`, judged.
    pub fn judge_load(&self, kind: CurveKind) -> Judged {
        let start = Model { combination: kind.with(CURVE_START), ..self.start.clone() };
        let free = self.free(kind, FreeForm::Load);
        self.judge(kind, FreeForm::Load, |half| {
            let starts = if self.moves_backlash(kind) { self.with_backlashes(&start) } else { Vec::new() };
            ahead(&self.halves.halves[half], &starts, &free, self.limits).unwrap_or_else(|| start.clone())
        })
    }

    /// Another `form` judged, its fits started from those of the `load` form: that one finds the way.
    pub fn judge_form(&self, kind: CurveKind, form: FreeForm, load: &Judged) -> Judged {
        self.judge(kind, form, |half| self.shaped(load.models[half].clone(), form))
    }

    fn judge(&self, kind: CurveKind, form: FreeForm, start: impl Fn(usize) -> Model + Sync) -> Judged {
        let halves = &self.halves.halves;
        let fit = |half: usize| best_whole(&halves[half], &start(half), &self.free(kind, form), self.limits);
        let (first, second) = rayon::join(|| fit(0), || fit(1));
        let models = [first, second];
        let by_other = |half: usize| square_sums(&halves[half], &models[1 - half]).concat();
        let sums = [by_other(0), by_other(1)].concat();
        Judged { models, sums }
    }

    /// The fit of `form` with the curve of `kind` to all strokes, from the better of those to the halves.
    pub fn fit(&self, kind: CurveKind, form: FreeForm, judged: &Judged) -> WholeFit {
        let mut free = self.free(kind, form);
        free.extend((self.limits.zero_rad > 0.0).then_some(Free::Zero));
        fit_whole(&self.halves.all, self.better(judged), &free, self.limits)
    }

    /// The model alone of the same fit, to be compared with others.
    pub fn model(&self, kind: CurveKind, form: FreeForm, judged: &Judged) -> Model {
        best_whole(&self.halves.all, self.better(judged), &self.free(kind, form), self.limits)
    }

    fn better<'j>(&self, judged: &'j Judged) -> &'j Model {
        let sum = |model: &Model| square_sums(&self.halves.all, model).concat().iter().map(|s| s.0).sum::<f64>();
        let [first, second] = &judged.models;
        if sum(first) <= sum(second) { first } else { second }
    }

    fn moves_backlash(&self, kind: CurveKind) -> bool {
        // A jump does not know the clearance.
        self.estimate_backlash && kind != CurveKind::Sign
    }

    fn with_backlashes(&self, start: &Model) -> Vec<Model> {
        let with = |share: f64| {
            let mut model = start.clone();
            model.joint.backlash_m = share * self.limits.stroke_rad * self.limits.pulley_radius_m;
            model
        };
        BACKLASH_STARTS.map(with).to_vec()
    }

    fn shaped(&self, mut model: Model, form: FreeForm) -> Model {
        /// Of the load: a start beside 0.
        const SHARE: f64 = 0.05;
        if form == FreeForm::Carried {
            model.effects.push(friction_of_load(SHARE));
        }
        for direction in Direction::BOTH {
            let branch = model.friction.of_mut(direction);
            match form {
                FreeForm::Viscous => branch.mu_c = 0.0,
                FreeForm::Load | FreeForm::Carried => {}
                FreeForm::Stribeck => {
                    branch.b_j = 0.2 * branch.a_j;
                    branch.c_j = direction.sign() * 10.0 / self.limits.speed_rad_s;
                }
            }
        }
        model
    }

    fn free(&self, kind: CurveKind, form: FreeForm) -> Vec<Free> {
        let friction =
            |direction| form.parameters(self.is_loaded).iter().map(move |term| Free::Friction(direction, *term));
        let mut free: Vec<Free> = Direction::BOTH.into_iter().flat_map(friction).collect();
        let carried = Direction::BOTH.into_iter().filter(|_| form == FreeForm::Carried);
        free.extend(carried.map(Free::Carried));
        free.extend(kind.range().map(|_| Free::Curve(kind)));
        free.extend(self.moves_backlash(kind).then_some(Free::Backlash));
        free
    }
}

/// Coulomb friction from the mean torque beyond the load in each direction; the others start slightly above zero, because a parameter at
/// its bound has no gradient away from it.
pub fn start(trials: &[Prepared], model: &Model, is_loaded: bool) -> Model {
    let mut start = model.clone();
    for direction in Direction::BOTH {
        let (mut sum, mut count) = (0.0, 0.0);
        for trial in trials {
            let series = &trial.series;
            let load_nm = series.joint_torque_nm(&model.dynamics);
            for (i, (y, v)) in series.torque_nm.iter().zip(&series.velocity_rad_s).enumerate() {
                if v * direction.sign() > 0.0 {
                    sum += y - model.joint.transmission() * load_nm(i);
                    count += 1.0;
                }
            }
        }
        let mean_n = if count > 0.0 { sum / count / model.joint.winch_radius_m } else { 0.0 };
        *start.friction.of_mut(direction) = Friction {
            mu_c: if is_loaded { 0.05 } else { 0.0 },
            a_j: mean_n,
            d: 0.01 * mean_n.abs(),
            ..Friction::default()
        };
    }
    start
}
