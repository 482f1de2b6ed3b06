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
    let x = Axis::linear("run minus mean (half widths of the identified 95 % interval)", -REACH, REACH);
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
        let away = |(value, se): &(f64, f64)| (value - quantity.mean) / (HALF_WIDTH * se);
        let runs: Vec<f64> = quantity.values.iter().flatten().map(away).collect();
        let mut add = |mark: Mark, is_in: &dyn Fn(f64) -> bool| {
            let of = runs.iter().filter(|away| is_in(**away)).map(|away| (away.clamp(-REACH, REACH), level));
            let of: Vec<_> = of.collect();
            if !of.is_empty() {
                panel.marks(name, of, mark, color);
            }
        };
        add(Mark::Disc(3.0), &|away| away.abs() <= REACH);
        add(Mark::Leftwards, &|away| away < -REACH);
        add(Mark::Rightwards, &|away| away > REACH);
    }
    Figure::single(
        &format!("runs_{:02}", at + 1),
        format!("{}: each run beside the mean", of.joint),
        "Each dot is a run, in half widths of its own 95 % interval: within -1 to 1 it agrees with the mean; a triangle at the edge \
         stands for one farther out. The bar is the half width that the scatter shows.",
        ROW_PX * shown.len().max(1) as f64,
        panel,
    )
}
