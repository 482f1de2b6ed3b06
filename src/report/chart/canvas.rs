//! Pixels: texts, lines and areas in an SVG, by plotters.
//!
//! Plotters writes whole pixels, which turns a flat curve into a staircase. So the canvas is drawn `FINENESS` times as
//! large and scaled down by the SVG's view box.

use super::{Anchor, Color, FONT_FAMILY, Hue, Mark, Stroke, palette};
use plotters::coord::Shift;
use plotters::drawing::DrawingAreaErrorKind;
use plotters::element::DashedPathElement;
use plotters::prelude::{
    Circle, DrawingArea, IntoDrawingArea, PathElement, Polygon, RGBColor, Rectangle, SVGBackend, Text,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color as _, FontTransform, IntoFont, RGBAColor, TextStyle, WHITE};

/// Steps per pixel.
const FINENESS: f64 = 10.0;
/// Plotters divides a font's size by this before it writes it.
const FONT_FACTOR: f64 = 1.24;
/// Half the height of capitals less half an x-height, in font sizes.
const CENTRE: f64 = 0.09;
/// Opacity of a colour that stands back.
const LIGHT: f64 = 0.4;

/// Size of ticks' texts and legends, px.
pub const TEXT_PX: f64 = 13.0;
/// Size of axis labels and headings, px.
pub const LABEL_PX: f64 = 14.0;

/// What drawing gives; writing to memory does not fail, but plotters does not know.
pub type Drawn<T = ()> = std::result::Result<T, DrawingAreaErrorKind<std::io::Error>>;

/// A drawing in pixels.
pub struct Canvas<'a> {
    root: DrawingArea<SVGBackend<'a>, Shift>,
}

/// An SVG of `width_px` by `height_px` called `title`, which screen readers speak aloud.
pub fn canvas((width_px, height_px): (u32, u32), title: &str, draw: impl FnOnce(&Canvas) -> Drawn) -> Drawn<String> {
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

fn fine_point((x, y): (f64, f64)) -> (i32, i32) {
    (fine(x), fine(y))
}

/// `color` as drawn on white.
fn rgba(color: Color, opacity: f64) -> RGBAColor {
    let rgb = match color.hue {
        Hue::Vermilion => RGBColor(213, 94, 0),
        Hue::Blue => RGBColor(0, 114, 178),
        Hue::Green => RGBColor(0, 158, 115),
        Hue::Orange => RGBColor(230, 159, 0),
        Hue::Purple => RGBColor(204, 121, 167),
        Hue::Ink => RGBColor(40, 44, 52),
        Hue::Grey => RGBColor(130, 136, 145),
        Hue::Pale => RGBColor(190, 195, 202),
        Hue::Grid => RGBColor(226, 229, 233),
        Hue::Paper => WHITE,
    };
    rgb.mix(if color.light { LIGHT * opacity } else { opacity })
}

impl Canvas<'_> {
    /// Writes `text` at a point in px.
    pub fn text(&self, at_px: (f64, f64), text: &str, size_px: f64, color: Color, anchor: Anchor) -> Drawn {
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
        let ink = rgba(color, 1.0);
        let style = TextStyle::from(font).color(&ink).pos(Pos::new(horizontal, vertical));
        // Plotters centres on half an x-height; the middle of digits and capitals is a little higher.
        let lower_px = if anchor == Anchor::Below { 0.0 } else { CENTRE * size_px };
        let shift_px = if anchor == Anchor::Upwards { (lower_px, 0.0) } else { (0.0, lower_px) };
        self.root.draw(&Text::new(text.to_string(), fine_point((at_px.0 + shift_px.0, at_px.1 + shift_px.1)), style))
    }

    /// A line through points in px.
    pub fn path(&self, points_px: &[(f64, f64)], stroke: Stroke) -> Drawn {
        let points: Vec<(i32, i32)> = points_px.iter().map(|p| fine_point(*p)).collect();
        let style = rgba(stroke.color, 1.0).stroke_width(fine(stroke.width_px) as u32);
        match stroke.dash_px {
            None => self.root.draw(&PathElement::new(points, style)),
            Some((dash, gap)) => self.root.draw(&DashedPathElement::new(points, fine(dash), fine(gap), style)),
        }
    }

    /// A straight line between points in px.
    pub fn line(&self, from_px: (f64, f64), to_px: (f64, f64), color: Color, width_px: f64) -> Drawn {
        self.path(&[from_px, to_px], Stroke::solid(color, width_px))
    }

    /// A filled rectangle between two corners in px.
    pub fn fill(&self, corner_px: (f64, f64), opposite_px: (f64, f64), color: Color, opacity: f64) -> Drawn {
        self.root.draw(&Rectangle::new([fine_point(corner_px), fine_point(opposite_px)], rgba(color, opacity).filled()))
    }

    /// The same in a colour of its own.
    pub fn cell(&self, corner_px: (f64, f64), opposite_px: (f64, f64), (r, g, b): (u8, u8, u8)) -> Drawn {
        self.root.draw(&Rectangle::new([fine_point(corner_px), fine_point(opposite_px)], RGBColor(r, g, b).filled()))
    }

    /// A filled outline in px.
    pub fn area(&self, outline_px: &[(f64, f64)], color: Color, opacity: f64) -> Drawn {
        self.root
            .draw(&Polygon::new(outline_px.iter().map(|p| fine_point(*p)).collect::<Vec<_>>(), rgba(color, opacity)))
    }

    /// A disc.
    pub fn disc(&self, at_px: (f64, f64), radius_px: f64, color: Color, opacity: f64) -> Drawn {
        self.root.draw(&Circle::new(fine_point(at_px), fine(radius_px), rgba(color, opacity).filled()))
    }

    /// A sign about a point in px.
    pub fn mark(&self, (x, y): (f64, f64), mark: Mark, color: Color) -> Drawn {
        let corners = |points: &[(f64, f64)]| {
            let around: Vec<(f64, f64)> = points.iter().map(|(a, b)| (x + a, y + b)).collect();
            self.area(&around, color, 1.0)
        };
        match mark {
            Mark::Up => corners(&[(-4.5, 3.5), (4.5, 3.5), (0.0, -4.5)]),
            Mark::Down => corners(&[(-4.5, -3.5), (4.5, -3.5), (0.0, 4.5)]),
            Mark::Leftwards => corners(&[(6.0, -5.0), (6.0, 5.0), (-4.0, 0.0)]),
            Mark::Rightwards => corners(&[(-6.0, -5.0), (-6.0, 5.0), (4.0, 0.0)]),
            Mark::Diamond => corners(&[(0.0, -5.5), (5.5, 0.0), (0.0, 5.5), (-5.5, 0.0)]),
            Mark::Square => corners(&[(-4.5, -4.5), (4.5, -4.5), (4.5, 4.5), (-4.5, 4.5)]),
            Mark::Disc(radius_px) => self.disc((x, y), radius_px, color, 1.0),
            Mark::Ring => {
                let style = rgba(color, 1.0).stroke_width(fine(1.5) as u32);
                self.root.draw(&Circle::new(fine_point((x, y)), fine(4.5), style))
            }
        }
    }

    /// A heading.
    pub fn heading(&self, at_px: (f64, f64), text: &str) -> Drawn {
        self.text(at_px, text, LABEL_PX, palette::INK, Anchor::Left)
    }
}

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
