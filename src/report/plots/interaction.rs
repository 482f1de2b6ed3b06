//! The figures of an interaction: one per trial.

use super::slug;
use crate::interaction::{Interaction, TrialInteraction};
use crate::report::chart::{Axis, Figure, Panel, Point, Stroke, palette, span};
use crate::report::number::counted;
use crate::report::wording::Units;

/// Height of a contact's bar, as a share of the panel's.
const BAR: f64 = 0.02;
/// Points of the band's edges.
const EDGE: usize = 1800;

/// A figure for each trial, with the trial's name.
pub fn figures(found: &Interaction) -> Vec<(String, Figure)> {
    found.trials.iter().map(|trial| (trial.entry.file.clone(), figure(found, trial))).collect()
}

fn figure(found: &Interaction, trial: &TrialInteraction) -> Figure {
    let units = Units::of(&found.model.joint);
    let extracted = &trial.extracted;
    let name = &trial.entry.file;
    let reference = extracted.reference_nm.as_ref();
    let seen = (0..extracted.torque_nm.len()).filter(|i| extracted.known[*i]).map(|i| extracted.torque_nm[i]);
    let (low, high) = span(seen.chain(reference.into_iter().flatten().copied()));
    let y = Axis::around(format!("interaction torque ({})", units.torque), [low, high, 0.0], 0.08);
    let (from_s, to_s) = span(extracted.time_s.iter().copied());
    let mut panel = Panel::new(Axis::linear("time (s)", from_s, to_s), y);
    fill(&mut panel, found, trial);
    Figure::single(
        &format!("interaction_{}", slug(name)),
        format!("{name}: {}", counted(trial.contacts.len(), "contact", "contacts")),
        "The torque that a person adds, low-passed, with the band in which it would lie on quiet motion; the bar at the \
         bottom marks contacts. The band widens around reversals, where friction changes over, and includes the whole \
         change of friction before the joint has moved through its clearance.",
        320.0,
        panel,
    )
}

/// Bars of the contacts, the band, the reference, the torque on top.
fn fill(panel: &mut Panel, found: &Interaction, trial: &TrialInteraction) {
    let extracted = &trial.extracted;
    let n = extracted.torque_nm.len();
    let floor = panel.y.places.0;
    let top = floor + BAR * (panel.y.places.1 - floor);
    for contact in &trial.contacts {
        panel.bar("contact", (contact.onset_s, contact.release_s), (floor, top), palette::ORANGE);
    }
    let spread =
        |i: usize| found.quiet.levels.uncertainty(extracted.weak[i], extracted.known[i], extracted.change_nm[i]);
    let step = n.div_ceil(EDGE).max(1);
    let edge =
        |sign: f64| -> Vec<Point> { (0..n).step_by(step).map(|i| (extracted.time_s[i], sign * spread(i))).collect() };
    panel.band("where 95 % of quiet samples lie", [edge(-1.0), edge(1.0)], palette::BLUE, 0.18);
    let over_time =
        |values: &[f64]| -> Vec<Point> { extracted.time_s.iter().copied().zip(values.iter().copied()).collect() };
    if let Some(reference_nm) = &extracted.reference_nm {
        panel.line("measured independently", over_time(reference_nm), Stroke::solid(palette::PALE, 3.4));
    }
    panel.line("extracted", over_time(&extracted.torque_nm), Stroke::solid(palette::BLUE, 1.3));
}
