//! Drawing: a canvas in pixels, panels with axes, marks that do not rely on colour alone.
//!
//! Plotters writes whole pixels, which turns a flat curve into a staircase. So the canvas is drawn `FINENESS` times as
//! large and scaled down by the SVG's view box.

mod axis;
mod cells;
mod panel;
pub mod thin;

pub use axis::{Axis, span};
pub use cells::Colors;
pub use panel::{Frame, Mark, Panel, Stroke};

use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::prelude::{DrawingArea, IntoDrawingArea, PathElement, RGBColor, Rectangle, SVGBackend, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, IntoFont, TextStyle, WHITE};

/// Steps per pixel.
const FINENESS: f64 = 10.0;
/// Plotters divides a font's size by this before it writes it.
const FONT_FACTOR: f64 = 1.24;
/// Half the height of capitals less half an x-height, in font sizes.
const CENTRE: f64 = 0.09;
/// The bundled font first (`png`), then what browsers have that looks like it.
pub const FONT_FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// Size of ticks' texts and legends, px.
pub const TEXT_PX: f64 = 13.0;
/// Size of axis labels and headings, px.
pub const LABEL_PX: f64 = 14.0;

/// Colours that colour-blind readers tell apart (Okabe and Ito), and greys.
pub mod palette {
    use super::RGBColor;
    use crate::model::{Direction, Status};

    /// Vermilion.
    pub const VERMILION: RGBColor = RGBColor(213, 94, 0);
    /// Blue.
    pub const BLUE: RGBColor = RGBColor(0, 114, 178);
    /// Bluish green.
    pub const GREEN: RGBColor = RGBColor(0, 158, 115);
    /// Orange.
    pub const ORANGE: RGBColor = RGBColor(230, 159, 0);
    /// Reddish purple.
    pub const PURPLE: RGBColor = RGBColor(204, 121, 167);
    /// Text and axes.
    pub const INK: RGBColor = RGBColor(40, 44, 52);
    /// What stands back.
    pub const GREY: RGBColor = RGBColor(130, 136, 145);
    /// Raw data behind others.
    pub const PALE: RGBColor = RGBColor(190, 195, 202);
    /// Grid lines.
    pub const GRID: RGBColor = RGBColor(226, 229, 233);

    /// The colour of a direction, the same in every figure.
    pub fn direction(direction: Direction) -> RGBColor {
        match direction {
            Direction::Up => VERMILION,
            Direction::Down => BLUE,
        }
    }

    /// `color`, standing back.
    pub fn lighter(color: RGBColor) -> RGBColor {
        let mixed = |part: u8| 255 - (255 - part) / 5 * 2;
        RGBColor(mixed(color.0), mixed(color.1), mixed(color.2))
    }

    /// The colour of a status.
    pub fn status(status: Status) -> RGBColor {
        match status {
            Status::Pinned => GREEN,
            Status::TradeOff => ORANGE,
            Status::Merged => BLUE,
            Status::Flat => GREY,
            Status::AtBound => PURPLE,
        }
    }
}

/// What drawing gives; writing to memory does not fail, but plotters does not know.
pub type Drawn<T = ()> = std::result::Result<T, DrawingAreaErrorKind<std::io::Error>>;

/// Where a text stands about its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The point is its left end, at half its height.
    Left,
    /// The point is its middle.
    Middle,
    /// The point is its right end, at half its height.
    Right,
    /// The point is the middle of its upper edge.
    Below,
    /// The point is its middle, and it reads upwards.
    Upwards,
}

/// A drawing in pixels.
pub struct Canvas<'a> {
    root: DrawingArea<SVGBackend<'a>, Shift>,
}

/// An SVG of `width_px` by `height_px` called `title`, which readers' machines speak aloud.
pub fn svg(width_px: u32, height_px: u32, title: &str, draw: impl FnOnce(&Canvas) -> Drawn) -> Drawn<String> {
    let fine = (width_px * FINENESS as u32, height_px * FINENESS as u32);
    let mut text = String::new();
    {
        let canvas = Canvas { root: SVGBackend::with_string(&mut text, fine).into_drawing_area() };
        canvas.root.fill(&WHITE)?;
        draw(&canvas)?;
        canvas.root.present()?;
    }
    let body = text.split_once('>').map_or("", |(_, body)| body);
    let title = title.replace('&', "&amp;").replace('<', "&lt;");
    Ok(format!(
        "<svg width=\"{width_px}\" height=\"{height_px}\" viewBox=\"0 0 {} {}\" stroke-linejoin=\"round\" role=\"img\" \
         xmlns=\"http://www.w3.org/2000/svg\">\n<title>{title}</title>{body}",
        fine.0, fine.1
    ))
}

