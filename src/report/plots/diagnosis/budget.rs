//! What the gap is made of, as a waterfall: from the gap as delivered down to what is left of it, and the noise floor beside it.

use super::CONTACT;
use crate::diagnose::{Cause, Diagnosis};
use crate::report::chart::{Axis, Color, Figure, Panel, Stroke, palette};
use crate::report::diagnosis::words::kept_together;
use crate::report::wording::Units;

/// Height of a part's row, px.
const ROW_PX: f64 = 30.0;
/// Half the height of a bar, in rows.
const HALF: f64 = 0.36;
/// Parts below this share are written with decimals.
const SMALL: f64 = 0.01;
/// Colours of the causes, in their order.
const COLORS: [Color; 3] = [palette::BLUE, palette::GREEN, palette::PURPLE];
/// Room to the right of the longest bar, as a share of it.
const ROOM: f64 = 0.02;

const CAPTION: &str = "The gap is sqrt(RMSE² - floor²); the rows divide its reduction in proportion to the mean squares that they remove.";

/// A part of the gap.
struct Part {
    /// Whose it is; `None` is the model's own parameters within their confidence.
    cause: Option<Cause>,
    /// How far it takes the gap down: share of the gap's RMS as delivered.
    share: f64,
    color: Color,
}

impl Part {
    fn name(&self) -> String {
        match self.cause {
            None => "own parameters, within confidence".to_string(),
            Some(Cause::Effect(id)) => id.to_string(),
            Some(Cause::Stale(name)) => format!("{name}, refitted"),
        }
    }
}

/// A bar of the waterfall with what stands beside it.
struct Bar {
    name: String,
    from_nm: f64,
    to_nm: f64,
    told: String,
    color: Color,
    /// Whether the next bar begins where this one starts.
    leads_on: bool,
}

/// The waterfall.
pub fn figure(found: &Diagnosis) -> Figure {
    let units = Units::of(&found.before.joint);
    let bars = bars(found, &units);
    let top_nm = bars.iter().map(|bar| bar.to_nm).fold(f64::MIN_POSITIVE, f64::max);
    let (unit, factor) = units.torque_scale(top_nm);
    let x = Axis::linear(format!("RMS ({unit})"), 0.0, factor * top_nm * (1.0 + ROOM));
    let mut panel = Panel::new(x, Axis::names(bars.iter().map(|bar| bar.name.clone())));
    for (row, bar) in bars.iter().enumerate() {
        let level = -(row as f64) - 0.5;
        let (from, to) = (factor * bar.from_nm, factor * bar.to_nm);
        panel.bar("", (from, to), (level - HALF, level + HALF), bar.color);
        panel.beside.push((level, kept_together(&bar.told)));
        if bar.leads_on {
            let edge = [(from, level - HALF), (from, level - 1.0 + HALF)];
            panel.line("", edge, Stroke::dashed(palette::GREY, 1.0, 3.0, 3.0));
        }
    }
    let height = ROW_PX * bars.len() as f64;
    Figure::single("budget", "What the gap is made of: the share that each cause explains", CAPTION, height, panel)
}

/// The rows from above: the gap, its parts, what is left, the floor.
fn bars(found: &Diagnosis, units: &Units) -> Vec<Bar> {
    let (before_nm, floor_nm) = (found.verdict.gap_before_nm, found.gap.floor.upper_nm());
    let bar = |name: &str, to_nm: f64, told: String, color| {
        let name = name.to_string();
        Bar { name, from_nm: 0.0, to_nm, told, color, leads_on: false }
    };
    let mut bars = vec![bar("gap as delivered", before_nm, units.torque(before_nm), palette::INK)];
    let mut left = 1.0;
    let parts = parts(found);
    for (at, part) in parts.iter().enumerate() {
        let (from_nm, to_nm) = (before_nm * (left - part.share), before_nm * left);
        left -= part.share;
        // The first bar begins at zero; a line from its edge would stand on the axis.
        let leads_on = at + 1 < parts.len() || left > 0.0;
        let told = share_text(part.share);
        bars.push(Bar { from_nm, leads_on, ..bar(&part.name(), to_nm, told, part.color) });
    }
    let after_nm = found.verdict.gap_after_nm;
    if before_nm > 0.0 {
        let told = format!("{}, {}", share_text(after_nm / before_nm), units.torque(after_nm));
        bars.push(bar("remains", after_nm, told, palette::VERMILION));
    }
    bars.push(bar("noise floor (upper limit)", floor_nm, units.torque(floor_nm), palette::PALE));
    bars
}

/// What takes the gap down, in the order in which it is taken off; together as far as the gap shrinks. Nothing where there is no gap.
fn parts(found: &Diagnosis) -> Vec<Part> {
    let (budget, verdict) = (&found.budget, &found.verdict);
    if verdict.gap_before_nm <= 0.0 {
        return Vec::new();
    }
    let own = (None, budget.within_confidence, palette::GREY);
    let causes = budget.causes.iter().zip(COLORS.into_iter().cycle()).map(|((cause, square), color)| {
        let color = if *cause == Cause::CONTACT { CONTACT } else { color };
        (Some(*cause), *square, color)
    });
    let squares: Vec<_> = std::iter::once(own).chain(causes).collect();
    let shrink = (1.0 - verdict.gap_after_nm / verdict.gap_before_nm).clamp(0.0, 1.0);
    let whole: f64 = squares.iter().map(|(_, square, _)| square).sum::<f64>().max(f64::MIN_POSITIVE);
    let part = |(cause, square, color)| Part { cause, share: shrink * square / whole, color };
    // The model's own parameters are worth a row only where they absorb anything to speak of.
    let is_worth = |part: &Part| part.share > if part.cause.is_none() { SMALL / 10.0 } else { 0.0 };
    squares.into_iter().map(part).filter(is_worth).collect()
}

/// How far the model's own parameters within their confidence (`None`) or a cause that was taken bring the gap down: share of its RMS.
pub fn added(by: Option<Cause>, found: &Diagnosis) -> Option<f64> {
    parts(found).into_iter().find(|part| part.cause == by).map(|part| part.share)
}

fn share_text(share: f64) -> String {
    match share {
        s if s < SMALL / 10.0 => "below 0.1 %".to_string(),
        s if s < SMALL => format!("{:.1} %", 100.0 * s),
        s => format!("{:.0} %", 100.0 * s),
    }
}
