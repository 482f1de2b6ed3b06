//! Figures as data: rows of panels, each with its axes and series. Born in `plots`; drawn as SVG (`draw`), from that as PNG, or
//! sent to the page's script (`data`), which draws the same value and lets a reader hover, zoom and select; or, on a terminal, as
//! characters (`characters`).

mod axis;
mod canvas;
mod characters;
mod data;
mod draw;
mod layout;
mod style;
pub mod thin;

pub use axis::{Axis, span};
pub use canvas::Drawn;
pub use characters::characters;
pub use data::Columns;
pub use draw::{FOR_FILES, FOR_PAGES, svg};
pub use style::{Anchor, Color, Hue, Mark, Stroke, palette};

/// The bundled font first (`png`), then what browsers have that looks like it.
pub const FONT_FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

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
