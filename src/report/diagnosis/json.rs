//! `diagnosis.json`.

use super::motion;
use crate::diagnose::{Answer, Candidate, Cause, Decision, Diagnosis, Form, Kind, Place, Shrink};
use serde_json::{Map, Value, json};

/// The diagnosis as in `diagnosis.json`.
pub fn to_json(found: &Diagnosis, campaign: &str, model: &str) -> Value {
    let verdict = &found.verdict;
    let mut told = json!({
        "format": "diagnosis/1",
        "gap": {
            "rmse_nm": found.gap.rmse_nm,
            "noise_floor_nm": found.gap.floor.rms_nm,
            "encoder_nm": found.gap.floor.encoder_nm,
            "noise_floor_source": found.gap.floor.source.name(),
            "explainable_nm": found.gap.explainable_nm,
            "recoverable_nm": found.gap.recoverable_nm,
        },
        "where": found.places.iter().map(place).collect::<Vec<Value>>(),
        "causes": found.candidates.iter().map(candidate).collect::<Vec<Value>>(),
        "verdict": {
            "kind": verdict.kind.name(),
            "effects": names(&verdict.effects),
            "confidence": verdict.confidence,
            "agreement": verdict.agreement,
            "gap_before_nm": verdict.gap_before_nm,
            "gap_after_nm": verdict.gap_after_nm,
            "probabilities": verdict.probabilities.iter().map(probability).collect::<Vec<Value>>(),
            "form": verdict.form.map(Form::name),
            "remainder": {
                "rms_nm": verdict.gap_after_nm,
                "share_of_gap": (verdict.gap_after_nm / verdict.gap_before_nm.max(f64::MIN_POSITIVE)).powi(2).min(1.0),
                "where": found.remainder.iter().map(place).collect::<Vec<Value>>(),
            },
        },
        "decisions": verdict.decisions.iter().map(decision).collect::<Vec<Value>>(),
        "next_experiment": super::experiment::next_json(found),
        "blind_spots": super::experiment::blind_json(found),
        "budget": {
            "floor": found.budget.floor,
            "within_confidence": found.budget.within_confidence,
            "causes": found.budget.causes.iter().map(|(c, x)| json!({ "effect": c.name(), "square": x })).collect::<Vec<Value>>(),
            "unexplained": found.budget.unexplained,
        },
        "contacts": found.contacts.iter().map(|c| json!({
            "file": c.file, "from_s": c.from_s, "to_s": c.to_s, "peak_nm": c.peak_nm,
        })).collect::<Vec<Value>>(),
        "motion": found.motion.as_ref().map(motion::to_json),
        "held_out": found.held_out,
        "warnings": found.warnings,
        "provenance": { "tautline": env!("CARGO_PKG_VERSION"), "campaign": campaign, "model": model },
    });
    put_shrink(&mut told["verdict"], verdict.shrink);
    let changed = found.policy.changed();
    if !changed.is_empty() {
        told["policy"] = changed.into_iter().map(|(name, value)| (name.to_string(), json!(value))).collect();
    }
    if verdict.kind == Kind::Ambiguous {
        told["verdict"]["taken"] = json!(verdict.effects.first().map(|cause| cause.name()));
    }
    told
}

fn names(causes: &[Cause]) -> Vec<&'static str> {
    causes.iter().map(|cause| cause.name()).collect()
}

fn probability((answer, probability): &(Answer, f64)) -> Value {
    let causes = match answer {
        Answer::Causes(causes) => names(causes),
        Answer::Outside => vec!["unknown"],
        Answer::Other => vec!["other"],
    };
    json!({ "causes": causes, "probability": probability })
}

fn decision(decision: &Decision) -> Value {
    json!({
        "rule": decision.rule,
        "subject": decision.subject,
        "value": decision.value,
        "limit": decision.limit,
        "outcome": decision.outcome,
    })
}

fn put_shrink(value: &mut Value, shrink: Shrink) {
    (value["shrink"], value["shrink_low"], value["shrink_high"]) =
        (json!(shrink.value), json!(shrink.low), json!(shrink.high));
}

fn place(place: &Place) -> Value {
    json!({
        "region": place.region.name(),
        "detail": place.detail,
        "share_of_gap": place.share_of_gap,
        "share_of_samples": place.share_of_samples,
        "rmse_nm": place.rmse_nm,
    })
}

fn candidate(candidate: &Candidate) -> Value {
    let parameters: Map<String, Value> =
        candidate.parameters.iter().map(|p| (p.name.clone(), json!(p.value))).collect();
    let intervals: Map<String, Value> = candidate
        .parameters
        .iter()
        .filter_map(|p| {
            Some((p.name.clone(), json!({ "low": p.interval?.0, "high": p.interval?.1, "doubt": p.doubt })))
        })
        .collect();
    let mut told = json!({
        "effect": candidate.cause.name(),
        "how": candidate.how,
        "held_out_rmse_nm": candidate.held_out_rmse_nm,
        "parameters": parameters,
        "intervals": intervals,
        "trades_with": names(&candidate.trades_with),
        "taken": candidate.taken,
        "in_addition": candidate.beside,
        "stopped": if candidate.settled { "converged" } else { "out_of_patience" },
    });
    put_shrink(&mut told, candidate.shrink);
    told
}
