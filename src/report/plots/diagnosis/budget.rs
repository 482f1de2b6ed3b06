//! What the mean square of the residual is made of: one bar, and its parts named below.

use super::CONTACT;
use crate::diagnose::{Cause, Diagnosis};
use crate::report::chart::{Anchor, Canvas, Drawn, LABEL_PX, TEXT_PX, palette, svg};
use crate::report::page::Drawing;
use crate::report::wording::Units;
use plotters::style::{RGBColor, WHITE};

const LEFT: f64 = 24.0;
const RIGHT: f64 = 836.0;
/// The bar's upper and lower edge, px.
const BAR: (f64, f64) = (40.0, 92.0);
/// Height of a named part's line, px.
const LINE_PX: f64 = 26.0;
/// A part narrower than this has its percentage below only, px.
const WIDE_PX: f64 = 46.0;
/// Parts below this share are told with their decimals.
const SMALL: f64 = 0.01;
/// Colours of the causes, in their order.
const COLORS: [RGBColor; 3] = [palette::BLUE, palette::GREEN, palette::PURPLE];

/// A part of the bar.
struct Part {
    name: String,
    square: f64,
    color: RGBColor,
}

/// The bar.
pub(super) fn draw(found: &Diagnosis) -> Drawn<Drawing> {
    let units = Units::of(found.before.joint.kind);
    let parts = parts(found);
    let whole: f64 = parts.iter().map(|part| part.square).sum::<f64>().max(f64::MIN_POSITIVE);
    let height = BAR.1 + 36.0 + LINE_PX * (parts.len() + 1) as f64;
    let drawn = svg(860, height as u32, "What the residual is made of", |canvas| {
        let title = format!("mean square of the residual: 100 % is an RMSE of {}", units.torque(whole.sqrt()));
        canvas.text((LEFT, 20.0), &title, LABEL_PX, palette::INK, Anchor::Left)?;
        bar(canvas, &parts, whole)?;
        head(canvas)?;
        parts.iter().enumerate().try_for_each(|(at, part)| line(canvas, part, whole, &units, at))
    })?;
    Ok(Drawing {
        name: "budget".to_string(),
        title: "What the gap is made of".to_string(),
        caption: "The residual's mean square in its parts, which add up: the floor that no model could explain, what the model's \
                  own parameters explain while they stay within their confidence, what each cause explains, and what is left. \
                  Squares add, roots do not: the RMS of each part is the root of its own square."
            .to_string(),
        svg: drawn,
    })
}

fn parts(found: &Diagnosis) -> Vec<Part> {
    let budget = &found.budget;
    let part = |name: &str, square: f64, color| Part { name: name.to_string(), square, color };
    let mut all = vec![
        part("floor: noise and what does not repeat", budget.floor, palette::PALE),
        part("the model within its own confidence", budget.within_confidence, palette::GREY),
    ];
    for ((cause, square), color) in budget.causes.iter().zip(COLORS.into_iter().cycle()) {
        all.push(match cause {
            &Cause::CONTACT => part("contact", *square, CONTACT),
            Cause::Effect(id) => part(id, *square, color),
            Cause::Stale(name) => part(&format!("stale parameters: {name}"), *square, color),
        });
    }
    all.push(part("unexplained", budget.unexplained, palette::VERMILION));
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

/// Parts side by side, a white line between them, their percentage in those that are wide enough.
fn bar(canvas: &Canvas, parts: &[Part], whole: f64) -> Drawn {
    let mut x = LEFT;
    for part in parts {
        let share = part.square / whole;
        let end = x + share * (RIGHT - LEFT);
        canvas.fill((x, BAR.0), (end, BAR.1), part.color, 1.0)?;
        if end - x > WIDE_PX {
            let ink = if is_dark(part.color) { WHITE } else { palette::INK };
            let middle = ((x + end) / 2.0, (BAR.0 + BAR.1) / 2.0);
            canvas.text(middle, &share_text(share), LABEL_PX, ink, Anchor::Middle)?;
        }
        if x > LEFT && end > x {
            canvas.line((x, BAR.0), (x, BAR.1), WHITE, 1.5)?;
        }
        x = end;
    }
    Ok(())
}

/// Whether white reads better on `color` than ink.
fn is_dark(color: RGBColor) -> bool {
    0.299 * f64::from(color.0) + 0.587 * f64::from(color.1) + 0.114 * f64::from(color.2) < 140.0
}

/// Middle of line `at`, px.
fn level(at: usize) -> f64 {
    BAR.1 + 28.0 + LINE_PX * at as f64
}

fn head(canvas: &Canvas) -> Drawn {
    for (x, text) in [(660.0, "of the square"), (RIGHT, "RMS")] {
        canvas.text((x, level(0)), text, TEXT_PX, palette::GREY, Anchor::Right)?;
    }
    Ok(())
}

fn line(canvas: &Canvas, part: &Part, whole: f64, units: &Units, at: usize) -> Drawn {
    let y = level(at + 1);
    canvas.fill((LEFT, y - 8.0), (LEFT + 22.0, y + 8.0), part.color, 1.0)?;
    canvas.text((LEFT + 34.0, y), &part.name, LABEL_PX, palette::INK, Anchor::Left)?;
    canvas.text((660.0, y), &share_text(part.square / whole), LABEL_PX, palette::INK, Anchor::Right)?;
    canvas.text((RIGHT, y), &units.torque(part.square.max(0.0).sqrt()), LABEL_PX, palette::INK, Anchor::Right)
}
