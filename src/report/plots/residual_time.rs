//! Residuals against time, of a few trials.

use crate::identify::{Identification, Residual};
use crate::model::Direction;
use crate::report::chart::{
    Anchor, Axis, Drawn, Frame, LABEL_PX, Mark, Panel, Stroke, TEXT_PX, palette, span, svg, thin,
};
use crate::report::wording::{Units, moving};
use std::ops::Range;

/// Trials shown.
const TRIALS: usize = 4;
/// Height of a trial's panel, px.
const HEIGHT_PX: f64 = 104.0;
/// Height of a panel with its title and ticks, px.
const PITCH_PX: f64 = 150.0;
/// The motion has turned once it came back by this share of the trial's whole travel.
const TURNED: f64 = 0.005;
/// The axis ends at this many times what all but `BEYOND` of the samples stay below: one peak must not flatten the rest.
const PEAKS: f64 = 12.0;
const BEYOND: f64 = 0.02;
/// Room above and below, as a share of what is shown.
const ROOM: f64 = 0.08;
/// Samples further apart than this many usual periods are not joined by a line.
const GAP_PERIODS: f64 = 10.0;
/// Stretches of a trial of which lowest and highest point are drawn.
const BUCKETS: usize = 700;

/// Residuals of typical and of bad trials, one above the other; `None` without any.
pub fn draw(found: &Identification) -> Drawn<Option<String>> {
    let trials = representative(&found.residuals);
    if trials.is_empty() {
        return Ok(None);
    }
    let units = Units::of(found.model.joint.kind);
    let ranges: Vec<(f64, f64)> = trials.iter().map(|(trial, _)| range_nm(trial)).collect();
    let (unit, factor) = units.torque_scale(ranges.iter().fold(0.0, |m: f64, r| m.max(-r.0).max(r.1)));
    let cut = trials.iter().zip(&ranges).any(|((trial, _), range)| !peaks_beyond(trial, *range).is_empty());
    let height = 62.0 + trials.len() as f64 * PITCH_PX;
    svg(860, height as u32, "Residual against time", |canvas| {
        let entry = |d: Direction| (Mark::Line(2.0, None), palette::direction(d), moving(d).to_string());
        let mut entries = Direction::BOTH.map(entry).to_vec();
        if cut {
            entries.push((Mark::Up, palette::INK, "peak beyond the frame".to_string()));
        }
        canvas.legend((92.0, 840.0), 16.0, &entries)?;
        let middle = 34.0 + (height - 62.0) / 2.0;
        canvas.text((22.0, middle), &format!("residual ({unit})"), LABEL_PX, palette::INK, Anchor::Upwards)?;
        for (i, (trial, note)) in trials.iter().enumerate() {
            let top = 56.0 + i as f64 * PITCH_PX;
            let frame = Frame { left: 92.0, top, right: 840.0, bottom: top + HEIGHT_PX };
            let (from_s, to_s) = span(trial.time_s.iter().copied());
            let y = Axis::around("", [factor * ranges[i].0, factor * ranges[i].1], ROOM);
            let panel = canvas.panel(frame, Axis::linear("", from_s, to_s), y)?;
            let peak = units.torque(thin::magnitude(trial.residual_nm.iter().copied(), 0.0));
            let figures = format!("RMSE {}, peak {peak}", units.torque(trial.rmse_nm()));
            let title = format!("{} ({}), {note}: {figures}", trial.file, trial.protocol.name());
            canvas.text((92.0, top - 11.0), &title, TEXT_PX, palette::INK, Anchor::Left)?;
            let gap_s = GAP_PERIODS * (to_s - from_s) / trial.time_s.len() as f64;
            let mut runs = runs(trial).into_iter();
            runs.try_for_each(|(direction, run)| draw_run(&panel, trial, direction, run, (gap_s, factor)))?;
            for (at, mark) in peaks_beyond(trial, ranges[i]) {
                panel.mark((trial.time_s[at], factor * trial.residual_nm[at]), mark, palette::INK)?;
            }
        }
        canvas.text(((92.0 + 840.0) / 2.0, height - 16.0), "time (s)", LABEL_PX, palette::INK, Anchor::Middle)
    })
    .map(Some)
}

/// What the trial's panel shows: zero and all samples, but for peaks that would flatten the rest.
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
        mine.sort_by(|a, b| residuals[*a].rmse_nm().total_cmp(&residuals[*b].rmse_nm()));
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

/// One run, its torque times `factor`; a pause longer than `gap_s` leaves a gap.
fn draw_run(
    panel: &Panel,
    trial: &Residual,
    direction: Direction,
    run: Range<usize>,
    (gap_s, factor): (f64, f64),
) -> Drawn {
    let total = trial.time_s.len();
    let stroke = Stroke::solid(palette::direction(direction), 1.1);
    let mut start = run.start;
    for i in run.start + 1..=run.end {
        if i == run.end || trial.time_s[i] - trial.time_s[i - 1] > gap_s {
            let points: Vec<(f64, f64)> =
                (start..i).map(|k| (trial.time_s[k], factor * trial.residual_nm[k])).collect();
            let buckets = (BUCKETS * points.len()).div_ceil(total);
            panel.line(thin::envelope(&points, buckets), stroke)?;
            start = i;
        }
    }
    Ok(())
}
