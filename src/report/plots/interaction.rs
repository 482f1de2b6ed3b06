//! The figures of an interaction: one per trial.

use super::slug;
use crate::interaction::{Interaction, TrialInteraction};
use crate::report::chart::{Axis, Drawn, Frame, Mark, Panel, Stroke, palette, span, svg, thin};
use crate::report::number::counted;
use crate::report::page::Drawing;
use crate::report::wording::Units;

/// Trials shown.
const SHOWN: usize = 8;
/// Stretches of time of which the lowest and highest point are drawn.
const BUCKETS: usize = 900;
/// Height of a contact's bar, as a share of the panel's.
const BAR: f64 = 0.02;

/// A figure per trial.
pub fn drawings(found: &Interaction) -> Drawn<Vec<Drawing>> {
    found.trials.iter().take(SHOWN).map(|trial| draw(found, trial)).collect()
}

fn draw(found: &Interaction, trial: &TrialInteraction) -> Drawn<Drawing> {
    let units = Units::of(found.model.joint.kind);
    let extracted = &trial.extracted;
    let name = &trial.entry.file;
    let reference = extracted.reference_nm.as_ref();
    let seen = (0..extracted.torque_nm.len()).filter(|i| extracted.known[*i]).map(|i| extracted.torque_nm[i]);
    let (low, high) = span(seen.chain(reference.into_iter().flatten().copied()));
    let y = Axis::around(format!("interaction torque ({})", units.torque), [low, high, 0.0], 0.08);
    let drawn = svg(860, 420, name, |canvas| {
        let (from_s, to_s) = span(extracted.time_s.iter().copied());
        let frame = Frame { left: 92.0, top: 44.0, right: 840.0, bottom: 364.0 };
        let panel = canvas.panel(frame, Axis::linear("time (s)", from_s, to_s), y)?;
        fill(&panel, found, trial)?;
        let mut entries = vec![
            (Mark::Line(1.3, None), palette::BLUE, "extracted".to_string()),
            (Mark::Band, palette::BLUE, "where 95 % of quiet samples lie".to_string()),
            (Mark::Line(5.0, None), palette::ORANGE, "contact".to_string()),
        ];
        if reference.is_some() {
            entries.push((Mark::Line(3.4, None), palette::PALE, "measured independently".to_string()));
        }
        canvas.legend((92.0, 840.0), 22.0, &entries)
    })?;
    Ok(Drawing {
        name: format!("interaction_{}", slug(name)),
        title: format!("{name}: {}", counted(trial.contacts.len(), "contact", "contacts")),
        caption: "The torque that a person adds, low-passed, with the band in which it would lie on quiet motion; the bar at the \
                  bottom marks contacts. The band widens around reversals, where friction changes over, and takes in the whole \
                  change of friction before the joint has moved through its clearance."
            .to_string(),
        svg: drawn,
    })
}

/// Bars of the contacts, the band, the reference, the torque on top.
fn fill(panel: &Panel, found: &Interaction, trial: &TrialInteraction) -> Drawn {
    let extracted = &trial.extracted;
    let n = extracted.torque_nm.len();
    let floor = panel.y.places.0;
    let top = floor + BAR * (panel.y.places.1 - floor);
    for contact in &trial.contacts {
        let (from, to) = (contact.onset_s, contact.release_s);
        panel.band(&[(from, floor), (to, floor)], &[(from, top), (to, top)], palette::ORANGE, 1.0)?;
    }
    let spread =
        |i: usize| found.quiet.levels.uncertainty(extracted.weak[i], extracted.known[i], extracted.change_nm[i]);
    let step = n.div_ceil(2 * BUCKETS).max(1);
    let edge = |sign: f64| -> Vec<(f64, f64)> {
        (0..n).step_by(step).map(|i| (extracted.time_s[i], sign * spread(i))).collect()
    };
    panel.band(&edge(-1.0), &edge(1.0), palette::BLUE, 0.18)?;
    let over_time = |values: &[f64]| -> Vec<(f64, f64)> {
        thin::envelope(&extracted.time_s.iter().copied().zip(values.iter().copied()).collect::<Vec<_>>(), BUCKETS)
    };
    if let Some(reference_nm) = &extracted.reference_nm {
        panel.line(over_time(reference_nm), Stroke::solid(palette::PALE, 3.4))?;
    }
    panel.line(over_time(&extracted.torque_nm), Stroke::solid(palette::BLUE, 1.3))
}
