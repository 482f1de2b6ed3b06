//! Every cause tried beside those that are known, and not twice in the same place.

use super::candidates::{Cause, Hypothesis, Likely, Round, try_all};
use super::choose::Search;
use super::fit::Fit;
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

impl<'d> Search<'d, '_> {
    /// Everything, or what is `among` some causes, tried beside `known`, whose fit is `fit`, in a place where some cause is known to have
    /// `reached` a score: again only if the same causes stand elsewhere than before.
    pub fn round(&self, known: &[Hypothesis], fit: &Fit<'d>, among: Option<&[Cause]>, reached: f64) -> Round<'d> {
        let mut causes: Vec<_> = known.iter().map(|hypothesis| (hypothesis.cause, hypothesis.how)).collect();
        causes.sort_unstable();
        let score = fit.score();
        let stand_there =
            |beside: &&Beside<'d>| beside.causes == causes && (beside.score - score).abs() <= SAME_SCORE * score;
        if let Some(beside) = self.rounds.all.borrow().iter().find(stand_there) {
            return beside.round.clone();
        }
        let known: Vec<Cause> = known.iter().map(|hypothesis| hypothesis.cause).collect();
        let likely = self.rounds.all.borrow().first().map_or_else(Likely::new, |first| first.round.likely.clone());
        let wanted = |cause: Cause| !known.contains(&cause) && among.is_none_or(|among| among.contains(&cause));
        let round = try_all(&self.base_of(fit), wanted, &likely, reached, self.listener);
        if among.is_some() {
            return round;
        }
        self.rounds.all.borrow_mut().push(Beside { causes, score, round: round.clone() });
        round
    }
}
