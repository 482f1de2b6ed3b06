//! The figures of a diagnosis.

pub mod budget;
pub mod candidates;
mod map;
pub mod motion;
mod places;
mod residual_position;
mod residual_time;

use crate::diagnose::{Cause, Diagnosis, View};
use crate::report::chart::{Color, Figure, palette, thin};

/// An axis holds all but this share of the samples: one peak must not flatten the rest.
const BEYOND: f64 = 0.002;
/// Room above and below, as a share of what is shown.
const ROOM: f64 = 0.12;
/// Stretches of contact, the same in every figure.
const CONTACT: Color = palette::ORANGE;

/// The figures of a diagnosis, as far as there are data for them.
pub struct Figures {
    /// What the gap is made of: the one to see first.
    pub budget: Figure,
    /// Where it lies over position and speed, before and after.
    pub map: Option<Figure>,
    /// The candidate causes.
    pub candidates: Option<Figure>,
    /// Where it lies, by region.
    pub places: Option<Figure>,
    /// The residual over position.
    pub position: Option<Figure>,
    /// The residual of each trial over time, the largest first.
    pub trials: Vec<(String, Figure)>,
    /// The gap in motion, where a simulator's log was compared.
    pub motion: Option<Figure>,
}

/// All figures.
pub fn figures(found: &Diagnosis) -> Figures {
    Figures {
        budget: budget::figure(found),
        map: map::figure(found),
        candidates: candidates::figure(found),
        places: places::figure(found),
        position: residual_position::figure(found),
        trials: residual_time::figures(found),
        motion: found.motion.as_ref().and_then(|gap| motion::figure(gap, found.before.joint.kind)),
    }
}

/// The residual of one trial under one model.
struct Residual {
    /// Measured less predicted, N m.
    nm: Vec<f64>,
    /// Whether the row counts.
    counts: Vec<bool>,
}

impl Residual {
    /// Rows that count.
    fn rows(&self) -> impl Iterator<Item = usize> {
        (0..self.counts.len()).filter(|i| self.counts[*i])
    }

    /// Mean square over the rows that count, (N m)^2.
    fn mean_square(&self) -> f64 {
        self.rows().map(|i| self.nm[i] * self.nm[i]).sum::<f64>() / self.rows().count().max(1) as f64
    }
}

/// Whether contact is among the causes: what happens within one is then explained, though by no model.
fn names_contact(found: &Diagnosis) -> bool {
    found.budget.causes.iter().any(|(cause, _)| *cause == Cause::CONTACT)
}

/// The residuals of `view`: by the model as delivered, and with what was found.
fn residuals(found: &Diagnosis, view: &View) -> [Residual; 2] {
    let less = |predicted_nm: &[f64]| view.measured_nm.iter().zip(predicted_nm).map(|(y, p)| y - p).collect();
    let mut outside = view.judged.clone();
    if names_contact(found) {
        for contact in found.contacts.iter().filter(|contact| contact.file == view.file) {
            let within = |time_s: &f64| (contact.from_s..=contact.to_s).contains(time_s);
            view.time_s.iter().zip(&mut outside).for_each(|(time_s, counts)| *counts &= !within(time_s));
        }
    }
    [
        Residual { nm: less(&view.before_nm), counts: view.judged.clone() },
        Residual { nm: less(&view.after_nm), counts: outside },
    ]
}

/// What the second of two pictures shows.
fn after_name(found: &Diagnosis) -> &'static str {
    let found_more = found.budget.causes.iter().any(|(cause, _)| *cause != Cause::CONTACT);
    match (found_more, names_contact(found)) {
        (true, true) => "with the causes found, contacts left out",
        (true, false) => "with the causes found",
        (false, true) => "contacts left out",
        (false, false) => "own parameters refitted within their confidence",
    }
}

/// The magnitude that nearly all residuals, before and after, stay below, N m.
fn reach_nm<'v>(found: &Diagnosis, views: impl IntoIterator<Item = &'v View>) -> f64 {
    let of = |view: &View| {
        let both = residuals(found, view);
        both.iter()
            .flat_map(|residual| residual.rows().map(|i| residual.nm[i]).collect::<Vec<f64>>())
            .collect::<Vec<_>>()
    };
    thin::magnitude(views.into_iter().flat_map(of), BEYOND)
}