fn fine(px: f64) -> i32 {
    (px * FINENESS).round() as i32
}

impl<'a> Canvas<'a> {
    /// Writes `text` at a point in px.
    pub fn text(&self, at_px: (f64, f64), text: &str, size_px: f64, color: RGBColor, anchor: Anchor) -> Drawn {
        if text.is_empty() {
            return Ok(());
        }
        let (horizontal, vertical) = match anchor {
            Anchor::Left => (HPos::Left, VPos::Center),
            Anchor::Middle | Anchor::Upwards => (HPos::Center, VPos::Center),
            Anchor::Right => (HPos::Right, VPos::Center),
            Anchor::Below => (HPos::Center, VPos::Top),
        };
        let font = (FONT_FAMILY, size_px * FINENESS * FONT_FACTOR).into_font();
        let font = if anchor == Anchor::Upwards { font.transform(FontTransform::Rotate270) } else { font };
        let style = TextStyle::from(font).color(&color).pos(Pos::new(horizontal, vertical));
        // Plotters centres on half an x-height; the middle of digits and capitals is a little higher.
        let lower_px = if anchor == Anchor::Below { 0.0 } else { CENTRE * size_px };
        let shift_px = if anchor == Anchor::Upwards { (lower_px, 0.0) } else { (0.0, lower_px) };
        self.root.draw(&Text::new(text.to_string(), (fine(at_px.0 + shift_px.0), fine(at_px.1 + shift_px.1)), style))
    }

    /// A straight line between points in px.
    pub fn line(&self, from_px: (f64, f64), to_px: (f64, f64), color: RGBColor, width_px: f64) -> Drawn {
        let points = vec![(fine(from_px.0), fine(from_px.1)), (fine(to_px.0), fine(to_px.1))];
        self.root.draw(&PathElement::new(points, color.stroke_width(fine(width_px) as u32)))
    }

    /// A filled rectangle between two corners in px.
    pub fn fill(&self, corner_px: (f64, f64), opposite_px: (f64, f64), color: RGBColor, opacity: f64) -> Drawn {
        let corners = [(fine(corner_px.0), fine(corner_px.1)), (fine(opposite_px.0), fine(opposite_px.1))];
        self.root.draw(&Rectangle::new(corners, color.mix(opacity).filled()))
    }

    /// Entries side by side from `left_px`, their middle at `y_px`: above a panel, where they cover no data. Where they
    /// would run beyond `right_px` they go on in a line below.
    pub fn legend(&self, (left_px, right_px): (f64, f64), y_px: f64, entries: &[(Mark, RGBColor, String)]) -> Drawn {
        let (mut x, mut y) = (left_px, y_px);
        for (mark, color, text) in entries {
            let width = 34.0 + text_width_px(text, TEXT_PX);
            if x > left_px && x + width > right_px {
                (x, y) = (left_px, y + LEGEND_LINE_PX);
            }
            self.sample((x, y), *mark, *color)?;
            self.text((x + 30.0, y), text, TEXT_PX, palette::INK, Anchor::Left)?;
            x += width + 14.0;
        }
        Ok(())
    }
}

/// Height of a line of a legend, px.
pub const LEGEND_LINE_PX: f64 = 20.0;

/// The width that `text` takes in DejaVu Sans, by classes of letters: right to a few percent.
pub fn text_width_px(text: &str, size_px: f64) -> f64 {
    let width = |c: char| match c {
        'i' | 'j' | 'l' | '\'' | '|' => 0.28,
        ' ' | ',' | '.' | ':' | ';' | 'I' => 0.33,
        'f' | 't' | 'r' | '(' | ')' | '-' | '/' => 0.40,
        'm' | 'M' | 'W' | 'w' | '%' | '~' | '\u{2212}' | '±' | '≈' | '=' | '<' | '>' => 0.86,
        'A'..='Z' => 0.69,
        _ => 0.62,
    };
    size_px * text.chars().map(width).sum::<f64>()
}
