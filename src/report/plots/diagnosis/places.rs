//! Where the gap lies: its share by region, as bars.

use crate::diagnose::Diagnosis;
use crate::report::chart::{Anchor, Axis, Figure, Panel, palette};
use crate::report::diagnosis::names::bounds;
use crate::report::diagnosis::words::percent;
use crate::report::wording::Units;

/// Regions shown.
const SHOWN: usize = 8;
/// Height of a region, px: its bar and its details below.
const PITCH_PX: f64 = 46.0;

const CAPTION: &str = "The share of the gap that a function of each quantity alone accounts for, with the narrowest range that holds most \
                       of the gap. Shares are of the gap's mean square, because only squares can be divided by place; the quantities are \
                       correlated, so the shares do not add up to 100 %.";

/// The bars; `None` without any region, or without a gap.
pub(super) fn figure(found: &Diagnosis) -> Option<Figure> {
    let places = &found.places[..SHOWN.min(found.places.len())];
    if places.is_empty() || !found.verdict.tells_of_a_gap() {
        return None;
    }
    let units = Units::of(&found.before.joint);
    let x = Axis::linear("share of the gap's mean square (%)", 0.0, 100.0);
    let mut panel = Panel::new(x, Axis::names(places.iter().map(bounds)));
    for (row, at) in places.iter().enumerate() {
        let level = -(row as f64) - 0.5;
        panel.bar("", (0.0, 100.0 * at.share_of_gap.clamp(0.0, 1.0)), (level + 0.05, level + 0.4), palette::BLUE);
        let details = format!("{} of samples, RMS {}", percent(at.share_of_samples), units.torque(at.rmse_nm));
        panel.texts(vec![((0.8, level - 0.18), details)], Anchor::Left, palette::GREY);
        panel.beside.push((level + 0.22, percent(at.share_of_gap)));
    }
    let height = PITCH_PX * places.len() as f64;
    Some(Figure::single("where", "Share of the gap by quantity", CAPTION, height, panel))
}
