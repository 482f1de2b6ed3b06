//! The page of a diagnosis.

use super::next::next_steps;
use super::tables::{candidates_table, changes_table, contacts_table, places_table};
use super::words::{grounds, percent, shrink, verdict};
use crate::diagnose::{Diagnosis, FloorSource, Kind};
use crate::report::number::count;
use crate::report::page::{Card, Drawing, Page};
use crate::report::wording::Units;

/// The page of `found`, with its `drawings`; the first `leading` of them stand before the tables.
pub fn page(found: &Diagnosis, campaign: &str, model: &str, drawings: Vec<Drawing>, leading: usize) -> Page {
    Page {
        kicker: format!("tautline diagnose · campaign {campaign} · model {model}"),
        title: found.before.joint.name.clone(),
        subject: "diagnosis".to_string(),
        short: verdict(found),
        steps: grounds(found),
        warnings: found.warnings.clone(),
        cards: cards(found),
        next: next_steps(found),
        tables: [candidates_table(found), changes_table(found), places_table(found), contacts_table(found)]
            .into_iter()
            .flatten()
            .collect(),
        drawings,
        leading,
        provenance: vec![
            ("tautline", env!("CARGO_PKG_VERSION").to_string()),
            ("campaign", campaign.to_string()),
            ("model", model.to_string()),
            ("trials", count(found.views.len())),
            (
                "samples judged",
                count(found.views.iter().flat_map(|view| &view.judged).filter(|judged| **judged).count()),
            ),
            ("held out in turn", found.held_out.to_string()),
        ],
    }
}

fn cards(found: &Diagnosis) -> Vec<Card> {
    let units = Units::of(found.before.joint.kind);
    let (gap, verdict) = (&found.gap, &found.verdict);
    let card = |name: &str, value: String, note: String| Card { name: name.to_string(), value, note };
    let source = match gap.floor.source {
        FloorSource::Repeats => "from repeats of one motion",
        FloorSource::Spectrum => "from the noise beyond the low-pass",
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
    all.push(card("floor", units.torque(gap.floor.rms_nm), source.to_string()));
    all.push(card("verdict", percent(verdict.confidence), "of the resamplings agree".to_string()));
    all
}
