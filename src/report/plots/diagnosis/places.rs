//! Where the gap lies: its share by region, as bars.

use crate::diagnose::{Diagnosis, Kind, Place};
use crate::report::chart::{Anchor, Axis, Canvas, Drawn, Frame, LABEL_PX, TEXT_PX, palette, svg};
use crate::report::diagnosis::names::place;
use crate::report::diagnosis::words::percent;
use crate::report::page::Drawing;
use crate::report::wording::Units;

/// Regions shown.
const SHOWN: usize = 8;
/// Height of a region, px: its bar and its details below.
const PITCH_PX: f64 = 46.0;
const TOP: f64 = 14.0;
const FRAME_X: (f64, f64) = (186.0, 780.0);

/// The bars; `None` without any region, or without a gap.
pub(super) fn draw(found: &Diagnosis) -> Drawn<Option<Drawing>> {
    let places = &found.places[..SHOWN.min(found.places.len())];
    if places.is_empty() || found.verdict.kind == Kind::None {
        return Ok(None);
    }
    let units = Units::of(found.before.joint.kind);
    let bottom = TOP + PITCH_PX * places.len() as f64;
    let drawn = svg(860, (bottom + 56.0) as u32, "Share of the gap by region", |canvas| {
        let x = Axis::linear("share of the gap's energy above the floor (%)", 0.0, 100.0);
        let y = Axis::linear("", 0.0, places.len() as f64).without_ticks();
        canvas.panel(Frame { left: FRAME_X.0, top: TOP, right: FRAME_X.1, bottom }, x, y)?;
        places.iter().enumerate().try_for_each(|(at, place)| row(canvas, place, &units, TOP + PITCH_PX * at as f64))
    })?;
    Ok(Some(Drawing {
        name: "where".to_string(),
        title: "Where the gap lies: share by region".to_string(),
        caption: "How much of the gap's energy above the floor goes with each quantity, with the bounds within which most of it \
                  stands. One gap may show in several ways, so the shares do not add up to 100 %."
            .to_string(),
        svg: drawn,
    }))
}

fn row(canvas: &Canvas, at: &Place, units: &Units, top: f64) -> Drawn {
    let end = FRAME_X.0 + (FRAME_X.1 - FRAME_X.0) * at.share_of_gap.clamp(0.0, 1.0);
    let middle = top + 14.0;
    canvas.fill((FRAME_X.0, middle - 8.0), (end, middle + 8.0), palette::BLUE, 1.0)?;
    canvas.text((FRAME_X.0 - 10.0, middle), place(at.region), LABEL_PX, palette::INK, Anchor::Right)?;
    canvas.text((end + 8.0, middle), &percent(at.share_of_gap), LABEL_PX, palette::INK, Anchor::Left)?;
    let samples = format!("{} of the samples, RMS {}", percent(at.share_of_samples), units.torque(at.rmse_nm));
    let details = format!("{}: {samples}", at.detail.replace(" -", " \u{2212}").replace("^2", "²"));
    canvas.text((FRAME_X.0 + 6.0, top + 33.0), &details, TEXT_PX, palette::GREY, Anchor::Left)
}
