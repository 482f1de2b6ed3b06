//! The tables of a diagnosis's page.

use super::names::{Role, bounds, formula, means};
use super::parameters::{Shown, shown};
use super::words::{percent, shrink, taken};
use crate::diagnose::{Candidate, Decision, Diagnosis};
use crate::report::number::significant;
use crate::report::page::{Block, Cell, Table};
use crate::report::plots::diagnosis::budget::added;
use crate::report::wording::Units;

/// Contact events listed, the largest first.
const CONTACTS: usize = 20;

fn table(intro: &str, heads: &[&str], rows: Vec<Vec<String>>) -> Option<Table> {
    (!rows.is_empty()).then(|| Table::new("", intro, heads, rows))
}

/// Every cause that was tried, best first.
pub fn candidates_table(found: &Diagnosis) -> Option<Table> {
    let units = Units::of(&found.before.joint);
    let is_hidden = |cause: &str| found.blind_spots.iter().any(|spot| spot.hides.contains(&cause));
    let row = |candidate: &Candidate| {
        let rival_of = taken(found).filter(|taken| taken.trades_with.contains(&candidate.cause));
        let role = match Role::of(candidate, found) {
            Role::Rival => format!("rival of {}", rival_of.map(|c| c.cause.name()).collect::<Vec<_>>().join(", ")),
            Role::Other | Role::Beside if is_hidden(candidate.cause.name()) => "not testable here".to_string(),
            role => role.name().to_string(),
        };
        vec![
            candidate.cause.name().to_string(),
            role,
            candidate.how.to_string(),
            added(Some(candidate.cause), found).map_or_else(String::new, percent),
            shrink(candidate.shrink),
            units.torque_beside(candidate.held_out_rmse_nm, found.gap.rmse_nm),
        ]
    };
    let mut told = table(
        "Each candidate is fitted together with the model's own parameters, which stay within their confidence, and scored on held-out data: \
         how far the gap shrinks, with a 95 % bootstrap interval. Where the verdict names several causes, their rows are those of all of \
         them together (\"adds\" is the part of each), and any other candidate is fitted in the place of one of them, or \"in addition\" \
         to all of them, where it gains too little to be named. A rival explains these data as well as the cause that it stands for. What \
         is \"not testable here\" needs a motion that these recordings lack (see the next steps).",
        &["cause", "verdict", "variant", "adds", "gap shrinks by", "held-out RMSE"],
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
            decision.outcome.to_string(),
        ]
    };
    table(
        "The limit that a cause must reach to be named, the value that each named cause reaches, and where the best of the others fall short. \
         \"share of the gap\", \"floors\" and \"encoder\" compare the reduction of the mean square, (N m)², with a share of the gap, with \
         the floor, and with the reduction that the encoder's errors alone would give; \"standard errors\" and \"clusters that gain\" ask \
         whether most trials or cycles improve; \"prior penalty\" is how far a first cause that the base imitates lowers the sum of the base's squared \
         moves, in standard deviations; \"distinct\" is the share of the reduction that no other cause gives, which a weak cause \
         must have; \"oscillation\" is the power of a line in the spectrum of the remainder over that of its neighbourhood; \
         \"repeats\" is what repeats of one motion differ by, over what the noise beyond the low-pass and the encoder would give; \
         \"form\", \"open\" and \"named\" compare the remainder, N m RMS above the floor; \"clear\" compares the gap with \
         the floor and the remainder with the gap, N m RMS (it selects the simulated verdicts that the probability is taken from, and which \
         causes need agreement); \"agreement\" is the share of the resamples that agree on the causes of a weak gap, or on the first of several that \
         are not clear; \"held out\" asks how much a flexible fit leaves, N m RMS above the floor: on trials, against what may be left of a named \
         gap, and on motion cycles, against what it leaves on trials (over the root of 2).",
        &["cause", "rule", "value", "limit", "outcome"],
        found.verdict.decisions.iter().map(row).collect(),
    )
}

/// The formula of each cause that the verdict names; nothing where there is none.
pub fn formulas(found: &Diagnosis) -> Option<Block> {
    let one = |candidate: &Candidate| {
        let name = Cell::from(candidate.cause.name().to_string());
        (name, format!("{}: {}", means(candidate.cause), formula(candidate.cause)))
    };
    let all: Vec<(Cell, String)> = taken(found).map(one).collect();
    (!all.is_empty()).then_some(Block::Terms(all))
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
    table(
        "Parameters that were added or refitted, with 95 % bootstrap intervals. Formulas below.",
        &["parameter", "as delivered", "fitted", "95 % interval", "unit", "warning"],
        taken(found).flat_map(of).collect(),
    )
}

/// Where the gap lies; nothing where there is none.
pub fn places_table(found: &Diagnosis) -> Option<Table> {
    let units = Units::of(&found.before.joint);
    let row = |at: &crate::diagnose::Place| {
        vec![bounds(at), percent(at.share_of_gap), percent(at.share_of_samples), units.torque(at.rmse_nm)]
    };
    let places = if found.verdict.tells_of_a_gap() { &found.places[..] } else { &[] };
    table(
        "The share of the gap's mean square that a function of each quantity alone accounts for, and the narrowest range that holds most of \
         the gap. The quantities are correlated, so the shares do not add up to 100 %.",
        &["quantity and range", "share of the gap", "samples in the range", "RMS in the range"],
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
        "Stretches of torque that nothing recorded explains and that do not repeat with the motion, the largest first. They are left out of \
         every fit.",
        &["trial", "from, to", "peak"],
        all.iter().take(CONTACTS).map(row).collect(),
    )
}
