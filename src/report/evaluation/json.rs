//! `evaluation.json`, which `evaluate --json` prints too.

use crate::evaluate::{Evaluation, Figures, Group, Rival, Split, Spread, TrialEvaluation};
use crate::report::identification::parameter;
use serde_json::{Map, Value, json};

/// `evaluation` of the model in the file called `model`, on the campaign called `campaign`; what is not known is null.
pub fn to_json(evaluation: &Evaluation, campaign: &str, model: &str) -> Value {
    let combinations: Map<String, Value> = evaluation
        .rivals
        .iter()
        .enumerate()
        .map(|(at, rival)| (rival.kind.name().to_string(), combination(evaluation, at, rival)))
        .collect();
    let mut overall = split(&evaluation.overall());
    add_raw(&mut overall, &evaluation.together(|t| &t.raw));
    json!({
        "format": "evaluation/1",
        "trials": evaluation.trials.iter().map(trial).collect::<Vec<Value>>(),
        "groups": evaluation.groups.iter().map(group).collect::<Vec<Value>>(),
        "overall": overall,
        "combinations": combinations,
        "lowpass_hz": evaluation.lowpass_hz,
        "warnings": evaluation.warnings,
        "provenance": { "tautline": env!("CARGO_PKG_VERSION"), "campaign": campaign, "model": model },
    })
}

fn trial(trial: &TrialEvaluation) -> Value {
    let mut value = split(&trial.filtered);
    value["file"] = json!(trial.entry.file);
    value["protocol"] = json!(trial.entry.protocol.name());
    value["repeat"] = json!(trial.entry.repeat);
    value["trajectory"] = json!(trial.entry.trajectory);
    value["speed_rad_s"] = json!(trial.entry.protocol.speed_rad_s());
    add_raw(&mut value, &trial.raw);
    value
}

/// The figures of all samples, with those of the two parts under `stable` and `transition`.
fn split(split: &Split) -> Value {
    let mut value = figures(&split.all);
    value["stable"] = figures(&split.stable);
    value["transition"] = figures(&split.transition);
    value
}

fn figures(figures: &Figures) -> Value {
    json!({
        "rmse_nm": figures.rmse_nm,
        "mae_nm": figures.mae_nm,
        "peak_nm": figures.peak_nm,
        "rmse_percent": figures.rmse_percent,
        "mae_percent": figures.mae_percent,
        "samples": figures.samples,
    })
}

/// Adds the figures with neither side filtered, to the whole and to its two parts.
fn add_raw(value: &mut Value, raw: &Split) {
    let mut add = |part: Option<&str>, figures: &Figures| {
        let place = match part {
            Some(part) => &mut value[part],
            None => value,
        };
        for (name, x) in [
            ("raw_rmse_nm", figures.rmse_nm),
            ("raw_mae_nm", figures.mae_nm),
            ("raw_peak_nm", figures.peak_nm),
            ("raw_rmse_percent", figures.rmse_percent),
            ("raw_mae_percent", figures.mae_percent),
        ] {
            place[name] = json!(x);
        }
    };
    add(None, &raw.all);
    add(Some("stable"), &raw.stable);
    add(Some("transition"), &raw.transition);
}

fn group(group: &Group) -> Value {
    json!({
        "protocol": group.protocol.name(),
        "trajectory": group.trajectory,
        "speed_rad_s": group.protocol.speed_rad_s(),
        "repeats": group.repeats,
        "trials": group.trials.len(),
        "rmse_nm_mean": group.rmse_nm.mean,
        "rmse_nm_sd": group.rmse_nm.sd,
        "mae_nm_mean": group.mae_nm.mean,
        "mae_nm_sd": group.mae_nm.sd,
    })
}

/// One curve over all trials together, with mean and SD over trials.
fn combination(evaluation: &Evaluation, at: usize, rival: &Rival) -> Value {
    let mut value = split(&evaluation.together(|t| &t.rivals[at]));
    let over_trials = |of: fn(&Figures) -> f64| Spread::of(evaluation.trials.iter().map(|t| of(&t.rivals[at].all)));
    let (rmse_nm, mae_nm) = (over_trials(|f| f.rmse_nm), over_trials(|f| f.mae_nm));
    value["rmse_nm_mean"] = json!(rmse_nm.mean);
    value["rmse_nm_sd"] = json!(rmse_nm.sd);
    value["mae_nm_mean"] = json!(mae_nm.mean);
    value["mae_nm_sd"] = json!(mae_nm.sd);
    value["parameter"] = json!(parameter(&rival.curve).map(|(_, x)| x));
    value["parameter_from"] = json!(rival.source.name());
    value["backlash_m"] = json!(rival.backlash_m);
    value
}
