//! The candidate causes: how far the gap shrinks with each, with its interval.

use super::budget::added;
use crate::diagnose::{Candidate, Diagnosis};
use crate::report::chart::{Axis, Color, Figure, Mark, Panel, Stroke, palette};
use crate::report::diagnosis::names::Role;
use crate::report::diagnosis::words::{flexible_shrink, percent, shrink};

/// Causes shown.
const SHOWN: usize = 14;
/// Height of a cause, px.
const PITCH_PX: f64 = 26.0;
/// A cause that makes the gap wider by more than this stands at the axis' end.
const WORST: f64 = -0.3;

const CAPTION: &str = "How far the gap shrinks with each candidate cause on held-out data, with its 95 % bootstrap interval. Where the \
                       verdict names several causes, their marks show all of them together, and the figure to the right is the part of \
                       each. The dashed line is what a flexible fit to the recorded motion reaches; a cause with fewer parameters may \
                       do better on held-out data. A rival explains these data as well as a named cause.";

/// The dots; `None` where nothing was tried.
pub(super) fn figure(found: &Diagnosis) -> Option<Figure> {
    let shown = &found.candidates[..SHOWN.min(found.candidates.len())];
    if shown.is_empty() {
        return None;
    }
    let low = shown.iter().map(|candidate| candidate.shrink.low).fold(0.0, f64::min).max(WORST);
    let x = Axis::linear("how far the gap above the floor shrinks (%)", 100.0 * low - 2.0, 103.0);
    let mut panel = Panel::new(x, Axis::names(shown.iter().map(|candidate| candidate.cause.name().to_string())));
    let most = 100.0 * flexible_shrink(found);
    let line = [(most, -(shown.len() as f64)), (most, 0.0)];
    panel.line("flexible fit", line, Stroke::dashed(palette::INK, 1.4, 6.0, 4.0));
    for (at, candidate) in shown.iter().enumerate() {
        row(&mut panel, candidate, found, -(at as f64) - 0.5);
    }
    let height = PITCH_PX * shown.len() as f64;
    let rest = match found.candidates.len() - shown.len() {
        0 => String::new(),
        more => format!(" The table lists {more} more."),
    };
    Some(Figure::single("candidates", "Candidate causes, ranked", &format!("{CAPTION}{rest}"), height, panel))
}

fn look(role: Role) -> (Mark, Color, &'static str) {
    match role {
        Role::Taken => (Mark::Disc(5.5), palette::BLUE, "named in the verdict"),
        Role::Rival => (Mark::Diamond, palette::VERMILION, "rival: explains as much"),
        Role::Beside => (Mark::Square, palette::GREY, "in addition to what is named"),
        Role::Other => (Mark::Ring, palette::GREY, "other candidate"),
    }
}

fn row(panel: &mut Panel, candidate: &Candidate, found: &Diagnosis, y: f64) {
    let role = Role::of(candidate, found);
    let (mark, color, name) = look(role);
    let at = &candidate.shrink;
    let width_px = if matches!(role, Role::Other | Role::Beside) { 1.4 } else { 2.4 };
    panel.line("", [(100.0 * at.low, y), (100.0 * at.high, y)], Stroke::solid(color, width_px));
    let (low, high) = panel.x.places;
    let mark = if 100.0 * at.value < low { Mark::Leftwards } else { mark };
    panel.marks(name, vec![((100.0 * at.value).clamp(low, high), y)], mark, color);
    // Several that were taken stand together: what tells them apart is what each adds.
    let together = found.budget.causes.len() > 1 && role == Role::Taken;
    let added = added(Some(candidate.cause), found).filter(|_| together);
    panel.beside.push((y, added.map_or_else(|| shrink(*at), |share| format!("adds {}", percent(share)))));
}
