//! The figures of a baseline, each with what it may move by.

use super::marks::TrialMark;
use crate::dynamics::JointKind;
use crate::evaluate::{Evaluation, Group, Split};
use crate::identify::{FrictionFit, Identification, Route};
use crate::model::{Combination, Confidence, Direction, Model, Term};
use crate::numerics::statistics::{HALF_WIDTH, mean, standard_deviation, student_t};
use std::f64::consts::SQRT_2;

/// What another machine's arithmetic (the last digit of a sine) may do to a figure on the same data: a share of it. Far above
/// what it does, far below any change of a filter or a formula.
const ROUNDING: f64 = 1e-6;
/// The same for what an iterative fit ends at, as a share of the half width of its 95 % interval: where many values do equally
/// well, the last digit decides between them.
const ROUNDING_OF_INTERVAL: f64 = 0.01;

/// One number, and what it may move by.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Dotted name; a trial's figures begin with its file.
    pub name: String,
    /// Unit as in files; empty of what has none.
    pub unit: String,
    /// The trial that it is of; none where it is of all or several.
    pub file: Option<String>,
    /// The number; NaN where there is none.
    pub value: f64,
    /// What it may move by on the same data, bit for bit.
    pub rounding: f64,
    /// What it may move by on other recordings of the same joint: half width of the 95 % interval of a difference; infinite
    /// where it is too loosely known to tell.
    pub tolerance: f64,
    /// Whether it is an error, which may shrink.
    pub is_error: bool,
}

/// The form of B(v) and the curve, by name.
pub(super) fn choices(found: &Identification) -> Vec<(String, String)> {
    let mut all = vec![("combination.kind".to_string(), found.model.combination.name().to_string())];
    match &found.route {
        Route::Sweeps(fits) => all.extend(Direction::BOTH.map(|direction| {
            (format!("forms.{}.exponentials", direction.name()), fits.of(direction).taken.rates.len().to_string())
        })),
        Route::Free(free) => all.push(("free_motion.form".to_string(), free.form.name(free.is_loaded).to_string())),
    }
    all
}

/// What an identification found, and how well it met the trials.
pub(super) fn of_identification(found: &Identification, trials: &[TrialMark], lowpass_hz: f64) -> Vec<Figure> {
    let mut all = Vec::new();
    match &found.route {
        Route::Sweeps(fits) => Direction::BOTH.iter().for_each(|direction| all.extend(of_fit(fits.of(*direction)))),
        Route::Free(free) => {
            all.push(error(
                "free_motion.held_out_rmse_nm".to_string(),
                free.held_out_nm,
                of_all(found, trials, lowpass_hz),
            ));
        }
    }
    all.push(error("fit.whole.rmse_nm".to_string(), found.rmse_nm(), of_all(found, trials, lowpass_hz)));
    all.extend(parameters(&found.model));
    all
}

/// A and the error of B(v) in one direction.
fn of_fit(fit: &FrictionFit) -> [Figure; 2] {
    let name = |figure: &str| format!("fit.{}.{figure}", fit.direction.name());
    let a = Figure {
        name: name("a_nm"),
        unit: "N m".to_string(),
        file: None,
        value: fit.a.a_nm,
        rounding: ROUNDING * fit.a.a_nm.abs(),
        tolerance: SQRT_2 * fit.a.half_width_nm,
        is_error: false,
    };
    [a, error(name("rmse_nm"), fit.taken.rmse_nm, share(fit.taken.freedom()))]
}

/// The seven parameters of each direction, the curve's own, and the clearance.
fn parameters(model: &Model) -> Vec<Figure> {
    let mut all = Vec::new();
    for direction in Direction::BOTH {
        for term in Term::ALL {
            let (unit, value) = (term.unit(JointKind::Revolute), model.friction.of(direction)[term]);
            all.push(parameter(model, term.dotted(direction), unit, value));
        }
    }
    match model.combination {
        Combination::Arctan { p, .. } => all.push(parameter(model, "combination.p".to_string(), "", p)),
        Combination::Power { n } => all.push(parameter(model, "combination.n".to_string(), "", n)),
        Combination::Sign | Combination::Linear => {}
    }
    all.push(parameter(model, "joint.backlash_m".to_string(), "m", model.joint.backlash_m));
    all
}

/// A parameter: two recordings know it independently, so a difference is known √2 times worse than either.
fn parameter(model: &Model, name: String, unit: &str, value: f64) -> Figure {
    let half_width = |c: &Confidence| (c.high - value).max(value - c.low);
    // A parameter that was not estimated was declared, or follows from declared ones: it has no error of its own.
    let half_width = model.confidence.get(&name).map_or(0.0, half_width);
    let rounding = (ROUNDING * value.abs()).max(ROUNDING_OF_INTERVAL * half_width);
    Figure {
        name,
        unit: unit.to_string(),
        file: None,
        value,
        rounding,
        tolerance: SQRT_2 * half_width,
        is_error: false,
    }
}

