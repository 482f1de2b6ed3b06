//! Values as colours: cells of a map, and the bar that says what a colour means.

use super::{Anchor, Axis, Canvas, Drawn, Frame, LABEL_PX, Mark, Panel, TEXT_PX, palette, text_width_px};
use plotters::style::RGBColor;

/// Viridis (van der Walt and Smith) from its bright end: lightness falls all along, so that it reads in print and by
/// colour-blind readers, and no value is as pale as paper.
const STOPS: [RGBColor; 9] = [
    RGBColor(253, 231, 37),
    RGBColor(173, 220, 48),
    RGBColor(94, 201, 98),
    RGBColor(40, 174, 128),
    RGBColor(33, 145, 140),
    RGBColor(44, 114, 142),
    RGBColor(59, 82, 139),
    RGBColor(71, 45, 123),
    RGBColor(68, 1, 84),
];
/// How far a cell reaches under its neighbours, px.
const LAP_PX: f64 = 0.6;
/// Strips of a colour bar.
const STRIPS: u32 = 90;

/// The colour at `share` of the scale, 0 to 1.
fn color_at(share: f64) -> RGBColor {
    let at = share.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let from = (at as usize).min(STOPS.len() - 2);
    let part = at - from as f64;
    let (a, b) = (STOPS[from], STOPS[from + 1]);
    let mix = |a: u8, b: u8| (f64::from(a) + part * (f64::from(b) - f64::from(a))).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// Which colour a value has; beyond the ends it has the end's.
#[derive(Debug, Clone, PartialEq)]
pub struct Colors {
    /// The values along the bar, with their label and unit.
    pub axis: Axis,
    /// Whether values lie above the bar's end.
    pub goes_on: bool,
}

impl Colors {
    fn of(&self, value: f64) -> RGBColor {
        let (low, high) = self.axis.places;
        color_at((self.axis.place(value) - low) / (high - low))
    }
}

impl Canvas<'_> {
    /// A cell of `panel` between its lower left and its upper right corner. It reaches a little further, so that no seam shows
    /// to neighbours on the right and above, which are drawn later.
    pub fn cell(&self, panel: &Panel, lower: (f64, f64), upper: (f64, f64), value: f64, colors: &Colors) -> Drawn {
        let ((left, bottom), (right, top)) = (panel.px(lower), panel.px(upper));
        self.fill((left.round(), bottom.round()), (right.round() + LAP_PX, top.round() - LAP_PX), colors.of(value), 1.0)
    }

    /// The bar of `colors`, upright, its ticks and label to the right; a triangle at the value of `marked`, named below.
    pub fn color_bar(&self, frame: Frame, colors: &Colors, marked: (f64, &str)) -> Drawn {
        let (low, high) = colors.axis.places;
        let height = frame.bottom - frame.top;
        let level = |place: f64| frame.bottom - height * (place - low) / (high - low);
        for strip in 0..STRIPS {
            // Each reaches to the top, the next one covers it: no seams.
            let share = f64::from(strip) / f64::from(STRIPS);
            let lower = frame.bottom - height * share;
            self.fill((frame.left, frame.top), (frame.right, lower), color_at(share), 1.0)?;
        }
        let mut widest = 0.0f64;
        for (place, text) in &colors.axis.ticks {
            let y = level(*place);
            self.line((frame.right, y), (frame.right + 4.0, y), palette::INK, 1.0)?;
            self.text((frame.right + 8.0, y), text, TEXT_PX, palette::INK, Anchor::Left)?;
            widest = widest.max(text_width_px(text, TEXT_PX));
        }
        let middle = (frame.right + widest + 24.0, frame.top + height / 2.0);
        self.text(middle, &colors.axis.label, LABEL_PX, palette::INK, Anchor::Upwards)?;
        if colors.goes_on {
            self.text((frame.left, frame.top - 18.0), "and above", TEXT_PX, palette::INK, Anchor::Left)?;
        }
        // A sample's middle is 13 px to the right of its beginning.
        let (value, name) = marked;
        let below = frame.bottom + 36.0;
        self.sample((frame.left - 20.0, level(colors.axis.place_within(value))), Mark::Rightwards, palette::INK)?;
        self.sample((frame.left - 20.0, below), Mark::Rightwards, palette::INK)?;
        self.text((frame.left + 2.0, below), name, TEXT_PX, palette::INK, Anchor::Left)
    }
}
