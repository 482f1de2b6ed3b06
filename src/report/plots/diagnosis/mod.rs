//! The figures of a diagnosis.

mod budget;
mod candidates;
mod map;
mod places;
mod residual_position;
mod residual_time;

use crate::diagnose::{Diagnosis, View};
use crate::report::chart::{Drawn, thin};
use crate::report::page::Drawing;

/// Figures that a reader sees first: what the gap is made of, and where it lies.
pub const LEADING: usize = 2;
/// An axis holds all but this share of the samples: one peak must not flatten the rest.
const BEYOND: f64 = 0.002;
/// Room above and below, as a share of what is shown.
const ROOM: f64 = 0.12;

/// All figures that there are data for.
pub fn drawings(found: &Diagnosis) -> Drawn<Vec<Drawing>> {
    let all = [
        Some(budget::draw(found)?),
        map::draw(found)?,
        candidates::draw(found)?,
        places::draw(found)?,
        residual_time::draw(found)?,
        residual_position::draw(found)?,
    ];
    Ok(all.into_iter().flatten().collect())
}

/// What the second of two pictures shows.
fn after_name(found: &Diagnosis) -> &'static str {
    if found.budget.causes.is_empty() { "within the model's own confidence" } else { "with what was found" }
}

/// Measured less predicted, N m: by the model as delivered, and with what was found.
fn residuals_nm(view: &View) -> [Vec<f64>; 2] {
    [&view.before_nm, &view.after_nm]
        .map(|predicted| view.measured_nm.iter().zip(predicted).map(|(y, p)| y - p).collect())
}

/// Rows of `view` that are judged.
fn judged(view: &View) -> impl Iterator<Item = usize> {
    (0..view.judged.len()).filter(|i| view.judged[*i])
}

/// The magnitude that nearly all residuals, before and after, stay below.
fn reach_nm<'v>(views: impl IntoIterator<Item = &'v View>) -> f64 {
    let of = |view: &View| {
        let [before, after] = residuals_nm(view);
        judged(view).flat_map(|i| [before[i], after[i]]).collect::<Vec<f64>>()
    };
    thin::magnitude(views.into_iter().flat_map(of), BEYOND)
}
