//! The trial that differs most in motion: position, real and simulated, and what they and their torques differ by.

use crate::diagnose::{MotionGap, MotionTrial};
use crate::dynamics::JointKind;
use crate::report::chart::{Axis, Color, Figure, Panel, Point, Stroke, palette};
use crate::report::wording::Units;

const CAPTION: &str = "From above: position as recorded and as simulated for the same commands, in the trial that differs most; their \
                       difference; and the difference of the torques, low-passed. Under a position controller the position gives way \
                       where the torque differs: the lower two should be mirror images, as far as torque explains motion.";

/// Three panels over time; `None` without a trial.
pub fn figure(gap: &MotionGap, kind: JointKind) -> Option<Figure> {
    let trial = gap.trials.iter().max_by(|a, b| a.rmse_rad().total_cmp(&b.rmse_rad()))?;
    let units = Units::of_kind(kind);
    let unit = if kind == JointKind::Revolute { "mrad" } else { "mm" };
    let apart: Vec<f64> = trial.position_difference_rad().iter().map(|x| 1e3 * x).collect();
    let position = difference(trial, "position difference", &apart, unit, (palette::VERMILION, false));
    let (unit, factor) = units.torque_scale(trial.peak_nm());
    let apart: Vec<f64> = trial.torque_difference_nm().iter().map(|y| factor * y).collect();
    let torque = difference(trial, "torque difference", &apart, unit, (palette::BLUE, true));
    let title = format!("{}: the recorded and the simulated motion", trial.file);
    let figure = Figure::new("motion", title, CAPTION);
    Some(figure.row(130.0, vec![positions(trial, &units)]).row(130.0, vec![position]).row(130.0, vec![torque]))
}

fn positions(trial: &MotionTrial, units: &Units) -> Panel {
    let shown = |values: &[f64]| values.iter().map(|x| units.position_factor * x).collect::<Vec<f64>>();
    let (recorded, simulated) = (shown(&trial.position_rad), shown(&trial.simulated_rad));
    let all = recorded.iter().chain(&simulated).copied();
    let mut panel = Panel::new(time(trial, false), Axis::around(format!("position ({})", units.position), all, 0.06));
    panel.line("simulated", points(trial, &simulated), Stroke::solid(palette::PALE, 3.0));
    panel.line("recorded", points(trial, &recorded), Stroke::solid(palette::INK, 1.2));
    panel.linked("motion")
}

fn difference(trial: &MotionTrial, name: &str, values: &[f64], unit: &str, (color, is_last): (Color, bool)) -> Panel {
    let y = Axis::around(format!("difference ({unit})"), values.iter().copied().chain([0.0]), 0.08);
    let mut panel = Panel::new(time(trial, is_last), y).linked("motion");
    panel.line(name, points(trial, values), Stroke::solid(color, 1.2));
    panel
}

fn time(trial: &MotionTrial, is_last: bool) -> Axis {
    let (first, last) = (trial.time_s[0], trial.time_s[trial.time_s.len() - 1]);
    let axis = Axis::linear("time (s)", first, last);
    if is_last { axis } else { axis.without_texts() }
}

fn points(trial: &MotionTrial, values: &[f64]) -> Vec<Point> {
    trial.time_s.iter().copied().zip(values.iter().copied()).collect()
}
