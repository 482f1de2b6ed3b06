//! Figures for the page's script: the same values as JSON, their numbers in columns that are shared, rounded and told by their
//! differences, so that they compress well.

use super::{Axis, Cells, Color, Figure, Mark, Panel, Point, Series, Shape, thin};
use serde_json::{Value, json};
use std::collections::HashMap;

/// Stretches of a line of which the script gets the lowest and the highest point: enough to zoom into a tenth; fewer where there are
/// many figures, so that pages stay small.
const BUCKETS: usize = 1400;
const BUCKETS_MIN: usize = 300;
/// Up to this many figures have all of them.
const FIGURES: usize = 20;
/// Steps of a column: finer than any screen shows.
const STEPS_X: f64 = 60_000.0;
const STEPS_Y: f64 = 6_000.0;

/// The columns of all figures of a page.
#[derive(Debug)]
pub struct Columns {
    buckets: usize,
    /// As JSON, and where each stands among them.
    known: HashMap<String, usize>,
}

impl Columns {
    /// None yet, of a page with this many `figures`.
    pub fn of(figures: usize) -> Self {
        let buckets = (BUCKETS * FIGURES / figures.max(FIGURES)).max(BUCKETS_MIN);
        Self { buckets, known: HashMap::new() }
    }

    /// All columns so far, as JSON.
    pub fn into_json(self) -> String {
        let mut all: Vec<(String, usize)> = self.known.into_iter().collect();
        all.sort_unstable_by_key(|(_, at)| *at);
        let all: Vec<String> = all.into_iter().map(|(column, _)| column).collect();
        format!("[{}]", all.join(","))
    }

    /// The number of the column that holds `values` in `steps` steps.
    fn add(&mut self, values: impl Iterator<Item = f64> + Clone, steps: f64) -> usize {
        let finite = values.clone().filter(|x| x.is_finite());
        let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let step = ((high - low) / steps).max(f64::MIN_POSITIVE);
        // Written straight: most of a page is such numbers.
        let mut column = format!("[{},{},[", json!(low), json!(step));
        let (mut last, mut comma) = (0i64, "");
        for x in values {
            column += comma;
            comma = ",";
            if x.is_finite() {
                let at = ((x - low) / step).round() as i64;
                column += &(at - last).to_string();
                last = at;
            } else {
                column += "null";
            }
        }
        column += "]]";
        let next = self.known.len();
        *self.known.entry(column).or_insert(next)
    }

    fn points(&mut self, points: &[Point]) -> Value {
        let x = self.add(points.iter().map(|p| p.0), STEPS_X);
        let y = self.add(points.iter().map(|p| p.1), STEPS_Y);
        json!([x, y])
    }
}

impl Figure {
    /// For the script, its numbers in `columns`.
    pub fn to_json(&self, columns: &mut Columns) -> Value {
        let mut panel = |panel: &Panel| {
            let series: Vec<Value> = panel.series.iter().map(|series| of_series(series, columns)).collect();
            json!({
                "title": panel.title, "x": axis(&panel.x), "y": axis(&panel.y), "series": series,
                "beside": panel.beside, "link": panel.link,
            })
        };
        let mut rows = Vec::new();
        for row in &self.rows {
            let panels: Vec<Value> = row.panels.iter().map(&mut panel).collect();
            rows.push(json!({ "height": row.height_px, "panels": panels }));
        }
        json!({ "title": self.title, "rows": rows })
    }
}

fn axis(axis: &Axis) -> Value {
    let (kind, from) = axis.kind();
    let texts = axis.is_names.then(|| axis.ticks.clone());
    json!({
        "label": axis.label, "kind": kind, "from": from, "ends": [axis.places.0, axis.places.1], "texts": texts,
        "hidden": axis.is_hidden,
    })
}

fn color(color: Color) -> Value {
    json!([color.hue.name(), u8::from(color.light)])
}

fn mark_name(mark: Mark) -> &'static str {
    match mark {
        Mark::Up => "up",
        Mark::Down => "down",
        Mark::Leftwards => "left",
        Mark::Rightwards => "right",
        Mark::Disc(_) => "disc",
        Mark::Ring => "ring",
        Mark::Diamond => "diamond",
        Mark::Square => "square",
    }
}

fn of_series(series: &Series, columns: &mut Columns) -> Value {
    let mut value = match &series.shape {
        Shape::Line(points, stroke) => json!({
            "kind": "line", "color": color(stroke.color), "width": stroke.width_px,
            "dash": stroke.dash_px.map(|(dash, gap)| [dash, gap]),
            "points": columns.points(&thin::joined(thin::runs(points, columns.buckets))),
        }),
        Shape::Band(lower, upper, of, opacity) => json!({
            "kind": "band", "color": color(*of), "opacity": opacity,
            "points": columns.points(&thin::low_edge(lower, columns.buckets)),
            "upper": columns.points(&thin::high_edge(upper, columns.buckets)),
        }),
        Shape::Dots(points, radius, of, opacity) => json!({
            "kind": "dots", "color": color(*of), "opacity": opacity, "radius": radius, "points": columns.points(points),
        }),
        Shape::Marks(points, mark, of) => {
            let radius = if let Mark::Disc(radius) = mark { *radius } else { 4.5 };
            json!({
                "kind": "marks", "color": color(*of), "mark": mark_name(*mark), "radius": radius,
                "points": columns.points(points),
            })
        }
        Shape::Texts(texts, anchor, of) => json!({
            "kind": "texts", "color": color(*of), "anchor": format!("{anchor:?}"), "texts": texts,
        }),
        Shape::Cells(cells) => of_cells(cells),
    };
    value["name"] = json!(series.name);
    value
}

fn of_cells(cells: &Cells) -> Value {
    let rounded = |x: &f64| x.is_finite().then(|| format!("{x:.3e}").parse::<f64>().unwrap_or(*x));
    let time = |s: f64| (1e3 * s).round() / 1e3;
    let stretches: Vec<Vec<Value>> = cells
        .stretches
        .iter()
        .map(|of| of.iter().map(|(trial, from, to)| json!([trial, time(*from), time(*to)])).collect())
        .collect();
    json!({
        "kind": "cells", "across": cells.across, "upwards": cells.upwards,
        "values": cells.values.iter().map(rounded).collect::<Vec<_>>(), "axis": axis(&cells.axis),
        "ticks": cells.axis.ticks, "marked": cells.marked, "stretches": stretches,
    })
}
