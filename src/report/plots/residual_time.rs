//! Residuals against time, of a few trials.

use crate::identify::{Identification, Residual};
use crate::model::Direction;
use crate::report::chart::{Axis, Figure, Mark, Panel, Point, Stroke, palette, span, thin};
use crate::report::wording::{Units, moving};
use std::ops::Range;

/// Trials shown.
const TRIALS: usize = 4;
/// Height of a trial's panel, px.
const HEIGHT_PX: f64 = 104.0;
/// The motion has turned once it came back by this share of the trial's whole travel.
const TURNED: f64 = 0.005;
/// The axis ends at this many times what all but `BEYOND` of the samples stay below: one peak must not flatten the rest.
const PEAKS: f64 = 12.0;
const BEYOND: f64 = 0.02;
/// Room above and below, as a share of what is shown.
const ROOM: f64 = 0.08;
/// Samples further apart than this many usual periods are not joined by a line.
const GAP_PERIODS: f64 = 10.0;

const CAPTION: &str = "Measured minus predicted torque, both low-passed, in a few trials: for each protocol the one with a typical \
                       residual and the one with the largest, each on its own scale. Peaks after each reversal point to the \
                       change-over curve, a slow drift to temperature or the sensor, a level that differs between directions to friction.";

/// Residuals of typical and of bad trials, one above the other; `None` without any.
pub fn figure(found: &Identification) -> Option<Figure> {
    let trials = representative(&found.residuals);
    if trials.is_empty() {
        return None;
    }
    let units = Units::of(&found.model.joint);
    let ranges: Vec<Point> = trials.iter().map(|(trial, _)| range_nm(trial)).collect();
    let (unit, factor) = units.torque_scale(ranges.iter().fold(0.0, |m: f64, r| m.max(-r.0).max(r.1)));
    let mut figure = Figure::new("residual_time", "Residual against time", CAPTION);
    for (i, (trial, note)) in trials.iter().enumerate() {
        let (from_s, to_s) = span(trial.time_s.iter().copied());
        let y = Axis::around(format!("residual ({unit})"), [factor * ranges[i].0, factor * ranges[i].1], ROOM);
        let peak = units.torque(thin::magnitude(trial.residual_nm.iter().copied(), 0.0));
        let figures = format!("RMSE {}, peak {peak}", units.torque(trial.rmse_nm));
        let label = if i + 1 == trials.len() { "time (s)" } else { "" };
        let mut panel = Panel::new(Axis::linear(label, from_s, to_s), y).titled(format!(
            "{} ({}), {note}: {figures}",
            trial.file,
            trial.protocol.name()
        ));
        for direction in Direction::BOTH {
            let stroke = Stroke::solid(palette::direction(direction), 1.1);
            panel.line(moving(direction), moving_points(trial, direction, factor), stroke);
        }
        for mark in [Mark::Up, Mark::Down] {
            let beyond = peaks_beyond(trial, ranges[i]).into_iter().filter(|(_, of)| *of == mark);
            let points: Vec<Point> = beyond.map(|(at, _)| (trial.time_s[at], factor * trial.residual_nm[at])).collect();
            if !points.is_empty() {
                panel.marks("peak beyond the frame", points, mark, palette::INK);
            }
        }
        figure = figure.row(HEIGHT_PX, vec![panel]);
    }
    Some(figure)
}

/// The trial's residual times `factor` where it moves in `direction`, with gaps between and where samples are missing.
fn moving_points(trial: &Residual, direction: Direction, factor: f64) -> Vec<Point> {
    let (from_s, to_s) = span(trial.time_s.iter().copied());
    let gap_s = GAP_PERIODS * (to_s - from_s) / trial.time_s.len() as f64;
    let gap = (f64::NAN, f64::NAN);
    let mut points = Vec::new();
    for (_, run) in runs(trial).into_iter().filter(|(of, _)| *of == direction) {
        for i in run.clone() {
            if i > run.start && trial.time_s[i] - trial.time_s[i - 1] > gap_s {
                points.push(gap);
            }
            points.push((trial.time_s[i], factor * trial.residual_nm[i]));
        }
        points.push(gap);
    }
    points
}

