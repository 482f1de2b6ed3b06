//! The trial that differs most in motion: position, real and simulated, and what they and their torques differ by.

use crate::diagnose::{MotionGap, MotionTrial};
use crate::dynamics::JointKind;
use crate::report::chart::{Axis, Canvas, Drawn, Frame, Mark, Stroke, palette, svg, thin};
use crate::report::page::Drawing;
use crate::report::wording::Units;
use plotters::style::RGBColor;

/// Stretches of time of which the lowest and highest point are drawn.
const BUCKETS: usize = 900;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 840.0;

/// Three panels over time; `None` without a trial.
pub fn draw(gap: &MotionGap, kind: JointKind) -> Drawn<Option<Drawing>> {
    let Some(trial) = gap.trials.iter().max_by(|a, b| a.rmse_rad().total_cmp(&b.rmse_rad())) else { return Ok(None) };
    let units = Units::of(kind);
    let svg = svg(860, 560, "Motion, real and simulated", |canvas| {
        positions(canvas, trial, &units)?;
        let entries = [
            (Mark::Line(3.0, None), palette::PALE, "simulated".to_string()),
            (Mark::Line(1.2, None), palette::INK, "recorded".to_string()),
        ];
        canvas.legend((LEFT, RIGHT), 14.0, &entries)?;
        let unit = if kind == JointKind::Revolute { "mrad" } else { "mm" };
        let apart: Vec<f64> = trial.position_difference_rad().iter().map(|x| 1e3 * x).collect();
        let label = format!("difference ({unit})");
        difference(canvas, trial, &apart, label, (212.0, palette::VERMILION, false))?;
        let (unit, factor) = units.torque_scale(trial.peak_nm());
        let apart: Vec<f64> = trial.torque_difference_nm().iter().map(|y| factor * y).collect();
        difference(canvas, trial, &apart, format!("difference ({unit})"), (362.0, palette::BLUE, true))
    })?;
    Ok(Some(Drawing {
        name: "motion".to_string(),
        title: format!("{}: the recorded and the simulated motion", trial.file),
        caption: "From above: position as recorded and as simulated for the same commands, in the trial that differs most; their \
                  difference; and the difference of the torques, low-passed. Under a position controller the position gives way \
                  where the torque differs: the lower two should be mirror images, as far as torque explains motion."
            .to_string(),
        svg,
    }))
}

fn positions(canvas: &Canvas, trial: &MotionTrial, units: &Units) -> Drawn {
    let shown = |values: &[f64]| values.iter().map(|x| units.position_factor * x).collect::<Vec<f64>>();
    let (recorded, simulated) = (shown(&trial.position_rad), shown(&trial.simulated_rad));
    let all = recorded.iter().chain(&simulated).copied();
    let y = Axis::around(format!("position ({})", units.position), all, 0.06);
    let panel = canvas.panel(frame(36.0), time(trial, false), y)?;
    panel.line(points(trial, &simulated), Stroke::solid(palette::PALE, 3.0))?;
    panel.line(points(trial, &recorded), Stroke::solid(palette::INK, 1.2))
}

fn difference(
    canvas: &Canvas,
    trial: &MotionTrial,
    values: &[f64],
    label: String,
    (top, color, is_last): (f64, RGBColor, bool),
) -> Drawn {
    let y = Axis::around(label, values.iter().copied().chain([0.0]), 0.08);
    let panel = canvas.panel(frame(top), time(trial, is_last), y)?;
    panel.line(points(trial, values), Stroke::solid(color, 1.2))
}

fn frame(top: f64) -> Frame {
    Frame { left: LEFT, top, right: RIGHT, bottom: top + 130.0 }
}

fn time(trial: &MotionTrial, is_last: bool) -> Axis {
    let (first, last) = (trial.time_s[0], trial.time_s[trial.time_s.len() - 1]);
    let axis = Axis::linear("time (s)", first, last);
    if is_last { axis } else { axis.without_texts() }
}

fn points(trial: &MotionTrial, values: &[f64]) -> Vec<(f64, f64)> {
    let all: Vec<(f64, f64)> = trial.time_s.iter().copied().zip(values.iter().copied()).collect();
    thin::envelope(&all, BUCKETS)
}
