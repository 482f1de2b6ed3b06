//! The page of a diagnosis.

use super::evidence::evidence;
use super::next::next_steps;
use super::tables::{candidates_table, changes_table, contacts_table, decisions_table, formulas, places_table};
use super::words::{kept_together, percent, short, shrink, taken};
use crate::diagnose::{Diagnosis, Floor, FloorSource, Kind, Verdict};
use crate::report::chart::Figure;
use crate::report::number::count;
use crate::report::page::{Block, Card, Page, Section, Table, Warning};
use crate::report::plots::diagnosis::{Figures, budget::added, figures};
use crate::report::wording::Units;

/// The page of `found`.
pub fn page(found: &Diagnosis, campaign: &str, model: &str) -> Page {
    let Figures { budget, map, candidates, places, position, trials, motion } = figures(found);
    let of = |figures: Vec<Option<Figure>>, tables: Vec<Option<Table>>| -> Vec<Block> {
        let figures = figures.into_iter().flatten().map(Block::Figure);
        figures.chain(tables.into_iter().flatten().map(Block::Table)).collect()
    };
    let trials: Vec<_> = trials.into_iter().map(|(name, figure)| (name, vec![figure])).collect();
    let traces = if trials.is_empty() { Vec::new() } else { vec![Block::Choice("trial", trials)] };
    let is_unknown = found.verdict.kind == Kind::Unknown;
    let fitted_title = if is_unknown { "What fits best, but not well enough" } else { "What was found: parameters" };
    let changes = changes_table(found).map(Block::Table);
    let sections = [
        Section::open("Where the gap lies", of(vec![map], Vec::new())),
        Section::open("Residual over time", traces),
        Section::open("Candidate causes", of(vec![candidates], vec![candidates_table(found)])),
        Section::open(fitted_title, changes.into_iter().chain(formulas(found)).collect()),
        Section::open("Compared with the simulator", of(vec![motion], Vec::new())),
        Section::open("What the gap depends on", of(vec![places, position], vec![places_table(found)])),
        Section::folded("Contact events", of(Vec::new(), vec![contacts_table(found)])),
        Section::open("Evidence", vec![Block::List(evidence(found))]),
        Section::folded("Decision rules", of(Vec::new(), vec![decisions_table(found)])),
    ];
    Page {
        kicker: format!("tautline diagnose · campaign {campaign} · model {model}"),
        title: found.before.joint.name.clone(),
        subject: "diagnosis".to_string(),
        short: short(found),
        lead: vec![budget],
        next: next_steps(found),
        cards: cards(found),
        warnings: found.warnings.iter().map(Warning::from).collect(),
        sections: sections.into_iter().filter(|section| !section.blocks.is_empty()).collect(),
        provenance: vec![
            ("campaign", campaign.to_string()),
            ("model", model.to_string()),
            ("trials", count(found.views.len())),
            ("samples scored", scored(found)),
            ("held out in turn", found.held_out.to_string()),
        ],
    }
}

/// How many samples are scored, of how many.
fn scored(found: &Diagnosis) -> String {
    let judged = || found.views.iter().flat_map(|view| &view.judged);
    format!("{} of {}", count(judged().filter(|judged| **judged).count()), count(judged().count()))
}

/// How sure the verdict is, the gap, how much of it is explained, what remains, the floor.
fn cards(found: &Diagnosis) -> Vec<Card> {
    let units = Units::of(&found.before.joint);
    let (gap, verdict) = (&found.gap, &found.verdict);
    // Side by side in one unit.
    let torque = |value_nm: f64| units.torque_beside(value_nm, gap.rmse_nm);
    let card =
        |name: &str, value: String, note: String| Card { name: name.to_string(), value, note: kept_together(&note) };
    let mut all = vec![
        card(
            "confidence",
            percent(verdict.confidence),
            format!("{}: the share of such verdicts that was right on simulated joints", of_what(verdict)),
        ),
        card(
            "gap as delivered",
            torque(verdict.gap_before_nm),
            format!(
                "RMS above the noise floor; RMSE {}, {} of the torque's RMS",
                torque(gap.rmse_nm),
                percent(gap.rmse_nm / torque_rms_nm(found))
            ),
        ),
    ];
    if verdict.tells_of_a_gap() && verdict.gap_before_nm > 0.0 {
        let own = added(None, found).map_or_else(String::new, |share| {
            format!(
                "; {} of the gap could also be due to the model's own parameters, within their confidence",
                percent(share)
            )
        });
        all.push(card("explained", shrink(verdict.shrink), format!("of the gap, on held-out {}{own}", found.held_out)));
        let rmse = taken(found).map(|candidate| format!("; held-out RMSE {}", torque(candidate.held_out_rmse_nm)));
        let rmse = rmse.last().unwrap_or_default();
        let within = taken(found).last().is_some_and(|last| last.held_out_rmse_nm <= gap.floor.upper_nm());
        let note = if within { "within the noise floor" } else { "RMS above the noise floor" };
        all.push(card("remains", torque(verdict.gap_after_nm), format!("{note}{rmse}")));
    }
    let floor = format!("upper limit; estimate {}, {}", torque(gap.floor.rms_nm), source(&gap.floor));
    all.push(card("noise floor", torque(gap.floor.upper_nm()), floor));
    if let Some(motion) = &found.motion {
        let (name, value, note) = super::motion::card(motion, found.before.joint.kind);
        all.push(Card { name, value, note });
    }
    all
}

/// What the confidence is in.
fn of_what(verdict: &Verdict) -> String {
    match verdict.kind {
        Kind::Ambiguous => format!("that it is one of the {}", verdict.effects.len()),
        _ => "in the verdict".to_string(),
    }
}

/// Where the floor comes from, in a few words: the evidence says more.
fn source(floor: &Floor) -> &'static str {
    match floor.source {
        _ if floor.encoder_nm.powi(2) > floor.rms_nm.powi(2) / 2.0 => "mostly the encoder's errors",
        FloorSource::Repeats => "from repeats of one motion",
        FloorSource::Spectrum => "from noise above the low-pass",
        FloorSource::Unforeseen => "the whole residual: no fit predicts it",
    }
}

/// RMS of the measured torque over the samples that are scored, N m.
fn torque_rms_nm(found: &Diagnosis) -> f64 {
    let scored = found.views.iter().flat_map(|view| view.measured_nm.iter().zip(&view.judged));
    let squares: Vec<f64> = scored.filter(|(_, judged)| **judged).map(|(torque_nm, _)| torque_nm * torque_nm).collect();
    (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt().max(f64::MIN_POSITIVE)
}
