//! The JSON of an identification: `model.json`, and what `identify --json` prints.
//!
//! The model's own keys come from `Model::to_json`; the rest is for people and for programs that judge the fit. Numbers
//! that are not finite are null.

use crate::identify::stribeck::ExponentialFit;
use crate::identify::{
    Check, CombinationFit, CurveFit, FreeFit, FrictionFit, Identification, LegFit, Refinement, RestsOn, Route,
};
use crate::model::{Combination, Direction};
use crate::numerics::statistics::mean;
use serde_json::{Map, Value, json};

/// The model of `identification` with its fit, forms, combinations, refinement, free motion, warnings and provenance.
pub fn to_json(identification: &Identification, campaign: &str) -> Value {
    let mut root = identification.model.to_json();
    let mut fit = Map::new();
    match &identification.route {
        Route::Sweeps(fits) => {
            let mut forms = Map::new();
            for direction in Direction::BOTH {
                let name = direction.name().to_string();
                fit.insert(name.clone(), branch_fit(fits.of(direction), &identification.legs));
                forms.insert(name, branch_forms(fits.of(direction)));
            }
            root["forms"] = forms.into();
        }
        Route::Free(free) => root["free_motion"] = free_motion(free),
    }
    fit.insert("whole".to_string(), whole(identification));
    root["fit"] = fit.into();
    root["combinations"] = identification.combination.as_ref().map_or(Value::Null, combinations);
    root["refinement"] = identification.refinement.as_ref().map_or(Value::Null, refinement);
    root["checks"] = identification.checks.iter().map(check).collect::<Vec<Value>>().into();
    let rests_on = |(name, all): (&String, &Vec<RestsOn>)| (name.clone(), all.iter().map(rests_on).collect());
    root["rests_on"] = identification.rests_on.iter().map(rests_on).collect::<Map<String, Value>>().into();
    root["warnings"] = json!(identification.warnings);
    root["provenance"] = json!({
        "tautline": env!("CARGO_PKG_VERSION"),
        "campaign": campaign,
        "trials": identification.trials,
        "rows": identification.rows,
    });
    root
}

fn check(check: &Check) -> Value {
    json!({
        "check": check.name,
        "passes": check.passes(),
        "value": check.value,
        "limit": check.limit,
        "concerns": check.concerns,
    })
}

fn rests_on(one: &RestsOn) -> Value {
    json!({ "on": one.on, "fitted": one.fitted, "change": one.change, "moves": one.moves })
}

/// How well one direction's legs and B(v) were met.
fn branch_fit(fit: &FrictionFit, legs: &[LegFit]) -> Value {
    let over_legs = |of: fn(&LegFit) -> f64| {
        mean(&legs.iter().filter(|leg| leg.direction == fit.direction).map(of).collect::<Vec<f64>>())
    };
    let mut out = json!({
        "a_nm": fit.a.a_nm,
        "a_sd_nm": fit.a.sd_nm,
        "a_half_width_nm": fit.a.half_width_nm,
        "a_half_width_given_zero_nm": fit.a.given_zero_nm,
        "a_by_zero_nm_rad": fit.a.by_zero_nm_rad,
        "rmse_nm": fit.taken.rmse_nm,
        "r_squared": fit.r_squared,
        "points": fit.points.b_nm.len(),
        "leg_rmse_nm_mean": over_legs(|leg| leg.rmse_nm),
        "leg_raw_rmse_nm_mean": over_legs(|leg| leg.raw_rmse_nm),
        "leg_r_squared_mean": over_legs(|leg| leg.r_squared),
    });
    write_covariance(&mut out, fit);
    out
}

/// Adds to `fit` the covariance of the friction parameters as the fit of B(v) has it, before any refining, each in its own
/// unit; or null and the reason.
pub fn write_covariance(out: &mut Value, fit: &FrictionFit) {
    match &fit.covariance {
        Ok(covariance) => {
            let rows: Vec<Vec<f64>> = covariance.matrix.row_iter().map(|row| row.iter().copied().collect()).collect();
            out["covariance"] = json!({ "parameters": covariance.parameters.iter().map(|term| term.name()).collect::<Vec<_>>(), "matrix": rows });
        }
        Err(reason) => (out["covariance"], out["covariance_absent"]) = (Value::Null, json!(reason)),
    }
}

/// The forms of (19) side by side.
pub fn branch_forms(fit: &FrictionFit) -> Value {
    let form = |form: &ExponentialFit| {
        json!({
            "exponentials": form.rates.len(),
            "rmse_nm": form.rmse_nm,
            "degrees_of_freedom": form.freedom(),
            "aicc": form.aicc(),
            "rates_s_rad": form.rates,
            "stopped": form.stopped.name(),
        })
    };
    json!({
        "tried": fit.forms.iter().map(form).collect::<Vec<Value>>(),
        "supported": fit.supported,
        "taken": fit.taken.rates.len(),
        "why": fit.why,
    })
}

/// The model against every trial, both sides low-passed.
fn whole(identification: &Identification) -> Value {
    let trial =
        |r: &crate::identify::Residual| json!({ "file": r.file, "protocol": r.protocol.name(), "rmse_nm": r.rmse_nm });
    json!({
        "rmse_nm": identification.rmse_nm(),
        "trials": identification.residuals.iter().map(trial).collect::<Vec<Value>>(),
    })
}

/// The curves by name.
pub fn combinations(fit: &CombinationFit) -> Value {
    let curve = |(at, c): (usize, &CurveFit)| {
        let figures = json!({
            "rmse_nm": c.rmse_nm,
            "r_squared": c.r_squared,
            "parameter": parameter(&c.curve).map(|(_, value)| value),
            "backlash_m": c.backlash_m,
            "supported": at == fit.supported,
            "taken": at == fit.taken,
            "reversals": fit.windows,
            "samples": fit.samples,
        });
        (c.kind.name().to_string(), figures)
    };
    fit.curves.iter().enumerate().map(curve).collect::<Map<String, Value>>().into()
}

/// Name and value of a curve's own parameter, if it has one.
pub fn parameter(curve: &Combination) -> Option<(&'static str, f64)> {
    match *curve {
        Combination::Arctan { p, .. } => Some(("p", p)),
        Combination::Power { n } => Some(("n", n)),
        Combination::Sign | Combination::Linear => None,
    }
}

fn refinement(refined: &Refinement) -> Value {
    json!({
        "before_rmse_nm": refined.before_nm,
        "after_held_out_rmse_nm": refined.after_nm,
        "kept": refined.kept,
        "stopped": refined.fit.stopped.name(),
    })
}

fn free_motion(free: &FreeFit) -> Value {
    let form = |(form, held_out_nm): &(crate::identify::free::FreeForm, f64)| json!({ "form": form.name(free.is_loaded), "held_out_rmse_nm": held_out_nm, "taken": *form == free.form });
    json!({
        "forms": free.forms.iter().map(form).collect::<Vec<Value>>(),
        "held_out_rmse_nm": free.held_out_nm,
        "rmse_nm": free.fit.rmse_nm,
        "stopped": free.fit.stopped.name(),
    })
}
