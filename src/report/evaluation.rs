//! An evaluation as `evaluation.json` (which `evaluate --json` prints too), on the terminal, and as a page.

use super::identification::parameter;
use super::number::{count, counted, significant, with_spread};
use super::page::{Card, Drawing, Page, Table};
use super::terminal::{BOLD, DIM, distrust, heading};
use super::wording::Units;
use crate::evaluate::{Evaluation, Figures, Group, Rival, Source, Split, Spread, TrialEvaluation};
use serde_json::{Map, Value, json};
use std::io::{self, Write};
use std::path::Path;

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

/// The page of `found`, with its `drawings`.
pub fn page(found: &Evaluation, campaign: &str, model: &str, drawings: Vec<Drawing>) -> Page {
    let units = Units::of(found.model.joint.kind);
    let overall = found.overall();
    let card = |name: &str, value: String, note: String| Card { name: name.to_string(), value, note };
    let raw = found.together(|t| &t.raw).all;
    Page {
        kicker: format!("tautline evaluate · campaign {campaign} · model {model}"),
        title: found.model.joint.name.clone(),
        subject: "evaluation".to_string(),
        short: verdict(found, &units),
        steps: vec![comparison(found, &units)],
        warnings: found.warnings.clone(),
        cards: vec![
            card("RMSE", units.torque(overall.all.rmse_nm), percent_of(&overall.all)),
            card("stable state", units.torque(overall.stable.rmse_nm), "RMSE, |K_f| = 1".to_string()),
            card("transition", units.torque(overall.transition.rmse_nm), "RMSE, |K_f| < 1".to_string()),
            card("peak", units.torque(overall.all.peak_nm), "largest error".to_string()),
            card("raw RMSE", units.torque(raw.rmse_nm), "neither side filtered".to_string()),
        ],
        tables: vec![groups_table(found, &units), curves_table(found, &units), trials_table(found, &units)],
        drawings,
        provenance: vec![
            ("tautline", env!("CARGO_PKG_VERSION").to_string()),
            ("campaign", campaign.to_string()),
            ("model", model.to_string()),
            ("trials judged", count(found.trials.len())),
            ("low-pass", format!("{} Hz on both sides", significant(found.lowpass_hz, 3))),
        ],
    }
}

fn percent_of(figures: &Figures) -> String {
    format!("{} % of the measured range", significant(figures.rmse_percent, 3))
}

fn verdict(found: &Evaluation, units: &Units) -> String {
    let Split { all, stable, transition } = found.overall();
    let trials = counted(found.trials.len(), "trial", "trials");
    format!(
        "Over {trials} the model leaves {} RMSE ({}): {} in stable state, {} in transitions; the largest error is {}.",
        units.torque(all.rmse_nm),
        percent_of(&all),
        units.torque(stable.rmse_nm),
        units.torque(transition.rmse_nm),
        units.torque(all.peak_nm),
    )
}

/// What the coefficient gains.
fn comparison(found: &Evaluation, units: &Units) -> String {
    let told = found.rivals.iter().enumerate().map(|(at, rival)| {
        let figures = found.together(|t| &t.rivals[at]);
        let own = if rival.source == Source::Model { ", the model's own" } else { "" };
        format!(
            "{} {} (peak {}){own}",
            rival.kind.name(),
            units.torque(figures.all.rmse_nm),
            units.torque(figures.all.peak_nm)
        )
    });
    format!("With each curve of the combination: {}.", told.collect::<Vec<_>>().join("; "))
}

/// Unit and factor that suit the error over all trials.
fn scale(found: &Evaluation, units: &Units) -> (&'static str, f64) {
    units.torque_scale(found.overall().all.rmse_nm)
}

/// Words of a group.
fn group_name(group: &Group, units: &Units) -> String {
    let speed =
        group.protocol.speed_rad_s().map_or(String::new(), |v| format!(" {} {}", significant(v, 3), units.speed));
    let trajectory = group.trajectory.as_ref().map_or(String::new(), |name| format!(" {name}"));
    format!("{}{speed}{trajectory}", group.protocol.name())
}

fn groups_table(found: &Evaluation, units: &Units) -> Table {
    let (unit, factor) = scale(found, units);
    let row = |group: &Group| {
        let scaled = |s: Spread| with_spread(factor * s.mean, factor * s.sd);
        let note = if group.repeats { "repeats" } else { "different motions" };
        vec![
            group_name(group, units),
            count(group.trials.len()),
            scaled(group.rmse_nm),
            scaled(group.mae_nm),
            note.to_string(),
        ]
    };
    Table {
        title: "By motion".to_string(),
        intro: "Mean ± standard deviation over trials, both sides low-passed.".to_string(),
        heads: vec!["motion".into(), "trials".into(), format!("RMSE ({unit})"), format!("MAE ({unit})"), "".into()],
        rows: found.groups.iter().map(row).collect(),
    }
}