/// Range of the trial's panel: zero and all samples, except peaks that would flatten the rest.
fn range_nm(trial: &Residual) -> (f64, f64) {
    let reach = PEAKS * thin::magnitude(trial.residual_nm.iter().copied(), BEYOND);
    let (low, high) = span(trial.residual_nm.iter().copied().chain([0.0]));
    (low.max(-reach), high.min(reach))
}

/// The farthest sample of each peak beyond `low` to `high`, with the triangle that says where it goes.
fn peaks_beyond(trial: &Residual, (low, high): (f64, f64)) -> Vec<(usize, Mark)> {
    let side = |at: &usize| match trial.residual_nm[*at] {
        y if y > high => 1,
        y if y < low => -1,
        _ => 0,
    };
    let samples: Vec<usize> = (0..trial.residual_nm.len()).collect();
    let height = |at: &usize| trial.residual_nm[*at].abs();
    let peaks = samples.chunk_by(|a, b| side(a) == side(b)).filter(|peak| side(&peak[0]) != 0);
    let farthest = peaks.filter_map(|peak| peak.iter().max_by(|a, b| height(a).total_cmp(&height(b))));
    farthest.map(|at| (*at, if side(at) > 0 { Mark::Up } else { Mark::Down })).collect()
}

/// Of each protocol the trials with the largest, the middle and the smallest residual, as far as there is room, in the
/// campaign's order and each with a word on why it is shown.
fn representative(residuals: &[Residual]) -> Vec<(&Residual, &'static str)> {
    let mut protocols: Vec<&str> = Vec::new();
    for name in residuals.iter().map(|r| r.protocol.name()) {
        if !protocols.contains(&name) {
            protocols.push(name);
        }
    }
    let ranked = protocols.iter().map(|name| {
        let of_protocol = |i: &usize| residuals[*i].protocol.name() == *name && residuals[*i].time_s.len() > 1;
        let mut mine: Vec<usize> = (0..residuals.len()).filter(of_protocol).collect();
        mine.sort_by(|a, b| residuals[*a].rmse_nm.total_cmp(&residuals[*b].rmse_nm));
        mine
    });
    let ranked: Vec<Vec<usize>> = ranked.filter(|mine| !mine.is_empty()).collect();
    let mut chosen: Vec<(usize, &'static str)> = Vec::new();
    for (share, note) in [(1.0, "largest residual"), (0.5, "typical residual"), (0.0, "smallest residual")] {
        for mine in &ranked {
            let at = mine[((mine.len() - 1) as f64 * share) as usize];
            if chosen.len() < TRIALS && !chosen.iter().any(|(i, _)| *i == at) {
                chosen.push((at, note));
            }
        }
    }
    chosen.sort_unstable();
    chosen.into_iter().map(|(i, note)| (&residuals[i], note)).collect()
}

/// Stretches of one direction: each runs up to the farthest position from which the motion then came back.
fn runs(trial: &Residual) -> Vec<(Direction, Range<usize>)> {
    let positions = &trial.position_rad;
    let (low, high) = span(positions.iter().copied());
    let turned_rad = TURNED * (high - low);
    let mut runs = Vec::new();
    let (mut start, mut farthest) = (0, 0);
    let mut direction: Option<Direction> = None;
    for (i, x) in positions.iter().enumerate() {
        let onward = x - positions[farthest];
        match direction {
            Some(going) if onward * going.sign() >= 0.0 => farthest = i,
            _ if onward.abs() > turned_rad => {
                if let Some(going) = direction {
                    runs.push((going, start..farthest + 1));
                    start = farthest;
                }
                direction = Some(if onward > 0.0 { Direction::Up } else { Direction::Down });
                farthest = i;
            }
            _ => {}
        }
    }
    runs.push((direction.unwrap_or(Direction::Up), start..positions.len()));
    runs
}
