//! The figure of runs of one joint: each quantity's runs beside their mean, in half widths of what they claim.

use crate::batch::{Quantity, Repeatability, Repeated};
use crate::numerics::statistics::HALF_WIDTH;
use crate::report::chart::{Anchor, Axis, Drawn, Frame, LABEL_PX, Mark, Stroke, palette, svg};
use crate::report::page::Drawing;

/// Height of a row, px.
const ROW_PX: f64 = 22.0;
/// Half widths drawn to either side; what lies beyond is drawn at the edge.
const REACH: f64 = 6.0;

/// A figure for each joint.
pub fn drawings(found: &[Repeatability]) -> Drawn<Vec<Drawing>> {
    found.iter().enumerate().map(|(at, of)| drawing(at, of)).collect()
}

fn drawing(at: usize, of: &Repeatability) -> Drawn<Drawing> {
    let shown: Vec<&Quantity> = of.quantities.iter().filter(|q| q.verdict != Repeated::NotIdentifiable).collect();
    let height = 110.0 + ROW_PX * shown.len() as f64;
    let picture = svg(860, height as u32, &format!("{}: runs beside their mean", of.joint), |canvas| {
        let frame = Frame { left: 250.0, top: 40.0, right: 840.0, bottom: height - 50.0 };
        let x = Axis::linear("run less mean (half widths of the claimed 95 % interval)", -REACH, REACH);
        let y = Axis::linear("", -(shown.len() as f64) + 0.5, 0.5).without_texts();
        let panel = canvas.panel(frame, x, y)?;
        for (row, quantity) in shown.iter().enumerate() {
            let level = -(row as f64);
            let color = match quantity.verdict {
                Repeated::Repeatable => palette::GREEN,
                Repeated::Scatters => palette::VERMILION,
                _ => palette::BLUE,
            };
            let wide = quantity.wider().min(REACH);
            panel.line([(-wide, level), (wide, level)], Stroke::solid(palette::lighter(color), 6.0))?;
            for (value, se) in quantity.values.iter().flatten() {
                let away = (value - quantity.mean) / (HALF_WIDTH * se);
                panel.mark((away.clamp(-REACH, REACH), level), Mark::Disc(3.0), color)?;
            }
        }
        for (row, quantity) in shown.iter().enumerate() {
            let middle = frame.top + (row as f64 + 0.5) * (frame.bottom - frame.top) / shown.len() as f64;
            canvas.text((240.0, middle), &quantity.name, LABEL_PX, palette::INK, Anchor::Right)?;
        }
        let entry = |color, text: &str| (Mark::Disc(3.0), color, text.to_string());
        canvas.legend(
            (250.0, 840.0),
            20.0,
            &[
                entry(palette::GREEN, "repeatable"),
                entry(palette::VERMILION, "scatters more"),
                entry(palette::BLUE, "depends on a condition"),
            ],
        )
    })?;
    Ok(Drawing {
        name: format!("runs_{:02}", at + 1),
        title: format!("{}: each run beside the mean", of.joint),
        caption: "Each dot is a run, in half widths of its own 95 % interval: within -1 to 1 it agrees with the mean. The bar is the \
                  half width that the scatter shows."
            .to_string(),
        svg: picture,
    })
}