/// How well the model predicts each trial, and each group of repeats.
pub(super) fn of_evaluation(found: &Evaluation, trials: &[TrialMark]) -> Vec<Figure> {
    let mut all = Vec::new();
    for group in &found.groups {
        let split = |at: &usize| &found.trials[*at].filtered;
        let repeats: Vec<f64> = group.trials.iter().map(|at| split(at).all.rmse_nm).filter(|x| x.is_finite()).collect();
        let scatter = scatter(group, &repeats);
        for at in &group.trials {
            let file = &found.trials[*at].entry.file;
            if let Some(mark) = trials.iter().find(|mark| mark.file == *file) {
                all.extend(of_trial(mark, split(at), scatter, found.lowpass_hz));
            }
        }
        let shares = group.trials.iter().filter_map(|at| {
            let mark = trials.iter().find(|mark| mark.file == found.trials[*at].entry.file)?;
            Some(mark.independent(found.lowpass_hz))
        });
        let tolerance = share(shares.sum()).max(scatter / (repeats.len() as f64).sqrt());
        let name = |figure: &str| format!("groups.{}.{figure}", label(group));
        all.push(error(name("rmse_nm_mean"), group.rmse_nm.mean, tolerance));
        all.push(error(name("mae_nm_mean"), group.mae_nm.mean, tolerance));
    }
    all
}

/// How far a trial's RMSE may differ between repeats, from their scatter, as a share of it; 0 without repeats.
fn scatter(group: &Group, repeats_nm: &[f64]) -> f64 {
    if !group.repeats || repeats_nm.len() < 2 {
        return 0.0;
    }
    SQRT_2 * student_t(repeats_nm.len() as f64 - 1.0) * standard_deviation(repeats_nm) / mean(repeats_nm)
}

fn of_trial(mark: &TrialMark, split: &Split, scatter: f64, lowpass_hz: f64) -> Vec<Figure> {
    let independent = mark.independent(lowpass_hz);
    let part = |samples: usize| independent * samples as f64 / split.all.samples as f64;
    let name = |figure: &str| format!("{}.{figure}", mark.file);
    let by = |independent: f64| share(independent).max(scatter);
    let mut all = vec![
        error(name("rmse_nm"), split.all.rmse_nm, by(independent)),
        error(name("mae_nm"), split.all.mae_nm, by(independent)),
        // The largest of many errors says nothing of the next recording's.
        error(name("peak_nm"), split.all.peak_nm, f64::INFINITY),
        error(name("stable.rmse_nm"), split.stable.rmse_nm, by(part(split.stable.samples))),
        error(name("transition.rmse_nm"), split.transition.rmse_nm, by(part(split.transition.samples))),
    ];
    all.iter_mut().for_each(|figure| figure.file = Some(mark.file.clone()));
    all
}

/// The protocol of a group, with its speed and trajectory.
fn label(group: &Group) -> String {
    let speed = group.protocol.speed_rad_s().map(|speed| format!(" {speed}")).unwrap_or_default();
    let trajectory = group.trajectory.as_ref().map(|name| format!(" {name}")).unwrap_or_default();
    format!("{}{speed}{trajectory}", group.protocol.name())
}

/// An error, which may move by `share` of itself on other data.
fn error(name: String, value: f64, share: f64) -> Figure {
    let (unit, rounding, tolerance) = ("N m".to_string(), ROUNDING * value.abs(), share * value.abs());
    Figure { name, unit, file: None, value, rounding, tolerance, is_error: true }
}

/// What the root mean square of `independent` errors may differ by from one recording to the next, as a share of it: its own
/// standard error is 1/√(2 n), a difference's √2 of that, an interval's half width 1.96 times more.
fn share(independent: f64) -> f64 {
    /// Of fewer errors the root mean square is anywhere.
    const FEW: f64 = 10.0;
    if independent < FEW { f64::INFINITY } else { HALF_WIDTH / independent.sqrt() }
}

/// The same of all trials of an identification: by the scatter between them where that is larger.
fn of_all(found: &Identification, trials: &[TrialMark], lowpass_hz: f64) -> f64 {
    let each: Vec<f64> = found.residuals.iter().map(|r| r.rmse_nm).filter(|x| x.is_finite()).collect();
    let n = each.len() as f64;
    let between = SQRT_2 * student_t(n - 1.0) * standard_deviation(&each) / n.sqrt() / mean(&each);
    let independent: f64 = trials.iter().map(|mark| mark.independent(lowpass_hz)).sum();
    share(independent).max(if between.is_finite() { between } else { 0.0 })
}
