//! The figure of runs of one joint: each quantity's runs beside their mean, in half widths of what they claim.

use crate::batch::{Quantity, Repeatability, Repeated};
use crate::numerics::statistics::HALF_WIDTH;
use crate::report::chart::{Axis, Figure, Mark, Panel, Stroke, palette};

/// Height of a row, px.
const ROW_PX: f64 = 22.0;
/// Half widths drawn to either side; what lies beyond is drawn at the edge.
const REACH: f64 = 6.0;

/// A figure for each joint.
pub fn figures(found: &[Repeatability]) -> Vec<Figure> {
    found.iter().enumerate().map(|(at, of)| figure(at, of)).collect()
}

fn figure(at: usize, of: &Repeatability) -> Figure {
    let shown: Vec<&Quantity> = of.quantities.iter().filter(|q| q.verdict != Repeated::NotIdentifiable).collect();
    let x = Axis::linear("run less mean (half widths of the claimed 95 % interval)", -REACH, REACH);
    let mut panel = Panel::new(x, Axis::names(shown.iter().map(|q| q.name.clone())));
    for (row, quantity) in shown.iter().enumerate() {
        let level = -(row as f64) - 0.5;
        let (color, name) = match quantity.verdict {
            Repeated::Repeatable => (palette::GREEN, "repeatable"),
            Repeated::Scatters => (palette::VERMILION, "scatters more"),
            _ => (palette::BLUE, "depends on a condition"),
        };
        let wide = quantity.wider().min(REACH);
        panel.line("", [(-wide, level), (wide, level)], Stroke::solid(palette::lighter(color), 6.0));
        let away = |(value, se): &(f64, f64)| ((value - quantity.mean) / (HALF_WIDTH * se)).clamp(-REACH, REACH);
        let runs = quantity.values.iter().flatten().map(|run| (away(run), level)).collect();
        panel.marks(name, runs, Mark::Disc(3.0), color);
    }
    Figure::single(
        &format!("runs_{:02}", at + 1),
        format!("{}: each run beside the mean", of.joint),
        "Each dot is a run, in half widths of its own 95 % interval: within -1 to 1 it agrees with the mean. The bar is the \
         half width that the scatter shows.",
        ROW_PX * shown.len().max(1) as f64,
        panel,
    )
}
