//! The tables of a diagnosis's page.

use super::names::{Role, bounds, claim, formula, means};
use super::parameters::{Shown, shown};
use super::words::{clearness, percent, shrink, taken};
use crate::diagnose::{Candidate, Decision, Diagnosis, Kind};
use crate::report::number::significant;
use crate::report::page::Table;
use crate::report::plots::diagnosis::budget::added;
use crate::report::wording::Units;

/// Contacts told, the largest first.
const CONTACTS: usize = 20;

fn table(intro: &str, heads: &[&str], rows: Vec<Vec<String>>) -> Option<Table> {
    (!rows.is_empty()).then(|| Table::new("", intro, heads, rows))
}

/// Every cause that was tried, best first.
pub fn candidates_table(found: &Diagnosis) -> Option<Table> {
    let units = Units::of(&found.before.joint);
    let row = |candidate: &Candidate| {
        let rival_of = taken(found).filter(|taken| taken.trades_with.contains(&candidate.cause));
        let role = match Role::of(candidate, found) {
            Role::Rival => format!("rival of {}", rival_of.map(|c| c.cause.name()).collect::<Vec<_>>().join(", ")),
            role => role.name().to_string(),
        };
        vec![
            candidate.cause.name().to_string(),
            role,
            candidate.how.to_string(),
            added(Some(candidate.cause), found).map_or_else(String::new, percent),
            shrink(candidate.shrink),
            units.torque(candidate.held_out_rmse_nm),
        ]
    };
    let mut told = table(
        "Best first. Each is fitted along with the model's own parameters, which move within their confidence, and scored on \
         held-out data: how far the gap above the floor shrinks, with a 95 % bootstrap interval. Where several were taken, they \
         stand with all of them together, and any other in the place of one of them; \"adds\" is each one's part of the shrink of them \
         all. A rival does as well as what was taken, on these data.",
        &["cause", "verdict", "how", "adds", "gap shrinks by", "held-out RMSE"],
        found.candidates.iter().map(row).collect(),
    )?;
    for (row, candidate) in told.rows.iter_mut().zip(&found.candidates) {
        row[0].meaning = means(candidate.cause).to_string();
    }
    Some(told)
}

/// Every rule that decided.
pub fn decisions_table(found: &Diagnosis) -> Option<Table> {
    let row = |decision: &Decision| {
        vec![
            decision.subject.to_string(),
            decision.rule.to_string(),
            significant(decision.value, 3),
            significant(decision.limit, 3),
            clearness(found).filter(|_| decision.rule == "clear").unwrap_or(decision.outcome).to_string(),
        ]
    };
    table(
        "What a cause must reach to be named, what those that were named reach, and where the best of the others fall short. The rules \
         \"share of the gap\", \"floors\" and \"encoder\" compare its gain in mean square, (N m)^2, with a share of the gap, of the \
         floor, and with what the encoder's errors alone would let it gain; \"standard errors\" and \"clusters that gain\" ask whether it \
         gains in most trials or cycles; \"distinct\" is the share of its gain in which it is ahead of every other cause, which a weak \
         one must be; \"clear\" is the least of those where one cause is named, and where several are, how many times the least \
         share of the gap the weakest explains: it decides nothing, but from which simulated verdicts the probability is taken; \"form\", \"open\" and \"named\" compare what is left, N m RMS above the floor.",
        &["of", "rule", "value", "limit", "outcome"],
        found.verdict.decisions.iter().map(row).collect(),
    )
}

/// What the causes that were taken change, parameter by parameter.
pub fn changes_table(found: &Diagnosis) -> Option<Table> {
    let row = |candidate: &Candidate, p: &Shown| {
        vec![
            format!("{} {}", candidate.cause.name(), p.name),
            p.before.clone().unwrap_or_else(|| "–".to_string()),
            p.value.clone(),
            p.interval.clone(),
            p.unit.clone(),
            p.doubt.unwrap_or("").to_string(),
        ]
    };
    let of = |candidate: &Candidate| shown(candidate, found).iter().map(|p| row(candidate, p)).collect::<Vec<_>>();
    let formulas: Vec<String> = taken(found).map(|c| format!("{}: {}", claim(c.cause), formula(c.cause))).collect();
    let intro = format!("What is added or moved, with 95 % bootstrap intervals: {}", formulas.join("; ") + ".");
    table(
        &intro,
        &["parameter", "delivered", "fitted", "95 % interval", "unit", "doubt"],
        taken(found).flat_map(of).collect(),
    )
}

/// Where the gap lies; nothing where there is none.
pub fn places_table(found: &Diagnosis) -> Option<Table> {
    let units = Units::of(&found.before.joint);
    let row = |at: &crate::diagnose::Place| {
        vec![bounds(at), percent(at.share_of_gap), percent(at.share_of_samples), units.torque(at.rmse_nm)]
    };
    let places = if found.verdict.kind == Kind::None { &[][..] } else { &found.places };
    table(
        "What the gap goes with, and the bounds within which most of it stands; shares are of the gap's mean square. One gap may show \
         in several ways, so they do not add up.",
        &["where", "share of the gap", "samples within", "RMS within"],
        places.iter().map(row).collect(),
    )
}

/// Stretches of contact, the largest first.
pub fn contacts_table(found: &Diagnosis) -> Option<Table> {
    let units = Units::of(&found.before.joint);
    let mut all: Vec<&crate::diagnose::Contact> = found.contacts.iter().collect();
    all.sort_by(|a, b| b.peak_nm.abs().total_cmp(&a.peak_nm.abs()));
    let row = |contact: &&crate::diagnose::Contact| {
        let from_to = format!("{} to {} s", significant(contact.from_s, 4), significant(contact.to_s, 4));
        vec![contact.file.clone(), from_to, units.torque(contact.peak_nm)]
    };
    table(
        "Torque that follows nothing recorded and is not there again when the motion is, the largest first. They are left out \
         of every fit.",
        &["trial", "from, to", "peak"],
        all.iter().take(CONTACTS).map(row).collect(),
    )
}
