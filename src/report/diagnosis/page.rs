//! The page of a diagnosis.

use super::next::next_steps;
use super::tables::{candidates_table, changes_table, contacts_table, decisions_table, places_table};
use super::words::{grounds, percent, shrink, verdict};
use crate::diagnose::{Diagnosis, FloorSource, Kind};
use crate::report::chart::Figure;
use crate::report::number::count;
use crate::report::page::{Block, Card, Page, Section, Table, Warning};
use crate::report::plots::diagnosis::{Figures, figures};
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
    let found_title =
        if found.verdict.kind == Kind::Unknown { "What fits best, but not well enough" } else { "What was found" };
    let sections = [
        Section::open("The traces behind it", traces),
        Section::open("Candidate causes", of(vec![candidates], vec![candidates_table(found)])),
        Section::open(found_title, of(Vec::new(), vec![changes_table(found)])),
        Section::open("Beside the simulator", of(vec![motion], Vec::new())),
        Section::open("Where the gap lies", of(vec![places, position], vec![places_table(found)])),
        Section::folded("Stretches that stand out", of(Vec::new(), vec![contacts_table(found)])),
        Section::open("Grounds", vec![Block::List(grounds(found))]),
        Section::folded("Rules that decided", of(Vec::new(), vec![decisions_table(found)])),
    ];
    Page {
        kicker: format!("tautline diagnose · campaign {campaign} · model {model}"),
        title: found.before.joint.name.clone(),
        subject: "diagnosis".to_string(),
        short: format!(
            "{} This verdict is right with a probability of {}.",
            verdict(found),
            percent(found.verdict.confidence)
        ),
        lead: std::iter::once(budget).chain(map).collect(),
        next: next_steps(found),
        cards: cards(found),
        warnings: found.warnings.iter().map(Warning::from).collect(),
        sections: sections.into_iter().filter(|section| !section.blocks.is_empty()).collect(),
        provenance: vec![
            ("campaign", campaign.to_string()),
            ("model", model.to_string()),
            ("trials", count(found.views.len())),
            (
                "samples scored",
                count(found.views.iter().flat_map(|view| &view.judged).filter(|judged| **judged).count()),
            ),
            ("held out in turn", found.held_out.to_string()),
        ],
    }
}

fn cards(found: &Diagnosis) -> Vec<Card> {
    let units = Units::of(&found.before.joint);
    let (gap, verdict) = (&found.gap, &found.verdict);
    let card = |name: &str, value: String, note: String| Card { name: name.to_string(), value, note };
    let source = match gap.floor.source {
        FloorSource::Repeats => "from repeats of one motion",
        FloorSource::Spectrum => "from the noise beyond the low-pass",
        FloorSource::Unforeseen => "that no fit finds again on held-out data",
    };
    let mut all = vec![card(
        "gap as delivered",
        units.torque(verdict.gap_before_nm),
        format!("above the floor; RMSE {}", units.torque(gap.rmse_nm)),
    )];
    if verdict.kind != Kind::None {
        let note = format!("held out; shrinks by {}", shrink(verdict.shrink));
        all.push(card("gap with what was found", units.torque(verdict.gap_after_nm), note));
    }
    if let Some(motion) = &found.motion {
        let (name, value, note) = super::motion::card(motion, found.before.joint.kind);
        all.push(Card { name, value, note });
    }
    let floor = format!("at most: {} {source}, and its standard error", units.torque(gap.floor.rms_nm));
    all.push(card("floor", units.torque(gap.floor.upper_nm()), floor));
    all.push(card("verdict", percent(verdict.confidence), "probability that it is right".to_string()));
    all
}
