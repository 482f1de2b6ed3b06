//! One sweep: recorded, low-passed, and the legs fitted to it.

use crate::identify::Identification;
use crate::report::chart::{Axis, Figure, Panel, Point, Stroke, palette, span};
use crate::report::number::significant;
use crate::report::wording::{Units, moving};

const CAPTION: &str = "Torque of the sweep of middle speed: as recorded, after the low-pass, and the fitted A sin(θ) + B of each leg. \
                       The fit should run through the middle of the low-passed signal over the whole leg; a bend that it does \
                       not follow is load that A sin(θ) does not describe, a ripple is torque that changes with position.";

/// Torque against time; `None` without a sweep.
pub fn figure(found: &Identification) -> Option<Figure> {
    let trace = found.trace.as_ref().filter(|trace| !trace.time_s.is_empty())?;
    let units = Units::of(&found.model.joint);
    let (from_s, to_s) = span(trace.time_s.iter().copied());
    let fitted = trace.legs.iter().flat_map(|(_, line)| line.iter().map(|p| p.1));
    let y = Axis::around(format!("torque ({})", units.torque), trace.raw_nm.iter().copied().chain(fitted), 0.04);
    let over_time =
        |values: &[f64]| -> Vec<Point> { trace.time_s.iter().copied().zip(values.iter().copied()).collect() };
    let heading = format!("{}, {} {}", trace.file, significant(trace.speed_rad_s, 3), units.speed);
    let mut panel = Panel::new(Axis::linear("time (s)", from_s, to_s), y).titled(heading);
    panel.line("as recorded", over_time(&trace.raw_nm), Stroke::solid(palette::PALE, 0.8));
    panel.line("low-passed", over_time(&trace.filtered_nm), Stroke::solid(palette::INK, 1.3));
    let form = if trace.with_load { "A × load + B" } else { "A sin(θ) + B" };
    for (direction, line) in &trace.legs {
        let stroke = Stroke::solid(palette::direction(*direction), 2.4);
        panel.line(format!("{form}, {}", moving(*direction)), line.iter().copied(), stroke);
    }
    Some(Figure::single("sweep", "One sweep, as recorded and as fitted", CAPTION, 322.0, panel))
}
