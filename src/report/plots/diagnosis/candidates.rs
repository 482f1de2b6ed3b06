//! Every cause that was tried: how far the gap shrinks, with its interval.

use crate::diagnose::{Candidate, Diagnosis};
use crate::report::chart::{Anchor, Axis, Canvas, Drawn, Frame, LABEL_PX, Mark, Panel, Stroke, TEXT_PX, palette, svg};
use crate::report::diagnosis::names::Role;
use crate::report::diagnosis::words::{flexible_shrink, shrink};
use crate::report::page::Drawing;
use plotters::style::RGBColor;

/// Causes shown.
const SHOWN: usize = 14;
/// Height of a cause, px.
const PITCH_PX: f64 = 28.0;
const TOP: f64 = 58.0;
/// Left and right end of the axis, px.
const FRAME_X: (f64, f64) = (216.0, 716.0);
/// A cause that makes the gap wider by more than this stands at the axis' end.
const WORST: f64 = -0.3;

/// The dots; `None` where nothing was tried.
pub(super) fn draw(found: &Diagnosis) -> Drawn<Option<Drawing>> {
    let shown = &found.candidates[..SHOWN.min(found.candidates.len())];
    if shown.is_empty() {
        return Ok(None);
    }
    let bottom = TOP + PITCH_PX * shown.len() as f64;
    let drawn = svg(860, (bottom + 56.0) as u32, "Causes tried", |canvas| {
        let low = shown.iter().map(|candidate| candidate.shrink.low).fold(0.0, f64::min).max(WORST);
        let x = Axis::linear("how far the gap above the floor shrinks (%)", 100.0 * low - 2.0, 103.0);
        let y = Axis::linear("", -(shown.len() as f64), 0.0).without_ticks();
        let panel = canvas.panel(Frame { left: FRAME_X.0, top: TOP, right: FRAME_X.1, bottom }, x, y)?;
        let most = 100.0 * flexible_shrink(found);
        panel.line([(most, -(shown.len() as f64)), (most, 0.0)], Stroke::dashed(palette::INK, 1.4, 6.0, 4.0))?;
        canvas.text((panel.px((most, 0.0)).0, TOP - 10.0), "flexible fit", TEXT_PX, palette::INK, Anchor::Middle)?;
        for (at, candidate) in shown.iter().enumerate() {
            row(canvas, &panel, candidate, Role::of(candidate, found), -(at as f64) - 0.5)?;
        }
        legend(canvas, shown, found)
    })?;
    Ok(Some(Drawing {
        name: "candidates".to_string(),
        title: "Causes tried".to_string(),
        caption: "How far the gap shrinks with each cause on data that its fit never saw, with its 95 % interval from resampling; \
                  where several were found, with all of them, and anything else on top. The dashed line is what a flexible fit \
                  to the recorded motion reaches; a cause with fewer numbers may do better still. A rival does as well as what \
                  was taken, within what these data can tell."
            .to_string(),
        svg: drawn,
    }))
}

fn look(role: Role) -> (Mark, RGBColor) {
    match role {
        Role::Taken => (Mark::Disc(5.5), palette::BLUE),
        Role::Rival => (Mark::Diamond, palette::VERMILION),
        Role::Other => (Mark::Ring, palette::GREY),
    }
}

fn row(canvas: &Canvas, panel: &Panel, candidate: &Candidate, role: Role, y: f64) -> Drawn {
    let (mark, color) = look(role);
    let at = &candidate.shrink;
    let width_px = if role == Role::Other { 1.4 } else { 2.4 };
    panel.line([(100.0 * at.low, y), (100.0 * at.high, y)], Stroke::solid(color, width_px))?;
    let (low, high) = panel.x.places;
    let mark = if 100.0 * at.value < low { Mark::Leftwards } else { mark };
    panel.mark(((100.0 * at.value).clamp(low, high), y), mark, color)?;
    let middle = panel.px((low, y)).1;
    let ink = if role == Role::Other { palette::GREY } else { palette::INK };
    canvas.text((FRAME_X.0 - 12.0, middle), candidate.cause.name(), LABEL_PX, ink, Anchor::Right)?;
    canvas.text((FRAME_X.1 + 12.0, middle), &shrink(*at), TEXT_PX, ink, Anchor::Left)
}

/// The roles that are there.
fn legend(canvas: &Canvas, shown: &[Candidate], found: &Diagnosis) -> Drawn {
    let names = [(Role::Taken, "taken"), (Role::Rival, "rival: does as well"), (Role::Other, "not taken")];
    let entries: Vec<(Mark, RGBColor, String)> = names
        .into_iter()
        .filter(|(role, _)| shown.iter().any(|candidate| Role::of(candidate, found) == *role))
        .map(|(role, name)| (look(role).0, look(role).1, name.to_string()))
        .collect();
    canvas.legend((FRAME_X.0, 840.0), 18.0, &entries)
}
