//! The figures of an interaction: one per trial.

use crate::interaction::{Interaction, TrialInteraction};
use crate::report::chart::{Axis, Drawn, Frame, Mark, Stroke, palette, span, svg, thin};
use crate::report::number::counted;
use crate::report::page::Drawing;
use crate::report::wording::Units;

/// Trials shown.
const SHOWN: usize = 8;
/// Stretches of time of which the lowest and highest point are drawn.
const BUCKETS: usize = 900;

/// A figure per trial.
pub fn drawings(found: &Interaction) -> Drawn<Vec<Drawing>> {
    found.trials.iter().take(SHOWN).map(|trial| draw(found, trial)).collect()
}

fn draw(found: &Interaction, trial: &TrialInteraction) -> Drawn<Drawing> {
    let units = Units::of(found.model.joint.kind);
    let extracted = &trial.extracted;
    let n = extracted.torque_nm.len();
    let name = trial.entry.file.clone();
    let over_time = |values: &dyn Fn(usize) -> f64| -> Vec<(f64, f64)> {
        thin::envelope(&(0..n).map(|i| (extracted.time_s[i], values(i))).collect::<Vec<_>>(), BUCKETS)
    };
    let spread =
        |i: usize| found.quiet.levels.uncertainty(extracted.weak[i], extracted.known[i], extracted.change_nm[i]);
    let step = n.div_ceil(2 * BUCKETS).max(1);
    let edge = |sign: f64| -> Vec<(f64, f64)> {
        (0..n).step_by(step).map(|i| (extracted.time_s[i], extracted.torque_nm[i] + sign * spread(i))).collect()
    };
    let reference = extracted.reference_nm.as_ref();
    let seen = (0..n).filter(|i| extracted.known[*i]).map(|i| extracted.torque_nm[i]);
    let (low, high) = span(seen.chain(reference.into_iter().flatten().copied()));
    let y = Axis::around(format!("interaction torque ({})", units.torque), [low, high, 0.0], 0.08);
    let drawn = svg(860, 420, &name, |canvas| {
        let (from_s, to_s) = span(extracted.time_s.iter().copied());
        let frame = Frame { left: 92.0, top: 44.0, right: 840.0, bottom: 364.0 };
        let panel = canvas.panel(frame, Axis::linear("time (s)", from_s, to_s), y)?;
        let floor = panel.y.places.0;
        let height = 0.02 * (panel.y.places.1 - floor);
        for contact in &trial.contacts {
            let (from, to) = (contact.onset_s, contact.release_s);
            panel.band(
                &[(from, floor), (to, floor)],
                &[(from, floor + height), (to, floor + height)],
                palette::ORANGE,
                1.0,
            )?;
        }
        panel.band(&edge(-1.0), &edge(1.0), palette::BLUE, 0.18)?;
        if let Some(reference) = reference {
            panel.line(over_time(&|i| reference[i]), Stroke::solid(palette::PALE, 3.4))?;
        }
        panel.line(over_time(&|i| extracted.torque_nm[i]), Stroke::solid(palette::BLUE, 1.3))?;
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
    let stem: String =
        name.chars().map(|c| if c.is_alphanumeric() || matches!(c, '-' | '_') { c } else { '_' }).collect();
    Ok(Drawing {
        name: format!("interaction_{stem}"),
        title: format!("{name}: {}", counted(trial.contacts.len(), "contact", "contacts")),
        caption: "The torque that a person adds, low-passed, with the band in which it would lie on quiet motion; the bar at the \
                  bottom marks contacts. The band widens around reversals, where friction changes over, and takes in the whole \
                  change of friction before the joint has moved through its clearance."
            .to_string(),
        svg: drawn,
    })
}
