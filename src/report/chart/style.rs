//! How a figure's parts look: colours, lines, markers, where texts stand.

/// Colours that colour-blind readers tell apart (Okabe and Ito), and greys.
pub mod palette {
    use super::{Color, Hue};
    use crate::model::{Direction, Status};

    const fn plain(hue: Hue) -> Color {
        Color { hue, light: false }
    }
    /// Vermilion.
    pub const VERMILION: Color = plain(Hue::Vermilion);
    /// Blue.
    pub const BLUE: Color = plain(Hue::Blue);
    /// Bluish green.
    pub const GREEN: Color = plain(Hue::Green);
    /// Orange.
    pub const ORANGE: Color = plain(Hue::Orange);
    /// Reddish purple.
    pub const PURPLE: Color = plain(Hue::Purple);
    /// Text and axes.
    pub const INK: Color = plain(Hue::Ink);
    /// What stands back.
    pub const GREY: Color = plain(Hue::Grey);
    /// Raw data behind others.
    pub const PALE: Color = plain(Hue::Pale);
    /// Grid lines.
    pub const GRID: Color = plain(Hue::Grid);
    /// The ground.
    pub const PAPER: Color = plain(Hue::Paper);

    /// The colour of a direction, the same in every figure.
    pub fn direction(direction: Direction) -> Color {
        match direction {
            Direction::Up => VERMILION,
            Direction::Down => BLUE,
        }
    }

    /// `color`, standing back.
    pub fn lighter(color: Color) -> Color {
        Color { light: true, ..color }
    }

    /// The colour of a status.
    pub fn status(status: Status) -> Color {
        match status {
            Status::Pinned => GREEN,
            Status::TradeOff => ORANGE,
            Status::Merged => BLUE,
            Status::Flat => GREY,
            Status::AtBound => PURPLE,
        }
    }
}

/// What a colour is called; the page has one for light ground and one for dark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hue {
    /// Text and axes.
    Ink,
    /// What stands back.
    Grey,
    /// Raw data behind others.
    Pale,
    /// Grid lines.
    Grid,
    /// The ground.
    Paper,
    /// Moving up; what is wrong.
    Vermilion,
    /// Moving down; what was found.
    Blue,
    /// Well known.
    Green,
    /// Contact.
    Orange,
    /// The sensor's limits.
    Purple,
}

impl Hue {
    /// Its name in the page's style sheet.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ink => "ink",
            Self::Grey => "grey",
            Self::Pale => "pale",
            Self::Grid => "grid",
            Self::Paper => "paper",
            Self::Vermilion => "vermilion",
            Self::Blue => "blue",
            Self::Green => "green",
            Self::Orange => "orange",
            Self::Purple => "purple",
        }
    }
}

/// A colour of the palette, or its pale kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Color {
    /// Which.
    pub hue: Hue,
    /// Whether it stands back.
    pub light: bool,
}

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub color: Color,
    /// Its width, px.
    pub width_px: f64,
    /// Length of dashes and of the gaps between them, px; `None` is a whole line.
    pub dash_px: Option<(f64, f64)>,
}

impl Stroke {
    /// A whole line.
    pub fn solid(color: Color, width_px: f64) -> Self {
        Self { color, width_px, dash_px: None }
    }

    /// A dashed line.
    pub fn dashed(color: Color, width_px: f64, dash_px: f64, gap_px: f64) -> Self {
        Self { color, width_px, dash_px: Some((dash_px, gap_px)) }
    }
}

/// A marker for one point; colour alone never identifies a series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mark {
    /// A triangle that points up: moving up.
    Up,
    /// A triangle that points down: moving down.
    Down,
    /// A triangle that points left: goes on there.
    Leftwards,
    /// A triangle that points right.
    Rightwards,
    /// A disc of this radius, px.
    Disc(f64),
    /// A ring.
    Ring,
    /// A square on its corner.
    Diamond,
    /// A square.
    Square,
}

impl Mark {
    /// The triangle that points where the motion goes.
    pub fn of(direction: crate::model::Direction) -> Self {
        match direction {
            crate::model::Direction::Up => Self::Up,
            crate::model::Direction::Down => Self::Down,
        }
    }
}

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
