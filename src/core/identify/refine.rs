//! `--refine`: all parameters together on the whole series, from the protocol's result, judged on trials it did not see.

use super::combination::CurveKind;
use super::forms::holds_at_rest;
use super::friction::FrictionFit;
use super::moving::{Free, Limits};
use super::predicted::Prepared;
use super::strokes::{Part, square_sums};
use super::support::excess;
use super::whole::{WholeFit, best_whole, fit_whole, rmse_nm};
use crate::model::{Both, Confidence, Direction, Friction, Model, Term};
use crate::numerics::marquardt::Stopped;

/// What refining gained.
#[derive(Debug, Clone)]
pub struct Refinement {
    /// RMSE of the protocol's model over all trials, N m.
    pub before_nm: f64,
    /// RMSE of refined models, each on the trials that its fit did not see, N m.
    pub after_nm: f64,
    /// Whether the gain exceeds its own standard error over trials.
    pub gained: bool,
    /// Whether the refined model is taken: it gained, and its B(v) stays sane towards rest as the protocol's must.
    pub kept: bool,
    /// The fit on all trials.
    pub fit: WholeFit,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// Refines `model` on `trials`; `folds` says which half each trial belongs to, `sweeps` what the protocol found,
/// `zero_rad` how far the zero of the position may be off.
pub fn refine(
    trials: &[Prepared],
    folds: &[usize],
    model: &Model,
    lowpass_hz: f64,
    sweeps: &Both<FrictionFit>,
    zero_rad: f64,
) -> Refinement {
    let mut free = free_parameters(model);
    free.extend((zero_rad > 0.0).then_some(Free::Zero));
    let parts: Vec<Part> =
        trials.iter().map(|trial| Part::new(trial, model.joint.backlash_rad(), lowpass_hz)).collect();
    let limits = Limits::new(trials, model, zero_rad);
    let before = trial_sums(&parts, model);
    let mut after = before.clone();
    for fold in 0..2 {
        let of = |wanted: bool| -> Vec<Part> {
            parts.iter().zip(folds).filter(|(_, f)| (**f == fold) == wanted).map(|(p, _)| p.clone()).collect()
        };
        let fitted = best_whole(&of(false), model, &free, &limits);
        let mut judged = trial_sums(&of(true), &fitted).into_iter();
        for (i, _) in folds.iter().enumerate().filter(|(_, f)| **f == fold) {
            after[i] = judged.next().unwrap_or(after[i]);
        }
    }
    let squares = |sums: &[(f64, f64)]| sums.iter().map(|s| s.0).collect::<Vec<f64>>();
    let (gain, error) = excess(&squares(&before), &squares(&after));
    let fit = in_order(fit_whole(&parts, model, &free, &limits));
    let gained = gain > error;
    let lost = Direction::BOTH.into_iter().find(|direction| gained && !is_sane(&fit.model, sweeps.of(*direction)));
    let kept = gained && lost.is_none();
    let unfinished = kept && fit.stopped != Stopped::Converged;
    Refinement {
        before_nm: rmse_nm(&before),
        after_nm: rmse_nm(&after),
        gained,
        kept,
        warnings: lost.map(lost_warning).into_iter().chain(unfinished.then(unfinished_warning)).collect(),
        fit,
    }
}

/// Sum of squares and number of samples of each trial.
fn trial_sums(parts: &[Part], model: &Model) -> Vec<(f64, f64)> {
    let sum = |strokes: &Vec<(f64, f64)>| strokes.iter().fold((0.0, 0.0), |(a, b), s| (a + s.0, b + s.1));
    square_sums(parts, model).iter().map(sum).collect()
}

/// The convention that tells the two exponentials apart: the cable's decays faster, |c_c r2| >= |c_j|. A fit may have taken
/// them past each other; then they change names, with all that is known of them.
fn in_order(mut fit: WholeFit) -> WholeFit {
    let radius_m = fit.model.joint.pulley_radius_m;
    for direction in Direction::BOTH {
        let branch = fit.model.friction.of_mut(direction);
        if branch.b_c == 0.0 || branch.b_j == 0.0 || (branch.c_c * radius_m).abs() >= branch.c_j.abs() {
            continue;
        }
        (branch.b_c, branch.b_j) = (branch.b_j, branch.b_c);
        (branch.c_c, branch.c_j) = (branch.c_j / radius_m, branch.c_c * radius_m);
        for (name, known) in &mut fit.confidence {
            let prefix = format!("friction.{}.", direction.name());
            let (now, factor) = match name.strip_prefix(&prefix) {
                Some("b_c") => ("b_j", 1.0),
                Some("b_j") => ("b_c", 1.0),
                Some("c_c") => ("c_j", radius_m),
                Some("c_j") => ("c_c", 1.0 / radius_m),
                _ => continue,
            };
            *name = prefix + now;
            *known = Confidence { low: factor * known.low, high: factor * known.high, ..*known };
        }
    }
    fit
}

/// Whether the B(v) of `model` stays sane below the speeds of the sweeps.
fn is_sane(model: &Model, protocol: &FrictionFit) -> bool {
    let b_nm = |v: f64| model.b_nm(protocol.direction, v);
    protocol.taken.rates.is_empty() || holds_at_rest(b_nm, &protocol.points)
}

fn lost_warning(direction: Direction) -> String {
    format!(
        "--refine would gain, but its B(v) moving {} runs away between rest and the slowest sweep: the protocol's model is \
         kept; record slower sweeps, or try --form one",
        direction.name()
    )
}

fn unfinished_warning() -> String {
    "the refinement stopped before it converged: its parameters might still move".to_string()
}

/// All parameters that the model uses; X_cl stays, for it is measured or estimated by itself.
fn free_parameters(model: &Model) -> Vec<Free> {
    let mut free = Vec::new();
    for direction in Direction::BOTH {
        let friction: &Friction = model.friction.of(direction);
        free.extend(
            Term::ALL.into_iter().filter(|term| !friction.lacks(*term)).map(|term| Free::Friction(direction, term)),
        );
    }
    let kind = CurveKind::of(&model.combination);
    free.extend(kind.range().map(|_| Free::Curve(kind)));
    free
}
