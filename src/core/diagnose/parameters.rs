//! What a fit says of parameters: their values, intervals by resampling, and whether the data pin them down.

use super::bootstrap::Resamples;
use super::candidates::Cause;
use super::choose::Choice;
use super::fit::Fit;
use super::parameter_ref::ParameterRef;
use super::stale::holds;
use crate::model::{Model, Term};
use crate::numerics::statistics::HALF_WIDTH;

/// Resamplings for a parameter's error.
const DRAWS: usize = 100;
/// A value within this share of its range from a bound, or of the bound where it may be negative, is at it.
const AT_BOUND: f64 = 1e-4;

/// Below this resolution a number is decided by what was assumed of its size: its interval by resampling says too little.
const RESOLVED: f64 = 0.9;
/// The warning about it.
const UNRESOLVED: &str = "these data do not tell it from others";

/// The warning about friction that comes out negative, and about an effect of the opposite sign.
pub const BELOW_ZERO: &str = "negative: it compensates for an unmodelled effect";

/// One parameter fitted.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// Its name: of an effect its own, of the model's own a dotted one.
    pub name: String,
    /// In SI.
    pub value: f64,
    /// The 95 % interval; nothing for what was chosen rather than fitted.
    pub interval: Option<(f64, f64)>,
    /// What is wrong with it: "at its bound", ...
    pub doubt: Option<&'static str>,
}

/// The model with all causes at their best, and its base where the last fit left it.
pub fn settled(choice: &Choice<'_>) -> Model {
    let mut model = choice.last.model.clone();
    for (way, x) in choice.base.moves.iter().zip(&choice.last.base_x) {
        way.apply(&mut model, *x);
    }
    model
}

/// The parameters of `cause` in `fit`, whose last effect it is if it is one alone.
pub fn of_cause(resamples: &Resamples, fit: &Fit<'_>, (cause, how): (Cause, &str)) -> Vec<Fitted> {
    let deviations = fit.deviations(resamples, DRAWS);
    let mut found = Vec::new();
    for ((way, deviation), resolution) in fit.moves.iter().zip(&deviations).zip(fit.resolution()) {
        for parameter in way.parameters() {
            let belongs = match (parameter, cause) {
                (ParameterRef::Effect(at, _), Cause::Effect(id)) => fit.model.effects[at].id() == id,
                (ParameterRef::Effect(..), Cause::Stale(_)) | (_, Cause::Effect(_)) => false,
                (_, Cause::Stale(name)) => holds((name, how), parameter),
            };
            if belongs && deviation.is_finite() {
                let at = |x: f64| {
                    let mut model = fit.model.clone();
                    way.apply(&mut model, x);
                    parameter.value(&model)
                };
                let (a, b) = (at(-HALF_WIDTH * deviation), at(HALF_WIDTH * deviation));
                let value = parameter.value(&fit.model);
                found.push(Fitted {
                    name: parameter.own_name(&fit.model),
                    value,
                    interval: Some((a.min(b), a.max(b))),
                    doubt: doubt(parameter, &fit.model, way.range(parameter, &fit.model))
                        .or((resolution < RESOLVED).then_some(UNRESOLVED)),
                });
            }
        }
    }
    if let Cause::Effect(id) = cause
        && let Some(added) = fit.model.effects.iter().find(|added| added.id() == id)
    {
        let chosen = added.named().filter(|(parameter, _)| found.iter().all(|known| known.name != parameter.name));
        let chosen: Vec<Fitted> =
            chosen.map(|(p, value)| Fitted { name: p.name.to_string(), value, interval: None, doubt: None }).collect();
        found.extend(chosen);
    }
    found
}

/// Viscous friction below zero would help the motion, and friction that rises with speed is no Stribeck effect. A positive range is compared in
/// its logarithm, for it spans decades.
fn doubt(parameter: ParameterRef, model: &Model, (low, high): (f64, f64)) -> Option<&'static str> {
    let is_positive = match parameter {
        ParameterRef::Friction(_, term) => term == Term::Viscous,
        ParameterRef::Effect(effect, at) => model.effects[effect].effect.about().parameters[at].is_positive,
        _ => false,
    };
    if is_positive && parameter.value(model) < 0.0 {
        return Some(BELOW_ZERO);
    }
    if !low.is_finite() || !high.is_finite() {
        return None;
    }
    let value = parameter.value(model);
    let is_at_bound = match low > 0.0 {
        true => !(AT_BOUND..=1.0 - AT_BOUND).contains(&((value / low).ln() / (high / low).ln())),
        false => [low, high].iter().any(|bound| (value - bound).abs() <= AT_BOUND * bound.abs()),
    };
    is_at_bound.then_some("at its bound")
}

#[cfg(test)]
mod tests {
    use super::doubt;
    use crate::diagnose::data::tests::bundled;
    use crate::diagnose::perturbation::of_effect;
    use crate::effects::Added;

    #[test]
    fn a_share_is_at_its_bound_where_it_is_least_and_nowhere_else() {
        let (data, mut model) = bundled();
        for (cold_share, expected) in [(0.4, None), (0.0, None), (-0.1, Some("at its bound"))] {
            let text = format!("warm_up:restarts=0,cold_share={cold_share},time_constant_s=15,exponent=1");
            model.effects = vec![Added::parse(&text).unwrap()];
            let share = &of_effect(&model, 0, &data.extent)[0];
            let parameter = share.parameters().next().unwrap();
            assert_eq!(parameter.own_name(&model), "cold_share");
            assert_eq!(doubt(parameter, &model, share.range(parameter, &model)), expected, "{text}");
        }
    }
}
