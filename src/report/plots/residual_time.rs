//! Residuals against time, of a few trials.

use crate::identify::{Identification, Residual};
use crate::model::Direction;
use crate::report::chart::{
    Anchor, Axis, Drawn, Frame, LABEL_PX, Mark, Panel, Stroke, TEXT_PX, palette, span, svg, thin,
};
use crate::report::wording::{Units, moving};

/// Trials shown.
const TRIALS: usize = 4;
/// Height of a trial's panel and of the room above it, px.
const HEIGHT_PX: f64 = 104.0;
const GAP_PX: f64 = 46.0;
/// Above this share of the trial's fastest motion the direction is taken from the speed's sign; below it stays.
const MOVING: f64 = 0.02;
/// Stretches of a trial of which lowest and highest point are drawn.
const BUCKETS: usize = 700;
/// The axis holds all but this share of the samples.
const BEYOND: f64 = 0.001;

/// Residuals of typical and of bad trials, one above the other; `None` without any.
pub fn draw(found: &Identification) -> Drawn<Option<String>> {
    let trials = representative(&found.residuals);
    if trials.is_empty() {
        return Ok(None);
    }
    let units = Units::of(found.model.joint.kind);
    let largest = thin::magnitude(trials.iter().flat_map(|r| r.residual_nm.iter().copied()), BEYOND);
    let (unit, factor) = units.torque_scale(largest);
    let reach = 1.15 * factor * largest;
    let height = 34.0 + trials.len() as f64 * (HEIGHT_PX + GAP_PX) + 20.0;
    svg(860, height as u32, "Residual against time", |canvas| {
        let entry = |d: Direction| (Mark::Line(2.0, None), palette::direction(d), moving(d).to_string());
        canvas.legend((92.0, 840.0), 16.0, &Direction::BOTH.map(entry))?;
        let middle = 34.0 + (height - 54.0) / 2.0;
        canvas.text((22.0, middle), &format!("residual ({unit})"), LABEL_PX, palette::INK, Anchor::Upwards)?;
        for (i, trial) in trials.iter().enumerate() {
            let top = 34.0 + i as f64 * (HEIGHT_PX + GAP_PX) + 22.0;
            let frame = Frame { left: 92.0, top, right: 840.0, bottom: top + HEIGHT_PX };
            let (from_s, to_s) = span(trial.time_s.iter().copied());
            let panel = canvas.panel(frame, Axis::linear("", from_s, to_s), Axis::linear("", -reach, reach))?;
            let title = format!("{} ({}), RMSE {}", trial.file, trial.protocol.name(), units.torque(trial.rmse_nm()));
            canvas.text((92.0, top - 10.0), &title, TEXT_PX, palette::INK, Anchor::Left)?;
            runs(trial)
                .iter()
                .try_for_each(|(direction, run)| draw_run(&panel, trial, *direction, run.clone(), factor))?;
        }
        canvas.text((840.0, height - 12.0), "time (s)", LABEL_PX, palette::INK, Anchor::Right)
    })
    .map(Some)
}

/// Of each protocol the trial with the middle and the one with the largest residual, in the campaign's order.
fn representative(residuals: &[Residual]) -> Vec<&Residual> {
    let mut chosen: Vec<usize> = Vec::new();
    let mut protocols: Vec<&str> = Vec::new();
    for name in residuals.iter().map(|r| r.protocol.name()) {
        if !protocols.contains(&name) {
            protocols.push(name);
        }
    }
    for name in protocols {
        let of_protocol = |i: &usize| residuals[*i].protocol.name() == name && residuals[*i].time_s.len() > 1;
        let mut mine: Vec<usize> = (0..residuals.len()).filter(of_protocol).collect();
        mine.sort_by(|a, b| residuals[*a].rmse_nm().total_cmp(&residuals[*b].rmse_nm()));
        chosen.extend(mine.get(mine.len() / 2));
        chosen.extend(mine.last());
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen.truncate(TRIALS);
    chosen.into_iter().map(|i| &residuals[i]).collect()
}

/// Stretches of one direction; noise of the speed at rest does not end one.
fn runs(trial: &Residual) -> Vec<(Direction, std::ops::Range<usize>)> {
    let fastest = trial.velocity_rad_s.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let mut runs: Vec<(Direction, std::ops::Range<usize>)> = Vec::new();
    for (i, v) in trial.velocity_rad_s.iter().enumerate() {
        let direction = if *v >= 0.0 { Direction::Up } else { Direction::Down };
        match runs.last_mut() {
            Some((last, run)) if *last == direction || v.abs() < MOVING * fastest => run.end = i + 1,
            _ => runs.push((direction, i..i + 1)),
        }
    }
    runs
}

/// One run, joined to the next; samples that are missing leave a gap.
fn draw_run(panel: &Panel, trial: &Residual, direction: Direction, run: std::ops::Range<usize>, factor: f64) -> Drawn {
    let total = trial.time_s.len();
    let (from_s, to_s) = span(trial.time_s.iter().copied());
    let usual_s = (to_s - from_s) / total as f64;
    let upto = (run.end + 1).min(total);
    let stroke = Stroke::solid(palette::direction(direction), 1.1);
    let mut start = run.start;
    for i in run.start + 1..=upto {
        if i == upto || trial.time_s[i] - trial.time_s[i - 1] > 10.0 * usual_s {
            let points: Vec<(f64, f64)> =
                (start..i).map(|k| (trial.time_s[k], factor * trial.residual_nm[k])).collect();
            let buckets = (BUCKETS * points.len()).div_ceil(total);
            panel.line(thin::envelope(&points, buckets), stroke)?;
            start = i;
        }
    }
    Ok(())
}
