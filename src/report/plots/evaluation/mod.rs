//! The figures of an evaluation, as the paper's 5 and 7 to 9 lay them out: the bars, then each trial's.

mod bars;
mod raw;
mod reversals;
mod series;

use crate::evaluate::{Evaluation, TrialEvaluation};
use crate::report::chart::{Axis, Figure, Panel, Point};
use crate::report::wording::Units;

/// A trial to be drawn.
struct Shown<'a> {
    /// Beginning of its figures' names.
    slug: String,
    trial: &'a TrialEvaluation,
    units: Units,
    lowpass_hz: f64,
}

impl Shown<'_> {
    /// `values` over the trial's time.
    fn over_time(&self, values: impl IntoIterator<Item = f64>) -> Vec<Point> {
        self.trial.view.time_s.iter().copied().zip(values).collect()
    }

    /// The time axis; only the lowest of several panels has its texts.
    fn time(&self, is_lowest: bool) -> Axis {
        let (from_s, to_s) = crate::report::chart::span(self.trial.view.time_s.iter().copied());
        let axis = Axis::linear("time (s)", from_s, to_s);
        if is_lowest { axis } else { axis.without_texts() }
    }

    /// A panel that zooms with all others of its trial.
    fn panel(&self, is_lowest: bool, y: Axis) -> Panel {
        Panel::new(self.time(is_lowest), y).linked(format!("time of {}", self.trial.entry.file))
    }
}

/// Error by curve of the combination.
pub fn bars(evaluation: &Evaluation) -> Figure {
    bars::figure(evaluation)
}

/// The figures of each trial, by its name.
pub fn trials(evaluation: &Evaluation) -> Vec<(String, Vec<Figure>)> {
    let units = Units::of(&evaluation.model.joint);
    let mut slugs: Vec<String> = Vec::new();
    let mut all = Vec::new();
    for (at, trial) in evaluation.trials.iter().enumerate() {
        let mut slug = super::slug(&trial.entry.file);
        if slugs.contains(&slug) {
            slug = format!("{slug}-{}", at + 1);
        }
        slugs.push(slug.clone());
        let shown = Shown { slug, trial, units, lowpass_hz: evaluation.lowpass_hz };
        let figures = [Some(series::figure(&shown)), reversals::figure(&shown, evaluation), Some(raw::figure(&shown))];
        all.push((trial.entry.file.clone(), figures.into_iter().flatten().collect()));
    }
    all
}
