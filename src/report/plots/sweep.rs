//! One sweep: recorded, low-passed, and the legs fitted to it.

use crate::identify::Identification;
use crate::model::Direction;
use crate::report::chart::{Anchor, Axis, Drawn, Frame, Mark, Stroke, TEXT_PX, palette, span, svg, thin};
use crate::report::number::significant;
use crate::report::wording::{Units, moving};

/// Stretches of the recorded signal of which lowest and highest point are drawn: about one per pixel.
const BUCKETS: usize = 700;

/// Torque against time; `None` without a sweep.
pub fn draw(found: &Identification) -> Drawn<Option<String>> {
    let Some(trace) = found.trace.as_ref().filter(|trace| !trace.time_s.is_empty()) else { return Ok(None) };
    let units = Units::of(found.model.joint.kind);
    let (from_s, to_s) = span(trace.time_s.iter().copied());
    let fitted = trace.legs.iter().flat_map(|(_, line)| line.iter().map(|p| p.1));
    let y = Axis::around(format!("torque ({})", units.torque), trace.raw_nm.iter().copied().chain(fitted), 0.04);
    let over_time = |values: &[f64]| -> Vec<(f64, f64)> {
        let points: Vec<(f64, f64)> = trace.time_s.iter().copied().zip(values.iter().copied()).collect();
        thin::envelope(&points, BUCKETS)
    };
    let heading = format!("{}, {} {}", trace.file, significant(trace.speed_rad_s, 3), units.speed);
    svg(860, 440, &heading, |canvas| {
        let frame = Frame { left: 92.0, top: 62.0, right: 840.0, bottom: 384.0 };
        let panel = canvas.panel(frame, Axis::linear("time (s)", from_s, to_s), y)?;
        canvas.text((92.0, 16.0), &heading, TEXT_PX, palette::INK, Anchor::Left)?;
        panel.line(over_time(&trace.raw_nm), Stroke::solid(palette::PALE, 0.8))?;
        panel.line(over_time(&trace.filtered_nm), Stroke::solid(palette::INK, 1.3))?;
        let mut entries = vec![
            (Mark::Line(1.5, None), palette::PALE, "as recorded".to_string()),
            (Mark::Line(1.5, None), palette::INK, "low-passed".to_string()),
        ];
        for (direction, line) in &trace.legs {
            let color = palette::direction(*direction);
            panel.line(line.iter().copied(), Stroke::solid(color, 2.4))?;
        }
        for direction in Direction::BOTH {
            if trace.legs.iter().any(|(of, _)| *of == direction) {
                let text =
                    format!("{}, {}", if trace.with_load { "A × load + B" } else { "A sin(θ) + B" }, moving(direction));
                entries.push((Mark::Line(2.4, None), palette::direction(direction), text));
            }
        }
        canvas.legend((92.0, 840.0), 42.0, &entries)
    })
    .map(Some)
}
