//! Figures as data: rows of panels, each with its axes and series. Born in `plots`; drawn as SVG (`draw`), from that as PNG, or
//! sent to the page's script (`data`), which draws the same value and lets a reader hover, zoom and select; or, on a terminal, as
//! characters (`characters`).

mod axis;
mod canvas;
mod characters;
mod data;
mod draw;
mod layout;
pub mod thin;

pub use axis::{Axis, span};
pub use canvas::Drawn;
pub use characters::characters;
pub use data::Columns;
pub use draw::{FOR_FILES, FOR_PAGES, svg};

/// The bundled font first (`png`), then what browsers have that looks like it.
pub const FONT_FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

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

/// A sign for one point; colour never tells alone what it is.
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

/// A point of x and y, in the units of the axes.
pub type Point = (f64, f64);

/// What a series draws.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A line; a point that is not finite breaks it.
    Line(Vec<Point>, Stroke),
    /// The area between two lines, with its opacity.
    Band(Vec<Point>, Vec<Point>, Color, f64),
    /// Small discs, many: radius in px, opacity.
    Dots(Vec<Point>, f64, Color, f64),
    /// Signs.
    Marks(Vec<Point>, Mark, Color),
    /// Texts at points.
    Texts(Vec<(Point, String)>, Anchor, Color),
    /// Cells with colours.
    Cells(Cells),
}

/// Cells of a map: which values they have, and which stretches of recordings stand behind each.
#[derive(Debug, Clone, PartialEq)]
pub struct Cells {
    /// Places (as on the axes) of the cells' edges from left to right.
    pub across: Vec<f64>,
    /// The same from below.
    pub upwards: Vec<f64>,
    /// Values row by row; NaN where there is none.
    pub values: Vec<f64>,
    /// The values along the colours, from zero.
    pub axis: Axis,
    /// A value to be marked beside the colours, and its name.
    pub marked: (f64, &'static str),
    /// For each cell the stretches of trials in it, the largest first: number of the trial, from and to, s.
    pub stretches: Vec<Vec<(usize, f64, f64)>>,
}

/// A shape with its name in the legend; without a name it has none.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// What it is; series of one name are one entry.
    pub name: String,
    /// What is drawn.
    pub shape: Shape,
}

/// Axes around series.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Its heading; may be empty.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// What it shows, the lowest first.
    pub series: Vec<Series>,
    /// Texts to the right of it, at values of y.
    pub beside: Vec<(f64, String)>,
    /// Panels of one name zoom together along x.
    pub link: Option<String>,
}

impl Panel {
    /// An empty panel.
    pub fn new(x: Axis, y: Axis) -> Self {
        Self { title: String::new(), x, y, series: Vec::new(), beside: Vec::new(), link: None }
    }

    /// With a heading.
    pub fn titled(self, title: impl Into<String>) -> Self {
        Self { title: title.into(), ..self }
    }

    /// Zooming together with all others of this `link`.
    pub fn linked(self, link: impl Into<String>) -> Self {
        Self { link: Some(link.into()), ..self }
    }

    fn add(&mut self, name: impl Into<String>, shape: Shape) {
        self.series.push(Series { name: name.into(), shape });
    }

    /// Adds a line.
    pub fn line(&mut self, name: impl Into<String>, points: impl IntoIterator<Item = Point>, stroke: Stroke) {
        self.add(name, Shape::Line(points.into_iter().collect(), stroke));
    }

    /// Adds the area between two lines.
    pub fn band(&mut self, name: impl Into<String>, edges: [Vec<Point>; 2], color: Color, opacity: f64) {
        let [lower, upper] = edges;
        self.add(name, Shape::Band(lower, upper, color, opacity));
    }

    /// Adds a rectangle.
    pub fn bar(&mut self, name: impl Into<String>, (left, right): Point, (low, high): Point, color: Color) {
        self.band(name, [vec![(left, low), (right, low)], vec![(left, high), (right, high)]], color, 1.0);
    }

    /// Adds small discs.
    pub fn dots(&mut self, name: impl Into<String>, points: Vec<Point>, radius_px: f64, color: Color, opacity: f64) {
        self.add(name, Shape::Dots(points, radius_px, color, opacity));
    }

    /// Adds signs.
    pub fn marks(&mut self, name: impl Into<String>, points: Vec<Point>, mark: Mark, color: Color) {
        self.add(name, Shape::Marks(points, mark, color));
    }

    /// Adds texts.
    pub fn texts(&mut self, texts: Vec<(Point, String)>, anchor: Anchor, color: Color) {
        self.add("", Shape::Texts(texts, anchor, color));
    }

    /// Adds cells.
    pub fn cells(&mut self, cells: Cells) {
        self.add("", Shape::Cells(cells));
    }
}

/// Panels side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Height of the panels' data areas, px.
    pub height_px: f64,
    /// From left to right.
    pub panels: Vec<Panel>,
}

/// A figure.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of its file, without extension; its address in the page.
    pub name: String,
    /// Its heading.
    pub title: String,
    /// What it shows, and what to look for.
    pub caption: String,
    /// Rows of panels from above.
    pub rows: Vec<Row>,
}

impl Figure {
    /// A figure of one panel.
    pub fn single(name: &str, title: impl Into<String>, caption: &str, height_px: f64, panel: Panel) -> Self {
        Self::new(name, title, caption).row(height_px, vec![panel])
    }

    /// A figure to be filled with rows.
    pub fn new(name: impl Into<String>, title: impl Into<String>, caption: impl Into<String>) -> Self {
        Self { name: name.into(), title: title.into(), caption: caption.into(), rows: Vec::new() }
    }

    /// With one more row below.
    pub fn row(mut self, height_px: f64, panels: Vec<Panel>) -> Self {
        self.rows.push(Row { height_px, panels });
        self
    }

    /// All panels.
    pub fn panels(&self) -> impl Iterator<Item = &Panel> {
        self.rows.iter().flat_map(|row| &row.panels)
    }

    /// The named series, one of each name: the entries of the legend.
    pub fn legend(&self) -> Vec<&Series> {
        let mut entries: Vec<&Series> = Vec::new();
        for series in self.panels().flat_map(|panel| &panel.series) {
            if !series.name.is_empty() && entries.iter().all(|entry| entry.name != series.name) {
                entries.push(series);
            }
        }
        entries
    }
}
