//! Sets of causes that do nearly as well as those chosen: what explains most alone need not belong to what explains most together.

use super::candidates::{Cause, FittedCause, Hypothesis, names};

/// Sets that are followed beside the chosen one.
const RUNNERS_UP: usize = 2;

/// A set that did nearly as well as the chosen one of its size.
#[derive(Debug, Clone)]
pub struct RunnerUp {
    /// Its causes.
    pub causes: Vec<Hypothesis>,
    /// What it leaves, (N m)^2.
    pub score: f64,
}

impl RunnerUp {
    /// Of `chosen` and one of `tried` more: one for each cause, best first.
    pub fn of_round(chosen: &[Hypothesis], tried: &[FittedCause]) -> Vec<Self> {
        let mut known: Vec<Cause> = Vec::new();
        let of_cause = |tried: &FittedCause| {
            if known.len() > RUNNERS_UP || known.contains(&tried.cause) {
                return None;
            }
            known.push(tried.cause);
            let causes = chosen.iter().cloned().chain(tried.hypothesis()).collect();
            Some(Self { causes, score: tried.score() })
        };
        tried.iter().filter_map(of_cause).collect()
    }

    /// The best of `all` that are not the causes that were `chosen`.
    pub fn best_of(mut all: Vec<Self>, chosen: &[Hypothesis]) -> Vec<Self> {
        all.sort_by(|a, b| a.score.total_cmp(&b.score));
        let mut known = vec![names(chosen)];
        all.retain(|one| {
            let own = names(&one.causes);
            let is_new = !known.contains(&own);
            known.push(own);
            is_new
        });
        all.truncate(RUNNERS_UP);
        all
    }
}
