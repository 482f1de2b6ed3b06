//! Where panels stand on a sheet: rows below each other, panels of a row side by side, data areas in line.

use super::canvas::{LABEL_PX, TEXT_PX, text_width_px};
use super::{Figure, Panel, Series, Shape};

/// Width of a sheet, px.
pub const WIDTH_PX: f64 = 860.0;
/// Room at the right edge, px.
const RIGHT_PX: f64 = 18.0;
/// Height of a legend's line, px.
pub const LEGEND_LINE_PX: f64 = 20.0;
/// Room above a panel, with and without a heading, px.
const HEADED_PX: f64 = 30.0;
const BARE_PX: f64 = 12.0;
/// Room below a panel, with and without ticks' texts, px.
const TICKED_PX: f64 = 26.0;
const LABELLED_PX: f64 = 20.0;
/// Room for the colours of cells, px.
const COLORS_PX: f64 = 96.0;

/// Where a panel's data area stands, px; labels and ticks stand outside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Left edge.
    pub left: f64,
    /// Upper edge.
    pub top: f64,
    /// Right edge.
    pub right: f64,
    /// Lower edge.
    pub bottom: f64,
}

/// A figure laid out.
pub struct Sheet<'f> {
    /// Its height, px.
    pub height_px: f64,
    /// The legend's entries with the points where they begin, px.
    pub legend: Vec<((f64, f64), &'f Series)>,
    /// The panels with their frames.
    pub panels: Vec<(Frame, &'f Panel)>,
}

/// Lays `figure` out.
pub fn sheet(figure: &Figure) -> Sheet<'_> {
    let (legend, mut top) = legend(figure.legend());
    let mut panels = Vec::new();
    for row in &figure.rows {
        let headed = row.panels.iter().any(|panel| !panel.title.is_empty());
        top += if headed { HEADED_PX } else { BARE_PX };
        // Panels of one column of the figure stand in line, and those of one row are equally wide.
        let alike = || figure.rows.iter().filter(|other| other.panels.len() == row.panels.len());
        let widest =
            |of: fn(&Panel) -> f64, column: usize| alike().map(|row| of(&row.panels[column])).fold(0.0, f64::max);
        let margins: Vec<(f64, f64)> =
            (0..row.panels.len()).map(|column| (widest(left_px, column), widest(beside_px, column))).collect();
        let taken: f64 = margins.iter().map(|(left, beside)| left + beside).sum();
        let width = (WIDTH_PX - RIGHT_PX - taken) / row.panels.len() as f64;
        let mut from = 0.0;
        for (panel, (left, beside)) in row.panels.iter().zip(margins) {
            let frame = Frame { left: from + left, top, right: from + left + width, bottom: top + row.height_px };
            panels.push((frame, panel));
            from = frame.right + beside;
        }
        top += row.height_px + row.panels.iter().map(below_px).fold(0.0, f64::max);
    }
    Sheet { height_px: top + 8.0, legend, panels }
}

/// Where an entry of the legend begins, px, and what it names.
type Entry<'s> = ((f64, f64), &'s Series);

/// Entries side by side, going on in a line below where they would run over the edge; and where they end.
fn legend(entries: Vec<&Series>) -> (Vec<Entry<'_>>, f64) {
    let (mut x, mut y) = (24.0, 16.0);
    let mut placed = Vec::new();
    for entry in entries {
        let width = 34.0 + text_width_px(&entry.name, TEXT_PX);
        if x > 24.0 && x + width > WIDTH_PX - RIGHT_PX {
            (x, y) = (24.0, y + LEGEND_LINE_PX);
        }
        placed.push(((x, y), entry));
        x += width + 14.0;
    }
    let end = if placed.is_empty() { 4.0 } else { y + 0.5 * LEGEND_LINE_PX };
    (placed, end)
}

/// Width of the widest tick's text, px.
pub fn ticks_px(panel: &Panel) -> f64 {
    panel.y.ticks.iter().map(|(_, text)| text_width_px(text, TEXT_PX)).fold(0.0, f64::max)
}

fn left_px(panel: &Panel) -> f64 {
    let label = if panel.y.label.is_empty() { 0.0 } else { LABEL_PX + 12.0 };
    24.0 + ticks_px(panel) + label
}

fn beside_px(panel: &Panel) -> f64 {
    let texts = panel.beside.iter().map(|(_, text)| text_width_px(text, TEXT_PX) + 12.0).fold(0.0, f64::max);
    let has_cells = panel.series.iter().any(|series| matches!(series.shape, Shape::Cells(_)));
    // Of two maps side by side each has its colours.
    texts.max(if has_cells { COLORS_PX } else { 0.0 })
}

fn below_px(panel: &Panel) -> f64 {
    let ticked = panel.x.ticks.iter().any(|(_, text)| !text.is_empty());
    (if ticked { TICKED_PX } else { 6.0 }) + if panel.x.label.is_empty() { 0.0 } else { LABELLED_PX }
}
