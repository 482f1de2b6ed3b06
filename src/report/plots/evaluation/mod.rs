//! The figures of an evaluation, as the paper's 5 and 7 to 9 lay them out.

mod bars;
mod raw;
mod reversals;
mod series;

use crate::evaluate::{Evaluation, Group, TrialEvaluation};
use crate::log::Protocol;
use crate::report::chart::Drawn;
use crate::report::page::Drawing;
use crate::report::wording::Units;

/// Motions shown, each with its repeats; more would only repeat what these show.
const SHOWN: usize = 6;

/// One motion with its repeats, to be drawn.
struct Shown<'a> {
    /// Beginning of its files' names.
    slug: String,
    /// What it is, in words.
    title: String,
    /// Its trials; the first is drawn in full.
    trials: Vec<&'a TrialEvaluation>,
    units: Units,
    lowpass_hz: f64,
}

/// All figures of `evaluation`, the bars first, then each motion's.
pub fn drawings(evaluation: &Evaluation) -> Drawn<Vec<Drawing>> {
    let mut all = vec![bars::draw(evaluation)?];
    for shown in shown(evaluation) {
        all.push(series::draw(&shown)?);
        all.push(raw::draw(&shown)?);
        all.extend(reversals::draw(&shown, evaluation)?);
    }
    Ok(all)
}

/// Repeats together, others one by one.
fn shown(evaluation: &Evaluation) -> Vec<Shown<'_>> {
    let mut all = Vec::new();
    for group in &evaluation.groups {
        let trials: Vec<&TrialEvaluation> = group.trials.iter().map(|at| &evaluation.trials[*at]).collect();
        match group.repeats {
            true => all.push((slug(group), name(group, trials.len()), trials)),
            false => all.extend(
                trials.into_iter().map(|t| (crate::report::plots::slug(&t.entry.file), t.entry.file.clone(), vec![t])),
            ),
        }
    }
    // Of many sweeps the slowest, the fastest and some between.
    let step = all.len().div_ceil(SHOWN).max(1);
    let units = Units::of(evaluation.model.joint.kind);
    let shown = |(slug, title, trials)| Shown { slug, title, trials, units, lowpass_hz: evaluation.lowpass_hz };
    let mut chosen: Vec<Shown> = all.into_iter().step_by(step).map(shown).collect();
    for at in 1..chosen.len() {
        if chosen[..at].iter().any(|earlier| earlier.slug == chosen[at].slug) {
            chosen[at].slug = format!("{}-{}", chosen[at].slug, at + 1);
        }
    }
    chosen
}

fn name(group: &Group, trials: usize) -> String {
    let protocol = match group.protocol {
        Protocol::Uniform { speed_rad_s } => format!("sweep at {speed_rad_s} rad/s"),
        other => other.name().to_string(),
    };
    let trajectory = group.trajectory.as_ref().map_or(String::new(), |name| format!(" “{name}”"));
    format!("{protocol}{trajectory}, {}", crate::report::number::counted(trials, "trial", "trials"))
}

fn slug(group: &Group) -> String {
    let speed = group.protocol.speed_rad_s().map_or(String::new(), |speed| format!("_{speed}"));
    let trajectory =
        group.trajectory.as_ref().map_or(String::new(), |name| format!("_{}", crate::report::plots::slug(name)));
    format!("{}{speed}{trajectory}", group.protocol.name())
}
