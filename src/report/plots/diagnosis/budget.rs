//! What the mean square of the residual is made of, as a waterfall: from the model as delivered down to the floor.

use super::CONTACT;
use crate::diagnose::{Cause, Diagnosis};
use crate::report::chart::{Axis, Color, Figure, Panel, Stroke, palette};
use crate::report::diagnosis::words::kept_together;
use crate::report::wording::Units;

/// Height of a part's row, px.
const ROW_PX: f64 = 30.0;
/// Half the height of a bar, in rows.
const HALF: f64 = 0.36;
/// Parts below this share are told with their decimals.
const SMALL: f64 = 0.01;
/// Colours of the causes, in their order.
const COLORS: [Color; 3] = [palette::BLUE, palette::GREEN, palette::PURPLE];

const CAPTION: &str = "The residual's mean square in its parts, which add up, from the model as delivered to the noise floor: what the \
                       model's own parameters explain while they stay within their confidence, what each cause adds, what is \
                       left, and the noise floor with its standard error, which no model could explain. Squares add, roots do not: the RMS of each part is the \
                       root of its own square.";

/// A part of the mean square.
pub struct Part {
    /// What it is.
    pub name: String,
    /// How much, (N m)^2.
    pub square: f64,
    /// Its colour, the same wherever it is shown.
    pub color: Color,
}

/// The waterfall.
pub fn figure(found: &Diagnosis) -> Figure {
    let units = Units::of(&found.before.joint);
    let parts = parts(found);
    let whole: f64 = parts.iter().map(|part| part.square).sum::<f64>().max(f64::MIN_POSITIVE);
    let names = std::iter::once("as delivered".to_string()).chain(parts.iter().map(|part| part.name.clone()));
    let x = Axis::linear("share of the residual's mean square (%)", 0.0, 100.0);
    let mut panel = Panel::new(x, Axis::names(names));
    let told = |square: f64| {
        let rms = units.torque(square.max(0.0).sqrt());
        kept_together(&format!("{}, {rms}", share_text(square / whole)))
    };
    let mut add = |row: usize, (from, to): (f64, f64), square: f64, color: Color| {
        let level = -(row as f64) - 0.5;
        panel.bar("", (100.0 * from / whole, 100.0 * to / whole), (level - HALF, level + HALF), color);
        panel.beside.push((level, told(square)));
        if row < parts.len() {
            let edge = 100.0 * from / whole;
            panel.line(
                "",
                [(edge, level - HALF), (edge, level - 1.0 + HALF)],
                Stroke::dashed(palette::GREY, 1.0, 3.0, 3.0),
            );
        }
    };
    let mut left = whole;
    for (row, part) in parts.iter().enumerate() {
        add(row + 1, (left - part.square, left), part.square, part.color);
        left -= part.square;
    }
    add(0, (0.0, whole), whole, palette::INK);
    // The first bar begins at zero; its edge would stand there too.
    panel.series.pop();
    let height = ROW_PX * (parts.len() + 1) as f64;
    Figure::single("budget", "What the gap is made of, and what each cause adds", CAPTION, height, panel)
}

/// The parts that are there, in the order in which they are taken off.
pub fn parts(found: &Diagnosis) -> Vec<Part> {
    let budget = &found.budget;
    let part = |name: &str, square: f64, color| Part { name: name.to_string(), square, color };
    let mut all = vec![part("model within its confidence", budget.within_confidence, palette::GREY)];
    for ((cause, square), color) in budget.causes.iter().zip(COLORS.into_iter().cycle()) {
        all.push(match cause {
            &Cause::CONTACT => part("contact", *square, CONTACT),
            Cause::Effect(id) => part(id, *square, color),
            Cause::Stale(name) => part(&format!("stale: {name}"), *square, color),
        });
    }
    all.push(part("unexplained", budget.unexplained, palette::VERMILION));
    all.push(part("noise floor, at most", budget.floor, palette::PALE));
    all.retain(|part| part.square > 0.0);
    all
}

fn share_text(share: f64) -> String {
    match share {
        s if s < SMALL / 10.0 => "below 0.1 %".to_string(),
        s if s < SMALL => format!("{:.1} %", 100.0 * s),
        s => format!("{:.0} %", 100.0 * s),
    }
}