fn curves_table(found: &Evaluation, units: &Units) -> Table {
    let (unit, factor) = scale(found, units);
    let figure = |x: f64| significant(factor * x, 3);
    let row = |(at, rival): (usize, &Rival)| {
        let split = found.together(|t| &t.rivals[at]);
        let own = parameter(&rival.curve).map_or(String::new(), |(name, x)| format!("{name} = {}", significant(x, 4)));
        vec![
            rival.kind.name().to_string(),
            own,
            rival.source.name().to_string(),
            figure(split.all.rmse_nm),
            figure(split.all.mae_nm),
            figure(split.stable.rmse_nm),
            figure(split.transition.rmse_nm),
            figure(split.transition.peak_nm),
        ]
    };
    let heads =
        ["curve", "parameter", "parameter from", "RMSE", "MAE", "stable RMSE", "transition RMSE", "transition peak"];
    Table {
        title: "By curve of the combination".to_string(),
        intro: format!("All trials together, low-passed, in {unit}. Sign is the model without any coefficient."),
        heads: heads.map(String::from).to_vec(),
        rows: found.rivals.iter().enumerate().map(row).collect(),
    }
}

fn trials_table(found: &Evaluation, units: &Units) -> Table {
    let (unit, factor) = scale(found, units);
    let figure = |x: f64| significant(factor * x, 3);
    let row = |t: &TrialEvaluation| {
        let Split { all, stable, transition } = t.filtered;
        vec![
            t.entry.file.clone(),
            count(all.samples),
            figure(all.rmse_nm),
            figure(all.mae_nm),
            figure(all.peak_nm),
            significant(all.rmse_percent, 3),
            figure(stable.rmse_nm),
            figure(transition.rmse_nm),
            figure(t.raw.all.rmse_nm),
        ]
    };
    let heads = ["trial", "samples", "RMSE", "MAE", "peak", "RMSE %", "stable RMSE", "transition RMSE", "raw RMSE"];
    Table {
        title: "By trial".to_string(),
        intro: format!(
            "In {unit}, low-passed, but for the raw RMSE. Percent is of the measured torque's range in the trial."
        ),
        heads: heads.map(String::from).to_vec(),
        rows: found.trials.iter().map(row).collect(),
    }
}

/// Writes the summary to `out`; `written` is where the files went.
pub fn write_summary(out: &mut impl Write, found: &Evaluation, campaign: &str, written: &Path) -> io::Result<()> {
    let units = Units::of(found.model.joint.kind);
    let trials = counted(found.trials.len(), "trial", "trials");
    writeln!(out, "{BOLD}{}{BOLD:#}  {DIM}judged on {trials} of campaign {campaign}{DIM:#}", found.model.joint.name)?;
    heading(out, &format!("Error, both sides low-passed at {} Hz", significant(found.lowpass_hz, 3)))?;
    writeln!(out, "  {DIM}{:<24} {:>7} {:>22} {:>22}{DIM:#}", "motion", "trials", "RMSE", "MAE")?;
    let (unit, factor) = scale(found, &units);
    for group in &found.groups {
        let scaled = |s: Spread| format!("{} {unit}", with_spread(factor * s.mean, factor * s.sd));
        let (name, number) = (group_name(group, &units), group.trials.len());
        writeln!(out, "  {name:<24} {number:>7} {:>22} {:>22}", scaled(group.rmse_nm), scaled(group.mae_nm))?;
    }
    heading(out, "By curve of the combination, all trials together")?;
    writeln!(
        out,
        "  {DIM}{:<10} {:>12} {:>14} {:>16} {:>14}{DIM:#}",
        "curve", "RMSE", "stable state", "transition", "peak"
    )?;
    for (at, rival) in found.rivals.iter().enumerate() {
        let Split { all, stable, transition } = found.together(|t| &t.rivals[at]);
        let [rmse, stable, transition, peak] =
            [all.rmse_nm, stable.rmse_nm, transition.rmse_nm, all.peak_nm].map(|x| units.torque(x));
        let own = if rival.source == Source::Model { "the model's" } else { "" };
        writeln!(out, "  {:<10} {rmse:>12} {stable:>14} {transition:>16} {peak:>14}  {own}", rival.kind.name())?;
    }
    let raw = found.together(|t| &t.raw).all;
    writeln!(
        out,
        "\n  Raw, neither side filtered: RMSE {}, MAE {}",
        units.torque(raw.rmse_nm),
        units.torque(raw.mae_nm)
    )?;
    distrust(out, &found.warnings)?;
    writeln!(out, "\nwritten to {BOLD}{}{BOLD:#}: evaluation.json, report.html, plots", written.display())
}
