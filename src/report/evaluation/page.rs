//! The page of an evaluation.

use super::{group_name, scale};
use crate::evaluate::{Evaluation, Figures, Group, Rival, Source, Split, Spread, TrialEvaluation};
use crate::report::identification::parameter;
use crate::report::number::{count, counted, significant, with_spread};
use crate::report::page::{Block, Card, Page, Section, Table, Warning, cells};
use crate::report::plots;
use crate::report::wording::Units;

/// A curve whose RMSE is below this share of that of the model's own curve is mentioned.
const BETTER: f64 = 0.8;
/// So many times the error of the stable state in transitions is worth a word.
const AFTER_REVERSALS: f64 = 1.5;

/// The page of `found`.
pub fn page(found: &Evaluation, campaign: &str, model: &str) -> Page {
    let units = Units::of(&found.model.joint);
    let overall = found.overall();
    let card = |name: &str, value: String, note: String| Card { name: name.to_string(), value, note };
    let raw = found.together(|t| &t.raw).all;
    Page {
        kicker: format!("tautline evaluate · campaign {campaign} · model {model}"),
        title: found.model.joint.name.clone(),
        subject: "evaluation".to_string(),
        short: verdict(found, &units),
        warnings: found.warnings.iter().map(Warning::from).collect(),
        cards: vec![
            card("RMSE", units.torque(overall.all.rmse_nm), percent_of(&overall.all)),
            card("stable state", units.torque(overall.stable.rmse_nm), "RMSE, |K_f| = 1".to_string()),
            card("transition", units.torque(overall.transition.rmse_nm), "RMSE, |K_f| < 1".to_string()),
            card("peak", units.torque(overall.all.peak_nm), "largest error".to_string()),
            card("raw RMSE", units.torque(raw.rmse_nm), "neither side filtered".to_string()),
        ],
        lead: vec![plots::evaluation::bars(found)],
        next: next(found, &units),
        sections: vec![
            Section::open("Trial by trial", vec![Block::Choice("trial", plots::evaluation::trials(found))]),
            Section::open("By trial", vec![Block::Table(trials_table(found, &units))]),
            Section::open("By motion", vec![Block::Table(groups_table(found, &units))]),
            Section::folded(
                "By change-over curve",
                vec![Block::List(vec![comparison(found, &units)]), Block::Table(curves_table(found, &units))],
            ),
        ],
        provenance: vec![
            ("campaign", campaign.to_string()),
            ("model", model.to_string()),
            ("trials evaluated", count(found.trials.len())),
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
        "RMSE over {trials}: {} ({}); {} in stable state, {} in transitions. The largest error is {}.",
        units.torque(all.rmse_nm),
        percent_of(&all),
        units.torque(stable.rmse_nm),
        units.torque(transition.rmse_nm),
        units.torque(all.peak_nm),
    )
}

/// What to do next, a sentence each.
fn next(found: &Evaluation, units: &Units) -> Vec<String> {
    let Split { stable, transition, .. } = found.overall();
    let mut steps = Vec::new();
    let rmse_nm = |at: usize| found.together(|t| &t.rivals[at]).all.rmse_nm;
    let own = found.rivals.iter().position(|rival| rival.source == Source::Model);
    let best = (0..found.rivals.len()).min_by(|a, b| rmse_nm(*a).total_cmp(&rmse_nm(*b)));
    if let (Some(own), Some(best)) = (own, best)
        && rmse_nm(best) < BETTER * rmse_nm(own)
    {
        let (name, figure) = (found.rivals[best].kind.name(), units.torque(rmse_nm(best)));
        steps.push(format!(
            "The change-over curve {name} has an RMSE of {figure}, less than the model's own: identify the joint again."
        ));
    }
    if transition.rmse_nm > AFTER_REVERSALS * stable.rmse_nm {
        let step = "The error is largest after reversals: check the clearance (identify --estimate-backlash) and the change-over curve.";
        steps.push(step.to_string());
    }
    let step = "To see whether the error is more than noise, and what causes it: tautline diagnose CAMPAIGN --model MODEL -o FOLDER.";
    steps.push(step.to_string());
    steps
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
    format!("With each change-over curve: {}.", told.collect::<Vec<_>>().join("; "))
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
        title: String::new(),
        intro: "Mean ± standard deviation over trials, both sides low-passed.".to_string(),
        heads: vec!["motion".into(), "trials".into(), format!("RMSE ({unit})"), format!("MAE ({unit})"), "".into()],
        rows: found.groups.iter().map(row).map(cells).collect(),
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
        title: String::new(),
        intro: format!(
            "All trials together, low-passed, in {unit}. Sign is the model without the paper's combination coefficient: friction changes over at once."
        ),
        heads: heads.map(String::from).to_vec(),
        rows: found.rivals.iter().enumerate().map(row).map(cells).collect(),
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
        title: String::new(),
        intro: format!(
            "In {unit}, low-passed, except the raw RMSE. Percent is of the measured torque's range in the trial."
        ),
        heads: heads.map(String::from).to_vec(),
        rows: found.trials.iter().map(row).map(cells).collect(),
    }
}
