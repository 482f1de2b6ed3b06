//! What was tried beside which causes, so that nothing is tried twice in the same place.

use super::candidates::{Cause, Likely, Round};
use std::cell::RefCell;

/// Causes whose squares differ by less than this share keep their order.
const SAME_SCORE: f64 = 1e-3;

/// What was tried so far, and beside which causes.
#[derive(Default)]
pub struct Rounds<'d> {
    all: RefCell<Vec<Beside<'d>>>,
}

/// What was tried beside some causes.
struct Beside<'d> {
    /// Which, in order.
    causes: Vec<(Cause, &'static str)>,
    /// What they leave, (N m)^2.
    score: f64,
    round: Round<'d>,
}

impl<'d> Rounds<'d> {
    /// What was tried beside `causes` (in order) where they left as much as now, `score`, (N m)^2.
    pub fn known(&self, causes: &[(Cause, &'static str)], score: f64) -> Option<Round<'d>> {
        let stand_there =
            |beside: &&Beside<'d>| beside.causes == causes && (beside.score - score).abs() <= SAME_SCORE * score;
        self.all.borrow().iter().find(stand_there).map(|beside| beside.round.clone())
    }

    /// Where to look for the shapes of effects: where the first round found them likely.
    pub fn likely(&self) -> Likely {
        self.all.borrow().first().map_or_else(Likely::new, |first| first.round.likely.clone())
    }

    /// Keeps what was tried beside `causes` (in order), which left `score`, (N m)^2.
    pub fn keep(&self, causes: Vec<(Cause, &'static str)>, score: f64, round: &Round<'d>) {
        self.all.borrow_mut().push(Beside { causes, score, round: round.clone() });
    }
}
